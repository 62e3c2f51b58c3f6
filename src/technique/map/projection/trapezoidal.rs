//! `trapezoidal`: what is seen, as the light sees it, fits in a trapezoid; the map is that trapezoid pulled to a square,
//! with the nearest part of it in most of its height. Depth is not warped: it is the light's own.
//!
//! T. Martin, T.-S. Tan, "Anti-aliasing and Continuity with Trapezoidal Shadow Maps", 2004. Known failures: where light
//! and view are nearly parallel the trapezoid turns abruptly as the camera moves. Formulas: docs/map.md#trapezoidal.

use super::body::{Body, range};
use super::cascaded::forward;
use super::{ONE_VIEW, Projection, View, single};
use crate::gpu::shader::Wgsl;
use crate::scene::{Light, Scene};
use crate::technique::Unsupported;
use crate::technique::map::settings::{Around, Fit, Settings};
use glam::{DMat4, DVec2, DVec3, DVec4};

/// One warped view.
#[derive(Debug)]
pub(super) struct Trapezoidal;

/// The smallest height of a trapezoid as a share of the light's view.
const LEAST_HEIGHT: f64 = 1e-6;

impl Projection for Trapezoidal {
    fn name(&self) -> &'static str {
        "trapezoidal"
    }

    fn shader(&self) -> Wgsl {
        ONE_VIEW
    }

    fn has_linear_depth(&self) -> bool {
        true
    }

    fn has_rasterised_depth(&self) -> bool {
        false
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
        let light_clip_from_world = frustum.clip_from_world();
        let in_light = |point: DVec3| {
            let at = light_clip_from_world * point.extend(1.0);
            at.truncate().truncate() / at.w
        };
        let (eye, axis) = (scene.camera.eye.as_dvec3(), forward(scene));
        let (near_m, far_m) = range(body.receivers.iter().map(|point| axis.dot(*point - eye)));
        let ends = [near_m.max(scene.camera.near_m), far_m].map(|distance| eye + distance * axis);
        let hull: Vec<DVec2> = body.receivers.iter().map(|point| in_light(*point)).collect();
        let line = before_light(&light_clip_from_world, ends).map_or([DVec2::ZERO; 2], |ends| ends.map(in_light));
        let trapezoid = Trapezoid::around(&hull, line, settings.knobs.focus_fraction, settings.knobs.focus_at);
        let texels = f64::from(settings.size);
        let rim = settings.rim_texels().min(0.5 * (texels - 1.0));
        let shift = 2.0 / texels * settings.fit.phase_texels;
        let clip_from_world = trapezoid.warp(1.0 - 2.0 * rim / texels, shift) * light_clip_from_world;
        let plain = frustum.view("map");
        let (depth, depth_q) = (plain.rows.depth, plain.rows.depth_q);
        let sign = plain.depth_sign;
        let mut view = View::of_clip(plain, &clip_from_world, sign);
        (view.rows.depth, view.rows.depth_q) = (depth, depth_q);
        Ok(vec![view])
    }
}

/// How near to the light's own plane the centre line may come, as a share of its far end's distance from it.
const LEAST_BEFORE: f64 = 1e-3;

/// The part of a line that lies before a light; what is level with it or behind has no place in its picture.
fn before_light(light_clip_from_world: &DMat4, ends: [DVec3; 2]) -> Option<[DVec3; 2]> {
    let w = ends.map(|end| (*light_clip_from_world * end.extend(1.0)).w);
    let least = LEAST_BEFORE * w[0].max(w[1]);
    let at = |w_wanted: f64| ends[0].lerp(ends[1], (w_wanted - w[0]) / (w[1] - w[0]));
    match w.map(|w| w >= least) {
        _ if least <= 0.0 => None,
        [true, true] => Some(ends),
        [false, _] => Some([at(least), ends[1]]),
        [true, false] => Some([ends[0], at(least)]),
    }
}

/// A trapezoid in the light's clip plane: its apex lies `apex` before its top line.
#[derive(Debug)]
struct Trapezoid {
    /// Along the centre line, from near to far.
    along: DVec2,
    top: f64,
    lambda: f64,
    apex: f64,
    /// Of the centre line, across it.
    lateral: f64,
    /// Largest |lateral distance| / distance from the apex.
    slope: f64,
}

impl Trapezoid {
    fn around(hull: &[DVec2], [near, far]: [DVec2; 2], focus_fraction: f64, focus_at: f64) -> Self {
        let along = (far - near).try_normalize().unwrap_or(DVec2::Y);
        let (top, base) = range(hull.iter().map(|point| along.dot(*point)));
        let lambda = (base - top).max(LEAST_HEIGHT);
        let delta = focus_fraction * lambda;
        // The focus must end before the warp would turn the other way.
        let divisor = (lambda - 2.0 * delta - lambda * focus_at).max(LEAST_HEIGHT * lambda);
        let apex = lambda * delta * (1.0 + focus_at) / divisor;
        let lateral = along.perp_dot(near);
        let slope_of = |point: &DVec2| (along.perp_dot(*point) - lateral).abs() / (along.dot(*point) - top + apex);
        let slope = hull.iter().map(slope_of).fold(LEAST_HEIGHT, f64::max);
        Self { along, top, lambda, apex, lateral, slope }
    }

    /// The warp of homogeneous light clip coordinates: to a square of half side `half`, shifted; depth is left alone.
    fn warp(&self, half: f64, shift: DVec2) -> DMat4 {
        let (lambda, eta) = (self.lambda, self.apex);
        // Distance from the apex along the centre line, and across it.
        let t = DVec4::new(self.along.x, self.along.y, 0.0, eta - self.top);
        let across = DVec4::new(-self.along.y, self.along.x, 0.0, -self.lateral);
        let y = 2.0 * eta * (eta + lambda) / lambda * DVec4::W - (lambda + 2.0 * eta) / lambda * t;
        let x = -across / self.slope;
        let rows = [half * x + shift.x * t, half * y + shift.y * t, DVec4::Z, t];
        DMat4::from_cols(rows[0], rows[1], rows[2], rows[3]).transpose()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A light at the origin that looks along −z: w is −z.
    #[test]
    fn the_centre_line_ends_before_the_light() {
        let clip = DMat4::from_cols(DVec4::X, DVec4::Y, DVec4::NEG_W, DVec4::ZERO);
        let line =
            |from_z: f64, to_z: f64| before_light(&clip, [DVec3::new(1.0, 0.0, from_z), DVec3::new(3.0, 0.0, to_z)]);
        assert_eq!(line(-1.0, -6.0), Some([DVec3::new(1.0, 0.0, -1.0), DVec3::new(3.0, 0.0, -6.0)]));
        let least = 6.0 * LEAST_BEFORE;
        for (from, to, cut) in [(6.0, -6.0, 0), (0.0, -6.0, 0), (-6.0, 6.0, 1), (-6.0, 0.0, 1)] {
            let ends = line(from, to).unwrap();
            assert!((ends[cut].z + least).abs() < 1e-12 && ends[1 - cut].z == -6.0, "{from} {to}: {ends:?}");
        }
        assert_eq!((line(0.0, 0.0), line(2.0, 1.0)), (None, None), "level with the light, and behind it");
    }

    /// TS-1: hulls lie inside the square, their nearest and farthest points on its top and base, the focus where asked.
    #[test]
    fn hulls_are_pulled_to_the_square() {
        for i in 0..200 {
            let turn = 0.21 * f64::from(i);
            let hull: Vec<DVec2> = (0..9)
                .map(|k| {
                    let angle = turn + 0.7 * f64::from(k) + 0.1 * f64::from(i % 7);
                    DVec2::new(0.8 * angle.cos(), (0.2 + 0.08 * f64::from(i % 8)) * angle.sin())
                })
                .collect();
            let ends = [hull[0], -hull[0] + DVec2::new(0.01, 0.02)];
            let trapezoid = Trapezoid::around(&hull, ends, 0.3, -0.6);
            let warp = trapezoid.warp(1.0, DVec2::ZERO);
            let warped = |point: DVec2| {
                let at = warp * DVec4::new(point.x, point.y, 0.0, 1.0);
                at.truncate().truncate() / at.w
            };
            let points: Vec<DVec2> = hull.iter().map(|point| warped(*point)).collect();
            let (low, high) = range(points.iter().map(|at| at.y));
            let widest = points.iter().map(|at| at.x.abs()).fold(0.0, f64::max);
            assert!((low + 1.0).abs() < 1e-9 && (high - 1.0).abs() < 1e-9, "{low} {high}");
            assert!((widest - 1.0).abs() < 1e-9, "{widest}");
            let focus = trapezoid.along * (trapezoid.top + 0.3 * trapezoid.lambda);
            assert!((warped(focus).y + 0.6).abs() < 1e-9, "{}", warped(focus).y);
        }
    }
}
