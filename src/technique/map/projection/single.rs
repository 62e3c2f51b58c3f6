//! `single`: one frustum, fitted tightly to receivers and casters. Orthographic for a directional light, the cone for a
//! spot light, the receivers' window for a point light whose receivers fit in one frustum. Formulas: docs/map.md#fit.

use super::fit::{LEAST_WIDTH, Reach, look};
use super::{LightFrustum, ONE_VIEW, Projection, Shape, View, Window};
use crate::gpu::shader::Wgsl;
use crate::scene::{Light, LightKind, Mesh, Scene};
use crate::technique::Unsupported;
use crate::technique::map::settings::{Around, Fit, Settings};
use glam::{DMat4, DVec3, UVec2};

/// One frustum.
#[derive(Debug)]
pub(super) struct Single;

/// Widest full angle of a perspective map, degrees: beyond, texels at the rim grow without limit.
const WIDEST_DEG: f64 = 170.0;
/// Manual fit: R. Ploszajczak, master's thesis, 2008.
const MANUAL_WIDTH_M: f64 = 10.0;
const MANUAL_NEAR_M: f64 = 1.0;
const MANUAL_FAR_M: f64 = 30.0;
const MANUAL_PULL_BACK_M: f64 = 5.0;
/// Full angle of a manual perspective map, radians: 90 degrees.
const MANUAL_FOV_RAD: f64 = std::f64::consts::FRAC_PI_2;

/// Where the light looks from and what its window is, before depth is known.
struct LightView {
    light_view_from_world: DMat4,
    shape: Shape,
    window: Window,
}

impl Projection for Single {
    fn name(&self) -> &'static str {
        "single"
    }

    fn shader(&self) -> Wgsl {
        ONE_VIEW
    }

    fn has_linear_depth(&self) -> bool {
        true
    }

    fn is_unwarped(&self) -> bool {
        true
    }

    fn supports(&self, scene: &Scene, light: &Light, settings: &Settings) -> Result<(), Unsupported> {
        // What the camera sees is not known yet; such a fit is checked when it is made.
        if settings.fit.around == Around::Receivers {
            return Ok(());
        }
        view(scene, light, &settings.fit, &[]).map(|_| ())
    }

    fn fit(
        &self,
        scene: &Scene,
        light: &Light,
        settings: &Settings,
        visible: &[DVec3],
    ) -> Result<Vec<View>, Unsupported> {
        Ok(vec![frustum(scene, light, settings, visible)?.view("map")])
    }
}

/// The fitted frustum.
pub(super) fn frustum(
    scene: &Scene,
    light: &Light,
    settings: &Settings,
    visible: &[DVec3],
) -> Result<LightFrustum, Unsupported> {
    let fit = &settings.fit;
    let LightView { light_view_from_world, shape, window } = view(scene, light, fit, visible)?;
    let texels = UVec2::splat(settings.size);
    let least = match shape {
        Shape::Parallel => LEAST_WIDTH * scene.bounds().radius().max(f64::MIN_POSITIVE),
        Shape::Perspective => LEAST_WIDTH,
    };
    let is_manual = fit.around == Around::Manual;
    let rim_texels = if is_manual { 0.0 } else { settings.rim_texels() };
    let window = window.with_rim(texels, rim_texels, least, fit.phase_texels);
    let fitted = if is_manual {
        (MANUAL_NEAR_M, MANUAL_FAR_M)
    } else {
        let reach = Reach::within(scene, &light_view_from_world, shape, window).unwrap_or_default();
        reach.planes(light, shape, settings)
    };
    let (near_m, far_m) = fit.planes_m(fitted)?;
    let (reversed, depth_metric) = (settings.reversed, settings.depth_metric);
    Ok(LightFrustum { light_view_from_world, window, near_m, far_m, shape, reversed, depth_metric, texels })
}

fn view(scene: &Scene, light: &Light, fit: &Fit, visible: &[DVec3]) -> Result<LightView, Unsupported> {
    let corners_of = |choose: fn(&Mesh) -> bool| -> Vec<DVec3> {
        let triangles = scene.meshes.iter().filter(|mesh| choose(mesh)).flat_map(|mesh| mesh.triangles.clone());
        triangles.flat_map(|triangle| scene.triangle_in_world(triangle)).collect()
    };
    match light.kind {
        LightKind::Directional { towards_light } | LightKind::Sun { towards_light, .. } => {
            let bounds = scene.bounds();
            let default_pull_back_m =
                if fit.around == Around::Manual { MANUAL_PULL_BACK_M } else { bounds.radius().max(f64::MIN_POSITIVE) };
            let travel = -towards_light.as_dvec3().normalize();
            let eye = bounds.centre() - travel * fit.pull_back_m.unwrap_or(default_pull_back_m);
            let light_view_from_world = look(eye, travel);
            let window = match (fit.width_m, fit.around) {
                (Some(width_m), _) => Window::square(0.5 * width_m),
                (None, Around::Manual) => Window::square(0.5 * MANUAL_WIDTH_M),
                (None, Around::Scene) => parallel_window(&light_view_from_world, &corners_of(|_| true)),
                (None, Around::Receivers) => parallel_window(&light_view_from_world, visible),
            };
            Ok(LightView { light_view_from_world, shape: Shape::Parallel, window })
        }
        LightKind::Spot { position, axis, outer_rad, .. } => {
            let full_rad = match fit.around {
                Around::Manual => fit.fov_rad.unwrap_or(MANUAL_FOV_RAD),
                _ => fit.fov_rad.unwrap_or(2.0 * outer_rad),
            };
            within_limit(full_rad)?;
            let light_view_from_world = look(position.as_dvec3(), axis.as_dvec3().normalize());
            Ok(LightView {
                light_view_from_world,
                shape: Shape::Perspective,
                window: Window::square((0.5 * full_rad).tan()),
            })
        }
        LightKind::Point { position, aim, .. }
        | LightKind::Rectangle { position, aim, .. }
        | LightKind::Sphere { position, aim, .. } => {
            let position = position.as_dvec3();
            let forward = (aim.as_dvec3() - position).try_normalize().unwrap_or(DVec3::NEG_Y);
            let light_view_from_world = look(position, forward);
            let manual_rad = (fit.around == Around::Manual).then_some(MANUAL_FOV_RAD);
            let window = match fit.fov_rad.or(manual_rad) {
                Some(full_rad) => Window::square((0.5 * full_rad).tan()),
                None => {
                    let receivers = match fit.around {
                        Around::Receivers => visible.to_vec(),
                        _ => corners_of(|mesh| mesh.receives),
                    };
                    let angle = |point: &DVec3| forward.angle_between(*point - position);
                    within_limit(2.0 * receivers.iter().map(angle).fold(0.0, f64::max))?;
                    // A receiver at the light itself lies in no direction.
                    Window::around(receivers.iter().filter(|point| **point != position).map(|point| {
                        let in_view = light_view_from_world.transform_point3(*point);
                        in_view.truncate() / -in_view.z
                    }))
                }
            };
            Ok(LightView { light_view_from_world, shape: Shape::Perspective, window })
        }
    }
}

fn within_limit(full_rad: f64) -> Result<(), Unsupported> {
    let asked_deg = full_rad.to_degrees();
    // The angle is typed in degrees and comes back through radians: a rounding error is no reason to refuse.
    if asked_deg <= WIDEST_DEG * (1.0 + f64::EPSILON * 4.0) {
        Ok(())
    } else {
        Err(Unsupported::FieldOfView { asked_deg, limit_deg: WIDEST_DEG })
    }
}

fn parallel_window(light_view_from_world: &DMat4, points: &[DVec3]) -> Window {
    Window::around(points.iter().map(|point| light_view_from_world.transform_point3(*point).truncate()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn too_wide_is_refused_and_the_limit_itself_is_not() {
        assert!(within_limit(WIDEST_DEG.to_radians()).is_ok());
        assert!(within_limit(171.0_f64.to_radians()).is_err());
    }
}
