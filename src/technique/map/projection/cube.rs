//! `cube`: six square views of 90 degrees around the light, of which only those are drawn that hold a receiver. A point
//! belongs to the face along whose axis it is farthest.
//!
//! Faces after the texture-cube convention, in an array texture. Assumes nothing. Known failures: taps cut off at a face
//! with `seam=clamp`; texels at a face's corner cover 0.19 of the solid angle of those at its middle.

use super::fit::{Reach, look_with_up};
use super::{LightFrustum, Projection, Shape, Shares, View, Window};
use crate::gpu::shader::{Wgsl, wgsl};
use crate::scene::{Light, Scene};
use crate::technique::Unsupported;
use crate::technique::map::settings::{Around, Settings};
use glam::{DMat3, DMat4, DVec3, UVec2};

/// Up to six faces.
#[derive(Debug)]
pub(super) struct Cube;

/// Name, forward and up of every face.
const FACES: [(&str, DVec3, DVec3); 6] = [
    ("face +X", DVec3::X, DVec3::Y),
    ("face -X", DVec3::NEG_X, DVec3::Y),
    ("face +Y", DVec3::Y, DVec3::NEG_Z),
    ("face -Y", DVec3::NEG_Y, DVec3::Z),
    ("face +Z", DVec3::Z, DVec3::Y),
    ("face -Z", DVec3::NEG_Z, DVec3::Y),
];

/// Tangent of half of 90 degrees, and a hair more: a point on a seam lies in its face in spite of rounding to f32.
const HALF_WIDTH: f64 = 1.0 + 1.0 / 65_536.0;

impl Projection for Cube {
    fn name(&self) -> &'static str {
        "cube"
    }

    fn shader(&self) -> Wgsl {
        wgsl!("map/projection/cube.wgsl")
    }

    fn has_linear_depth(&self) -> bool {
        true
    }

    fn is_unwarped(&self) -> bool {
        true
    }

    fn supports(&self, _: &Scene, light: &Light, _: &Settings) -> Result<(), Unsupported> {
        position(light).map(|_| ())
    }

    fn fit(
        &self,
        scene: &Scene,
        light: &Light,
        settings: &Settings,
        visible: &[DVec3],
    ) -> Result<Vec<View>, Unsupported> {
        let position = position(light)?;
        let window = Window::square(HALF_WIDTH);
        let turn = jitter(settings);
        let faces = FACES.map(|(name, forward, up)| (name, turn * forward, turn * up));
        let holds = |forward: DVec3| {
            let is_in = |point: &&DVec3| along_axis(&faces, **point - position) == forward;
            settings.fit.around != Around::Receivers || visible.iter().find(is_in).is_some()
        };
        let held: Vec<(&str, DVec3, DMat4, Reach)> = faces
            .iter()
            .filter(|(_, forward, _)| holds(*forward))
            .filter_map(|(name, forward, up)| {
                let view = look_with_up(position, *forward, *up);
                Some((*name, *forward, view, Reach::within(scene, &view, Shape::Perspective, window)?))
            })
            .collect();
        // One pair of planes for all faces: a tap beyond a face's side compares the same receiver in the next face.
        let reach = held.iter().map(|(.., reach)| *reach).reduce(Reach::and).unwrap_or_default();
        let (near_m, far_m) = settings.fit.planes_m(reach.planes(light, Shape::Perspective, settings))?;
        let face = |(name, forward, light_view_from_world, _): &(&str, DVec3, DMat4, Reach)| {
            let frustum = LightFrustum {
                light_view_from_world: *light_view_from_world,
                window,
                near_m,
                far_m,
                shape: Shape::Perspective,
                reversed: settings.reversed,
                depth_metric: settings.depth_metric,
                texels: UVec2::splat(settings.size),
            };
            // Distance along the face's axis.
            let selector = forward.extend(-forward.dot(position)).as_vec4();
            View { selector, ..frustum.view(name) }
        };
        if held.is_empty() {
            let (name, forward, up) = faces[0];
            return Ok(vec![face(&(name, forward, look_with_up(position, forward, up), reach))]);
        }
        Ok(held.iter().map(face).collect())
    }

    fn select(&self, views: &[View], point_in_world: DVec3) -> Shares {
        let along = |view: &View| view.selector.as_dvec4().dot(point_in_world.extend(1.0));
        let mut best = 0;
        for (i, view) in views.iter().enumerate() {
            if along(view) > along(&views[best]) {
                best = i;
            }
        }
        Shares::one(best)
    }

    /// Along the tangent that reaches 1 on the nearest side.
    fn seam_texels(&self, views: &[View], view: usize, point_in_world: DVec3) -> Option<f64> {
        let along = |view: &View| view.selector.as_dvec4().dot(point_in_world.extend(1.0));
        let others = views.iter().enumerate().filter(|(i, _)| *i != view);
        let nearest = others.map(|(_, other)| along(other)).reduce(f64::max)?;
        let half = 0.5 * f64::from(views[view].texels.x) / HALF_WIDTH;
        Some(half * (1.0 - nearest / along(&views[view])))
    }
}

/// Where the light is.
pub(super) fn position(light: &Light) -> Result<DVec3, Unsupported> {
    let homogeneous = light.homogeneous();
    if homogeneous.w == 0.0 {
        return Err(Unsupported::Light { kind: light.kind_name(), handled: "lights with a position" });
    }
    Ok(homogeneous.truncate())
}

/// The axis of the face that a direction falls in; the first of several.
fn along_axis(faces: &[(&str, DVec3, DVec3); 6], direction: DVec3) -> DVec3 {
    let mut best = faces[0].1;
    for (_, forward, _) in faces {
        if direction.dot(*forward) > direction.dot(best) {
            best = *forward;
        }
    }
    best
}

/// The phase as a small turn of the whole cube: faces that moved sideways would leave gaps between them.
fn jitter(settings: &Settings) -> DMat3 {
    let texel_rad = 2.0 * HALF_WIDTH / f64::from(settings.size);
    let phase = settings.fit.phase_texels * texel_rad;
    DMat3::from_rotation_y(phase.x) * DMat3::from_rotation_x(phase.y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::technique::map::settings::DepthMetric;

    /// CU-1: solid angle of a texel at the middle of a face, of a side and at a corner.
    #[test]
    fn a_texels_solid_angle_falls_towards_the_corners() {
        let frustum = LightFrustum {
            light_view_from_world: look_with_up(DVec3::ZERO, DVec3::X, DVec3::Y),
            window: Window::square(HALF_WIDTH),
            near_m: 0.1,
            far_m: 10.0,
            shape: Shape::Perspective,
            reversed: true,
            depth_metric: DepthMetric::Projected,
            texels: UVec2::splat(1024),
        };
        let view = frustum.view("face +X");
        let solid_angle = |direction: DVec3| {
            let steps = view.site(direction).texel_steps_m(direction.normalize());
            steps[0].cross(steps[1]).length() / direction.length_squared()
        };
        let middle = solid_angle(DVec3::X);
        let side = solid_angle(DVec3::new(1.0, 1.0, 0.0)) / middle;
        let corner = solid_angle(DVec3::ONE) / middle;
        assert!((side - 2.0_f64.powf(-1.5)).abs() < 1e-6, "{side}");
        assert!((corner - 3.0_f64.powf(-1.5)).abs() < 1e-6, "{corner}");
    }

    #[test]
    fn every_direction_lies_in_exactly_one_face() {
        let side_of = |direction: DVec3| {
            let axis = along_axis(&FACES, direction);
            (axis, direction.dot(axis))
        };
        assert_eq!(side_of(DVec3::new(1.0, 1.0, 1.0)).0, DVec3::X, "ties: x before y before z");
        assert_eq!(side_of(DVec3::new(0.0, -1.0, 1.0)).0, DVec3::NEG_Y);
        for i in 0..500 {
            let (a, b) = (0.11 * f64::from(i), 0.37 * f64::from(i));
            let direction = DVec3::new(a.cos() * b.sin(), b.cos(), a.sin() * b.sin());
            assert_eq!(side_of(direction).1, direction.abs().max_element());
        }
    }
}
