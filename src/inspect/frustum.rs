//! How near and how far the geometry inside a frustum is, measured along its axis.
//!
//! Every triangle is clipped to the frustum's four sides (I. Sutherland, G. Hodgman, "Reentrant Polygon Clipping", 1974),
//! so a floor that passes below the eye counts from where it comes into sight, not from the eye's own plane. The four
//! sides together also cut away everything behind the apex.

use crate::scene::Camera;
use glam::{DMat4, DVec2, DVec3, UVec2, dcamera::rh};
use serde::Serialize;

/// A span of distances in metres.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct DepthRange {
    /// The smallest distance.
    pub nearest_m: f64,
    /// The largest distance.
    pub farthest_m: f64,
}

impl DepthRange {
    /// The range of some distances; `None` without any.
    pub(super) fn of(distances_m: impl IntoIterator<Item = f64>) -> Option<Self> {
        distances_m.into_iter().fold(None, |range: Option<Self>, d| {
            let Self { nearest_m, farthest_m } = range.unwrap_or(Self { nearest_m: d, farthest_m: d });
            Some(Self { nearest_m: nearest_m.min(d), farthest_m: farthest_m.max(d) })
        })
    }
}

/// An infinite pyramid of sight; its view space looks along −z.
pub(super) struct Frustum {
    view_from_world: DMat4,
    /// Tangents of the horizontal and vertical half angles.
    tan_half: DVec2,
}

/// Beyond this |y| of a light's direction its up axis is −Z instead of +Y, so that a light straight above has a basis.
const NEARLY_VERTICAL: f64 = 0.999;

impl Frustum {
    /// What the camera sees in a picture of `size` pixels.
    pub(super) fn of_camera(camera: &Camera, size: UVec2) -> Self {
        let tan_half_y = (0.5 * camera.fov_y_rad).tan();
        let aspect = f64::from(size.x) / f64::from(size.y);
        Self { view_from_world: camera.view_from_world(), tan_half: DVec2::new(tan_half_y * aspect, tan_half_y) }
    }

    /// The square frustum around a cone: what a spot light's map sees.
    pub(super) fn around_cone(apex: DVec3, axis: DVec3, half_angle_rad: f64) -> Self {
        let axis = axis.normalize();
        let up = if axis.y.abs() <= NEARLY_VERTICAL { DVec3::Y } else { DVec3::NEG_Z };
        let view_from_world = rh::view::look_to_mat4(apex, axis, up);
        Self { view_from_world, tan_half: DVec2::splat(half_angle_rad.tan()) }
    }

    /// Distances along the axis of whatever part of the triangles is inside; `None` if nothing is.
    pub(super) fn depth_range(&self, triangles: impl Iterator<Item = [DVec3; 3]>) -> Option<DepthRange> {
        DepthRange::of(triangles.flat_map(|triangle| self.clip(triangle)).map(|corner| -corner.z))
    }

    /// The part of a triangle inside the four sides, in view space.
    fn clip(&self, triangle: [DVec3; 3]) -> Vec<DVec3> {
        let in_view = triangle.map(|p| self.view_from_world.transform_point3(p)).to_vec();
        let sides = [(DVec3::X, self.tan_half.x), (DVec3::Y, self.tan_half.y)];
        let inward = sides.into_iter().flat_map(|(axis, tan)| [axis - DVec3::Z * tan, -axis - DVec3::Z * tan]);
        inward.fold(in_view, |polygon, normal| clip_to_half_space(&polygon, normal))
    }
}

/// The part of a polygon where `normal · p ≥ 0`.
fn clip_to_half_space(polygon: &[DVec3], normal: DVec3) -> Vec<DVec3> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (k, &from) in polygon.iter().enumerate() {
        let to = polygon[(k + 1) % polygon.len()];
        let (start, end) = (normal.dot(from), normal.dot(to));
        if start >= 0.0 {
            kept.push(from);
        }
        if start * end < 0.0 {
            kept.push(from.lerp(to, start / (start - end)));
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_4;

    /// A few roundings of numbers of this size.
    const ROUNDING_M: f64 = 1e-12;

    fn looking_along_x() -> Frustum {
        Frustum::around_cone(DVec3::Y, DVec3::X, FRAC_PI_4)
    }

    #[test]
    fn a_floor_counts_from_where_it_comes_into_sight() {
        // From height 1 with a half angle of 45° the floor appears at distance 1; it reaches far behind the eye.
        let floor = [DVec3::new(-50.0, 0.0, -100.0), DVec3::new(-50.0, 0.0, 100.0), DVec3::new(40.0, 0.0, 0.0)];
        let range = looking_along_x().depth_range([floor].into_iter()).unwrap();
        assert!(
            (range.nearest_m - 1.0).abs() < ROUNDING_M && (range.farthest_m - 40.0).abs() < ROUNDING_M,
            "{range:?}"
        );
    }

    #[test]
    fn a_wall_across_the_axis_has_one_distance() {
        let wall = [DVec3::new(3.0, -9.0, -9.0), DVec3::new(3.0, 9.0, -9.0), DVec3::new(3.0, 0.0, 9.0)];
        let range = looking_along_x().depth_range([wall].into_iter()).unwrap();
        assert!((range.nearest_m - 3.0).abs() < ROUNDING_M && (range.farthest_m - 3.0).abs() < ROUNDING_M);
    }

    #[test]
    fn what_is_behind_or_beside_is_not_seen() {
        let behind = [DVec3::new(-3.0, 0.0, 0.0), DVec3::new(-3.0, 2.0, 0.0), DVec3::new(-3.0, 0.0, 2.0)];
        let beside = behind.map(|p| p + DVec3::new(4.0, 0.0, 9.0));
        assert_eq!(looking_along_x().depth_range([behind, beside].into_iter()), None);
    }

    #[test]
    fn a_light_straight_above_has_a_basis() {
        let down = Frustum::around_cone(DVec3::Y * 4.0, DVec3::NEG_Y, FRAC_PI_4);
        let floor = [DVec3::ZERO, DVec3::X, DVec3::Z];
        assert_eq!(down.depth_range([floor].into_iter()), Some(DepthRange { nearest_m: 4.0, farthest_m: 4.0 }));
    }
}
