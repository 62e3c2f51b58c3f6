//! The definition of a crossing, decided by the signs of exact determinants, and where along the segment it lies.

use crate::scene::Segment;
use glam::DVec3;
use robust::{Coord3D, orient3d};

/// Whether `segment` p → q crosses the triangle: p and q strictly on opposite sides of its plane, and the line passing
/// all three edges on the same side or through them. Exact for all finite input that does not underflow.
///
/// The line cannot lie in the plane then, so the three edge signs are never all zero; a triangle without area has no
/// sides and is never crossed.
pub(super) fn crosses(segment: &Segment, &[a, b, c]: &[DVec3; 3]) -> bool {
    let &Segment { from: p, to: q } = segment;
    let (p_side, q_side) = (side(a, b, c, p), side(a, b, c, q));
    if !(p_side < 0.0 && q_side > 0.0 || p_side > 0.0 && q_side < 0.0) {
        return false;
    }
    let edges = [side(p, q, a, b), side(p, q, b, c), side(p, q, c, a)];
    edges.iter().all(|&edge| edge >= 0.0) || edges.iter().all(|&edge| edge <= 0.0)
}

/// A number whose sign, exactly, says on which side of the plane a, b, c the point d lies; 0 on it.
pub(super) fn side(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> f64 {
    let [a, b, c, d] = [a, b, c, d].map(|v| Coord3D { x: v.x, y: v.y, z: v.z });
    orient3d(a, b, c, d)
}

/// Where along `segment` it crosses the triangle, 0..=1, given that it does. Rounded, but never before the segment
/// enters the triangle's box, so a traversal may leave out boxes that begin behind a known hit.
pub(super) fn parameter(segment: &Segment, corners: &[DVec3; 3]) -> f64 {
    let [a, b, c] = *corners;
    let (origin, along) = (segment.from, segment.to - segment.from);
    let normal = (b - a).cross(c - a);
    // f64::max and min skip NaN: where rounding leaves 0/0 the box decides alone.
    (normal.dot(a - origin) / normal.dot(along)).max(entry(origin, along, corners)).min(1.0)
}

/// Where the ray enters the box of `corners`, at least 0. Rounds as the tree does, which must not see a box later.
fn entry(origin: DVec3, along: DVec3, corners: &[DVec3; 3]) -> f64 {
    let [a, b, c] = *corners;
    let (min, max) = (a.min(b).min(c), a.max(b).max(c));
    (0..3).fold(0.0, |entry: f64, axis| {
        let near = if along[axis].is_sign_negative() { max[axis] } else { min[axis] };
        entry.max((near - origin[axis]) * clamped_inverse(along[axis]))
    })
}

/// 1/x, but ±10³⁰⁰ where that is larger or infinite: a plane the ray is parallel to is then passed far before the
/// start or far behind the end, and 0 · ∞ cannot arise.
pub(super) fn clamped_inverse(x: f64) -> f64 {
    const LARGEST: f64 = 1e300;
    if x.abs() * LARGEST > 1.0 { 1.0 / x } else { LARGEST.copysign(x) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRIANGLE: [DVec3; 3] = [DVec3::ZERO, DVec3::X, DVec3::Y];

    fn down(x: f64, y: f64) -> Segment {
        Segment { from: DVec3::new(x, y, 1.0), to: DVec3::new(x, y, -1.0) }
    }

    #[test]
    fn edges_and_vertices_belong_to_the_triangle_and_the_next_number_does_not() {
        for (x, y) in [(0.25, 0.25), (0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (0.5, 0.5), (0.3, 0.0)] {
            assert!(crosses(&down(x, y), &TRIANGLE), "{x} {y}");
        }
        for (x, y) in [(0.3, -f64::MIN_POSITIVE), (0.5, 0.5f64.next_up()), (1.0f64.next_up(), 0.0)] {
            assert!(!crosses(&down(x, y), &TRIANGLE), "{x} {y}");
        }
    }

    #[test]
    fn both_ends_are_open() {
        let at = |z: f64| DVec3::new(0.25, 0.25, z);
        assert!(!crosses(&Segment { from: at(0.0), to: at(1.0) }, &TRIANGLE));
        assert!(!crosses(&Segment { from: at(1.0), to: at(0.0) }, &TRIANGLE));
        assert!(crosses(&Segment { from: at(1.0), to: at(-f64::MIN_POSITIVE) }, &TRIANGLE));
    }

    #[test]
    fn no_area_no_plane_and_no_length_is_a_miss() {
        assert!(!crosses(&down(0.5, 0.0), &[DVec3::ZERO, DVec3::X, 0.5 * DVec3::X]));
        assert!(!crosses(&Segment { from: -DVec3::X, to: 2.0 * DVec3::X }, &TRIANGLE));
        assert!(!crosses(&Segment { from: DVec3::ZERO, to: DVec3::ZERO }, &TRIANGLE));
    }

    #[test]
    fn the_parameter_is_the_fraction_of_the_way() {
        assert_eq!(
            parameter(&Segment { from: DVec3::new(0.2, 0.2, 3.0), to: DVec3::new(0.2, 0.2, -1.0) }, &TRIANGLE),
            0.75
        );
    }
}
