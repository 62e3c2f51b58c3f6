//! One casting triangle, stored for speed, and the f64 test that decides all but the doubtful rays.
//!
//! The test is that of Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection" (2013): move the start of the ray
//! to the origin, shear its direction onto an axis, and compare areas in the plane across it. The areas that decide
//! are compared with the error bounds of [`Ray`] instead of with zero.

use super::ray::Ray;
use glam::{DVec3, Vec3};

/// What the fast test knows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Crossing {
    /// Certainly not crossed.
    Missed,
    /// Certainly crossed.
    Crossed,
    /// Some sign is in doubt.
    Unsure {
        /// But not those of the edges: the line certainly passes inside.
        inside: bool,
    },
}

/// A triangle in the order in which the tree's leaves list them.
#[derive(Debug, Clone, Copy)]
pub(super) struct PackedTriangle {
    /// One row per axis, one column per corner: the ray picks its axes by row.
    rows: [[f32; 3]; 3],
    /// Triangle id in the scene, which stands for all triangles in its place.
    pub(super) id: u32,
}

impl PackedTriangle {
    pub(super) fn new(id: u32, corners: [Vec3; 3]) -> Self {
        Self { rows: std::array::from_fn(|axis| corners.map(|corner| corner[axis])), id }
    }

    /// The corners, exactly.
    pub(super) fn corners(&self) -> [DVec3; 3] {
        let [x, y, z] = self.rows;
        std::array::from_fn(|i| Vec3::new(x[i], y[i], z[i]).as_dvec3())
    }

    /// Decides the crossing where the signs are beyond doubt.
    #[inline]
    pub(super) fn crossing(&self, ray: &Ray) -> Crossing {
        let from_start = |axis: usize| self.rows[axis].map(|x| f64::from(x) - ray.from[axis]);
        let [x_axis, y_axis, z_axis] = ray.axes;
        let (x, y, z) = (from_start(x_axis), from_start(y_axis), from_start(z_axis));
        let x: [f64; 3] = std::array::from_fn(|i| x[i] - ray.shear[0] * z[i]);
        let y: [f64; 3] = std::array::from_fn(|i| y[i] - ray.shear[1] * z[i]);

        // Twice the signed areas that the ray spans with each edge; edge i lies opposite corner i.
        let edges: [f64; 3] = [x[2] * y[1] - y[2] * x[1], x[0] * y[2] - y[0] * x[2], x[1] * y[0] - y[1] * x[0]];
        let lowest = smaller(smaller(edges[0], edges[1]), edges[2]);
        let highest = larger(larger(edges[0], edges[1]), edges[2]);
        if lowest < -ray.edge_error && highest > ray.edge_error {
            return Crossing::Missed;
        }

        // Six times the signed volumes that the triangle spans with the start and with the end of the segment.
        let start_side = edges[0] * z[0] + edges[1] * z[1] + edges[2] * z[2];
        let end_side = start_side - ray.depth * (edges[0] + edges[1] + edges[2]);
        let (start, end) = (sign(start_side, ray.start_error), sign(end_side, ray.end_error));
        let inside = lowest > ray.edge_error || highest < -ray.edge_error;
        match start * end {
            1 => Crossing::Missed,
            -1 if inside => Crossing::Crossed,
            _ => Crossing::Unsure { inside },
        }
    }
}

/// 1 or −1 where the sign is certain, else 0.
fn sign(value: f64, error: f64) -> i32 {
    i32::from(value > error) - i32::from(value < -error)
}

/// The larger of two numbers in one instruction, unlike `f64::max`, which takes care of NaN.
#[inline]
pub(super) fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// The smaller of two numbers in one instruction.
#[inline]
pub(super) fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}
