//! Two pictures of one scene, ours and another renderer's, radiance by radiance: where they differ by more than rounding,
//! or for area lights by more than chance.

use crate::mask::{Truth, TruthMask};
use crate::receiver::{Receiver, Receivers};
use crate::scene::Scene;
use glam::{DMat4, DVec2, IVec2, UVec2, Vec3};

/// Relative difference that two renderers of f32 arithmetic may have: a few hundred roundings, and no 2 % of anything.
pub const RADIANCE_TOLERANCE: f64 = 1e-3;

/// Pixels from an edge within which two rasterisers, or two shadow epsilons, may disagree.
const EDGE_PX: i32 = 2;
/// Darker than this share of the picture's brightest pixel, a difference counts relative to that.
const LEAST_SHARE: f64 = 1e-4;
/// Where neighbouring surfaces meet at more than about 20 degrees there is an edge.
const CREASE_COSINE: f64 = 0.94;
/// Where a neighbour lies off the tangent plane by more than this share of its distance there is an edge, too.
const STEP: f64 = 0.5;

/// So close to its triangle's border a pixel centre may be given to the neighbour: rasterisers snap corners.
const SNAP_PX: f64 = 1.0 / 64.0;

/// How two pictures differ.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct RadianceDifference {
    /// Pixels compared.
    pub compared: u64,
    /// Pixels with geometry left out because they lie within two pixels of an edge.
    pub near_edges: u64,
    /// Largest relative difference of a compared pixel; for area lights of what chance does not explain.
    pub largest: f64,
    /// Compared pixels (`y * width + x`) above the tolerance, ascending.
    pub above: Vec<u32>,
}

/// What chance and the points of an area light may explain of a difference.
#[derive(Debug, Clone, Copy)]
pub struct Noise<'a> {
    /// Variance of the other picture, per pixel.
    pub variance: &'a [Vec3],
    /// Standard errors granted.
    pub critical: f64,
    /// Share of the unblocked light granted.
    pub discrepancy: f64,
    /// What the light would give unblocked, per pixel.
    pub unblocked: &'a [Vec3],
}

/// Compares two pictures at every pixel with geometry that is not `near_edge`. Pixels that are NaN in `theirs` are left
/// out.
#[must_use]
pub fn compare_radiance(
    receivers: &Receivers,
    ours: &[Vec3],
    theirs: &[Vec3],
    near_edge: &[bool],
    noise: Option<Noise<'_>>,
) -> RadianceDifference {
    let brightest = theirs.iter().filter(|pixel| pixel.is_finite()).map(|p| p.max_element()).fold(0.0, f32::max);
    let floor = (LEAST_SHARE * f64::from(brightest)).max(f64::MIN_POSITIVE);
    let mut difference = RadianceDifference { compared: 0, near_edges: 0, largest: 0.0, above: Vec::new() };
    for (pixel, receiver) in receivers.pixels.iter().enumerate() {
        if receiver.is_none() || !theirs[pixel].is_finite() {
            continue;
        }
        if near_edge[pixel] {
            difference.near_edges += 1;
            continue;
        }
        let of_channel = |channel: usize| {
            let (a, b) = (f64::from(ours[pixel][channel]), f64::from(theirs[pixel][channel]));
            let granted = noise.map_or(0.0, |noise| {
                let sigma = f64::from(noise.variance[pixel][channel]).sqrt();
                noise.critical * sigma + noise.discrepancy * f64::from(noise.unblocked[pixel][channel])
            });
            ((a - b).abs() - granted).max(0.0) / b.abs().max(floor)
        };
        let relative = (0..3).map(of_channel).fold(0.0, f64::max);
        difference.compared += 1;
        difference.largest = difference.largest.max(relative);
        if relative > RADIANCE_TOLERANCE {
            difference.above.push(pixel as u32);
        }
    }
    difference
}

/// Pixels within two pixels of where the surface ends, folds or steps back, and of a shadow's edge if `truth` is given;
/// and those whose centre lies on the border of a facet.
#[must_use]
pub fn near_edges(scene: &Scene, receivers: &Receivers, truth: Option<&TruthMask>) -> Vec<bool> {
    let mut near = near_pixel_edges(receivers, truth);
    let clip_from_world = scene.camera.clip_from_world(receivers.size);
    let on_border = |(pixel, receiver): (usize, &Option<Receiver>)| {
        let (x, y) = (pixel as u32 % receivers.size.x, pixel as u32 / receivers.size.x);
        let centre = DVec2::new(x.into(), y.into()) + 0.5;
        receiver
            .is_some_and(|receiver| is_on_border(scene, &clip_from_world, receivers.size, receiver.triangle, centre))
    };
    for (near, border) in near.iter_mut().zip(receivers.pixels.iter().enumerate().map(on_border)) {
        *near |= border;
    }
    near
}

/// Whether a point of the picture lies within [`SNAP_PX`] of a triangle's border. A triangle that reaches behind the
/// eye has none in the picture.
fn is_on_border(scene: &Scene, clip_from_world: &DMat4, size: UVec2, triangle: u32, centre: DVec2) -> bool {
    let in_clip = scene.triangle_in_world(triangle).map(|corner| *clip_from_world * corner.extend(1.0));
    if in_clip.iter().any(|corner| corner.w <= 0.0) {
        return false;
    }
    let corners = in_clip.map(|c| (DVec2::new(c.x, -c.y) / c.w * 0.5 + 0.5) * size.as_dvec2());
    (0..3).any(|i| {
        let (from, along) = (corners[i], corners[(i + 1) % 3] - corners[i]);
        along.perp_dot(centre - from).abs() <= SNAP_PX * along.length()
    })
}

fn near_pixel_edges(receivers: &Receivers, truth: Option<&TruthMask>) -> Vec<bool> {
    let size = receivers.size.as_ivec2();
    let index = |at: IVec2| (at.y * size.x + at.x) as usize;
    let is_edge = |a: usize, b: usize| {
        let is_shadow_edge = truth.is_some_and(|truth| changes(truth.pixels[a], truth.pixels[b]));
        is_shadow_edge || is_geometry_edge(receivers.pixels[a].as_ref(), receivers.pixels[b].as_ref())
    };
    let mut near = vec![false; receivers.pixels.len()];
    for y in 0..size.y {
        for x in 0..size.x {
            let at = IVec2::new(x, y);
            let next = [IVec2::X, IVec2::Y].map(|step| at + step);
            let borders = next.iter().any(|next| next.cmplt(size).all() && is_edge(index(at), index(*next)));
            if borders {
                mark(&mut near, size, at);
            }
        }
    }
    near
}

/// Marks all pixels whose centre is within [`EDGE_PX`] of the two sides of an edge right or below of a pixel.
fn mark(near: &mut [bool], size: IVec2, at: IVec2) {
    for dy in -EDGE_PX..=EDGE_PX + 1 {
        for dx in -EDGE_PX..=EDGE_PX + 1 {
            let to = at + IVec2::new(dx, dy);
            if to.min_element() >= 0 && to.cmplt(size).all() {
                near[(to.y * size.x + to.x) as usize] = true;
            }
        }
    }
}

fn changes(a: Option<Truth>, b: Option<Truth>) -> bool {
    a != b || a == Some(Truth::Undecided)
}

fn is_geometry_edge(a: Option<&Receiver>, b: Option<&Receiver>) -> bool {
    let (Some(a), Some(b)) = (a, b) else { return a.is_some() != b.is_some() };
    let between = b.point_in_world - a.point_in_world;
    let folds = a.normal_in_world.dot(b.normal_in_world) < CREASE_COSINE;
    folds || a.normal_in_world.dot(between).abs() > STEP * between.length()
}

/// Standard errors beyond which one of `tests` would lie by chance with probability `alpha` (Z. Šidák, "Rectangular
/// Confidence Regions for the Means of Multivariate Normal Distributions", 1967): found by halving.
#[must_use]
pub fn critical_deviation(tests: u64, alpha: f64) -> f64 {
    let of_one = -((-alpha).ln_1p() / (tests.max(1) as f64)).exp_m1();
    let (mut low, mut high) = (0.0, 40.0);
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        // Both tails of the normal distribution.
        if libm::erfc(middle / std::f64::consts::SQRT_2) > of_one {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn floor(size: UVec2) -> Receivers {
        let at = |i: u32| Receiver {
            triangle: 0,
            point_in_world: DVec3::new((i % size.x).into(), 0.0, (i / size.x).into()),
            normal_in_world: DVec3::Y,
        };
        Receivers { size, pixels: (0..size.x * size.y).map(|i| Some(at(i))).collect() }
    }

    #[test]
    fn two_percent_and_one_pixel_are_noticed_and_rounding_is_not() {
        let receivers = floor(UVec2::new(8, 8));
        let theirs = vec![Vec3::new(0.5, 0.25, 1.0); 64];
        let compared = |ours: &[Vec3]| compare_radiance(&receivers, ours, &theirs, &[false; 64], None);
        let rounded: Vec<Vec3> = theirs.iter().map(|p| *p * (1.0 + 1e-6)).collect();
        assert_eq!(compared(&rounded).above, [0_u32; 0]);
        let brighter: Vec<Vec3> = theirs.iter().map(|p| *p * 1.02).collect();
        assert_eq!(compared(&brighter).above.len(), 64);
        let mut one = theirs.clone();
        one[19].y *= 1.01;
        assert_eq!(compared(&one).above, [19]);
        assert_eq!(compare_radiance(&receivers, &one, &theirs, &[true; 64], None).compared, 0);
    }

    #[test]
    fn noise_is_granted_as_far_as_it_goes() {
        let receivers = floor(UVec2::new(2, 1));
        let (theirs, ours) = ([Vec3::ONE; 2], [Vec3::splat(1.1), Vec3::splat(1.3)]);
        let variance = [Vec3::splat(0.0025); 2];
        let noise = Noise { variance: &variance, critical: 3.0, discrepancy: 0.05, unblocked: &[Vec3::ONE; 2] };
        assert_eq!(compare_radiance(&receivers, &ours, &theirs, &[false; 2], Some(noise)).above, [1]);
    }

    #[test]
    fn edges_spread_by_two_pixels() {
        let mut receivers = floor(UVec2::new(16, 16));
        assert!(!near_pixel_edges(&receivers, None).contains(&true));
        for pixel in receivers.pixels.iter_mut().skip(8).step_by(16) {
            pixel.as_mut().unwrap().point_in_world.y = 3.0;
        }
        let near = near_pixel_edges(&receivers, None);
        let columns: Vec<usize> = (0..16).filter(|x| near[*x]).collect();
        assert_eq!(columns, [5, 6, 7, 8, 9, 10, 11]);
    }

    #[test]
    fn one_test_has_the_familiar_two_standard_errors() {
        assert!((critical_deviation(1, 0.05) - 1.959_964).abs() < 1e-6);
        assert!((critical_deviation(100_000, 0.01) - 5.326_7).abs() < 1e-2);
    }
}
