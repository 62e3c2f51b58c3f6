//! How far a point is from a triangle.

use glam::DVec3;

/// Distance from a point to a triangle: to its plane where the foot is inside, otherwise to its nearest side.
#[must_use]
pub fn distance_to_triangle(point: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let sides = [(a, b), (b, c), (c, a)];
    let normal = (b - a).cross(c - a);
    let is_above = |(from, to): (DVec3, DVec3)| (to - from).cross(point - from).dot(normal) >= 0.0;
    if normal != DVec3::ZERO && sides.into_iter().all(is_above) {
        return (point - a).dot(normal).abs() / normal.length();
    }
    sides.into_iter().map(|(from, to)| distance_to_segment(point, from, to)).fold(f64::INFINITY, f64::min)
}

fn distance_to_segment(point: DVec3, from: DVec3, to: DVec3) -> f64 {
    let along = to - from;
    let share = (point - from).dot(along) / along.length_squared();
    // A segment without length has no share (NaN): its start is as near as any of it.
    let share = if share.is_nan() { 0.0 } else { share.clamp(0.0, 1.0) };
    point.distance(from + along * share)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A few roundings of numbers of this size.
    const ROUNDING: f64 = 1e-12;

    #[test]
    fn distance_to_a_triangle_by_region() {
        let triangle = [DVec3::ZERO, DVec3::X * 2.0, DVec3::Y * 2.0];
        let cases = [
            (DVec3::new(0.5, 0.5, 3.0), 3.0),
            (DVec3::new(1.0, -2.0, 0.0), 2.0),
            (DVec3::new(2.0, 2.0, 0.0), 2.0_f64.sqrt()),
            (DVec3::new(-3.0, -4.0, 0.0), 5.0),
        ];
        for (point, expected) in cases {
            assert!((distance_to_triangle(point, triangle) - expected).abs() < ROUNDING);
        }
        assert!((distance_to_triangle(DVec3::Z, [DVec3::ZERO; 3]) - 1.0).abs() < ROUNDING);
    }
}
