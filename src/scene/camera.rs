//! The camera: matrices and pixel rays, all in f64 from the camera's rounded f32 numbers.

use glam::{DMat4, DVec2, DVec3, UVec2, Vec3, dcamera::rh};

/// A perspective camera. `eye != target`, `up` is not parallel to the view direction, 0 < fov < π, near > 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Where the camera is, rebased world.
    pub eye: Vec3,
    /// A point it looks at, rebased world.
    pub target: Vec3,
    /// Which way is up.
    pub up: Vec3,
    /// Vertical field of view, radians.
    pub fov_y_rad: f64,
    /// Distance of the near plane, metres.
    pub near_m: f64,
    /// The far plane.
    pub far: Far,
}

/// The camera's far plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Far {
    /// None: depth is infinite-far.
    Infinite,
    /// At this distance in metres, beyond near.
    Finite(f64),
}

impl Camera {
    /// World to view space; the view looks along −z.
    #[must_use]
    pub fn view_from_world(&self) -> DMat4 {
        rh::view::look_at_mat4(self.eye.as_dvec3(), self.target.as_dvec3(), self.up.as_dvec3())
    }

    /// View to wgpu clip space with reversed depth (near = 1, far = 0). `size` in pixels gives the aspect ratio.
    #[must_use]
    pub fn clip_from_view(&self, size: UVec2) -> DMat4 {
        let aspect = f64::from(size.x) / f64::from(size.y);
        match self.far {
            Far::Infinite => rh::proj::directx::perspective_infinite_reverse(self.fov_y_rad, aspect, self.near_m),
            // The same matrix with near and far exchanged reverses finite depth.
            Far::Finite(far_m) => rh::proj::directx::perspective(self.fov_y_rad, aspect, far_m, self.near_m),
        }
    }

    /// World to wgpu clip space, reversed depth.
    #[must_use]
    pub fn clip_from_world(&self, size: UVec2) -> DMat4 {
        self.clip_from_view(size) * self.view_from_world()
    }

    /// World direction (not normalised; view depth 1) of the ray from the eye through `pixel`, whose centres are at
    /// (x + ½, y + ½) with y down.
    #[must_use]
    pub fn ray_through(&self, size: UVec2, pixel: DVec2) -> DVec3 {
        let size = size.as_dvec2();
        let tan_half = (0.5 * self.fov_y_rad).tan();
        let ndc = DVec2::new(2.0 * pixel.x / size.x - 1.0, 1.0 - 2.0 * pixel.y / size.y);
        let in_view = DVec3::new(ndc.x * tan_half * size.x / size.y, ndc.y * tan_half, -1.0);
        self.view_from_world().transpose().transform_vector3(in_view)
    }
}
