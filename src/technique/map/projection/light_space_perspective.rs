//! `light-space-perspective`: a perspective warp whose axis is perpendicular to the light, so that parallel light stays
//! parallel; how strong it is balances the errors near and far.
//!
//! M. Wimmer, D. Scherzer, W. Purgathofer, "Light Space Perspective Shadow Maps", 2004. For a light that is somewhere it
//! works in the light's own post-perspective space, where its rays are parallel. Known failures: nothing is gained where
//! light and view are parallel; below `min_angle_deg` the map is that of `single` around what is seen. Formulas:
//! docs/map.md#light-space-perspective.

use super::body::{Body, range};
use super::fit::LEAST_WIDTH;
use super::light_space::{Held, LightSpace};
use super::{ONE_VIEW, Projection, Shape, View, Window, single};
use crate::gpu::shader::Wgsl;
use crate::scene::{Light, Scene};
use crate::technique::Unsupported;
use crate::technique::map::settings::{Around, Fit, Settings};
use glam::{DMat4, DVec2, DVec3, DVec4, UVec2};

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

    fn supports(&self, scene: &Scene, light: &Light, settings: &Settings) -> Result<(), Unsupported> {
        single::Single.supports(scene, light, settings)
    }

    fn fit(
        &self,
        scene: &Scene,
        light: &Light,
        settings: &Settings,
        visible: &[DVec3],
    ) -> Result<Vec<View>, Unsupported> {
        let body = Body::of(scene, light, visible);
        let around_seen = Fit { around: Around::Receivers, ..settings.fit };
        let frustum = single::frustum(scene, light, &Settings { fit: around_seen, ..*settings }, &body.receivers)?;
        let uniform = frustum.view("map");
        let least_sine = settings.knobs.min_angle_rad.sin().max(LEAST_WIDTH);
        let Some(space) = LightSpace::of(&frustum, light.homogeneous(), &scene.camera, least_sine) else {
            return Ok(vec![uniform]);
        };
        let held = space.held(&frustum, &body);
        if held.points.is_empty() {
            return Ok(vec![uniform]);
        }
        let warp = Warp::around(&held, &space, settings.knobs.n_opt_scale);
        let clip_from_world = warp.clip_from_light(&held.points, settings) * space.light_from_world;
        let Warp { near, depth, .. } = warp;
        let near_far = match frustum.shape {
            Shape::Parallel => format!("warp's centre {near:.6} m before what it holds, {depth:.6} m deep"),
            Shape::Perspective => {
                format!("{}, warp's centre {near:.6} tangents before what it holds, {depth:.6} deep", uniform.near_far)
            }
        };
        let window = format!("warped, {:.2} degrees between light and view", space.sine.asin().to_degrees());
        let sign = if settings.reversed { -1.0 } else { 1.0 };
        Ok(vec![View { window, near_far, ..View::of_clip(uniform, &clip_from_world, sign) }])
    }
}

/// The near distance of the warp that balances the errors at both ends.
fn optimal_near(nearest: f64, sine: f64, depth: f64) -> f64 {
    (nearest + (nearest * (nearest + depth * sine)).sqrt()) / sine
}

/// A perspective along −z of light space.
struct Warp {
    centre: DVec3,
    near: f64,
    depth: f64,
}

impl Warp {
    fn around(held: &Held, space: &LightSpace, n_opt_scale: f64) -> Self {
        let along = |axis: usize| range(held.points.iter().map(|point| point[axis]));
        let [(x_min, x_max), (y_min, y_max), (z_min, z_max)] = [0, 1, 2].map(along);
        let near = n_opt_scale * optimal_near(held.nearest, space.sine, z_max - z_min);
        let depth = (z_max - z_min).max(LEAST_WIDTH * near);
        let x = space.eye_x.unwrap_or(0.5 * (x_min + x_max));
        Self { centre: DVec3::new(x, 0.5 * (y_min + y_max), z_max + near), near, depth }
    }

    /// (x, y, warped z) × q, q; q is the distance from the centre along −z.
    fn apply(&self, point: DVec3) -> DVec4 {
        self.matrix() * point.extend(1.0)
    }

    fn matrix(&self) -> DMat4 {
        let (n, f) = (self.near, self.near + self.depth);
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

    /// With n = 1, f = 100 and light across the view: n + √(n f).
    #[test]
    fn the_optimal_near_distance_is_the_published_one() {
        assert!((optimal_near(1.0, 1.0, 99.0) - 11.0).abs() < 1e-12);
    }
}
