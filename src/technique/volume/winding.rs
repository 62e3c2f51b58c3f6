//! How often a closed mesh winds around a point: 0 outside, 1 inside a mesh wound outward.
//!
//! A. Jacobson, L. Kavan, O. Sorkine-Hornung, "Robust Inside-Outside Segmentation using Generalized Winding Numbers",
//! 2013, with the solid angle of A. van Oosterom, J. Strackee, "The Solid Angle of a Plane Triangle", 1983.

use glam::DVec3;
use std::f64::consts::TAU;

/// The winding number, a whole one for a closed mesh and a point off it.
pub(super) fn winding_number(triangles: impl Iterator<Item = [DVec3; 3]>, point: DVec3) -> f64 {
    let half_solid_angle = |corners: [DVec3; 3]| {
        let [a, b, c] = corners.map(|corner| corner - point);
        let [la, lb, lc] = [a, b, c].map(DVec3::length);
        let volume = a.dot(b.cross(c));
        volume.atan2(la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb)
    };
    triangles.map(half_solid_angle).sum::<f64>() / TAU
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inspect::fixtures::{Shape, cube};

    /// Sums of a few dozen arctangents.
    const ROUNDING: f64 = 1e-12;

    fn number(shape: &Shape, point: DVec3) -> f64 {
        let corners = |triangle: &[u32; 3]| triangle.map(|v| shape.positions[v as usize]);
        winding_number(shape.triangles.iter().map(corners), point)
    }

    #[test]
    fn inside_outside_and_inside_out() {
        let cube = cube(DVec3::ZERO);
        let (inside, outside) = (DVec3::splat(0.4), DVec3::new(0.4, 1.7, 0.4));
        assert!((number(&cube, inside) - 1.0).abs() < ROUNDING);
        assert!(number(&cube, outside).abs() < ROUNDING);
        assert!((number(&cube.inverted(), inside) + 1.0).abs() < ROUNDING);
    }

    #[test]
    fn a_cavity_is_outside() {
        let shell = cube(DVec3::ZERO);
        let mut cavity = cube(DVec3::ZERO).inverted();
        cavity.positions.iter_mut().for_each(|p| *p = DVec3::splat(0.25) + 0.5 * *p);
        assert!(number(&shell.and(&cavity), DVec3::splat(0.5)).abs() < ROUNDING);
    }
}
