//! Whether a shadow ray crosses a triangle: the f64 twin of the test in `shaders/irregular/casters.wgsl`, and a bound on
//! what f32 can change about it (docs/irregular.md#error-bound).

use glam::{DVec3, DVec4};

/// Half an ulp of 1 in f32: the relative error of one rounding.
const U: f64 = 0.5 * f32::EPSILON as f64;
/// Roundings that reach a triple product, relative to the product of its factors' lengths: at most 11.6 are derived, and
/// the rest is for terms of higher order and for devices that round subtractions of products otherwise.
const ROUNDINGS: f64 = 16.0;

/// What exact arithmetic knows of a crossing that f32 decides.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Decision {
    /// Not crossed, whatever the rounding.
    Clear,
    /// Crossed, whatever the rounding.
    Blocked,
    /// A sign lies within its error bound.
    InDoubt,
}

/// A number whose sign decides, and the most by which f32 may miss it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bounded {
    pub(super) value: f64,
    pub(super) error: f64,
}

impl Bounded {
    /// 1 or −1 where the sign is certain, else 0.
    fn sign(self) -> i32 {
        i32::from(self.value > self.error) - i32::from(self.value < -self.error)
    }

    /// The triple product of three vectors that come in f32 with at most two roundings each.
    fn triple(a: DVec3, b: DVec3, c: DVec3) -> Self {
        Self { value: a.dot(b.cross(c)), error: ROUNDINGS * U * a.length() * b.length() * c.length() }
    }

    fn negated(self) -> Self {
        Self { value: -self.value, ..self }
    }
}

/// Whether the segment from a point to the homogeneous light crosses a triangle that has the light on `light_side` (the
/// sign of its distance from the plane).
pub(super) fn crossing(point: DVec3, light: DVec4, corners: [DVec3; 3], light_side: i32) -> Decision {
    let side = plane_side(point, corners).sign() * light_side;
    let edges = edge_sides(point, light, corners).map(Bounded::sign);
    let passes_outside = edges.contains(&1) && edges.contains(&-1);
    if side > 0 || passes_outside {
        return Decision::Clear;
    }
    let passes_inside = edges == [1; 3] || edges == [-1; 3];
    if side < 0 && passes_inside { Decision::Blocked } else { Decision::InDoubt }
}

/// Positive where the point is on the triangle's counter-clockwise side.
pub(super) fn plane_side(point: DVec3, [a, b, c]: [DVec3; 3]) -> Bounded {
    Bounded::triple(a - point, b - a, c - a).negated()
}

/// On which side of each edge the line from the point to the light passes.
pub(super) fn edge_sides(point: DVec3, light: DVec4, [a, b, c]: [DVec3; 3]) -> [Bounded; 3] {
    let to_light = light.truncate() - light.w * point;
    [(a, b), (b, c), (c, a)].map(|(from, to)| {
        if comes_before(to, from) {
            Bounded::triple(to_light, from_nearer_end(point, light, to), from - to).negated()
        } else {
            Bounded::triple(to_light, from_nearer_end(point, light, from), to - from)
        }
    })
}

/// From that end of the ray to a corner which rounds least.
fn from_nearer_end(point: DVec3, light: DVec4, corner: DVec3) -> DVec3 {
    let (offset, from_light) = (corner - point, corner - light.truncate());
    let is_nearer_light = light.w != 0.0 && from_light.length_squared() < offset.length_squared();
    if is_nearer_light { from_light } else { offset }
}

/// An order of points in space: both triangles at an edge work with the same numbers.
fn comes_before(p: DVec3, q: DVec3) -> bool {
    (p.x, p.y, p.z) < (q.x, q.y, q.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRIANGLE: [DVec3; 3] = [DVec3::ZERO, DVec3::X, DVec3::Y];
    const ABOVE: DVec4 = DVec4::new(0.2, 0.2, 5.0, 1.0);

    #[test]
    fn far_from_every_edge_it_is_decided() {
        let below = |x: f64, y: f64| crossing(DVec3::new(x, y, -1.0), ABOVE, TRIANGLE, 1);
        assert_eq!(below(0.25, 0.25), Decision::Blocked);
        assert_eq!(below(-0.5, 0.25), Decision::Clear);
        assert_eq!(crossing(DVec3::new(0.25, 0.25, 1.0), ABOVE, TRIANGLE, 1), Decision::Clear, "on the light's side");
        let sun = DVec4::new(0.0, 0.0, 1.0, 0.0);
        assert_eq!(crossing(DVec3::new(0.25, 0.25, -1.0), sun, TRIANGLE, 1), Decision::Blocked);
        assert_eq!(crossing(DVec3::new(0.75, 0.75, -1.0), sun, TRIANGLE, 1), Decision::Clear);
    }

    #[test]
    fn within_rounding_of_an_edge_or_the_plane_it_is_not() {
        let sun = DVec4::new(0.0, 0.0, 1.0, 0.0);
        for x in [0.0, 1e-7, -1e-7] {
            assert_eq!(crossing(DVec3::new(x, 0.5, -1.0), sun, TRIANGLE, 1), Decision::InDoubt, "{x}");
            assert_eq!(crossing(DVec3::new(0.25, 0.25, x), sun, TRIANGLE, 1), Decision::InDoubt, "{x}");
        }
        assert_eq!(crossing(DVec3::new(1e-4, 0.5, -1.0), sun, TRIANGLE, 1), Decision::Blocked);
        assert_eq!(crossing(DVec3::new(-1e-4, 0.5, -1.0), sun, TRIANGLE, 1), Decision::Clear);
    }

    #[test]
    fn next_to_the_light_small_triangles_are_decided_too() {
        let small = TRIANGLE.map(|corner| ABOVE.truncate() + 1e-6 * (corner - DVec3::new(0.25, 0.25, 1.0)));
        assert_eq!(crossing(DVec3::new(0.2, 0.2, -5.0), ABOVE, small, 1), Decision::Blocked);
        assert_eq!(crossing(DVec3::new(9.2, 0.2, -5.0), ABOVE, small, 1), Decision::Clear);
    }

    #[test]
    fn neighbours_see_exactly_opposite_numbers_at_their_edge() {
        let point = DVec3::new(0.123, 0.456, -0.789);
        let [.., ca] = edge_sides(point, ABOVE, TRIANGLE);
        let [_, bc, _] = edge_sides(point, ABOVE, [-DVec3::X, DVec3::ZERO, DVec3::Y]);
        assert_eq!(ca.value, -bc.value);
        assert_ne!(ca.value, 0.0);
    }
}
