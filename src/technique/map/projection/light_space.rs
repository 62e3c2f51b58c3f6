//! Light space: the light's rays fall along −y, and the camera looks down −z as far as that allows. For parallel light it
//! is the world, turned. For a light that is somewhere it is the light's post-perspective space (x/w, 1/w, z/w), w the
//! distance along the light's axis: there its rays are parallel, and what holds for parallel light holds for it.
//!
//! M. Wimmer, D. Scherzer, W. Purgathofer, "Light Space Perspective Shadow Maps", 2004.

use super::body::Body;
use super::{LightFrustum, Shape};
use crate::scene::Camera;
use glam::{DMat3, DMat4, DVec3, DVec4};

/// See the module.
#[derive(Debug)]
pub(super) struct LightSpace {
    /// Homogeneous; w is 1 for parallel light, else the distance along the light's axis.
    pub(super) light_from_world: DMat4,
    /// Sine of the angle between the light's axis and the camera's.
    pub(super) sine: f64,
    /// The eye's x for parallel light; from a light that is somewhere the eye may lie to the side, or behind it.
    pub(super) eye_x: Option<f64>,
    eye: DVec3,
    axis: DVec3,
    near_m: f64,
}

/// What a map must hold, in light space.
#[derive(Debug)]
pub(super) struct Held {
    /// Receivers, and how far up casters may be.
    pub(super) points: Vec<DVec3>,
    /// The smallest distance of a receiver along the camera's axis, over its w.
    pub(super) nearest: f64,
}

/// (x, y, z, 1) to (x, 1, z, −y): perspective along −y, the nearer to the eye the higher.
const PERSPECTIVE: DMat4 = DMat4::from_cols(DVec4::X, DVec4::NEG_W, DVec4::Z, DVec4::Y);

impl LightSpace {
    /// Around a light's frustum, whose `light` is its apex, or a direction. `None` where the camera looks along its axis.
    pub(super) fn of(frustum: &LightFrustum, light: DVec4, camera: &Camera, least_sine: f64) -> Option<Self> {
        let eye = camera.eye.as_dvec3();
        let axis = -camera.view_from_world().row(2).truncate();
        let y = frustum.light_view_from_world.row(2).truncate();
        let sine = y.cross(axis).length();
        if sine < least_sine {
            return None;
        }
        let z = -(axis - axis.dot(y) * y).normalize();
        let turned = DMat4::from_mat3(DMat3::from_cols(y.cross(z), y, z).transpose());
        let (light_from_world, eye_x) = match frustum.shape {
            Shape::Parallel => (turned, Some(turned.transform_point3(eye).x)),
            Shape::Perspective => (PERSPECTIVE * turned * DMat4::from_translation(-light.truncate()), None),
        };
        Some(Self { light_from_world, sine, eye_x, eye, axis, near_m: camera.near_m })
    }

    /// What a map of the frustum must hold of a body: for a light that is somewhere, the receivers inside the frustum and
    /// what is above them up to its near plane.
    pub(super) fn held(&self, frustum: &LightFrustum, body: &Body) -> Held {
        let is_held = |point: &DVec3| frustum.shape == Shape::Parallel || frustum.sees(*point);
        let receivers: Vec<DVec3> = body.receivers.iter().copied().filter(is_held).collect();
        let nearness = |point: &DVec3| self.axis.dot(*point - self.eye).max(self.near_m) / self.homogeneous(*point).w;
        let nearest = receivers.iter().map(nearness).fold(f64::INFINITY, f64::min);
        let points = match frustum.shape {
            Shape::Parallel => body.points().map(|point| self.place(point)).collect(),
            Shape::Perspective => {
                let (top, bottom) = (1.0 / frustum.near_m, 1.0 / frustum.far_m);
                let column = |point: &DVec3| {
                    let at = self.place(*point);
                    [DVec3::new(at.x, at.y.clamp(bottom, top), at.z), DVec3::new(at.x, top, at.z)]
                };
                receivers.iter().flat_map(column).collect()
            }
        };
        Held { points, nearest }
    }

    fn homogeneous(&self, point: DVec3) -> DVec4 {
        self.light_from_world * point.extend(1.0)
    }

    fn place(&self, point: DVec3) -> DVec3 {
        let at = self.homogeneous(point);
        at.truncate() / at.w
    }
}
