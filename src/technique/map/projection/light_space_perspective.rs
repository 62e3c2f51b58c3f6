//! `light-space-perspective`: a perspective warp whose axis is perpendicular to the light, so that parallel light stays
//! parallel; how strong it is balances the errors near and far.
//!
//! M. Wimmer, D. Scherzer, W. Purgathofer, "Light Space Perspective Shadow Maps", 2004. Assumes a light infinitely far
//! away. Known failures: nothing is gained where light and view are parallel; below `min_angle_deg` the map is that of
//! `single` around what is seen. Formulas: docs/map.md#light-space-perspective.

use super::body::{Body, range};
use super::cascaded::forward;
use super::fit::LEAST_WIDTH;
use super::{LightFrustum, ONE_VIEW, Projection, Shape, View, Window, single};
use crate::gpu::shader::Wgsl;
use crate::scene::{Light, LightKind, Scene};
use crate::technique::Unsupported;
use crate::technique::map::settings::{Around, Fit, Settings};
use glam::{DMat3, DMat4, DVec2, DVec3, DVec4, UVec2};

/// One warped view.
#[derive(Debug)]
pub(super) struct LightSpacePerspective;

/// What lies on the body's hull stays inside by this share of its extent.
const SLACK: f64 = 1e-3;

impl Projection for LightSpacePerspective {
    fn name(&self) -> &'static str {
        "light-space-perspective"
    }

    fn shader(&self) -> Wgsl {
        ONE_VIEW
    }

    fn supports(&self, _: &Scene, light: &Light, _: &Settings) -> Result<(), Unsupported> {
        towards(light).map(|_| ())
    }

    fn fit(
        &self,
        scene: &Scene,
        light: &Light,
        settings: &Settings,
        visible: &[DVec3],
    ) -> Result<Vec<View>, Unsupported> {
        let towards_light = towards(light)?;
        let body = Body::of(scene, light, visible);
        let uniform = || {
            let fit = Fit { around: Around::Receivers, ..settings.fit };
            single::frustum(scene, light, &Settings { fit, ..*settings }, &body.receivers)
        };
        let axis = forward(scene);
        let sine = towards_light.cross(axis).length();
        let is_degenerate = sine.asin() < settings.knobs.min_angle_rad || sine < LEAST_WIDTH;
        if is_degenerate {
            return Ok(vec![uniform()?.view("map")]);
        }
        let light_from_world = light_space(towards_light, axis);
        let in_light: Vec<DVec3> = body.points().map(|point| light_from_world * point).collect();
        let eye = light_from_world * scene.camera.eye.as_dvec3();
        let distances = body.receivers.iter().map(|point| axis.dot(*point - scene.camera.eye.as_dvec3()));
        let nearest_m = range(distances).0.max(scene.camera.near_m);
        let warp = Warp::around(&in_light, eye, settings.knobs.n_opt_scale * optimal_near(nearest_m, sine, &in_light));
        let clip_from_world = warp.clip_from_light(&in_light, settings) * DMat4::from_mat3(light_from_world);
        let sign = if settings.reversed { -1.0 } else { 1.0 };
        let near_far = format!("warp's centre {:.6} m before what it holds, {:.6} m deep", warp.near_m, warp.depth_m);
        // Only its names and size are kept.
        let plain = LightFrustum {
            light_view_from_world: DMat4::IDENTITY,
            window: Window::square(1.0),
            near_m: 0.0,
            far_m: 1.0,
            shape: Shape::Parallel,
            reversed: settings.reversed,
            depth_metric: settings.depth_metric,
            texels: UVec2::splat(settings.size),
        };
        let view = View::of_clip(plain.view("map"), &clip_from_world, sign);
        Ok(vec![View {
            window: format!("warped, {:.2} degrees between light and view", sine.asin().to_degrees()),
            near_far,
            ..view
        }])
    }
}

fn towards(light: &Light) -> Result<DVec3, Unsupported> {
    match light.kind {
        LightKind::Directional { towards_light } => Ok(towards_light.as_dvec3().normalize()),
        _ => Err(Unsupported::Light { kind: light.kind_name(), handled: "directional lights" }),
    }
}

/// World to light space: y towards the light, the camera looks down −z as far as y allows.
fn light_space(towards_light: DVec3, axis: DVec3) -> DMat3 {
    let y = towards_light;
    let z = -(axis - axis.dot(y) * y).normalize();
    DMat3::from_cols(y.cross(z), y, z).transpose()
}

/// The near distance of the warp that balances the errors at both ends.
fn optimal_near(nearest_m: f64, sine: f64, in_light: &[DVec3]) -> f64 {
    let (z_min, z_max) = range(in_light.iter().map(|point| point.z));
    (nearest_m + (nearest_m * (nearest_m + (z_max - z_min) * sine)).sqrt()) / sine
}

/// A perspective along −z of light space.
struct Warp {
    centre: DVec3,
    near_m: f64,
    depth_m: f64,
}

impl Warp {
    fn around(in_light: &[DVec3], eye: DVec3, near_m: f64) -> Self {
        let (z_min, z_max) = range(in_light.iter().map(|point| point.z));
        let (y_min, y_max) = range(in_light.iter().map(|point| point.y));
        let depth_m = (z_max - z_min).max(LEAST_WIDTH * near_m);
        Self { centre: DVec3::new(eye.x, 0.5 * (y_min + y_max), z_max + near_m), near_m, depth_m }
    }

    /// (x, y, warped z) × q, q; q is the distance from the centre along −z.
    fn apply(&self, point: DVec3) -> DVec4 {
        self.matrix() * point.extend(1.0)
    }

    fn matrix(&self) -> DMat4 {
        let (n, f) = (self.near_m, self.near_m + self.depth_m);
        let rows = [
            DVec4::new(n, 0.0, 0.0, 0.0),
            DVec4::new(0.0, n, 0.0, 0.0),
            DVec4::new(0.0, 0.0, f / (n - f), n * f / (n - f)),
            DVec4::new(0.0, 0.0, -1.0, 0.0),
        ];
        DMat4::from_cols(rows[0], rows[1], rows[2], rows[3]).transpose() * DMat4::from_translation(-self.centre)
    }

    /// Light space to clip space: warped x and depth become x and y, height becomes depth.
    fn clip_from_light(&self, in_light: &[DVec3], settings: &Settings) -> DMat4 {
        let warped: Vec<DVec3> =
            in_light.iter().map(|point| self.apply(*point)).map(|at| at.truncate() / at.w).collect();
        let texels = UVec2::splat(settings.size);
        let plane = Window::around(warped.iter().map(|at| DVec2::new(at.x, at.z)));
        let least = LEAST_WIDTH * (plane.max - plane.min).max_element().max(f64::MIN_POSITIVE);
        let window = plane.with_rim(texels, settings.rim_texels(), least, settings.fit.phase_texels);
        let (low, high) = range(warped.iter().map(|at| at.y));
        let slack = SLACK * (high - low).max(least);
        let (low, high) = (low - slack, high + slack);
        let (scale, middle) = (2.0 / (window.max - window.min), window.max + window.min);
        let depth_scale = if settings.reversed { 1.0 } else { -1.0 } / (high - low);
        let depth_zero = if settings.reversed { low } else { high };
        let rows = [
            DVec4::new(scale.x, 0.0, 0.0, -0.5 * scale.x * middle.x),
            DVec4::new(0.0, 0.0, scale.y, -0.5 * scale.y * middle.y),
            DVec4::new(0.0, depth_scale, 0.0, -depth_scale * depth_zero),
            DVec4::W,
        ];
        DMat4::from_cols(rows[0], rows[1], rows[2], rows[3]).transpose() * self.matrix()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_light_runs_along_depth_alone() {
        let towards_light = DVec3::new(0.3, 0.8, -0.2).normalize();
        let light_from_world = light_space(towards_light, DVec3::new(0.1, -0.2, -1.0).normalize());
        assert!((light_from_world * towards_light - DVec3::Y).length() < 1e-12);
        assert!((light_from_world.determinant() - 1.0).abs() < 1e-12);
        let body: Vec<DVec3> = (0..40).map(|i| DVec3::new(f64::from(i % 7), f64::from(i % 5), -f64::from(i))).collect();
        let warp = Warp::around(&body, DVec3::new(2.0, 1.0, 3.0), 4.0);
        for point in body {
            let (low, high) = (warp.apply(point), warp.apply(point + DVec3::Y));
            let (low, high) = (low.truncate() / low.w, high.truncate() / high.w);
            assert!((low.x - high.x).abs() < 1e-12 && (low.z - high.z).abs() < 1e-12 && high.y > low.y);
            assert!((-1e-12..=1.0 + 1e-12).contains(&low.z), "{low}");
        }
    }

    /// With n = 1, f = 100 and light across the view: n + √(n f).
    #[test]
    fn the_optimal_near_distance_is_the_published_one() {
        let body = [DVec3::ZERO, DVec3::new(0.0, 0.0, -99.0)];
        assert!((optimal_near(1.0, 1.0, &body) - 11.0).abs() < 1e-12);
    }
}
