//! What a segment needs to be tested quickly: Woop's axes and shear, the slab test's inverses, and bounds on the
//! rounding error of everything computed from them.
//!
//! # The error bounds
//!
//! u = 2⁻⁵³; M is the largest |v − p| along an axis over the casters' box; first-order terms, then rounded up.
//! p → q is taken as exact. The computed direction q − p and corner A = a − p are right to u per component, the shear
//! S = d_x/d_z (|S| ≤ 1) to 3u. So x = A_x − S·A_z, at most 2M, is right to u·M (A_x) + 5u·M (S, A_z, product) + 2u·M
//! (difference) = **8uM**; an edge area C_x·B_y − C_y·B_x, at most 8M², to 4 · 2M · 8uM (factors) + 2 · 4uM²
//! (products) + 8uM² (difference) = **80uM²**.
//! The start's volume Σ edge·z is right to 3 · (80 + 8 + 8)uM³ (edge, z, product) + 48uM³ (sums) = **336uM³**. The end's
//! volume subtracts d_z·Σ edge, right to 3 · 80 + 40 (sums) + 24 · 2 (d_z, product) = 328uM²·|d_z|, and rounds once
//! more, 24uM²·(M + |d_z|): **360uM²·(M + |d_z|)**.
//!
//! When p may move by `radius` in any direction, up to √3·`radius` along an axis (see [`super::occlusion`]), an edge's
//! volume, which is d_z times its area, changes by at most √3·`radius`·|b − q|·|c − b|, and the start's volume by
//! √3·`radius` times the triangle's doubled area; the end's does not change. |b − q| is at most √3 times its largest
//! component, |c − b| at most the diagonal of the box, the doubled area less than its square. 2 stands for each √3.

use super::exact::clamped_inverse;
use crate::scene::{Bounds, Segment};
use glam::DVec3;

/// Half an ulp of 1: the relative error of one rounding.
const U: f64 = 0.5 * f64::EPSILON;
/// Bound of an edge area's error in u·M²: the derived 80, and a fifth for terms of higher order.
const EDGE_ERROR: f64 = 96.0 * U;
/// Bound of a volume's error in u·M²·(M + |d_z|): the derived 360, and a fifth.
const VOLUME_ERROR: f64 = 432.0 * U;
/// Error of where the ray passes a plane of a box, as a shift of that plane, in u·M: the difference, the inverse of a
/// rounded direction and the product make 4; as much again, for one rounding of the shifted start.
const SLAB_ERROR: f64 = 8.0 * U;

/// A segment prepared for tests against boxes and triangles.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ray {
    /// Start.
    pub(super) from: [f64; 3],
    /// Axes in Woop's order: the last is the one along which the direction is longest.
    pub(super) axes: [usize; 3],
    /// How far the direction leans from the last axis along the first two, −1..=1.
    pub(super) shear: [f64; 2],
    /// Length of the segment along the last axis, signed.
    pub(super) depth: f64,
    /// Below this an edge area's sign is in doubt.
    pub(super) edge_error: f64,
    /// Below this the sign of the volume with the start is in doubt.
    pub(super) start_error: f64,
    /// Below this the sign of the volume with the end is in doubt.
    pub(super) end_error: f64,
    /// Per axis.
    pub(super) slabs: [Slab; 3],
}

/// One axis of the slab test. The start is moved forward for planes where the ray enters and back for planes where it
/// leaves, so rounding cannot close a slab that the exact ray passes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Slab {
    /// 1 if the ray runs towards smaller coordinates and so enters a box at its maximum, else 0.
    pub(super) entry_side: usize,
    /// Start, moved forward.
    pub(super) entry_origin: f64,
    /// Start, moved back.
    pub(super) exit_origin: f64,
    /// Inverse of the direction, finite.
    pub(super) inverse: f64,
}

impl Ray {
    /// Prepares `segment` for triangles inside `bounds`, with all decisions in doubt that could change when its start
    /// moves by `radius_m`. `None` if it has no length: it crosses nothing.
    pub(super) fn new(segment: &Segment, bounds: &Bounds, radius_m: f64) -> Option<Self> {
        let &Segment { from, to } = segment;
        if from == to {
            return None;
        }
        let along = to - from;
        let axes = woop_axes(along);
        let [x, y, depth] = axes.map(|axis| along[axis]);

        let reach = farthest(from, bounds);
        let diagonal = 2.0 * bounds.radius();
        let moved = 2.0 * radius_m;
        let slack = SLAB_ERROR * reach + moved;
        Some(Self {
            from: from.to_array(),
            axes,
            shear: [x / depth, y / depth],
            depth,
            edge_error: EDGE_ERROR * reach * reach + moved * 2.0 * farthest(to, bounds) * diagonal / depth.abs(),
            start_error: VOLUME_ERROR * reach * reach * reach + moved * diagonal * diagonal,
            end_error: VOLUME_ERROR * reach * reach * (reach + depth.abs()),
            slabs: std::array::from_fn(|axis| Slab::new(from[axis], along[axis], slack)),
        })
    }
}

impl Slab {
    fn new(from: f64, along: f64, slack: f64) -> Self {
        let forward = slack.copysign(along);
        Self {
            entry_side: usize::from(along.is_sign_negative()),
            entry_origin: from + forward,
            exit_origin: from - forward,
            inverse: clamped_inverse(along),
        }
    }
}

/// The axes, the one along which `along` is longest last.
fn woop_axes(along: DVec3) -> [usize; 3] {
    let size = along.abs();
    if size.x >= size.y && size.x >= size.z {
        [1, 2, 0]
    } else if size.y >= size.z {
        [2, 0, 1]
    } else {
        [0, 1, 2]
    }
}

/// The largest distance along an axis from `point` to a point of `bounds`.
fn farthest(point: DVec3, bounds: &Bounds) -> f64 {
    (bounds.max - point).abs().max((bounds.min - point).abs()).max_element()
}
