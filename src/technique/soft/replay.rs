//! A soft shadow replayed: exact over the truth's points → exact over the technique's own → the inner technique's chain,
//! each stage averaged over the points. A stage's cause is that of the points which changed it most.

use super::prepared::PreparedSoft;
use crate::cause::{Cause, Replay, Stage};
use crate::mask::{Mask, Truth};
use crate::receiver::PixelClass;
use crate::scene::Emitter;
use crate::technique::TechniqueError;
use crate::truth;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// What the points add up to at one pixel.
#[derive(Debug, Clone, Default)]
struct Sums {
    exact: f64,
    stages: Vec<StageSum>,
}

#[derive(Debug, Clone, Default)]
struct StageSum {
    value: f64,
    /// By how much each cause changed the value, without sign.
    changes: BTreeMap<Cause, f64>,
}

pub(super) fn replay(soft: &PreparedSoft<'_>, answer: &Mask, pixels: &[u32]) -> Result<Replay, TechniqueError> {
    let mut sums = vec![Sums::default(); pixels.len()];
    let mut names: Vec<&'static str> = Vec::new();
    for light in &soft.lights {
        let inner = soft.with_point(light, |inner, classes| {
            let asked: Vec<u32> =
                pixels.iter().copied().filter(|pixel| classes[*pixel as usize] == PixelClass::Asked).collect();
            inner.replay(&inner.run()?.mask, &asked)
        })?;
        names = inner.stages.iter().map(|stage| stage.name).collect();
        for (slot, pixel) in inner.pixels.iter().enumerate() {
            // The inner pixels are some of ours, both in order.
            if let Ok(index) = pixels.binary_search(pixel) {
                sums[index].add(&inner, slot);
            }
        }
    }
    Ok(chain(soft, answer, pixels, &sums, &names))
}

impl Sums {
    fn add(&mut self, inner: &Replay, slot: usize) {
        self.stages.resize_with(inner.stages.len(), StageSum::default);
        self.exact += inner.exact[slot];
        let mut before = inner.exact[slot];
        for (sum, stage) in self.stages.iter_mut().zip(&inner.stages) {
            let value = stage.values[slot];
            *sum.changes.entry(stage.causes[slot]).or_default() += (value - before).abs();
            sum.value += value;
            before = value;
        }
    }
}

fn chain(soft: &PreparedSoft<'_>, answer: &Mask, pixels: &[u32], sums: &[Sums], names: &[&'static str]) -> Replay {
    let count = soft.lights.len() as f64;
    let of_points = Stage {
        name: "points on the light",
        values: sums.iter().map(|sum| sum.exact / count).collect(),
        causes: vec![soft.blamed_for_points(); pixels.len()],
    };
    let mut stages = vec![of_points];
    for (index, name) in names.iter().copied().enumerate() {
        let of = |sum: &Sums| sum.stages.get(index).cloned().unwrap_or_default();
        let values = sums.iter().map(|sum| of(sum).value / count).collect();
        let causes = sums.iter().map(|sum| most(&of(sum).changes)).collect();
        stages.push(Stage { name, values, causes });
    }
    // Points behind the surface were not asked; the mean of all was rounded once, to f32.
    let answered = |pixel: &u32| answer.pixels[*pixel as usize].map_or(f64::NAN, |v| f64::from(v.get()));
    let rounded = pixels.iter().map(answered).collect();
    stages.push(Stage { name: "mean", values: rounded, causes: vec![Cause::Precision; pixels.len()] });
    Replay { pixels: pixels.to_vec(), exact: exact(soft, pixels), stages }
}

/// The cause that changed most; of equals the first.
fn most(changes: &BTreeMap<Cause, f64>) -> Cause {
    changes.iter().fold((Cause::Precision, 0.0), |most, (cause, by)| if *by > most.1 { (*cause, *by) } else { most }).0
}

/// What the truth's own points say.
fn exact(soft: &PreparedSoft<'_>, pixels: &[u32]) -> Vec<f64> {
    let (job, emitter) = (&soft.job, Emitter::new(soft.job.light));
    let radius_m = job.scene.bounds().radius();
    let of_pixel = |pixel: &u32| {
        let receiver = job.receivers.pixels.get(*pixel as usize).copied().flatten();
        match receiver.map(|receiver| truth::of_area(job.scene, job.casters, &emitter, &receiver, radius_m)) {
            Some(Truth::Known(visibility)) => f64::from(visibility.get()),
            Some(Truth::Undecided) | None => f64::NAN,
        }
    };
    pixels.par_iter().map(of_pixel).collect()
}
