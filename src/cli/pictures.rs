//! The pictures of a run, named `<scene>.<light>.<n>.<kind>.png` after its place in the report.

use super::output::OutFolder;
use crate::evaluate::{Evaluation, Question, View};
use crate::mask::Mask;
use crate::receiver::PixelClass;
use crate::report::model::Run;
use crate::report::picture::{Caption, CauseMap, ErrorMap, ValueMap, cause_map, error_map, value_map};
use crate::technique::footprint::Footprint;
use crate::verdict::Verdict;
use glam::Vec2;
use rayon::prelude::*;

/// Error map, causes and, for techniques with texels, m. `index` is the run's place in the report.
pub(super) fn write_run(
    out: &OutFolder,
    index: usize,
    view: &View<'_>,
    question: &Question<'_>,
    run: &Run,
    evaluation: &Evaluation<'_>,
) -> anyhow::Result<()> {
    write_error_map(out, index, question, run, &evaluation.mask, &evaluation.verdict)?;
    let (classes, truth) = (&question.classes, &question.truth.mask);
    let ledger = &evaluation.ledger;
    let causes = cause_map(&CauseMap { caption: caption(run), classes, truth, ledger })?;
    out.write(&name(run, index, "causes"), &causes)?;
    let footprints = footprints(question, evaluation);
    if footprints.iter().any(Option::is_some) {
        let m: Vec<Option<f32>> = footprints.iter().map(|f| f.map(|f| f.m as f32)).collect();
        let texel: Vec<Option<Vec2>> = footprints.iter().map(|f| f.map(|f| f.position_in_texels.as_vec2())).collect();
        let size = view.scene.image_size;
        let picture = value_map(&ValueMap { caption: caption(run), size, m: &m, texel: &texel })?;
        out.write(&name(run, index, "m"), &picture)?;
    }
    Ok(())
}

/// The footprint of a texel at every asked pixel.
pub(super) fn footprints(question: &Question<'_>, evaluation: &Evaluation<'_>) -> Vec<Option<Footprint>> {
    let asked = question.classes.par_iter().enumerate();
    let footprint = |(pixel, class): (usize, &PixelClass)| {
        (*class == PixelClass::Asked).then(|| evaluation.prepared.footprint(pixel as u32)).flatten()
    };
    asked.map(footprint).collect()
}

/// Truth, technique and signed error side by side.
pub(super) fn write_error_map(
    out: &OutFolder,
    index: usize,
    question: &Question<'_>,
    run: &Run,
    mask: &Mask,
    verdict: &Verdict,
) -> anyhow::Result<()> {
    let (classes, truth) = (&question.classes, &question.truth.mask);
    let picture = error_map(&ErrorMap { caption: caption(run), classes, truth, mask, verdict })?;
    out.write(&name(run, index, "error"), &picture)?;
    Ok(())
}

fn caption(run: &Run) -> Caption<'_> {
    Caption { scene: &run.scene, light: &run.light, technique: &run.typed }
}

fn name(run: &Run, index: usize, kind: &str) -> String {
    format!("{}.{}.{index}.{kind}.png", file_name(&run.scene), file_name(&run.light))
}

/// A scene's or light's name as part of a file's name, on every file system.
pub(super) fn file_name(name: &str) -> String {
    name.chars().map(|c| if c.is_alphanumeric() || "-_".contains(c) { c } else { '_' }).collect()
}
