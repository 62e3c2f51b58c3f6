//! A triangle as a rasteriser sees it: three lines in the picture, and an inverse view depth that is linear over it.
//!
//! M. Olano, T. Greer, "Triangle Scan Conversion using 2D Homogeneous Coordinates", 1997: no clipping, and corners at
//! infinity or behind the eye are no special case.

use glam::{DMat4, DVec2, DVec3, DVec4};

/// Lines and depth in pixels, y down, evaluated as dot products with (x, y, 1).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProjectedTriangle {
    /// Lines through the sides, positive inside, scaled to pixels.
    pub sides: [DVec3; 3],
    /// Inverse view depth, 1/m; not positive behind the eye.
    pub inverse_depth: DVec3,
    /// True if its corners run clockwise in the picture, as an outward face's do that is seen from behind.
    pub is_back: bool,
}

impl ProjectedTriangle {
    /// From homogeneous corners in world space, w = 0 for a point at infinity, seen in a picture of that size; `None`
    /// edge-on.
    #[must_use]
    pub fn new(corners: [DVec4; 3], clip_from_world: &DMat4, size: DVec2) -> Option<Self> {
        let in_picture = |p: DVec4| DVec3::new(0.5 * (p.w + p.x) * size.x, 0.5 * (p.w - p.y) * size.y, p.w);
        let [a, b, c] = corners.map(|corner| in_picture(*clip_from_world * corner));
        let determinant = a.dot(b.cross(c));
        let lines = [b.cross(c), c.cross(a), a.cross(b)];
        let sides = lines.map(|line| line * determinant.signum() / line.truncate().length());
        let weighted = lines.iter().zip(corners).map(|(line, corner)| *line * corner.w);
        let inverse_depth = weighted.sum::<DVec3>() / determinant;
        let is_seen = determinant != 0.0 && sides.iter().all(|side| side.is_finite());
        // y runs down: counter-clockwise corners have a negative determinant.
        is_seen.then_some(Self { sides, inverse_depth, is_back: determinant > 0.0 })
    }

    /// The columns, from and to, between which a row at height `y` is inside; none if to is less than from.
    #[must_use]
    pub fn columns(&self, y: f64) -> [f64; 2] {
        self.sides.iter().fold([f64::NEG_INFINITY, f64::INFINITY], |[from, to], side| {
            let constant = side.y * y + side.z;
            let crossing = -constant / side.x;
            if side.x > 0.0 {
                [from.max(crossing), to]
            } else if side.x < 0.0 {
                [from, to.min(crossing)]
            } else if constant < 0.0 {
                [f64::INFINITY, f64::NEG_INFINITY]
            } else {
                [from, to]
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dcamera::rh;

    fn seen(corners: [DVec4; 3]) -> ProjectedTriangle {
        let clip_from_world = rh::proj::directx::perspective_infinite_reverse(1.0, 1.0, 0.1);
        ProjectedTriangle::new(corners, &clip_from_world, DVec2::splat(100.0)).unwrap()
    }

    fn projected(corners: [DVec3; 3]) -> ProjectedTriangle {
        seen(corners.map(|p| p.extend(1.0)))
    }

    const CENTRE: DVec3 = DVec3::new(50.0, 50.0, 1.0);
    const CORNERS: [DVec3; 3] = [DVec3::new(-1.0, -1.0, -4.0), DVec3::new(1.0, -1.0, -4.0), DVec3::new(0.0, 1.0, -4.0)];

    #[test]
    fn it_knows_its_sides_its_depth_and_which_way_it_turns() {
        let [a, b, c] = CORNERS;
        for (corners, is_back) in [([a, b, c], false), ([b, a, c], true)] {
            let seen = projected(corners);
            assert_eq!(seen.is_back, is_back);
            assert!((seen.inverse_depth.dot(CENTRE) - 0.25).abs() < 1e-12);
            assert!(seen.sides.iter().all(|side| side.dot(CENTRE) > 0.0));
            assert!(seen.sides.iter().any(|side| side.dot(DVec3::new(99.0, 99.0, 1.0)) < 0.0));
            let [from, to] = seen.columns(50.0);
            assert!(from > 35.0 && from < 50.0 && to > 50.0 && to < 65.0, "{from} {to}");
            let [from, to] = seen.columns(0.0);
            assert!(from > to);
        }
    }

    #[test]
    fn a_corner_at_infinity_is_the_limit_of_a_far_one() {
        let [a, b, c] = CORNERS.map(|p| p.extend(1.0));
        let direction = DVec3::new(0.1, 1.0, -2.0);
        let (at_infinity, far) = (seen([a, b, direction.extend(0.0)]), seen([a, b, c + 1e9 * direction.extend(0.0)]));
        let depth = |triangle: ProjectedTriangle| triangle.inverse_depth.dot(CENTRE);
        assert!((depth(at_infinity) - depth(far)).abs() < 1e-6 && depth(at_infinity) < 0.25);
    }

    #[test]
    fn behind_the_eye_its_depth_is_negative() {
        assert!(projected(CORNERS.map(|p| -p)).inverse_depth.dot(CENTRE) < 0.0);
    }
}
