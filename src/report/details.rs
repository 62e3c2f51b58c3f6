//! What else is known of a run besides its row in a table: its errors near seams, over texel phases and in motion, and its
//! bias.

use super::format::{NOTHING, grouped, percent, printable};
use super::model::Run;
use crate::technique::EffectiveBias;
use crate::verdict::{BinError, ViewError};

/// One thing that is known.
pub(super) struct Detail {
    /// What it is about.
    pub(super) label: &'static str,
    /// A line of any length.
    pub(super) text: String,
}

/// All that is known, in the order in which it is shown.
pub(super) fn details(run: &Run) -> Vec<Detail> {
    let labelled = |label, text: Option<String>| text.map(|text| Detail { label, text });
    let once = [labelled("seams", seams(run)), labelled("jitter", jitter(run)), labelled("motion", motion(run))];
    let biases = biases(run.bias.as_deref().unwrap_or_default());
    once.into_iter().flatten().chain(biases.into_iter().map(|text| Detail { label: "bias", text })).collect()
}

/// Texels around seams that are told apart from the rest.
const NEAR_SEAM_TEXELS: f64 = 2.0;

/// Whether a run with wrong pixels is worse in one of its views, and near seams.
fn seams(run: &Run) -> Option<String> {
    let seams = run.seams.as_ref().filter(|_| run.pixels.is_some_and(|pixels| pixels.wrong > 0))?;
    let fraction = |view: &&ViewError| view.error.wrong_fraction().unwrap_or(0.0);
    let worst = seams.views.iter().max_by(|a, b| fraction(a).total_cmp(&fraction(b)))?;
    let [near, far] = seams.split_at(NEAR_SEAM_TEXELS);
    let share = |bin: BinError| bin.wrong_fraction().map_or_else(|| NOTHING.to_owned(), percent);
    Some(format!(
        "in the worst of {} views, {}: {} of {} px wrong; within {NEAR_SEAM_TEXELS} texels of a seam {}, beyond {}",
        seams.views.len(),
        printable(&worst.name),
        share(worst.error),
        grouped(worst.error.asked),
        share(near),
        share(far)
    ))
}

/// What shifting the texel grid of a run does to its share of wrong pixels.
fn jitter(run: &Run) -> Option<String> {
    let jitter = run.jitter?;
    let [mean, min, max] =
        [jitter.wrong_fraction.mean, jitter.wrong_fraction.min, jitter.wrong_fraction.max].map(percent);
    Some(format!("{} texel phases: {mean} wrong on average, {min} to {max}", jitter.phases))
}

/// How much of a run flips from frame to frame although the truth does not.
fn motion(run: &Run) -> Option<String> {
    let motion = run.motion?;
    let (steps, followed) = (motion.steps, motion.followed.name());
    let [camera, light] =
        [motion.camera_flips, motion.light_flips].map(|flips| format!("{:.1} (at most {})", flips.mean, flips.max));
    Some(format!("{steps} steps: {camera} {followed} flip at a step of the camera, {light} pixels at one of the light"))
}

/// Of more views than these only the least and the most biased are shown.
const LISTED_VIEWS: usize = 4;

/// How far comparisons were really moved, one line for each view.
fn biases(views: &[EffectiveBias]) -> Vec<String> {
    let mut shown: Vec<&EffectiveBias> = views.iter().collect();
    if shown.len() > LISTED_VIEWS {
        shown.sort_by(|a, b| a.along_light.m.median.total_cmp(&b.along_light.m.median));
        shown = vec![shown[0], shown[shown.len() - 1]];
    }
    let of = |view: &str| if views.len() > 1 { format!("{}: ", printable(view)) } else { String::new() };
    let mut lines: Vec<String> = shown.iter().map(|bias| of(&bias.view) + &bias.told()).collect();
    if shown.len() < views.len() {
        lines.push(format!(
            "{} more views that receivers read, between these: in report.json",
            views.len() - shown.len()
        ));
    }
    lines
}
