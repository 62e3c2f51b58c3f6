//! How a material sends light from a direction on to the eye: a diffuse and a specular term. Formulas:
//! docs/lighting.md.
//!
//! Specular: (r·v)^Ns about the mirrored light direction r (B. T. Phong, "Illumination for Computer Generated Pictures",
//! 1975), or (n·h)^Ns about the half vector h (J. Blinn, "Models of Light Reflection for Computer Synthesized Pictures",
//! 1977). Both are 0 where the light is behind the surface.

use crate::scene::{LightingMode, Material, Scene, Shading};
use glam::DVec3;
use std::f64::consts::FRAC_1_PI;

/// Kd/π · max(0, n·l) + Ks · spec, without the 1/π in classic mode. All directions are unit vectors from the surface.
pub(super) fn reflected(scene: &Scene, material: &Material, normal: DVec3, to_light: DVec3, to_eye: DVec3) -> DVec3 {
    let cosine = normal.dot(to_light);
    if cosine <= 0.0 {
        return DVec3::ZERO;
    }
    let diffuse_scale = match scene.mode {
        LightingMode::Physical => FRAC_1_PI,
        LightingMode::Classic => 1.0,
    };
    let highlight = match scene.shading {
        Shading::BlinnPhong => normal.dot((to_light + to_eye).normalize_or_zero()),
        Shading::Phong | Shading::Gouraud | Shading::Flat => (2.0 * cosine * normal - to_light).dot(to_eye),
    };
    let specular = highlight.max(0.0).powf(f64::from(material.shininess));
    material.diffuse.as_dvec3() * (diffuse_scale * cosine) + material.specular.as_dvec3() * specular
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inspect::fixtures::{cube, scene_of};
    use glam::Vec3;

    /// A few roundings of numbers near one; f32 coefficients are read exactly.
    const ROUNDING: f64 = 1e-12;

    /// Diffuse ½ and specular ¼ with exponent 2, light at 45° from the normal +Y, eye at an angle on the other side.
    fn reflected_at(shading: Shading, mode: LightingMode, eye_angle: f64) -> f64 {
        let mut scene = scene_of(&[cube(DVec3::ZERO)]);
        (scene.shading, scene.mode) = (shading, mode);
        (scene.materials[0].specular, scene.materials[0].shininess) = (Vec3::splat(0.25), 2.0);
        let to_light = DVec3::new(-1.0, 1.0, 0.0).normalize();
        let to_eye = DVec3::new(eye_angle.sin(), eye_angle.cos(), 0.0);
        reflected(&scene, &scene.materials[0], DVec3::Y, to_light, to_eye).x
    }

    fn assert_near(actual: f64, expected: f64) {
        assert!((actual - expected).abs() < ROUNDING, "{actual} is not {expected}");
    }

    #[test]
    fn the_mirror_direction_has_the_full_highlight() {
        let angle = std::f64::consts::FRAC_PI_4;
        let diffuse = 0.5 * angle.cos();
        for shading in [Shading::Phong, Shading::BlinnPhong, Shading::Gouraud, Shading::Flat] {
            assert_near(reflected_at(shading, LightingMode::Classic, angle), diffuse + 0.25);
            assert_near(reflected_at(shading, LightingMode::Physical, angle), diffuse * FRAC_1_PI + 0.25);
        }
    }

    #[test]
    fn off_the_mirror_phong_falls_twice_as_fast_in_angle_as_blinn() {
        let (angle, off) = (std::f64::consts::FRAC_PI_4, 0.2_f64);
        let diffuse = 0.5 * angle.cos();
        let highlight = |shading| reflected_at(shading, LightingMode::Classic, angle + off) - diffuse;
        assert_near(highlight(Shading::Phong), 0.25 * off.cos().powi(2));
        assert_near(highlight(Shading::BlinnPhong), 0.25 * (0.5 * off).cos().powi(2));
    }

    #[test]
    fn a_light_behind_the_surface_adds_nothing() {
        let mut scene = scene_of(&[cube(DVec3::ZERO)]);
        // With exponent 0 the highlight would be 1 in every direction.
        (scene.materials[0].specular, scene.materials[0].shininess) = (Vec3::ONE, 0.0);
        let lit_from = |to_light| reflected(&scene, &scene.materials[0], DVec3::Y, to_light, DVec3::Y);
        assert_eq!(lit_from(DVec3::NEG_Y), DVec3::ZERO);
        assert_eq!(lit_from(DVec3::X), DVec3::ZERO);
        assert!(lit_from(DVec3::Y).x > 1.0);
    }
}
