//! The camera as volumes see it: the picture's own matrix with the depth row that the parameters ask for, rounded once;
//! and the near and far end of each pixel's ray. Formulas: docs/volume.md#depth.

use super::settings::{FarPlane, Settings};
use crate::scene::{Camera, Far, Scene};
use crate::technique::Unsupported;
use glam::{DMat4, DVec2, DVec3, DVec4, Mat4, UVec2};

/// Margin of a forward infinite far plane, as a share of the depth range: with none, f32 rounding puts points at
/// infinity in front of the far plane or behind it as it likes. Reversed depth needs none, its infinity is exactly 0.
const FORWARD_MARGIN: f64 = 1.0 / (1 << 22) as f64;
/// An automatic far plane lies behind the farthest geometry by this share of its distance, so that rounding cannot cut
/// it off.
const FAR_SLACK: f64 = 1e-3;

/// The camera's matrix and rays.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Eye {
    camera: Camera,
    size: UVec2,
    /// Where the far plane is, metres along the view; `None` if nowhere.
    pub(super) far_m: Option<f64>,
    /// World to clip, rounded.
    pub(super) clip_from_world: Mat4,
    /// The row of z.
    depth_row: DVec4,
    /// Depth of points at infinity; `None` with a finite far plane, where the matrix's own row puts them beyond it.
    pub(super) depth_at_infinity: Option<f32>,
    /// True where depth 1 is near.
    pub(super) reversed: bool,
}

impl Eye {
    /// The scene's camera under the settings' depth convention and far plane.
    ///
    /// # Errors
    /// [`Unsupported::Degenerate`] if the far plane is not behind the near plane.
    pub(super) fn new(scene: &Scene, settings: &Settings) -> Result<Self, Unsupported> {
        let camera = scene.camera;
        let far_m = match settings.far {
            FarPlane::Infinite => None,
            FarPlane::Clamp(length) | FarPlane::Finite(length) => Some(length.or(automatic_far_m(scene))),
        };
        let near_m = camera.near_m;
        if far_m.is_some_and(|far_m| far_m <= near_m) {
            let why = format!("far_m is not beyond the camera's near plane at {near_m} m");
            return Err(Unsupported::Degenerate { why });
        }
        let depth_row = depth_row(near_m, far_m, settings.reversed);
        let mut rows = camera.clip_from_view(scene.image_size).transpose();
        rows.z_axis = depth_row;
        let clip_from_world = (rows.transpose() * camera.view_from_world()).as_mat4();
        let depth_at_infinity = far_m.is_none().then_some(-depth_row.z as f32);
        Ok(Self {
            camera,
            size: scene.image_size,
            far_m,
            clip_from_world,
            depth_row,
            depth_at_infinity,
            reversed: settings.reversed,
        })
    }

    /// The depth a cleared buffer holds: the far end.
    pub(super) fn clear_depth(&self) -> f32 {
        if self.reversed { 0.0 } else { 1.0 }
    }

    /// Depth of what lies that far along the view, between near and far end.
    pub(super) fn depth_at(&self, distance_m: f64) -> f32 {
        let distance_m = distance_m.max(self.camera.near_m);
        (self.depth_row.w / distance_m - self.depth_row.z).clamp(0.0, 1.0) as f32
    }

    /// The middle of the near rectangle.
    pub(super) fn near_centre(&self) -> DVec3 {
        self.point_on_plane(0.5 * self.size.as_dvec2(), self.camera.near_m)
    }

    /// Where the ray through a pixel's centre meets the plane at `distance_m` along the view, rebased world.
    pub(super) fn point_at(&self, pixel: u32, distance_m: f64) -> DVec3 {
        let column_row = DVec2::new((pixel % self.size.x).into(), (pixel / self.size.x).into());
        self.point_on_plane(column_row + 0.5, distance_m)
    }

    /// Where the ray through a pixel's centre meets the near plane.
    pub(super) fn near_point(&self, pixel: u32) -> DVec3 {
        self.point_at(pixel, self.camera.near_m)
    }

    /// Where the camera is, rebased world.
    pub(super) fn position_in_world(&self) -> DVec3 {
        self.camera.eye.as_dvec3()
    }

    /// Distance of a point along the view, metres.
    pub(super) fn distance_m(&self, point_in_world: DVec3) -> f64 {
        -self.camera.view_from_world().transform_point3(point_in_world).z
    }

    /// The corners of the near rectangle in order around it, rebased world.
    pub(super) fn near_rectangle(&self) -> [DVec3; 4] {
        let (w, h) = (f64::from(self.size.x), f64::from(self.size.y));
        [(0.0, 0.0), (w, 0.0), (w, h), (0.0, h)].map(|(x, y)| self.point_on_plane(DVec2::new(x, y), self.camera.near_m))
    }

    /// The near plane (unit normal, offset), oriented so that the camera looks along the normal.
    pub(super) fn near_plane(&self) -> DVec4 {
        let forward = self.camera.view_from_world().transpose().transform_vector3(DVec3::NEG_Z).normalize();
        let through = self.position_in_world() + self.camera.near_m * forward;
        forward.extend(-forward.dot(through))
    }

    fn point_on_plane(&self, pixel: DVec2, distance_m: f64) -> DVec3 {
        self.position_in_world() + distance_m * self.camera.ray_through(self.size, pixel)
    }
}

/// Row of z of the projection; w is minus the view's z, so a point at infinity has depth minus the third entry.
fn depth_row(near_m: f64, far_m: Option<f64>, reversed: bool) -> DVec4 {
    let (z, w) = match (far_m, reversed) {
        (None, true) => (0.0, near_m),
        (None, false) => (FORWARD_MARGIN - 1.0, near_m * (FORWARD_MARGIN - 1.0)),
        (Some(far_m), true) => (near_m / (far_m - near_m), near_m * far_m / (far_m - near_m)),
        (Some(far_m), false) => (far_m / (near_m - far_m), near_m * far_m / (near_m - far_m)),
    };
    DVec4::new(0.0, 0.0, z, w)
}

fn automatic_far_m(scene: &Scene) -> f64 {
    let view: DMat4 = scene.camera.view_from_world();
    let distance = |triangle: u32| scene.triangle_in_world(triangle).map(|corner| -view.transform_point3(corner).z);
    match scene.camera.far {
        Far::Finite(far_m) => far_m,
        Far::Infinite => {
            let farthest = (0..scene.triangles.len() as u32).flat_map(distance).fold(0.0, f64::max);
            farthest.max(2.0 * scene.camera.near_m) * (1.0 + FAR_SLACK)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inspect::fixtures::{cube, scene_of};
    use crate::technique::Spec;

    fn eye(typed: &str) -> Eye {
        let scene = scene_of(&[cube(DVec3::splat(-0.5))]);
        Eye::new(&scene, &Settings::of(&Spec::parse(typed).unwrap())).unwrap()
    }

    fn depth(eye: &Eye, distance_m: f64) -> f64 {
        let clip = eye.clip_from_world.as_dmat4() * eye.point_at(0, distance_m).extend(1.0);
        clip.z / clip.w
    }

    /// Rounding of the matrix to f32.
    const F32: f64 = 1e-5;

    #[test]
    fn depth_runs_from_near_to_far_in_every_convention() {
        for (typed, near, far) in [("reversed", 1.0, 0.0), ("forward", 0.0, 1.0)] {
            for plane in ["infinite", "finite", "clamp"] {
                let eye = eye(&format!("volume:depth_convention={typed},far={plane}"));
                assert!((depth(&eye, 0.1) - near).abs() < F32);
                assert!((depth(&eye, 3.0) - f64::from(eye.depth_at(3.0))).abs() < F32);
                assert!((f64::from(eye.depth_at(f64::INFINITY)) - far).abs() < F32);
                assert!((depth(&eye, eye.far_m.unwrap_or(1e7)) - far).abs() < F32);
            }
        }
    }

    #[test]
    fn infinity_has_a_depth_of_its_own() {
        assert_eq!(eye("volume").depth_at_infinity, Some(0.0));
        let forward = eye("volume:depth_convention=forward").depth_at_infinity.unwrap();
        assert!(forward < 1.0 && forward > 1.0 - 1e-6);
        assert_eq!(eye("volume:far=finite").depth_at_infinity, None);
    }

    #[test]
    fn the_reversed_infinite_matrix_is_the_pictures_own() {
        let scene = scene_of(&[cube(DVec3::ZERO)]);
        assert_eq!(eye("volume").clip_from_world, scene.camera.clip_from_world(scene.image_size).as_mat4());
    }

    #[test]
    fn near_points_lie_on_the_near_plane_and_far_must_be_behind_it() {
        let view = eye("volume");
        for point in view.near_rectangle().into_iter().chain([view.near_point(77)]) {
            assert!(view.near_plane().dot(point.extend(1.0)).abs() < 1e-12);
        }
        let scene = scene_of(&[cube(DVec3::ZERO)]);
        let before = Settings::of(&Spec::parse("volume:far=finite,far_m=0.05").unwrap());
        assert!(Eye::new(&scene, &before).is_err());
    }
}
