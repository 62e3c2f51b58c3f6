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

#[cfg(test)]
mod tests {
    use super::super::fit::look;
    use super::super::{Shape, Window};
    use super::*;
    use crate::cast::testing::Random;
    use crate::scene::Far;
    use crate::technique::map::settings::DepthMetric;
    use glam::UVec2;

    /// Coordinates of up to 10 m, divided by no less than 0.1 m.
    const ROUNDING: f64 = 1e-11;

    fn set_up(random: &mut Random, shape: Shape) -> (LightSpace, DVec3, DVec3) {
        let (light, travel) = (5.0 * random.in_cube(), random.in_cube().normalize());
        let frustum = LightFrustum {
            light_view_from_world: look(light, travel),
            window: Window::square(1.0),
            near_m: 0.1,
            far_m: 10.0,
            shape,
            reversed: true,
            depth_metric: DepthMetric::Projected,
            texels: UVec2::ONE,
        };
        let (eye, target) = (5.0 * random.in_cube(), 5.0 * random.in_cube());
        let (eye, target) = (eye.as_vec3(), target.as_vec3());
        let up = (target - eye).any_orthonormal_vector();
        let camera = Camera { eye, target, up, fov_y_rad: 1.0, near_m: 0.1, far: Far::Infinite };
        let homogeneous = if shape == Shape::Parallel { (-travel).extend(0.0) } else { light.extend(1.0) };
        (LightSpace::of(&frustum, homogeneous, &camera, 1e-3).unwrap(), light, travel)
    }

    #[test]
    fn light_falls_along_y_alone_and_nothing_is_mirrored() {
        let mut random = Random(3);
        for i in 0..2000 {
            let shape = if i % 2 == 0 { Shape::Parallel } else { Shape::Perspective };
            let (space, light, travel) = set_up(&mut random, shape);
            let point = 5.0 * random.in_cube();
            let nearer = match shape {
                Shape::Parallel => point - travel,
                Shape::Perspective if travel.dot(point - light) < 0.5 => continue,
                Shape::Perspective => point.lerp(light, 0.3),
            };
            let (low, high) = (space.place(point), space.place(nearer));
            assert!((low.x - high.x).abs() < ROUNDING && (low.z - high.z).abs() < ROUNDING, "{low} {high}");
            assert!(high.y > low.y, "{shape:?}");
            assert!(space.light_from_world.determinant() > 0.0, "{shape:?}");
        }
    }

    /// Across the light, distance along the camera's axis over w changes along −z only, by the sine of the angle.
    #[test]
    fn what_is_near_in_the_picture_is_near_along_z() {
        let mut random = Random(4);
        for i in 0..2000 {
            let shape = if i % 2 == 0 { Shape::Parallel } else { Shape::Perspective };
            let (space, light, travel) = set_up(&mut random, shape);
            let from = light + travel * (0.5 + random.unit()) + travel.cross(random.in_cube());
            let to = from + travel.cross(random.in_cube());
            let nearness = |point: DVec3| space.axis.dot(point - space.eye) / space.homogeneous(point).w;
            let change = nearness(to) - nearness(from);
            let along_z = space.place(to).z - space.place(from).z;
            assert!((change + space.sine * along_z).abs() < ROUNDING, "{shape:?}: {change} {along_z}");
        }
    }
}
