//! Visibility along a line of the picture, truth beside a technique, and the width of every penumbra on it beside the
//! width that the distances predict (docs/soft.md#penumbra).

use super::View;
use crate::mask::{Mask, Truth, TruthMask};
use crate::scene::{Light, LightKind, emission_normal};
use glam::{DVec3, IVec2, UVec2};

/// What counts as fully lit and as fully dark: the outer steps of a few dozen points are wider than these.
const LIT: f64 = 0.98;
const DARK: f64 = 0.02;

/// One pixel of the line that shows a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Column and row.
    pub pixel: UVec2,
    /// Way along the surface from the line's first sample, metres.
    pub along_m: f64,
    /// Exact visibility; `None` where nothing is asked or nobody knows.
    pub truth: Option<f64>,
    /// The technique's.
    pub technique: Option<f64>,
    /// Width of the penumbra that the first blocker on the way to the light's centre throws here; `None` without one.
    pub predicted_m: Option<f64>,
}

/// A stretch of the line that leads from light to shadow or back.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Penumbra {
    /// Where it begins and ends, metres along the line.
    pub from_m: f64,
    /// See `from_m`.
    pub to_m: f64,
}

impl Penumbra {
    /// Its width along the line, metres.
    #[must_use]
    pub fn width_m(&self) -> f64 {
        self.to_m - self.from_m
    }
}

/// Samples every pixel from `from` to `to`, both included, that shows a surface. `truth` and `technique` are of the
/// view's picture.
#[must_use]
pub fn profile(
    view: &View<'_>,
    light: &Light,
    truth: &TruthMask,
    technique: &Mask,
    [from, to]: [UVec2; 2],
) -> Vec<Sample> {
    let radius_m = view.scene.bounds().radius();
    let pixels = pixels_between(from.as_ivec2(), to.as_ivec2());
    let mut samples: Vec<Sample> = Vec::new();
    let mut before: Option<DVec3> = None;
    let ends = [pixels.first(), pixels.last()].map(|pixel| surface(view, *pixel?));
    let direction = ends[0].zip(ends[1]).and_then(|(a, b)| (b - a).try_normalize());
    for pixel in pixels {
        let index = (pixel.y * view.receivers.size.x + pixel.x) as usize;
        let Some(receiver) = view.receivers.pixels[index] else { continue };
        let point = receiver.point_in_world;
        let step_m = before.map_or(0.0, |before| before.distance(point));
        before = Some(point);
        let segment = light.segment_from(point, radius_m);
        let hit = view.casters.nearest_hit(&segment, Some(receiver.triangle));
        samples.push(Sample {
            pixel,
            along_m: samples.last().map_or(0.0, |last| last.along_m) + step_m,
            truth: truth.pixels[index].and_then(|truth| match truth {
                Truth::Known(visibility) => Some(f64::from(visibility.get())),
                Truth::Undecided => None,
            }),
            technique: technique.pixels[index].map(|visibility| f64::from(visibility.get())),
            predicted_m: hit.zip(direction).and_then(|(hit, direction)| {
                predicted_width_m(light, point, segment.from.lerp(segment.to, hit.t), direction)
            }),
        });
    }
    samples
}

fn surface(view: &View<'_>, pixel: UVec2) -> Option<DVec3> {
    let index = (pixel.y * view.receivers.size.x + pixel.x) as usize;
    view.receivers.pixels[index].map(|receiver| receiver.point_in_world)
}

/// Every pixel of the straight line between two, both included.
fn pixels_between(from: IVec2, to: IVec2) -> Vec<UVec2> {
    let steps = (to - from).abs().max_element().max(1);
    let along = (to - from).as_dvec2() / f64::from(steps);
    let mut pixels: Vec<UVec2> =
        (0..=steps).map(|i| (from.as_dvec2() + along * f64::from(i)).round().as_uvec2()).collect();
    pixels.dedup();
    pixels
}

/// s (d_r − d_b)/d_b with distances along the way the light faces, and s the light's extent along the line; of a sun
/// 2 tan(α) (d_r − d_b) with its angular radius α, over the share of the line that runs across the light. `None` for a light
/// without extent.
fn predicted_width_m(light: &Light, receiver: DVec3, blocker: DVec3, direction: DVec3) -> Option<f64> {
    let centre = light.homogeneous().truncate();
    if let LightKind::Sun { angular_radius_rad, .. } = light.kind {
        // Across the light: a slope stretches it.
        let width_m = 2.0 * angular_radius_rad.tan() * centre.dot(blocker - receiver);
        return Some(width_m / direction.reject_from(centre).length());
    }
    let (forward, extent_m) = match light.kind {
        LightKind::Rectangle { half_width, half_height, .. } => {
            let along = |half: glam::Vec3| 2.0 * half.as_dvec3().dot(direction).abs();
            (emission_normal(half_width, half_height), along(half_width) + along(half_height))
        }
        LightKind::Sphere { radius_m, .. } => ((receiver - centre).try_normalize()?, 2.0 * f64::from(radius_m)),
        LightKind::Point { .. } | LightKind::Directional { .. } | LightKind::Spot { .. } | LightKind::Sun { .. } => {
            return None;
        }
    };
    let [to_receiver, to_blocker] = [receiver, blocker].map(|point| forward.dot(point - centre));
    (to_blocker > 0.0).then(|| extent_m * (to_receiver - to_blocker) / to_blocker)
}

/// The penumbras of one of a profile's curves, in order.
#[must_use]
pub fn penumbras(samples: &[Sample], value: impl Fn(&Sample) -> Option<f64>) -> Vec<Penumbra> {
    let mut found = Vec::new();
    // The last sample that was fully lit (true) or fully dark, and where.
    let mut last: Option<(bool, f64)> = None;
    for sample in samples {
        let Some(value) = value(sample) else {
            last = None;
            continue;
        };
        let settled = if value >= LIT {
            true
        } else if value <= DARK {
            false
        } else {
            continue;
        };
        if let Some((_, from_m)) = last.filter(|(was_lit, _)| *was_lit != settled) {
            found.push(Penumbra { from_m, to_m: sample.along_m });
        }
        last = Some((settled, sample.along_m));
    }
    found
}

/// The width predicted in the middle of a stretch: what the nearest sample with a prediction says.
#[must_use]
pub fn predicted_at(samples: &[Sample], penumbra: &Penumbra) -> Option<f64> {
    let middle_m = 0.5 * (penumbra.from_m + penumbra.to_m);
    let known = samples.iter().filter_map(|sample| Some(((sample.along_m - middle_m).abs(), sample.predicted_m?)));
    known.filter(|(off_m, _)| *off_m <= penumbra.width_m()).min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, width)| width)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn samples(values: &[f64]) -> Vec<Sample> {
        let sample = |(x, value): (u32, &f64)| Sample {
            pixel: UVec2::new(x, 0),
            along_m: f64::from(x) * 0.1,
            truth: (*value >= 0.0).then_some(*value),
            technique: None,
            predicted_m: Some(0.3).filter(|_| *value < 0.5),
        };
        (0..).zip(values).map(sample).collect()
    }

    #[test]
    fn penumbras_lead_from_light_to_shadow_and_back() {
        let samples = samples(&[1.0, 1.0, 0.7, 0.3, 0.0, 0.0, 0.5, 1.0, 1.0, 0.5, 1.0, -1.0, 0.0]);
        let found = penumbras(&samples, |sample| sample.truth);
        let rounded: Vec<[i64; 2]> =
            found.iter().map(|p| [p.from_m, p.to_m].map(|m| (m * 10.0).round() as i64)).collect();
        assert_eq!(rounded, [[1, 4], [5, 7]], "neither a dent nor a gap is a penumbra");
        assert_eq!(predicted_at(&samples, &found[0]), Some(0.3));
    }

    #[test]
    fn lines_hold_every_pixel_once() {
        let line = |a: [i32; 2], b: [i32; 2]| pixels_between(a.into(), b.into());
        assert_eq!(line([3, 5], [3, 5]), [UVec2::new(3, 5)]);
        assert_eq!(line([0, 0], [4, 2]).len(), 5);
        assert_eq!(line([4, 2], [0, 0]).first(), Some(&UVec2::new(4, 2)));
    }
}
