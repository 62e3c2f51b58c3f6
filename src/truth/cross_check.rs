//! The cross-check: the brute-force twin of the ray core decides an even share of the pixels again.

use super::asked;
use crate::cast::brute;
use crate::mask::{Truth, TruthMask, Visibility};
use crate::receiver::{PixelClass, Receiver, Receivers};
use crate::scene::{Emitter, Light, Scene, Segment};
use crate::watch::{Interrupted, Watch};
use glam::DVec4;
use rayon::prelude::*;

/// A pixel on which two oracles differ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Disagreement {
    /// `y * width + x`.
    pub pixel: u32,
    /// The shadow ray that both were asked about; of an area light's the one to its centre.
    pub segment: Segment,
    /// What the truth says.
    pub exact: Visibility,
    /// What brute force says.
    pub brute: Visibility,
}

/// Decides `samples` shadow rays again by brute force and returns the pixels on which the two differ. The pixels are
/// always the same ones, spread evenly over those that `truth` knows; all of them if there are no more rays.
///
/// # Errors
/// [`Interrupted`] once `watch` says so.
pub fn cross_check(
    scene: &Scene,
    light: &Light,
    receivers: &Receivers,
    classes: &[PixelClass],
    watch: &dyn Watch,
    truth: &TruthMask,
    samples: u32,
) -> Result<Vec<Disagreement>, Interrupted> {
    let known: Vec<_> = (0..truth.pixels.len())
        .filter_map(|i| match truth.pixels[i] {
            Some(Truth::Known(exact)) => Some((i as u32, asked(receivers, classes, i)?, exact)),
            Some(Truth::Undecided) | None => None,
        })
        .collect();
    let radius_m = scene.bounds().radius();
    let emitter = Emitter::new(light);
    let chosen = spread(known.len(), (samples as usize).div_ceil(emitter.count()));
    watch.start("brute-force check", chosen.len() as u64);
    let checked: Result<Vec<Option<Disagreement>>, Interrupted> = chosen
        .into_par_iter()
        .map(|i| {
            if watch.interrupted() {
                return Err(Interrupted);
            }
            let (pixel, receiver, exact) = known[i];
            let segment = light.segment_from(receiver.point_in_world, radius_m);
            let brute = by_brute_force(scene, light, &emitter, &receiver, radius_m);
            watch.advance(1);
            Ok((brute != exact).then_some(Disagreement { pixel, segment, exact, brute }))
        })
        .collect();
    Ok(checked?.into_iter().flatten().collect())
}

fn by_brute_force(scene: &Scene, light: &Light, emitter: &Emitter, receiver: &Receiver, radius_m: f64) -> Visibility {
    let eye_side = scene.facing(receiver.triangle, scene.camera.eye.as_dvec3().extend(1.0));
    let is_before = |point: DVec4| scene.facing(receiver.triangle, point) * eye_side.signum() > 0.0;
    let is_clear = |point: DVec4| {
        let segment = Segment::towards(receiver.point_in_world, point, radius_m);
        brute::any_hit(scene, &segment, Some(receiver.triangle)).is_none()
    };
    let points = emitter.points_for(receiver.point_in_world);
    let seen = points.filter(|point| (!light.is_area() || is_before(*point)) && is_clear(*point)).count();
    Visibility::new((seen as f64 / emitter.count() as f64) as f32).unwrap_or(Visibility::SHADOW)
}

/// Up to `samples` different indices below `count`, ascending: one in each of as many equal parts, at a place that the
/// golden ratio picks, so that no regular pattern of the picture can hide between them.
pub(super) fn spread(count: usize, samples: usize) -> Vec<usize> {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let samples = samples.min(count);
    let part = |i: usize| i * count / samples;
    (0..samples)
        .map(|i| {
            let size = part(i + 1) - part(i);
            part(i) + (((i as f64 * GOLDEN).fract() * size as f64) as usize).min(size - 1)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_different_and_evenly_spread() {
        assert_eq!(spread(5, 5), [0, 1, 2, 3, 4]);
        assert_eq!(spread(3, 100), [0, 1, 2]);
        assert_eq!(spread(0, 100), [0usize; 0]);
        let chosen = spread(10_007, 100);
        assert_eq!(chosen.len(), 100);
        assert!(chosen.windows(2).all(|pair| pair[0] < pair[1] && pair[1] - pair[0] < 202));
        let columns: std::collections::HashSet<_> = spread(100 * 100, 100).iter().map(|index| index % 100).collect();
        assert!(columns.len() > 50, "a grid of samples would see {} columns of 100", columns.len());
    }
}
