//! Which polygons a fan of triangles from the first corner can stand for: flat and convex ones.
//!
//! Normal of the polygon by Newell's method (M. Newell, in Sutherland, Sproull and Schumacker, "A Characterization of
//! Ten Hidden-Surface Algorithms", 1974); convex = every turn goes the same way and all turns together are one full
//! turn, which a star (two full turns) fails.

use glam::DVec3;
use std::f64::consts::{PI, TAU};
use thiserror::Error;

/// How far, in polygon sizes, a corner may lie off the polygon's plane. Technique and truth see the same triangles, so
/// a bent quad harms no verdict; this refuses only polygons whose splitting would be a guess at the shape.
const BEND_TOLERANCE: f64 = 1e-2;

/// How far, in polygon sizes, a corner may lie inside the line between its neighbours. Coordinates printed with six
/// digits put corners of straight edges off by less.
const DENT_TOLERANCE: f64 = 1e-3;

/// Normals shorter than this, in polygon sizes squared, belong to triangles or polygons without area.
const AREA_TOLERANCE: f64 = 1e-12;

/// Why a polygon cannot be split into a fan.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub(super) enum Fault {
    #[error("the face is not flat: a corner lies {0:.3} of its size off its plane; split it into triangles")]
    Bent(f64),
    #[error("the face is concave or crosses itself; split it into triangles")]
    Concave,
}

/// Whether a fan from the first corner covers the polygon exactly once. Polygons without area pass: their triangles are
/// degenerate and counted as such.
pub(super) fn check_flat_and_convex(corners: &[DVec3]) -> Result<(), Fault> {
    let corners = in_unit_size(corners);
    if corners.windows(2).all(|edge| edge[0].cross(edge[1]).length() <= AREA_TOLERANCE) {
        return Ok(());
    }
    // Triangles with area whose normals cancel: an hourglass.
    let normal = newell_normal(&corners).ok_or(Fault::Concave)?;
    let middle = corners.iter().sum::<DVec3>() / corners.len() as f64;
    let bend = corners.iter().map(|&c| (c - middle).dot(normal).abs()).fold(0.0, f64::max);
    if bend > BEND_TOLERANCE {
        return Err(Fault::Bent(bend));
    }
    let mut full_turn = 0.0;
    for (i, &corner) in corners.iter().enumerate() {
        let before = corners[(i + corners.len() - 1) % corners.len()];
        let after = corners[(i + 1) % corners.len()];
        let (arriving, leaving) = (corner - before, after - corner);
        let left = arriving.cross(leaving).dot(normal);
        let chord = (after - before).length();
        if left < -DENT_TOLERANCE * chord || chord == 0.0 {
            return Err(Fault::Concave);
        }
        full_turn += left.atan2(arriving.dot(leaving));
    }
    // The sum is a multiple of a full turn: half a turn decides which.
    if (full_turn - TAU).abs() > PI { Err(Fault::Concave) } else { Ok(()) }
}

/// Moved to the first corner, scaled to a largest coordinate of 1, corners that repeat the one before left out.
fn in_unit_size(corners: &[DVec3]) -> Vec<DVec3> {
    let first = corners.first().copied().unwrap_or_default();
    let size = corners.iter().map(|&c| (c - first).abs().max_element()).fold(0.0, f64::max);
    if size == 0.0 {
        return vec![DVec3::ZERO];
    }
    let mut unit: Vec<DVec3> = corners.iter().map(|&c| (c - first) / size).collect();
    unit.dedup();
    if unit.len() > 1 && unit.first() == unit.last() {
        unit.pop();
    }
    unit
}

fn newell_normal(corners: &[DVec3]) -> Option<DVec3> {
    let next = corners.iter().cycle().skip(1);
    let doubled_area: DVec3 = corners.iter().zip(next).map(|(a, b)| a.cross(*b)).sum();
    (doubled_area.length() > AREA_TOLERANCE).then(|| doubled_area.normalize())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn in_plane(points: &[(f64, f64)]) -> Vec<DVec3> {
        points.iter().map(|&(x, y)| DVec3::new(x, y, 0.3 * x - 0.7 * y + 5.0)).collect()
    }

    #[test]
    fn convex_polygons_pass_at_every_scale_and_in_both_windings() {
        let hexagon: Vec<_> = (0..6).map(|i| (TAU * f64::from(i) / 6.0).sin_cos()).collect();
        for scale in [1e-6, 1.0, 1e6, 1e200] {
            let mut corners: Vec<_> = in_plane(&hexagon).iter().map(|&c| c * scale).collect();
            assert_eq!(check_flat_and_convex(&corners), Ok(()));
            corners.reverse();
            assert_eq!(check_flat_and_convex(&corners), Ok(()));
        }
    }

    #[test]
    fn corners_on_a_straight_edge_and_repeated_corners_pass() {
        let corners = in_plane(&[(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (2.0, 2.0), (2.0, 2.0), (0.0, 2.0), (0.0, 0.0)]);
        assert_eq!(check_flat_and_convex(&corners), Ok(()));
    }

    #[test]
    fn polygons_without_area_pass() {
        let point = vec![DVec3::ONE; 4];
        assert_eq!(check_flat_and_convex(&point), Ok(()));
        assert_eq!(check_flat_and_convex(&in_plane(&[(0.0, 0.0), (1.0, 1.0), (2.0, 2.0), (1.0, 1.0)])), Ok(()));
    }

    #[test]
    fn concave_crossing_and_star_polygons_fail() {
        let arrow = in_plane(&[(0.0, 0.0), (2.0, 1.0), (0.0, 2.0), (0.5, 1.0)]);
        let bow_tie = in_plane(&[(0.0, 0.0), (2.0, 2.0), (2.0, 0.0), (0.0, 1.0)]);
        let star: Vec<_> = (0..5).map(|i| (TAU * f64::from(2 * i) / 5.0).sin_cos()).collect();
        let spike = in_plane(&[(0.0, 0.0), (1.0, 0.0), (3.0, 0.0), (1.0, 0.0), (0.0, 1.0)]);
        let hourglass = in_plane(&[(0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.0, 1.0)]);
        for polygon in [arrow, bow_tie, hourglass, in_plane(&star), spike] {
            assert_eq!(check_flat_and_convex(&polygon), Err(Fault::Concave), "{polygon:?}");
        }
    }

    #[test]
    fn bent_polygons_fail() {
        let mut corners = in_plane(&[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]);
        assert_eq!(check_flat_and_convex(&corners), Ok(()));
        corners[2].z += 0.2;
        assert!(matches!(check_flat_and_convex(&corners), Err(Fault::Bent(_))));
    }
}
