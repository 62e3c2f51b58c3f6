//! Volumes replayed in f64, one approximation at a time: exact → triangles in use → reach and far plane → near plane →
//! scissor → 8-bit stencil → the GPU's answer. Before the stencil every stage is a whole number of volumes; a receiver
//! is lit where it is zero.

use super::prepared::PreparedVolume;
use crate::cause::{Cause, Replay, Stage};
use crate::mask::{Mask, Truth};
use crate::technique::TechniqueError;
use crate::truth;
use rayon::prelude::*;

/// Stages in order, each with the cause that owns its change.
const STAGES: [(&str, Cause); 6] = [
    ("triangles in use", Cause::OpenMesh),
    ("reach", Cause::ClippingFar),
    ("near plane", Cause::ClippingNear),
    ("scissor", Cause::ClippingFrustum),
    ("stencil", Cause::StencilOverflow),
    ("gpu", Cause::Precision),
];

/// Replays some pixels; `answer` is what the last run gave.
pub(super) fn replay(volume: &PreparedVolume<'_>, answer: &Mask, pixels: &[u32]) -> Result<Replay, TechniqueError> {
    let wrapped = volume.settings.clamps_stencil.then(|| volume.wrapped_stencil()).transpose()?;
    let replayed: Vec<(u32, f64, [f64; STAGES.len()])> = pixels
        .par_iter()
        .filter_map(|&pixel| {
            let (exact, values) = replay_pixel(volume, answer, wrapped.as_deref(), pixel)?;
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
    wrapped: Option<&[u8]>,
    pixel: u32,
) -> Option<(f64, [f64; STAGES.len()])> {
    let job = &volume.job;
    let receiver = volume.receiver(pixel)?;
    let answered = f64::from(answer.pixels.get(pixel as usize).copied().flatten()?.get());
    let counts = volume.counts(pixel)?;
    let (eye, radius_m) = (volume.eye.position_in_world(), volume.counter.scene_radius_m);
    let exact = match truth::of_receiver(job.casters, job.light, &receiver, eye, radius_m) {
        Truth::Known(visibility) => f64::from(visibility.get()),
        Truth::Undecided => return None,
    };
    let stencil = match wrapped {
        None => lit(counts.stencil().into()),
        // What the stencil lost at its ends is what differs from the same draws into a stencil that wraps.
        Some(wrapped) if lit(wrapped[pixel as usize].into()) != answered => answered,
        Some(_) => lit(counts.drawn),
    };
    let before = [counts.crossed, counts.reached, counts.from_near, counts.drawn].map(lit);
    Some((exact, [before[0], before[1], before[2], before[3], stencil, answered]))
}

fn lit(count: i64) -> f64 {
    if count == 0 { 1.0 } else { 0.0 }
}
