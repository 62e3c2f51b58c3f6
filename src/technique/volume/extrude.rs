//! Vertices moved away from the light: to infinity, or by a length. Computed in f64 and rounded once, so that every
//! face that uses a vertex uses the same one. Formulas: docs/volume.md#extrusion.

use glam::{DVec3, DVec4, Vec3, Vec4};

/// How far a volume reaches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Reach {
    /// To infinity: extruded vertices have w = 0.
    Infinite,
    /// By this many metres along the light's rays.
    Metres(f64),
}

/// Where a vertex goes. The light is homogeneous, with w = 0 for a direction towards it.
pub(super) fn extrude(vertex: Vec3, light: DVec4, reach: Reach) -> Vec4 {
    let away = away_from_light(vertex.as_dvec3(), light);
    match reach {
        Reach::Infinite => away.as_vec3().extend(0.0),
        Reach::Metres(length_m) => (vertex.as_dvec3() + length_m * away.normalize_or_zero()).as_vec3().extend(1.0),
    }
}

/// V·Lw − L: the direction of the light's ray at a point, not normalised.
fn away_from_light(point: DVec3, light: DVec4) -> DVec3 {
    point * light.w - light.truncate()
}

/// Whether a finite volume over a triangle ends behind a point: whether the point lies on the light's side of the
/// triangle's extruded image. Only asked of points whose ray to the light crosses the triangle.
pub(super) fn reaches(corners: [DVec3; 3], light: DVec4, reach: Reach, point: DVec3) -> bool {
    if reach == Reach::Infinite {
        return true;
    }
    let [a, b, c] = corners.map(|corner| extrude(corner.as_vec3(), light, reach).truncate().as_dvec3());
    let normal = (b - a).cross(c - a);
    let side = |homogeneous: DVec4| normal.dot(homogeneous.truncate() - a * homogeneous.w);
    side(point.extend(1.0)) * side(light) > 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAMP: DVec4 = DVec4::new(0.0, 4.0, 0.0, 1.0);
    const SUN: DVec4 = DVec4::new(0.0, 1.0, 0.0, 0.0);

    #[test]
    fn infinitely_far_is_a_direction() {
        assert_eq!(extrude(Vec3::new(1.0, 2.0, 0.0), LAMP, Reach::Infinite), Vec4::new(1.0, -2.0, 0.0, 0.0));
        assert_eq!(extrude(Vec3::new(1.0, 2.0, 0.0), SUN, Reach::Infinite), Vec4::new(0.0, -1.0, 0.0, 0.0));
    }

    #[test]
    fn a_length_is_in_metres_along_the_ray() {
        assert_eq!(extrude(Vec3::new(3.0, 0.0, 0.0), LAMP, Reach::Metres(5.0)), Vec4::new(6.0, -4.0, 0.0, 1.0));
        assert_eq!(extrude(Vec3::X, SUN, Reach::Metres(2.0)), Vec4::new(1.0, -2.0, 0.0, 1.0));
        let at_the_light = extrude(Vec3::new(0.0, 4.0, 0.0), LAMP, Reach::Metres(5.0));
        assert_eq!(at_the_light, Vec4::new(0.0, 4.0, 0.0, 1.0));
    }

    #[test]
    fn a_wide_triangle_falls_short_of_the_length_in_its_middle() {
        // Corners at 45 degrees around the axis: their images lie length × cos 45° below them.
        let corners = [DVec3::new(4.0, 0.0, 0.0), DVec3::new(-2.0, 0.0, 3.464), DVec3::new(-2.0, 0.0, -3.464)];
        let reach = Reach::Metres(2.0);
        assert!(reaches(corners, LAMP, reach, DVec3::new(0.0, -1.41, 0.0)));
        assert!(!reaches(corners, LAMP, reach, DVec3::new(0.0, -1.42, 0.0)));
        assert!(reaches(corners, LAMP, Reach::Infinite, DVec3::new(0.0, -1e9, 0.0)));
    }
}
