//! `gnomon profile`: visibility along a line of the picture, and every penumbra's width beside the predicted one.

use super::args::ProfileArgs;
use super::context::{load, only_light, open_gpu, prepare};
use super::exit;
use super::output::OutFolder;
use super::terminal::{Terminal, say};
use crate::evaluate::{Penumbra, Sample, View, penumbras, predicted_at, profile};
use crate::report::profile::{profile_csv, profile_plot};
use crate::technique::Spec;
use anyhow::bail;

pub(super) fn run(args: &ProfileArgs, terminal: &Terminal) -> anyhow::Result<u8> {
    let spec = Spec::parse(&args.technique)?;
    let scene = load(&args.scene.scene, args.scene.size)?;
    let light = only_light(&scene, &args.scene)?;
    let size = scene.image_size;
    if let Some(outside) = args.line.iter().find(|pixel| pixel.cmpge(size).any()) {
        bail!("pixel {},{} lies outside the picture of {} x {} pixels", outside.x, outside.y, size.x, size.y);
    }
    let out = args.out.as_deref().map(OutFolder::open).transpose()?;
    let gpu = open_gpu()?;
    let view = View::new(&gpu, &scene)?;
    let question = view.ask(light, terminal)?;
    let mask = prepare(&spec, &view, light, &question.classes)?.run()?.mask;
    terminal.proceed()?;
    let samples = profile(&view, light, &question.truth.mask, &mask, args.line);
    let of_truth = penumbras(&samples, |sample| sample.truth);
    let of_technique = penumbras(&samples, |sample| sample.technique);
    let [from, to] = args.line;
    let title = format!(
        "{}, light '{}', {}, pixels {},{} to {},{}",
        scene.name,
        light.name,
        spec.short(),
        from.x,
        from.y,
        to.x,
        to.y
    );
    terminal.finish();
    say(&title);
    say(&table(&samples, &of_truth, &of_technique));
    if let Some(out) = &out {
        let predicted = |penumbra: &Penumbra| {
            let (middle_m, width_m) = (0.5 * (penumbra.from_m + penumbra.to_m), predicted_at(&samples, penumbra)?);
            Some([middle_m - 0.5 * width_m, middle_m + 0.5 * width_m])
        };
        let spans: Vec<[f64; 2]> = of_truth.iter().filter_map(predicted).collect();
        say(&format!("wrote {}", out.write("profile.csv", &profile_csv(&samples)?)?.display()));
        let plot = profile_plot(&title, &samples, &spans)?;
        say(&format!("wrote {}", out.write("profile.svg", plot.as_bytes())?.display()));
    }
    Ok(exit::OK)
}

/// One line per penumbra of the truth, with the technique's that overlaps it most.
fn table(samples: &[Sample], of_truth: &[Penumbra], of_technique: &[Penumbra]) -> String {
    if of_truth.is_empty() {
        return "  no penumbra: the line never leads from full light to full shadow".to_owned();
    }
    let metres = |width: Option<f64>| width.map_or_else(|| "-".to_owned(), |width| format!("{width:.4}"));
    let rows = of_truth.iter().map(|penumbra| {
        let overlap = |other: &Penumbra| other.to_m.min(penumbra.to_m) - other.from_m.max(penumbra.from_m);
        let theirs = of_technique.iter().filter(|other| overlap(other) >= 0.0);
        let theirs = theirs.max_by(|a, b| overlap(a).total_cmp(&overlap(b))).map(Penumbra::width_m);
        format!(
            "  {:>9.4} m {:>9.4} m   {:>9} {:>9} {:>9}",
            penumbra.from_m,
            penumbra.to_m,
            metres(Some(penumbra.width_m())),
            metres(theirs),
            metres(predicted_at(samples, penumbra))
        )
    });
    let head = "       from          to    truth [m] technique predicted".to_owned();
    std::iter::once(head).chain(rows).collect::<Vec<_>>().join("\n")
}
