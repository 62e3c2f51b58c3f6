//! The points of a light that its exact visibility counts: the light itself, or a fixed set of low discrepancy on a
//! light with an extent, uniform in area. Every oracle counts the same points, so answers are compared ray by ray.
//!
//! On a rectangle the columns are the midpoints of N equal strips and the rows, too, are each used once, in the order of
//! the scrambled bit reversal of A. Owen ("Randomly Permuted (t,m,s)-Nets", 1995), hashed as B. Burley shows ("Practical
//! Hash-based Owen Scrambling", 2020). On a disc the points lie on H. Vogel's spiral ("A Better Way to Construct the
//! Sunflower Head", 1979). Error bounds: docs/truth.md#area-lights.

use super::{Light, LightKind, Segment};
use glam::{DVec2, DVec3, DVec4};
use std::f64::consts::PI;

/// Chosen among a few hundred: of these, its sets from 16 to 256 points leave half planes of any tilt the least error.
const SEED: u32 = 316_761;

/// The points of one light.
#[derive(Debug, Clone, PartialEq)]
pub struct Emitter {
    points: Points,
}

#[derive(Debug, Clone, PartialEq)]
enum Points {
    /// A light without extent, homogeneous.
    One(DVec4),
    /// The same for every receiver, each rounded to f32; homogeneous.
    Fixed(Vec<DVec4>),
    /// On the disc through a sphere's centre that faces the receiver.
    Facing { centre: DVec3, radius_m: f64, on_unit_disc: Vec<DVec2> },
}

impl Emitter {
    /// The points of `light`.
    #[must_use]
    pub fn new(light: &Light) -> Self {
        let points = match light.kind {
            LightKind::Rectangle { position, half_width, half_height, samples, .. } => {
                let place = |at: DVec2| {
                    let offset = half_width.as_dvec3() * at.x + half_height.as_dvec3() * at.y;
                    (position.as_dvec3() + offset).as_vec3().as_dvec3().extend(1.0)
                };
                Points::Fixed(square(samples).map(|at| place(2.0 * at - 1.0)).collect())
            }
            LightKind::Sphere { position, radius_m, samples, .. } => Points::Facing {
                centre: position.as_dvec3(),
                radius_m: radius_m.into(),
                on_unit_disc: disc(samples).collect(),
            },
            LightKind::Sun { towards_light, angular_radius_rad, samples } => {
                let towards = towards_light.as_dvec3();
                let direction =
                    |at: DVec2| sun_direction(towards, angular_radius_rad, at).as_vec3().as_dvec3().extend(0.0);
                Points::Fixed(disc(samples).map(direction).collect())
            }
            LightKind::Point { .. } | LightKind::Directional { .. } | LightKind::Spot { .. } => {
                Points::One(light.homogeneous())
            }
        };
        Self { points }
    }

    /// How many points; at least 1.
    #[must_use]
    pub fn count(&self) -> usize {
        match &self.points {
            Points::One(_) => 1,
            Points::Fixed(points) => points.len(),
            Points::Facing { on_unit_disc, .. } => on_unit_disc.len(),
        }
    }

    /// Every point as a receiver sees it, homogeneous: w = 0 with a unit vector towards a light infinitely far
    /// away.
    pub fn points_for(&self, receiver_in_world: DVec3) -> impl Iterator<Item = DVec4> + '_ {
        let [right, up] = match &self.points {
            Points::Facing { centre, .. } => facing_axes(centre - receiver_in_world),
            Points::One(_) | Points::Fixed(_) => [DVec3::ZERO; 2],
        };
        (0..self.count()).map(move |index| match &self.points {
            Points::One(light) => *light,
            Points::Fixed(points) => points[index],
            Points::Facing { centre, radius_m, on_unit_disc } => {
                let at = on_unit_disc[index] * radius_m;
                (centre + right * at.x + up * at.y).extend(1.0)
            }
        })
    }

    /// The shadow ray to every point, in the same order; see [`Light::segment_from`].
    pub fn segments_from(&self, receiver_in_world: DVec3, scene_radius_m: f64) -> impl Iterator<Item = Segment> + '_ {
        self.points_for(receiver_in_world).map(move |point| Segment::towards(receiver_in_world, point, scene_radius_m))
    }
}

/// The unit vector towards a place of the unit disc on a sun.
#[must_use]
pub fn sun_direction(towards_centre: DVec3, angular_radius_rad: f64, on_unit_disc: DVec2) -> DVec3 {
    let [right, up] = facing_axes(towards_centre);
    let at = on_unit_disc * angular_radius_rad.tan();
    (towards_centre + right * at.x + up * at.y).normalize()
}

/// Two unit vectors across a direction, the same for the same direction.
fn facing_axes(towards: DVec3) -> [DVec3; 2] {
    let (right, up) = towards.try_normalize().unwrap_or(DVec3::Y).any_orthonormal_pair();
    [right, up]
}

/// `count` points of the unit square. Every one of `count` equal columns and of `count` equal rows holds one, in its
/// middle.
fn square(count: u32) -> impl Iterator<Item = DVec2> {
    let mut by_height: Vec<u32> = (0..count).collect();
    by_height.sort_by_key(|&column| scrambled(column).reverse_bits());
    let mut row_of = vec![0; count as usize];
    for (row, column) in (0..count).zip(by_height) {
        row_of[column as usize] = row;
    }
    let middle = move |index: u32| (f64::from(index) + 0.5) / f64::from(count);
    (0..count).zip(row_of).map(move |(column, row)| DVec2::new(middle(column), middle(row)))
}

/// A hash each of whose bits depends on lower bits only: read backwards, it is a nested scramble. Constants: Burley.
fn scrambled(index: u32) -> u32 {
    let hash = index.wrapping_add(SEED);
    [0x6c50_b47c, 0xb82f_1e52, 0xc7af_e638, 0x8d22_f6e6].into_iter().fold(hash, |h, c| h ^ h.wrapping_mul(c))
}

/// `count` points of the unit disc, one for each of `count` rings of equal area, a golden angle apart.
fn disc(count: u32) -> impl Iterator<Item = DVec2> {
    let golden_angle = PI * (3.0 - 5.0_f64.sqrt());
    (0..count).map(f64::from).map(move |i| {
        let radius = ((i + 0.5) / f64::from(count)).sqrt();
        DVec2::from_angle(i * golden_angle) * radius
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// Share of the unit square below the line x·cos + y·sin = `offset`, for a tilt of 0 to π/2: the square's four
    /// corners each cut a triangle off the half plane.
    fn square_share(tilt: f64, offset: f64) -> f64 {
        let (c, s) = (tilt.cos(), tilt.sin());
        if c.abs().min(s) < 1e-12 {
            return offset.clamp(0.0, 1.0);
        }
        let triangle = |t: f64| 0.5 * t.max(0.0).powi(2);
        (triangle(offset) - triangle(offset - c) - triangle(offset - s) + triangle(offset - c - s)) / (c * s)
    }

    /// Share of the unit disc below such a line: its circular segment.
    fn disc_share(_tilt: f64, offset: f64) -> f64 {
        let t = offset.clamp(-1.0, 1.0);
        ((-t).acos() + t * (1.0 - t * t).sqrt()) / PI
    }

    /// The largest error of the counted share over 400 places of the line.
    fn worst(points: &[DVec2], tilt: f64, share: fn(f64, f64) -> f64) -> f64 {
        let direction = DVec2::from_angle(tilt);
        let offsets = (0..400).map(|i| -1.5 + 3.0 * (f64::from(i) + 0.1234) / 400.0);
        let error = |offset: f64| {
            let counted = points.iter().filter(|point| point.dot(direction) < offset).count();
            (counted as f64 / points.len() as f64 - share(tilt, offset)).abs()
        };
        offsets.map(error).fold(0.0, f64::max)
    }

    #[test]
    fn half_planes_along_a_side_are_met_within_one_sample() {
        for count in [1, 2, 3, 7, 16, 64, 100, 256] {
            let points: Vec<_> = square(count).collect();
            for tilt in [0.0, 0.5 * PI] {
                let transposed = points.iter().map(|p| DVec2::new(p.y, p.x)).collect::<Vec<_>>();
                let along = if tilt == 0.0 { &points } else { &transposed };
                let error = worst(along, 0.0, square_share);
                assert!(error <= 0.5 / f64::from(count) + 1e-12, "{count} {tilt}: {error}");
            }
        }
    }

    #[test]
    fn half_planes_of_any_tilt_are_met_within_half_a_row_of_samples() {
        for count in [64, 128, 144, 256, 1024] {
            let bound = 0.5 / f64::from(count).sqrt();
            let (square, disc): (Vec<_>, Vec<_>) = (square(count).collect(), disc(count).collect());
            for step in 0..=36 {
                let tilt = 0.25 * TAU * f64::from(step) / 36.0;
                let errors = [worst(&square, tilt, square_share), worst(&disc, tilt, disc_share)];
                assert!(errors.iter().all(|error| *error <= bound), "{count} {tilt}: {errors:?} of {bound}");
            }
        }
    }

    #[test]
    fn four_times_the_samples_halve_the_error_at_least() {
        let mean = |count| {
            let points: Vec<_> = square(count).collect();
            (1..36).map(|step| worst(&points, 0.25 * TAU * f64::from(step) / 36.0, square_share)).sum::<f64>()
        };
        let rates = [16, 64, 256].map(|count| mean(4 * count) / mean(count));
        assert!(rates.iter().all(|rate| *rate < 0.5), "{rates:?}");
    }

    #[test]
    fn a_suns_points_fill_its_cone_and_lie_about_its_centre() {
        let towards = DVec3::new(0.3, 0.8, -0.4).normalize();
        let radius_rad = 3.0_f64.to_radians();
        let kind = LightKind::Sun { towards_light: towards.as_vec3(), angular_radius_rad: radius_rad, samples: 400 };
        let sun = Light { name: "sun".into(), kind, intensity: glam::Vec3::ONE, range_m: f64::INFINITY };
        let emitter = Emitter::new(&sun);
        let directions: Vec<DVec4> = emitter.points_for(DVec3::ZERO).collect();
        assert!(emitter.points_for(DVec3::ONE * 1e6).eq(directions.iter().copied()), "the same from everywhere");
        let angles: Vec<f64> = directions.iter().map(|d| d.truncate().angle_between(towards)).collect();
        assert!(directions.iter().all(|d| d.w == 0.0 && (d.truncate().length() - 1.0).abs() < 1e-6));
        assert!(
            angles.iter().all(|angle| *angle <= radius_rad + 1e-6) && angles.iter().any(|a| *a > 0.99 * radius_rad)
        );
        let mean = directions.iter().map(|d| d.truncate()).sum::<DVec3>() / 400.0;
        assert!(mean.angle_between(towards) < 0.02 * radius_rad);
        // Half of the disc's area lies within √½ of its radius.
        let inner = angles.iter().filter(|angle| angle.tan() < radius_rad.tan() * 0.5_f64.sqrt()).count();
        assert_eq!(inner, 200);
    }

    #[test]
    fn a_grid_shifted_by_half_a_cell_fails() {
        let shifted: Vec<_> = square(64).map(|point| point + 0.5 / 8.0).collect();
        assert!(worst(&shifted, 0.0, square_share) > 1.0 / 64.0);
    }
}
