//! Volumes replayed in f64, one approximation at a time: exact → triangles in use → reach and far plane → near plane →
//! scissor → 8-bit stencil → caps → the GPU's answer. Before the stencil every stage is a whole number of volumes; a
//! receiver is lit where it is zero. What a stencil loses at its ends and what wrong caps do depends on the order and on
//! the far side of every volume; there the counterfactual is the GPU itself, without that one approximation.

use super::prepared::PreparedVolume;
use super::settings::Settings;
use crate::cause::{Cause, Replay, Stage};
use crate::mask::{Mask, Truth};
use crate::technique::TechniqueError;
use crate::truth;
use rayon::prelude::*;

/// Stages in order, each with the cause that owns its change.
const STAGES: [(&str, Cause); 7] = [
    ("triangles in use", Cause::OpenMesh),
    ("reach", Cause::ClippingFar),
    ("near plane", Cause::ClippingNear),
    ("scissor", Cause::ClippingFrustum),
    ("stencil", Cause::StencilOverflow),
    ("caps", Cause::TechniqueModel),
    ("gpu", Cause::Precision),
];

/// Stencils that the GPU leaves without one approximation; `None` where the settings do not have it.
struct Without {
    clamping: Option<Vec<u8>>,
    wrong_caps: Option<Vec<u8>>,
}

/// Replays some pixels; `answer` is what the last run gave.
pub(super) fn replay(volume: &PreparedVolume<'_>, answer: &Mask, pixels: &[u32]) -> Result<Replay, TechniqueError> {
    let stencil_under = |settings: Option<Settings>| settings.map(|s| volume.stencil_under(&s)).transpose();
    let without = Without {
        clamping: stencil_under(volume.settings.with_wrapping_stencil())?,
        wrong_caps: stencil_under(volume.settings.with_sound_caps())?,
    };
    let replayed: Vec<(u32, f64, [f64; STAGES.len()])> = pixels
        .par_iter()
        .filter_map(|&pixel| {
            let (exact, values) = replay_pixel(volume, answer, &without, pixel)?;
            Some((pixel, exact, values))
        })
        .collect();
    let stage = |(index, (name, cause)): (usize, (&'static str, Cause))| Stage {
        name,
        values: replayed.iter().map(|(_, _, values)| values[index]).collect(),
        causes: vec![cause; replayed.len()],
    };
    Ok(Replay {
        pixels: replayed.iter().map(|(pixel, ..)| *pixel).collect(),
        exact: replayed.iter().map(|(_, exact, _)| *exact).collect(),
        stages: STAGES.into_iter().enumerate().map(stage).collect(),
    })
}

fn replay_pixel(
    volume: &PreparedVolume<'_>,
    answer: &Mask,
    without: &Without,
    pixel: u32,
) -> Option<(f64, [f64; STAGES.len()])> {
    let job = &volume.job;
    let receiver = volume.receiver(pixel)?;
    let answered = f64::from(answer.pixels.get(pixel as usize).copied().flatten()?.get());
    let counts = volume.counts(pixel)?;
    let (eye, radius_m) = (volume.eye.position_in_world(), volume.counter.scene_radius_m);
    let exact = match truth::of_receiver(job.casters, job.light, &receiver, eye, radius_m) {
        Truth::Known(visibility) => f64::from(visibility.get()),
        // Of an area light's centre alone, which nobody asked about: either answer is right.
        Truth::Undecided => lit(counts.crossed),
    };
    let [crossed, reached, from_near, drawn] =
        [counts.crossed, counts.reached, counts.from_near, counts.drawn].map(lit);
    // Where the answer is another without the approximation, the approximation made it.
    let after = |before: f64, without: &Option<Vec<u8>>| match without {
        Some(stencil) if lit(stencil[pixel as usize].into()) != answered => answered,
        _ => before,
    };
    let wrapped = if volume.settings.clamps_stencil { drawn } else { lit(counts.stencil().into()) };
    let stencil = after(wrapped, &without.clamping);
    let caps = after(stencil, &without.wrong_caps);
    Some((exact, [crossed, reached, from_near, drawn, stencil, caps, answered]))
}

fn lit(count: i64) -> f64 {
    if count == 0 { 1.0 } else { 0.0 }
}
