//! The smooth-shading terminator: pixels that look like shadow acne although no shadow technique has a say in them.
//!
//! A facet turned away from the light is in its own shadow. Where the interpolated normal still faces the light, the
//! lighting model lights it, and every correct shadow cuts a saw-tooth along the facets' edges into that light (J.
//! Snyder, A. Barr, "Ray Tracing Complex Models Containing Surface Tessellations", 1987). It is a statistic of its own.

use super::attenuation::incident;
use super::interpolate::Facet;
use crate::receiver::{Receiver, Receivers};
use crate::scene::{Light, Scene, Shading};
use rayon::prelude::*;

/// Per pixel: whether its facet is turned away from a light that its interpolated normal still faces. Never with flat
/// shading, on the background, or where the light does not shine.
#[must_use]
pub fn terminator(scene: &Scene, receivers: &Receivers, light: &Light) -> Vec<bool> {
    let is_on_terminator = |receiver: &Receiver| {
        incident(light, scene.mode, receiver.point_in_world).is_some_and(|incident| {
            let is_facet_dark = receiver.normal_in_world.dot(incident.towards_light) <= 0.0;
            is_facet_dark && Facet::new(scene, receiver).shading_normal().dot(incident.towards_light) > 0.0
        })
    };
    let is_smooth = scene.shading != Shading::Flat;
    receivers.pixels.par_iter().map(|pixel| is_smooth && pixel.as_ref().is_some_and(is_on_terminator)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inspect::fixtures::{Shape, scene_of};
    use crate::scene::LightKind;
    use glam::{DVec3, UVec2, Vec3};

    /// One facet with normal +Y whose corner normals lean towards +X at the first corner, and a light from +X, just
    /// below the facet's plane.
    fn leaning() -> (Scene, Receivers, Light) {
        let positions = vec![DVec3::ZERO, DVec3::X, DVec3::NEG_Z];
        let mut scene = scene_of(&[Shape { positions, triangles: vec![[0, 1, 2]] }]);
        scene.corner_normals[0] = [Vec3::new(0.6, 0.8, 0.0), Vec3::Y, Vec3::new(-0.6, 0.8, 0.0)];
        let at = |x, z| {
            let point_in_world = DVec3::new(x, 0.0, z);
            Some(Receiver { triangle: 0, point_in_world, normal_in_world: DVec3::Y })
        };
        let pixels = vec![at(0.1, -0.1), at(0.1, -0.8), None];
        let kind = LightKind::Directional { towards_light: Vec3::new(1.0, -0.05, 0.0).normalize() };
        let light = Light { name: "low".into(), kind, intensity: Vec3::ONE, range_m: f64::INFINITY };
        (scene, Receivers { size: UVec2::new(3, 1), pixels }, light)
    }

    #[test]
    fn only_where_the_interpolated_normal_leans_to_the_light() {
        let (scene, receivers, light) = leaning();
        assert_eq!(terminator(&scene, &receivers, &light), [true, false, false]);
    }

    #[test]
    fn a_facet_that_faces_the_light_has_none() {
        let (scene, receivers, mut light) = leaning();
        light.kind = LightKind::Directional { towards_light: Vec3::new(1.0, 0.05, 0.0).normalize() };
        assert_eq!(terminator(&scene, &receivers, &light), [false; 3]);
    }

    #[test]
    fn flat_shading_has_none() {
        let (mut scene, receivers, light) = leaning();
        scene.shading = Shading::Flat;
        assert_eq!(terminator(&scene, &receivers, &light), [false; 3]);
    }
}
