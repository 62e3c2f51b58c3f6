//! `perspective`: the map is laid out in the camera's post-perspective space, where near receivers are large.
//!
//! M. Stamminger, G. Drettakis, "Perspective Shadow Maps", 2002. A virtual camera stands as far behind the eye as it must
//! for all casters to be before it. In its space a light behind the camera is inverted: the first blocker is the one
//! farthest from it. Known failures: casters behind the virtual eye are lost; light along the view leaves no more than a
//! uniform map; the gain at the near end is paid at the far end. Formulas: docs/map.md#perspective.

use super::body::{Body, range};
use super::cascaded::forward;
use super::fit::{LEAST_WIDTH, look};
use super::{LightFrustum, ONE_VIEW, Projection, Shape, View, Window};
use crate::gpu::shader::Wgsl;
use crate::scene::{Light, Scene};
use crate::technique::Unsupported;
use crate::technique::map::settings::Settings;
use glam::{DMat4, DVec3, DVec4, UVec2, dcamera::rh};

/// One warped view.
#[derive(Debug)]
pub(super) struct Perspective;

/// A light whose homogeneous w in the camera's space is less than this share of it shines in parallel there.
const PARALLEL_BELOW: f64 = 1e-3;
/// Widest full angle at which a light in the camera's space looks at the middle of what it must see, degrees.
const WIDEST_DEG: f64 = 170.0;
/// What lies on the body's hull stays inside by this share of its extent.
const SLACK: f64 = 1e-3;

impl Projection for Perspective {
    fn name(&self) -> &'static str {
        "perspective"
    }

    fn shader(&self) -> Wgsl {
        ONE_VIEW
    }

    fn supports(&self, _: &Scene, _: &Light, _: &Settings) -> Result<(), Unsupported> {
        Ok(())
    }

    fn needs_of_picture(&self) -> &'static [&'static str] {
        &["a light that is not among what is seen"]
    }

    fn fit(
        &self,
        scene: &Scene,
        light: &Light,
        settings: &Settings,
        visible: &[DVec3],
    ) -> Result<Vec<View>, Unsupported> {
        let body = Body::of(scene, light, visible);
        let camera = VirtualCamera::around(scene, settings, &body);
        let points: Vec<DVec3> = camera.seen(body.points()).collect();
        let in_camera = camera.clip_from_world * light.homogeneous();
        let light = LightInCamera::of(in_camera);
        let frustum = light.frustum(settings, &points)?;
        let clip_from_world = frustum.clip_from_world() * camera.clip_from_world;
        let sign = if settings.reversed != light.is_inverted() { -1.0 } else { 1.0 };
        let view = frustum.view("map");
        let near_far =
            format!("virtual camera {:.6} m back, from {:.6} m to {:.6} m", camera.back_m, camera.near_m, camera.far_m);
        Ok(vec![View { near_far, ..View::of_clip(view, &clip_from_world, sign) }])
    }
}

/// The camera in whose space the map is laid out: a finite frustum around the body.
struct VirtualCamera {
    clip_from_world: DMat4,
    back_m: f64,
    near_m: f64,
    far_m: f64,
}

impl VirtualCamera {
    fn around(scene: &Scene, settings: &Settings, body: &Body) -> Self {
        let view_from_world = scene.camera.view_from_world();
        let forward = forward(scene);
        let distance = |point: DVec3| -view_from_world.transform_point3(point).z;
        let nearest_m = body.points().map(distance).fold(f64::INFINITY, f64::min);
        let needed_m = (scene.camera.near_m - nearest_m).max(0.0);
        let back_m = settings.knobs.virtual_back_m.unwrap_or(needed_m);
        let view = view_from_world * DMat4::from_translation(forward * back_m);
        let least_m = scene.camera.near_m;
        let before =
            body.points().map(|point| view.transform_point3(point)).filter(|at| -at.z >= least_m * (1.0 - SLACK));
        let (nearest_m, farthest_m) = range(before.clone().map(|at| -at.z));
        let near_m = nearest_m.max(least_m) * (1.0 - SLACK);
        let far_m = farthest_m.max(near_m * 2.0) * (1.0 + SLACK);
        let window = Window::around(before.map(|at| at.truncate() / -at.z));
        let (min, max) = (window.min * near_m, window.max.max(window.min + LEAST_WIDTH) * near_m);
        let clip_from_view = rh::proj::directx::frustum(min.x, max.x, min.y, max.y, near_m, far_m);
        Self { clip_from_world: clip_from_view * view, back_m, near_m, far_m }
    }

    /// The points before it, in its post-perspective space.
    fn seen(&self, points: impl Iterator<Item = DVec3>) -> impl Iterator<Item = DVec3> {
        let in_camera = points.map(|point| self.clip_from_world * point.extend(1.0));
        in_camera.filter(|at| at.w >= self.near_m * (1.0 - SLACK)).map(|at| at.truncate() / at.w)
    }
}

/// How the light shines in the camera's space.
#[derive(Debug, Clone, Copy, PartialEq)]
enum LightInCamera {
    /// From that direction.
    Parallel { towards_light: DVec3 },
    /// From a point, or, inverted, towards it.
    Point { at: DVec3, is_inverted: bool },
}

impl LightInCamera {
    fn of(light: DVec4) -> Self {
        if light.w.abs() < PARALLEL_BELOW * light.length() {
            return Self::Parallel { towards_light: light.truncate().normalize() };
        }
        Self::Point { at: light.truncate() / light.w, is_inverted: light.w < 0.0 }
    }

    fn is_inverted(self) -> bool {
        matches!(self, Self::Point { is_inverted: true, .. })
    }

    /// The light's view of the points, which are in the camera's space too.
    fn frustum(self, settings: &Settings, points: &[DVec3]) -> Result<LightFrustum, Unsupported> {
        let texels = UVec2::splat(settings.size);
        let centre = 0.5
            * (points.iter().copied().fold(DVec3::splat(f64::INFINITY), DVec3::min)
                + points.iter().copied().fold(DVec3::splat(f64::NEG_INFINITY), DVec3::max));
        let (light_view_from_world, shape) = match self {
            Self::Parallel { towards_light } => (look(centre + towards_light, -towards_light), Shape::Parallel),
            Self::Point { at, .. } => (look(at, facing(at, centre, points)?), Shape::Perspective),
        };
        let in_view: Vec<DVec3> = points.iter().map(|point| light_view_from_world.transform_point3(*point)).collect();
        let window = Window::around(in_view.iter().map(|at| match shape {
            Shape::Parallel => at.truncate(),
            Shape::Perspective => at.truncate() / -at.z,
        }));
        let window = window.with_rim(texels, settings.rim_texels(), LEAST_WIDTH, settings.fit.phase_texels);
        let (nearest, farthest) = range(in_view.iter().map(|at| -at.z));
        let slack = SLACK * (farthest - nearest).max(LEAST_WIDTH);
        let (near_m, far_m) = match shape {
            Shape::Parallel => (nearest - slack, farthest + slack),
            Shape::Perspective => ((nearest - slack).max(0.5 * nearest), farthest + slack),
        };
        let (reversed, depth_metric) = (settings.reversed, settings.depth_metric);
        Ok(LightFrustum { light_view_from_world, window, near_m, far_m, shape, reversed, depth_metric, texels })
    }
}

/// Where a point light looks: at the middle of what it must see or, where that spans too wide an angle, along the
/// camera's axis, across which all of it lies on one side of the light.
fn facing(at: DVec3, centre: DVec3, points: &[DVec3]) -> Result<DVec3, Unsupported> {
    let span_deg = |travel: DVec3| {
        let angles = points.iter().map(|point| travel.angle_between(*point - at));
        2.0 * angles.fold(0.0, f64::max).to_degrees()
    };
    let at_middle = (centre - at).normalize();
    let asked_deg = span_deg(at_middle);
    let along_axis = DVec3::Z * (centre.z - at.z).signum();
    if asked_deg <= WIDEST_DEG {
        Ok(at_middle)
    } else if span_deg(along_axis) < 180.0 {
        Ok(along_axis)
    } else {
        Err(Unsupported::FieldOfView { asked_deg, limit_deg: WIDEST_DEG })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// PS-4: how lights shine in a camera at the origin that looks along −z.
    #[test]
    fn the_sign_of_the_light_in_the_cameras_space() {
        let camera = rh::proj::directx::perspective(1.0, 1.3, 1.0, 100.0);
        let w = |light: DVec4| (camera * light).w;
        assert_eq!(w(DVec4::Y), 0.0, "directional across the view");
        assert!(w(DVec4::NEG_Z) > 0.0, "ahead");
        assert!(w(DVec4::new(0.0, 1.0, -0.3, 0.0)) > 0.0, "obliquely ahead");
        assert!(w(DVec4::Z) < 0.0, "behind");
        assert_eq!(w(DVec4::new(3.0, 1.0, 0.0, 1.0)), 0.0, "a point in the camera's plane");
        assert!(w(DVec4::new(0.0, 1.0, -2.0, 1.0)) > 0.0 && w(DVec4::new(0.0, 1.0, 2.0, 1.0)) < 0.0);
        let parallel = LightInCamera::of(camera * DVec4::new(0.0, 1.0, 1e-5, 0.0));
        assert!(matches!(parallel, LightInCamera::Parallel { .. }));
        assert!(LightInCamera::of(camera * DVec4::new(0.0, 1.0, 0.5, 0.0)).is_inverted());
    }
}
