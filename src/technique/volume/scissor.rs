//! The part of the picture that a light's range can reach: the bounding rectangle of a sphere in perspective.
//!
//! E. Lengyel, "The Mechanics of Robust Stencil Shadows", 2002. Exact per axis, rounded outward to pixels: it holds
//! every pixel that shows a point in range.

use crate::scene::{Camera, Light};
use glam::{DVec3, UVec2};

/// A rectangle of pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Rectangle {
    /// First column and row.
    pub(super) min: UVec2,
    /// First column and row beyond.
    pub(super) max: UVec2,
}

impl Rectangle {
    /// The whole picture.
    pub(super) fn whole(size: UVec2) -> Self {
        Self { min: UVec2::ZERO, max: size }
    }

    /// Where a light's range reaches; everything for a directional light and one without a range.
    pub(super) fn of_range(light: &Light, camera: &Camera, size: UVec2) -> Self {
        let homogeneous = light.homogeneous();
        if homogeneous.w == 0.0 || light.range_m.is_infinite() {
            return Self::whole(size);
        }
        let in_view = camera.view_from_world().transform_point3(homogeneous.truncate());
        let ahead = DVec3::new(in_view.x, in_view.y, -in_view.z);
        let tan_y = (0.5 * camera.fov_y_rad).tan();
        let tan_x = tan_y * f64::from(size.x) / f64::from(size.y);
        let [left, right] = on_axis(ahead.x, ahead.z, light.range_m, tan_x);
        let [bottom, top] = on_axis(ahead.y, ahead.z, light.range_m, tan_y);
        let pixel = |ndc: f64, side: u32| 0.5 * (ndc + 1.0) * f64::from(side);
        let min = UVec2::new(pixel(left, size.x).floor() as u32, pixel(-top, size.y).floor() as u32);
        let max = UVec2::new(pixel(right, size.x).ceil() as u32, pixel(-bottom, size.y).ceil() as u32);
        Self { min: min.min(size), max: max.min(size) }
    }

    /// Whether a pixel (`y * width + x`) is inside.
    pub(super) fn contains(&self, pixel: u32, width: u32) -> bool {
        let at = UVec2::new(pixel % width, pixel / width);
        at.cmpge(self.min).all() && at.cmplt(self.max).all()
    }

    /// Columns and rows.
    pub(super) fn size(&self) -> UVec2 {
        self.max.saturating_sub(self.min)
    }
}

/// Extent of a sphere's image along one axis, −1..=1: centre `across` and `ahead` of the eye. Empty (0 to 0) behind it.
fn on_axis(across: f64, ahead: f64, radius_m: f64, tan_half: f64) -> [f64; 2] {
    if ahead + radius_m <= 0.0 {
        return [0.0, 0.0];
    }
    let distance = across.hypot(ahead);
    if distance <= radius_m {
        return [-1.0, 1.0];
    }
    let (centre, half) = (across.atan2(ahead), (radius_m / distance).asin());
    [(centre - half), (centre + half)].map(|angle| {
        let beyond = angle.abs() >= std::f64::consts::FRAC_PI_2;
        let bound = if beyond { f64::INFINITY.copysign(angle) } else { angle.tan() / tan_half };
        bound.clamp(-1.0, 1.0)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inspect::fixtures::{point_light, scene_of};
    use crate::scene::Scene;
    use glam::DVec2;
    use proptest::prelude::*;

    fn rectangle(scene: &Scene, position: DVec3, range_m: f64) -> Rectangle {
        let light = Light { range_m, ..point_light(position.as_vec3()) };
        Rectangle::of_range(&light, &scene.camera, scene.image_size)
    }

    proptest! {
        #[test]
        fn every_visible_point_in_range_is_inside(
            (x, y, z) in (-6.0..6.0_f64, -6.0..6.0_f64, -20.0..8.0_f64),
            range in 0.1..6.0_f64, px in 0.0..64.0_f64, py in 0.0..64.0_f64, depth in 0.1..30.0_f64,
        ) {
            let scene = scene_of(&[]);
            let light = DVec3::new(x, y, z).as_vec3().as_dvec3();
            let point = scene.camera.eye.as_dvec3() + depth * scene.camera.ray_through(scene.image_size, DVec2::new(px, py));
            let pixel = py.floor() as u32 * 64 + px.floor() as u32;
            if point.distance(light) < range {
                prop_assert!(rectangle(&scene, light, range).contains(pixel, 64));
            }
        }
    }

    #[test]
    fn a_small_range_is_a_small_rectangle_and_behind_the_eye_is_none() {
        let scene = scene_of(&[]);
        let ahead = rectangle(&scene, DVec3::ZERO, 0.2);
        assert!(ahead.size().max_element() < 8 && ahead.contains(32 * 64 + 32, 64));
        assert_eq!(rectangle(&scene, DVec3::Z * 9.0, 0.5).size().x, 0);
        assert_eq!(rectangle(&scene, DVec3::Z * 5.0, 0.5), Rectangle::whole(scene.image_size));
        assert_eq!(rectangle(&scene, DVec3::ZERO, f64::INFINITY), Rectangle::whole(scene.image_size));
    }
}
