//! What the user can type.

use super::exit;
use super::sweep::Shard;
use clap::{Args, Parser, Subcommand};
use glam::UVec2;
use std::path::PathBuf;

/// gnomon measures real-time shadows against exact ray casting and explains every wrong pixel.
#[derive(Debug, Parser)]
#[command(version, after_help = exit::HELP, arg_required_else_help = true)]
pub(super) struct Cli {
    #[command(subcommand)]
    pub(super) command: Command,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Judge techniques on scenes: a table, and with --out report.json and error maps
    #[command(after_help = "Examples:\n  gnomon check scenes/torus\n  \
        gnomon check scenes/room -t map:size=2048,filter=pcf-box3 --light lamp --out out/room\n  \
        gnomon check model.obj -t map:bias=none --size 640x480")]
    Check(CheckArgs),
    /// Tell what changed from one report.json to another; exit 1 on a regression
    #[command(
        after_help = "Example:\n  gnomon compare out/main/report.json out/mine/report.json --max-new-wrong 0.01%"
    )]
    Compare(CompareArgs),
    /// Measure every configuration of some grids: rows, fronts and plots
    #[command(
        after_help = "Examples:\n  gnomon sweep scenes/room --light spot --grid 'map:size=256..4096,filter=nearest|pcf-box3' --out out/sweep\n  \
        gnomon sweep scenes/room --grid 'map:size=256..4096' --out out/part-1 --shard 1/3\n\n\
        In a grid a..b doubles from a to b, and | separates values. Called again with the same --out, it goes on where \
        it ended, however it ended."
    )]
    Sweep(SweepArgs),
    /// Join the results of several sweeps, such as the shards of one
    #[command(after_help = "Example:\n  gnomon merge out/part-1 out/part-2 out/part-3 --out out/whole")]
    Merge(MergeArgs),
    /// Find the cheapest technique within a budget
    #[command(after_help = "Examples:\n  gnomon advise scenes/room --light spot --max-wrong 0.1%\n  \
        gnomon advise scenes/torus --light lamp --max-wrong 0.01% --max-ms 5\n\nExit code 1 if nothing keeps to the budget.")]
    Advise(AdviseArgs),
    /// Repeat published experiments, with the error of every answer
    #[command(after_help = "Example:\n  gnomon bench-published")]
    BenchPublished(BenchPublishedArgs),
    /// Draw a scene, lit with the shadows of a technique or with the exact ones
    #[command(after_help = "Examples:\n  gnomon render scenes/room -t map:size=512 -o room.png\n  \
        gnomon render scenes/torus --light lamp --show volumes -o volumes.png\n  \
        gnomon render scenes/torus -t volume --pipeline darkening --darkening 0.6 -o dark.png")]
    Render(RenderArgs),
    /// Measure a technique's shadow along a line of the picture: penumbra widths, CSV and plot
    #[command(
        after_help = "Example:\n  gnomon profile scenes/area --light panel -t soft --line 330,240,300,300 --out out/profile"
    )]
    Profile(ProfileArgs),
    /// Compare our pictures of a scene with Mitsuba's, radiance by radiance
    #[command(after_help = "Example:\n  gnomon compare-render scenes/room -t map:size=2048 --out out/compare")]
    CompareRender(CompareRenderArgs),
    /// Write the exact visibility of a light as an image
    #[command(after_help = "Example:\n  gnomon truth scenes/torus --light lamp -o truth.png")]
    Truth(TruthArgs),
    /// Write a technique's visibility of a light as an image
    #[command(after_help = "Example:\n  gnomon mask scenes/torus --light lamp -t map:size=256 -o mask.exr")]
    Mask(MaskArgs),
    /// Judge a visibility image that another renderer made for a scene
    #[command(after_help = "Example:\n  gnomon judge scenes/torus --light lamp my-engine.png\n\n\
        The image: grey is visibility (0 shadow, 255 lit), alpha 255 where answered; EXR: float channels V and A.")]
    Judge(JudgeArgs),
    /// Tell what a scene requires, which techniques apply, and what to expect of one
    #[command(after_help = "Example:\n  gnomon inspect scenes/room -t map:size=1024")]
    Inspect(InspectArgs),
    /// Explain one pixel: ray, occluder, every stage, the cause and the fix
    #[command(after_help = "Example:\n  gnomon explain scenes/torus -t map:bias=none --light lamp --pixel 512,400")]
    Explain(ExplainArgs),
    /// Find what is wrong with a technique's shadows, and try the fixes
    #[command(after_help = "Example:\n  gnomon diagnose scenes/torus -t map:size=512,bias=none --light lamp")]
    Diagnose(DiagnoseArgs),
    /// Write the scene file that gnomon makes around a bare OBJ, beside it
    #[command(after_help = "Example:\n  gnomon scaffold models/teapot.obj")]
    Scaffold(ScaffoldArgs),
    /// List the scenes of a folder, the techniques and their parameters, or the presets
    #[command(after_help = "Examples:\n  gnomon list techniques\n  gnomon list scenes --folder my/scenes\n  \
        gnomon list --matrix")]
    List(ListArgs),
    /// Tell what this machine can do: adapters, features, limits, oracles, versions
    #[command(after_help = "Examples:\n  gnomon doctor\n  GNOMON_ADAPTER=1 gnomon doctor")]
    Doctor,
}

/// The scene and what to look at.
#[derive(Debug, Args)]
pub(super) struct SceneArgs {
    /// Scene folder, scene.toml or OBJ file
    pub(super) scene: PathBuf,
    /// Only this light [default: every light; a command that answers for one light wants its name if there are several]
    #[arg(long, value_name = "NAME")]
    pub(super) light: Option<String>,
    /// Picture size in pixels, instead of the scene's
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub(super) size: Option<UVec2>,
}

#[derive(Debug, Args)]
pub(super) struct CheckArgs {
    /// Scene folders, scene.toml or OBJ files
    #[arg(required = true, value_name = "SCENE")]
    pub(super) scenes: Vec<PathBuf>,
    /// Technique, e.g. map:size=2048,filter=pcf-box3 [default: the scene's budgets, or a small set]
    #[arg(short, long, value_name = "SPEC")]
    pub(super) technique: Vec<String>,
    /// Only this light [default: every light]
    #[arg(long, value_name = "NAME")]
    pub(super) light: Option<String>,
    /// Picture size in pixels, instead of the scene's
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub(super) size: Option<UVec2>,
    /// Shift the light's texel grid N times by sub-texel steps; budgets then bind the mean
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=1024))]
    pub(super) jitter: u32,
    /// Move the camera, then the light, by N quarter-pixel steps, and count the pixels that flip though the truth does not
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=256))]
    pub(super) motion: u32,
    /// Who answers for the truth; both: exact, and every ray again by Mitsuba
    #[arg(long, value_enum, default_value_t = OracleChoice::Exact)]
    pub(super) oracle: OracleChoice,
    /// Write report.json and pictures here
    #[arg(long, value_name = "DIR")]
    pub(super) out: Option<PathBuf>,
    /// Formats to write to --out besides report.json, separated by commas: csv, markdown, junit, html
    #[arg(long, value_name = "LIST", value_delimiter = ',', requires = "out")]
    pub(super) format: Vec<String>,
}

#[derive(Debug, Args)]
pub(super) struct CompareArgs {
    /// The earlier report.json, or its folder
    pub(super) before: PathBuf,
    /// The later one
    pub(super) after: PathBuf,
    /// Growth of the share of wrong pixels that is no regression yet, e.g. 0.01%
    #[arg(long, value_name = "SHARE", default_value = "0", value_parser = share)]
    pub(super) max_new_wrong: f64,
    /// Ratio of counted work (vertices, primitives, fragments, bytes) that is no regression yet
    #[arg(long, value_name = "RATIO", default_value_t = 1.0)]
    pub(super) max_work_ratio: f64,
    /// Ratio of GPU milliseconds that is no regression yet, on one hardware adapter [default: times do not count]
    #[arg(long, value_name = "RATIO")]
    pub(super) max_ms_ratio: Option<f64>,
}

#[derive(Debug, Args)]
pub(super) struct SweepArgs {
    /// Scene folders, scene.toml or OBJ files
    #[arg(required = true, value_name = "SCENE")]
    pub(super) scenes: Vec<PathBuf>,
    /// Configurations, e.g. 'map:size=256..4096,filter=nearest|pcf-box3'
    #[arg(long, value_name = "GRID", required = true)]
    pub(super) grid: Vec<String>,
    /// Only this light [default: every light]
    #[arg(long, value_name = "NAME")]
    pub(super) light: Option<String>,
    /// Picture size in pixels, instead of the scene's
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub(super) size: Option<UVec2>,
    /// Write results here, or go on with those that are here
    #[arg(long, value_name = "DIR")]
    pub(super) out: PathBuf,
    /// Measure only the I-th of N equal shares of the rows
    #[arg(long, value_name = "I/N", default_value = "1/1", value_parser = shard)]
    pub(super) shard: Shard,
    /// A row that takes longer has failed
    #[arg(long, value_name = "S", default_value_t = 300.0)]
    pub(super) row_seconds: f64,
    /// A row whose maps and buffers take more on the GPU has failed [default: no limit]
    #[arg(long, value_name = "MB")]
    pub(super) row_megabytes: Option<f64>,
    /// Where truths are kept between calls [default: the folder truth in --out]
    #[arg(long, value_name = "DIR")]
    pub(super) truth_cache: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(super) struct MergeArgs {
    /// Folders with a results.jsonl
    #[arg(required = true, value_name = "DIR")]
    pub(super) folders: Vec<PathBuf>,
    /// Write the joined results here
    #[arg(long, value_name = "DIR")]
    pub(super) out: PathBuf,
}

#[derive(Debug, Args)]
pub(super) struct AdviseArgs {
    #[command(flatten)]
    pub(super) scene: SceneArgs,
    /// Largest share of wrong pixels among the asked, e.g. 0.1%
    #[arg(long, value_name = "SHARE", value_parser = share)]
    pub(super) max_wrong: f64,
    /// Largest GPU time, milliseconds
    #[arg(long, value_name = "MS")]
    pub(super) max_ms: Option<f64>,
    /// Texel phases over which the share of wrong pixels is the mean
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub(super) phases: u32,
    /// Only these configurations, as in sweep [default: maps, volumes, and every other technique as it is by default]
    #[arg(long, value_name = "GRID")]
    pub(super) grid: Vec<String>,
}

#[derive(Debug, Args)]
pub(super) struct BenchPublishedArgs {
    /// Folder with the scenes torus, pipe and polygons-*
    #[arg(long, value_name = "DIR", default_value = "scenes")]
    pub(super) folder: PathBuf,
    /// Picture size in pixels, instead of the scenes'
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub(super) size: Option<UVec2>,
}

#[derive(Debug, Args)]
pub(super) struct RenderArgs {
    #[command(flatten)]
    pub(super) scene: SceneArgs,
    /// Technique whose shadows to draw [default: the exact shadows]
    #[arg(short, long, value_name = "SPEC")]
    pub(super) technique: Option<String>,
    /// How the shadows are applied: light on ambient, light on black, or darkness on light
    #[arg(long, value_enum, default_value_t = PipelineName::AmbientLit)]
    pub(super) pipeline: PipelineName,
    /// With --pipeline darkening: how much of the light a shadow takes away, 0 to 1
    #[arg(long, value_name = "SHARE", default_value_t = 0.5, value_parser = share)]
    pub(super) darkening: f64,
    /// Draw what the technique works with into the picture of one light
    #[arg(long, value_enum)]
    pub(super) show: Option<Show>,
    /// Picture to write: .png (sRGB) or .exr (linear, unclamped)
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: PathBuf,
}

/// Names of [`crate::shade::Pipeline`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum PipelineName {
    /// Ambient light, then each light where it is seen
    AmbientLit,
    /// All lighting where a light is seen, black elsewhere
    Black,
    /// All lighting, then a dark quad over each light's shadow
    Darkening,
}

/// What `render --show` draws.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum Show {
    /// Shadow volumes, translucent, with their edges
    Volumes,
    /// The edges at which casters end as the light sees them
    Silhouette,
    /// How many volumes the stencil counted at each pixel, in false colour
    Stencil,
    /// What the light sees, by stored depth
    DepthMap,
    /// The light's frustum in the scene
    Frustum,
}

impl Show {
    /// As it is typed.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Volumes => "volumes",
            Self::Silhouette => "silhouette",
            Self::Stencil => "stencil",
            Self::DepthMap => "depth-map",
            Self::Frustum => "frustum",
        }
    }
}

#[derive(Debug, Args)]
pub(super) struct ProfileArgs {
    #[command(flatten)]
    pub(super) scene: SceneArgs,
    /// Technique
    #[arg(short, long, value_name = "SPEC")]
    pub(super) technique: String,
    /// First and last pixel, from the top left
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = line)]
    pub(super) line: [UVec2; 2],
    /// Write profile.csv and profile.svg here
    #[arg(long, value_name = "DIR")]
    pub(super) out: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(super) struct CompareRenderArgs {
    #[command(flatten)]
    pub(super) scene: SceneArgs,
    /// Technique whose shadows to compare as well; the exact ones always are
    #[arg(short, long, value_name = "SPEC")]
    pub(super) technique: Vec<String>,
    /// Write compare.json and the pictures as EXR here
    #[arg(long, value_name = "DIR")]
    pub(super) out: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(super) struct TruthArgs {
    #[command(flatten)]
    pub(super) scene: SceneArgs,
    /// Who answers; both: exact, with Mitsuba's disagreements told
    #[arg(long, value_enum, default_value_t = OracleChoice::Exact)]
    pub(super) oracle: OracleChoice,
    /// Image to write: .png or .exr
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: PathBuf,
}

#[derive(Debug, Args)]
pub(super) struct MaskArgs {
    #[command(flatten)]
    pub(super) scene: SceneArgs,
    /// Technique
    #[arg(short, long, value_name = "SPEC")]
    pub(super) technique: String,
    /// Image to write: .png or .exr
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: PathBuf,
}

#[derive(Debug, Args)]
pub(super) struct JudgeArgs {
    #[command(flatten)]
    pub(super) scene: SceneArgs,
    /// Visibility image: .png or .exr
    pub(super) mask: PathBuf,
    /// Write report.json and an error map here
    #[arg(long, value_name = "DIR")]
    pub(super) out: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(super) struct InspectArgs {
    #[command(flatten)]
    pub(super) scene: SceneArgs,
    /// Technique to predict
    #[arg(short, long, value_name = "SPEC")]
    pub(super) technique: Option<String>,
}

#[derive(Debug, Args)]
pub(super) struct ExplainArgs {
    #[command(flatten)]
    pub(super) scene: SceneArgs,
    /// Technique
    #[arg(short, long, value_name = "SPEC")]
    pub(super) technique: String,
    /// Pixel, from the top left
    #[arg(long, value_name = "X,Y", value_parser = pixel)]
    pub(super) pixel: UVec2,
}

#[derive(Debug, Args)]
pub(super) struct DiagnoseArgs {
    #[command(flatten)]
    pub(super) scene: SceneArgs,
    /// Technique
    #[arg(short, long, value_name = "SPEC")]
    pub(super) technique: String,
}

#[derive(Debug, Args)]
pub(super) struct ScaffoldArgs {
    /// OBJ file
    pub(super) obj: PathBuf,
}

#[derive(Debug, Args)]
pub(super) struct ListArgs {
    /// What to list
    #[arg(required_unless_present = "matrix")]
    pub(super) what: Option<Listed>,
    /// Which technique handles which kind of light, and what it needs
    #[arg(long, conflicts_with = "what")]
    pub(super) matrix: bool,
    /// Folder to look for scenes in
    #[arg(long, value_name = "DIR", default_value = "scenes")]
    pub(super) folder: PathBuf,
}

/// Who answers for the truth.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum OracleChoice {
    /// The exact ray core
    Exact,
    /// Mitsuba 3; where the exact ray core says otherwise, nobody
    Mitsuba,
    /// The exact ray core, and Mitsuba beside it
    Both,
}

#[derive(Debug, Clone, Copy, clap::ValueEnum)]
pub(super) enum Listed {
    Scenes,
    Techniques,
    Presets,
}

fn size(typed: &str) -> Result<UVec2, String> {
    pair(typed, 'x').filter(|size| size.min_element() > 0).ok_or_else(|| format!("'{typed}' is not like 1024x768"))
}

/// `0.1%` or `0.001`.
fn share(typed: &str) -> Result<f64, String> {
    let (number, unit) = typed.strip_suffix('%').map_or((typed, 1.0), |number| (number, 0.01));
    let share = number.trim().parse().ok().map(|number: f64| unit * number);
    share
        .filter(|share| (0.0..=1.0).contains(share))
        .ok_or_else(|| format!("'{typed}' is not between 0 and 1, like 0.1% or 0.001"))
}

fn shard(typed: &str) -> Result<Shard, String> {
    let shard =
        typed.split_once('/').and_then(|(part, of)| Some(Shard { part: part.parse().ok()?, of: of.parse().ok()? }));
    shard.filter(|shard| (1..=shard.of).contains(&shard.part)).ok_or_else(|| format!("'{typed}' is not like 1/3"))
}

fn pixel(typed: &str) -> Result<UVec2, String> {
    pair(typed, ',').ok_or_else(|| format!("'{typed}' is not like 512,400"))
}

fn line(typed: &str) -> Result<[UVec2; 2], String> {
    let numbers: Option<Vec<u32>> = typed.split(',').map(|number| number.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some([x0, y0, x1, y1]) => Ok([UVec2::new(*x0, *y0), UVec2::new(*x1, *y1)]),
        _ => Err(format!("'{typed}' is not like 100,200,300,200")),
    }
}

fn pair(typed: &str, separator: char) -> Option<UVec2> {
    let (x, y) = typed.split_once(separator)?;
    Some(UVec2::new(x.trim().parse().ok()?, y.trim().parse().ok()?))
}
