//! `single`: one frustum, fitted tightly to receivers and casters. Orthographic for a directional light, the cone for a
//! spot light, the receivers' window for a point light whose receivers fit in one frustum. Formulas: docs/map.md#fit.

use super::clip::depth_range;
use super::{LightFrustum, Projection, Shape, Window};
use crate::scene::{Light, LightKind, Mesh, Scene};
use crate::technique::Unsupported;
use crate::technique::map::settings::{Around, Fit, Settings};
use glam::{DMat4, DVec3, UVec2};

/// One frustum.
#[derive(Debug)]
pub(super) struct Single;

/// Widest full angle of a perspective map, degrees: beyond, texels at the rim grow without limit.
const WIDEST_DEG: f64 = 170.0;
/// Near plane before the nearest caster by this share of its distance (perspective) or of the range (parallel), so that
/// rounding cannot clip it.
const NEAR_SLACK: f64 = 1e-2;
/// Far plane beyond the farthest receiver by this share, likewise.
const FAR_SLACK: f64 = 1e-3;
/// Smallest near distance as a share of far, for casters at the light.
const NEAR_FLOOR: f64 = 1e-3;
/// A fit of no width gets this share of the scene's radius.
const LEAST_WIDTH: f64 = 1e-6;
/// Manual fit: R. Ploszajczak, master's thesis, 2008.
const MANUAL_WIDTH_M: f64 = 10.0;
const MANUAL_NEAR_M: f64 = 1.0;
const MANUAL_FAR_M: f64 = 30.0;
const MANUAL_PULL_BACK_M: f64 = 5.0;
/// Full angle of a manual perspective map, radians: 90 degrees.
const MANUAL_FOV_RAD: f64 = std::f64::consts::FRAC_PI_2;

/// Where the light looks from and what its window is, before depth is known.
struct View {
    light_view_from_world: DMat4,
    shape: Shape,
    window: Window,
}

impl Projection for Single {
    fn name(&self) -> &'static str {
        "single"
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
    ) -> Result<LightFrustum, Unsupported> {
        let fit = &settings.fit;
        let View { light_view_from_world, shape, window } = view(scene, light, fit, visible)?;
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
            fitted_depths(scene, light, &light_view_from_world, shape, window)
        };
        let (near_m, far_m) = (fit.near_m.unwrap_or(fitted.0), fit.far_m.unwrap_or(fitted.1));
        if near_m >= far_m {
            let why = format!("the light's near plane at {near_m} m is not before its far plane at {far_m} m");
            return Err(Unsupported::Degenerate { why });
        }
        Ok(LightFrustum::new(light_view_from_world, window, (near_m, far_m), shape, settings.reversed, texels))
    }
}

fn view(scene: &Scene, light: &Light, fit: &Fit, visible: &[DVec3]) -> Result<View, Unsupported> {
    let corners_of = |choose: fn(&Mesh) -> bool| -> Vec<DVec3> {
        let triangles = scene.meshes.iter().filter(|mesh| choose(mesh)).flat_map(|mesh| mesh.triangles.clone());
        triangles.flat_map(|triangle| scene.triangle_in_world(triangle)).collect()
    };
    match light.kind {
        LightKind::Directional { towards_light } => {
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
            Ok(View { light_view_from_world, shape: Shape::Parallel, window })
        }
        LightKind::Spot { position, axis, outer_rad, .. } => {
            let full_rad = match fit.around {
                Around::Manual => fit.fov_rad.unwrap_or(MANUAL_FOV_RAD),
                _ => fit.fov_rad.unwrap_or(2.0 * outer_rad),
            };
            within_limit(full_rad)?;
            let light_view_from_world = look(position.as_dvec3(), axis.as_dvec3().normalize());
            Ok(View {
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
                    Window::around(receivers.iter().map(|point| {
                        let in_view = light_view_from_world.transform_point3(*point);
                        in_view.truncate() / -in_view.z
                    }))
                }
            };
            Ok(View { light_view_from_world, shape: Shape::Perspective, window })
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

/// Near before the nearest caster in the window, far behind the farthest receiver in it.
fn fitted_depths(scene: &Scene, light: &Light, view: &DMat4, shape: Shape, window: Window) -> (f64, f64) {
    let range = |choose: fn(&Mesh) -> bool| {
        let triangles = scene.meshes.iter().filter(|mesh| choose(mesh)).flat_map(|mesh| mesh.triangles.clone());
        depth_range(triangles.map(|triangle| scene.triangle_in_world(triangle)), view, window, shape)
    };
    let receivers = range(|mesh| mesh.receives).unwrap_or((0.5, 1.0));
    let nearest = range(|mesh| mesh.casts).unwrap_or(receivers).0.min(receivers.1);
    let farthest = receivers.1.min(light.range_m);
    match shape {
        Shape::Perspective => {
            let far_m = farthest.max(f64::MIN_POSITIVE) * (1.0 + FAR_SLACK);
            (((1.0 - NEAR_SLACK) * nearest).clamp(NEAR_FLOOR * far_m, (1.0 - NEAR_SLACK) * far_m), far_m)
        }
        Shape::Parallel => {
            let range_m = (farthest - nearest).max(LEAST_WIDTH * farthest.abs().max(f64::MIN_POSITIVE));
            (nearest - NEAR_SLACK * range_m, farthest + FAR_SLACK * range_m)
        }
    }
}

fn parallel_window(light_view_from_world: &DMat4, points: &[DVec3]) -> Window {
    Window::around(points.iter().map(|point| light_view_from_world.transform_point3(*point).truncate()))
}

/// Light view for a direction of travel: never singular, because up changes where the direction nears it, and always
/// the same rule, because it fixes the texel grid.
fn look(eye: DVec3, travel: DVec3) -> DMat4 {
    /// |travel.y| above which Y no longer serves as up.
    const NEAR_VERTICAL: f64 = 0.999;
    let up = if travel.y.abs() <= NEAR_VERTICAL { DVec3::Y } else { DVec3::NEG_Z };
    let side = travel.cross(up).normalize();
    let rotation = glam::DMat3::from_cols(side, side.cross(travel), -travel).transpose();
    DMat4::from_mat3(rotation) * DMat4::from_translation(-eye)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn looking_straight_down_is_no_singularity() {
        let view = look(DVec3::ZERO, DVec3::NEG_Y);
        assert_eq!(view.transform_vector3(DVec3::X), DVec3::X);
        assert_eq!(view.transform_vector3(DVec3::NEG_Z), DVec3::Y);
    }

    #[test]
    fn every_direction_gives_a_rotation() {
        for i in 0..2000 {
            let (turn, height) = (0.37 * f64::from(i), 1.0 - f64::from(i) / 999.5);
            let flat = (1.0 - height * height).max(0.0).sqrt();
            let travel = DVec3::new(flat * turn.cos(), height, flat * turn.sin()).normalize();
            let view = look(DVec3::ZERO, travel);
            assert!((view.determinant() - 1.0).abs() < 1e-12);
            assert!((view.transform_vector3(travel) - DVec3::NEG_Z).length() < 1e-12);
        }
    }

    #[test]
    fn too_wide_is_refused_and_the_limit_itself_is_not() {
        assert!(within_limit(WIDEST_DEG.to_radians()).is_ok());
        assert!(within_limit(171.0_f64.to_radians()).is_err());
    }
}
