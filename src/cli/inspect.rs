//! `gnomon inspect`: what a scene requires, which techniques apply, and what to expect of one before it is measured.

use super::args::InspectArgs;
use super::columns::{columns, text};
use super::command::{as_typed, quoted};
use super::context::{lights, load, open_gpu};
use super::exit;
use super::terminal::{Terminal, say};
use crate::evaluate::View;
use crate::gpu::Gpu;
use crate::inspect::{DepthRange, MeshReport, SceneReport, inspect};
use crate::receiver::PixelClass;
use crate::scene::{Far, Light, Scene};
use crate::shade::terminator;
use crate::technique::{Spec, registry};

pub(super) fn run(args: &InspectArgs, terminal: &Terminal) -> anyhow::Result<u8> {
    let typed = args.technique.as_deref().map(Spec::parse).transpose()?;
    let scene = load(&args.scene.scene, args.scene.size)?;
    let lights = lights(&scene, args.scene.light.as_deref())?;
    let report = inspect(&scene);
    say(&format!("{}: {}\n", scene.name, scene.about));
    say(&meshes(&report.meshes));
    say(&geometry(&scene, &report));
    let gpu = open_gpu()?;
    let view = View::new(&gpu, &scene)?;
    for light in lights {
        terminal.proceed()?;
        say(&light_facts(&view, light, &report));
        match &typed {
            None => say(&applicability(&gpu, &scene, light)?),
            Some(spec) => say(&prediction(&view, light, spec)?),
        }
    }
    let technique = typed.map_or_else(String::new, |spec| format!(" -t {}", quoted(&spec.short())));
    say(&format!("next step: gnomon check {}{technique}", as_typed(&args.scene)));
    Ok(exit::OK)
}

/// One row per mesh, with what keeps it from being closed.
fn meshes(reports: &[MeshReport]) -> String {
    /// More meshes than this are summed up in one row.
    const LISTED: usize = 24;
    let mut table = columns();
    table.set_header([
        "mesh",
        "triangles",
        "casts",
        "closed",
        "outward",
        "open edges",
        "T-junctions",
        "non-manifold",
        "degenerate",
        "duplicate",
    ]);
    for mesh in reports.iter().take(LISTED) {
        let yes_no = |is: bool| if is { "yes" } else { "no" }.to_owned();
        table.add_row([
            mesh.name.clone(),
            mesh.triangles.to_string(),
            yes_no(mesh.casts),
            yes_no(mesh.is_closed),
            yes_no(mesh.is_outward),
            mesh.open_edges.to_string(),
            (mesh.t_junctions_exact + mesh.t_junctions_near).to_string(),
            mesh.non_manifold_edges.to_string(),
            mesh.degenerate_triangles.to_string(),
            mesh.duplicate_triangles.to_string(),
        ]);
    }
    let rest = reports.len().saturating_sub(LISTED);
    let open = reports.iter().filter(|mesh| mesh.casts && !mesh.is_closed).count();
    let more = if rest > 0 { format!("\n… and {rest} more meshes") } else { String::new() };
    format!("{}{more}\n{} meshes, {open} of the casters open\n", text(table, ""), reports.len())
}

fn range(range: Option<DepthRange>) -> String {
    range.map_or_else(|| "nothing".to_owned(), |r| format!("{:.4} m to {:.4} m", r.nearest_m, r.farthest_m))
}

fn geometry(scene: &Scene, report: &SceneReport) -> String {
    let far = match scene.camera.far {
        Far::Infinite => "infinite".to_owned(),
        Far::Finite(far_m) => format!("{far_m:.6} m"),
    };
    format!(
        "extent               {:.4} m\ncamera sees          {}\ncamera near, far     {:.6} m, {far}\n\
         recommended          {}\nreceiver planes      {}\n",
        report.extent_m,
        range(report.view_depth),
        scene.camera.near_m,
        range(report.recommended_view),
        report.planes
    )
}

fn light_facts(view: &View<'_>, light: &Light, report: &SceneReport) -> String {
    let classes = view.receivers.classify(view.scene, light);
    let count = |class: PixelClass| classes.iter().filter(|c| **c == class).count();
    let of_light = report.lights.iter().find(|l| l.name == light.name);
    let cone = of_light.and_then(|l| l.receivers_half_angle_rad).map_or_else(String::new, |half| {
        format!("\n  receivers span     {:.1} degrees around the aim", 2.0 * half.to_degrees())
    });
    format!(
        "light '{}' ({})\n  casters            {}\n  receivers          {}{cone}\n  \
         pixels asked       {} of {}, {} facing away, {} not lit\n  terminator         {} pixels: facet turned away, \
         interpolated normal still lit (looks like acne, no shadow technique causes it)",
        light.name,
        light.kind_name(),
        range(of_light.and_then(|l| l.casters)),
        range(of_light.and_then(|l| l.receivers)),
        count(PixelClass::Asked),
        classes.len(),
        count(PixelClass::FacingAway),
        count(PixelClass::NotLit),
        terminator(view.scene, &view.receivers, light).iter().filter(|is| **is).count(),
    )
}

/// Which techniques apply to a light, and why the others don't.
fn applicability(gpu: &Gpu, scene: &Scene, light: &Light) -> anyhow::Result<String> {
    let mut lines = Vec::new();
    for technique in registry() {
        let spec = Spec::parse(technique.id())?;
        let verdict = match technique.supports(&spec, scene, light, gpu) {
            Ok(()) => "applies".to_owned(),
            Err(why) => format!("not applicable: {why}"),
        };
        lines.push(format!("  {:<18} {verdict}", technique.id()));
    }
    Ok(format!("{}\n", lines.join("\n")))
}

/// What to expect of one technique, before it runs.
fn prediction(view: &View<'_>, light: &Light, spec: &Spec) -> anyhow::Result<String> {
    let classes = view.receivers.classify(view.scene, light);
    let prepared = match spec.technique().prepare(spec, view.job(light, &classes)) {
        Ok(prepared) => prepared,
        Err(crate::technique::TechniqueError::Unsupported(why)) => return Ok(format!("  not applicable: {why}\n")),
        Err(error) => return Err(error.into()),
    };
    let mut lines: Vec<String> =
        prepared.facts().into_iter().map(|(label, value)| format!("  {label:<18} {value}")).collect();
    let asked = (0..classes.len()).filter(|pixel| classes[*pixel] == PixelClass::Asked);
    let mut m: Vec<f64> = asked.filter_map(|pixel| prepared.footprint(pixel as u32)).map(|f| f.m).collect();
    m.sort_by(f64::total_cmp);
    if let (Some(least), Some(middle), Some(most)) = (m.first(), m.get(m.len() / 2), m.last()) {
        let undersampled = m.iter().filter(|m| **m > 1.0).count() as f64 / m.len() as f64;
        lines.push(format!(
            "  {:<18} min {least:.2}, median {middle:.2}, max {most:.2}; {:.1} % of pixels undersampled (m > 1)",
            "texel in pixels, m",
            100.0 * undersampled
        ));
    }
    Ok(format!("{}\n", lines.join("\n")))
}
