//! Whether an object's shadow volume can touch the camera's near rectangle: only then does counting the faces before
//! the surface start from a wrong number.
//!
//! The volume touches the rectangle only if the object reaches into the pyramid (for a directional light: the prism)
//! between the light and the rectangle; C. Everitt, M. Kilgard, "Practical and Robust Stenciled Shadow Volumes for
//! Hardware-Accelerated Rendering", 2002. The test is conservative: a sphere stands for the object.

use glam::{DVec3, DVec4};

/// A light this near to the near plane (sine of the angle) leaves no pyramid worth its name: nothing is safe then.
pub(super) const LEAST_SINE: f64 = 1e-6;

/// Planes with unit normals around the pyramid, all normals inward; `None` if the light lies in the near plane.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Pyramid {
    planes: Option<Vec<DVec4>>,
}

/// How far a homogeneous light is from a plane, relative to the length of its vector: negative behind it.
pub(super) fn sine_to_plane(plane: DVec4, light: DVec4) -> f64 {
    plane.dot(light) / light.length()
}

impl Pyramid {
    /// Around a near rectangle (corners in order around it) in its plane, and a homogeneous light.
    pub(super) fn new(rectangle: [DVec3; 4], near_plane: DVec4, light: DVec4) -> Self {
        let sine = sine_to_plane(near_plane, light);
        if sine.abs() <= LEAST_SINE {
            return Self { planes: None };
        }
        let centre = rectangle.iter().sum::<DVec3>() / 4.0;
        let side = |i: usize| {
            let (from, to) = (rectangle[i], rectangle[(i + 1) % 4]);
            let normal = (to - from).cross(light.truncate() - light.w * from).normalize_or_zero();
            let inward = if normal.dot(centre - from) < 0.0 { -normal } else { normal };
            inward.extend(-inward.dot(from))
        };
        let base = if sine > 0.0 { near_plane } else { -near_plane };
        Self { planes: Some((0..4).map(side).chain([base]).collect()) }
    }

    /// Whether a sphere lies outside the pyramid for certain.
    pub(super) fn excludes(&self, centre: DVec3, radius_m: f64) -> bool {
        let planes = self.planes.as_deref().unwrap_or_default();
        planes.iter().any(|plane| plane.dot(centre.extend(1.0)) < -radius_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At z = −1, looked through along −z.
    const RECTANGLE: [DVec3; 4] = [
        DVec3::new(-1.0, 1.0, -1.0),
        DVec3::new(1.0, 1.0, -1.0),
        DVec3::new(1.0, -1.0, -1.0),
        DVec3::new(-1.0, -1.0, -1.0),
    ];
    const PLANE: DVec4 = DVec4::new(0.0, 0.0, -1.0, -1.0);

    #[test]
    fn between_light_and_rectangle_is_unsafe_and_beside_or_beyond_is_safe() {
        for light in [DVec4::new(0.0, 0.0, 9.0, 1.0), DVec4::new(0.0, 0.0, 1.0, 0.0)] {
            let pyramid = Pyramid::new(RECTANGLE, PLANE, light);
            assert!(!pyramid.excludes(DVec3::new(0.0, 0.0, 4.0), 0.1));
            assert!(pyramid.excludes(DVec3::new(3.0, 0.0, 4.0), 0.1));
            assert!(pyramid.excludes(DVec3::new(0.0, 0.0, -4.0), 0.1), "its volume leads away from the rectangle");
            assert!(!pyramid.excludes(DVec3::new(1.05, 0.0, -0.9), 0.1), "a sphere that touches is unsafe");
        }
    }

    #[test]
    fn a_light_in_the_near_plane_makes_nothing_safe() {
        let pyramid = Pyramid::new(RECTANGLE, PLANE, DVec4::new(5.0, 0.0, -1.0, 1.0));
        assert!(!pyramid.excludes(DVec3::splat(1e6), 1e-3));
    }
}
