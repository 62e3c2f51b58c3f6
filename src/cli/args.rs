//! What the user can type.

use super::exit;
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
    /// Draw a scene, lit with the shadows of a technique or with the exact ones
    #[command(after_help = "Examples:\n  gnomon render scenes/room -t map:size=512 -o room.png\n  \
        gnomon render scenes/torus --light lamp --show volumes -o volumes.png\n  \
        gnomon render scenes/torus -t volume --pipeline darkening --darkening 0.6 -o dark.png")]
    Render(RenderArgs),
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
    /// Explain one pixel: ray, occluder, every stage of the technique, the cause and the fix
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
    /// Formats to write to --out besides report.json, separated by commas: csv, markdown, junit
    #[arg(long, value_name = "LIST", value_delimiter = ',', requires = "out")]
    pub(super) format: Vec<String>,
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

fn share(typed: &str) -> Result<f64, String> {
    let share = typed.parse().ok().filter(|share| (0.0..=1.0).contains(share));
    share.ok_or_else(|| format!("'{typed}' is not between 0 and 1"))
}

fn size(typed: &str) -> Result<UVec2, String> {
    pair(typed, 'x').filter(|size| size.min_element() > 0).ok_or_else(|| format!("'{typed}' is not like 1024x768"))
}

fn pixel(typed: &str) -> Result<UVec2, String> {
    pair(typed, ',').ok_or_else(|| format!("'{typed}' is not like 512,400"))
}

fn pair(typed: &str, separator: char) -> Option<UVec2> {
    let (x, y) = typed.split_once(separator)?;
    Some(UVec2::new(x.trim().parse().ok()?, y.trim().parse().ok()?))
}
