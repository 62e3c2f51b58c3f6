//! What fits share: the light's basis, and where near and far plane go. Formulas: docs/map.md#fit.

use super::clip::depth_range;
use super::{Shape, Window};
use crate::scene::{Light, Mesh, Scene};
use crate::technique::Unsupported;
use crate::technique::map::settings::{Fit, NearMode, Settings};
use glam::{DMat3, DMat4, DVec3};

/// Near plane before the nearest caster by this share of its distance (perspective) or of the range (parallel), so that
/// rounding cannot clip it.
const NEAR_SLACK: f64 = 1e-2;
/// Far plane beyond the farthest receiver by this share, likewise.
const FAR_SLACK: f64 = 1e-3;
/// Smallest near distance as a share of far, for casters at the light.
const NEAR_FLOOR: f64 = 1e-3;
/// A fit of no width gets this share of the scene's radius.
pub(super) const LEAST_WIDTH: f64 = 1e-6;

/// How near and how far casters and receivers reach in a view, metres along it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Reach {
    pub(super) nearest_caster_m: f64,
    pub(super) nearest_receiver_m: f64,
    pub(super) farthest_receiver_m: f64,
}

impl Default for Reach {
    /// Of a view that holds nothing: any planes will do.
    fn default() -> Self {
        Self { nearest_caster_m: 0.5, nearest_receiver_m: 0.5, farthest_receiver_m: 1.0 }
    }
}

impl Reach {
    /// Inside a window; `None` if it holds no receiver.
    pub(super) fn within(scene: &Scene, view: &DMat4, shape: Shape, window: Window) -> Option<Self> {
        let range = |choose: fn(&Mesh) -> bool| {
            let triangles = scene.meshes.iter().filter(|mesh| choose(mesh)).flat_map(|mesh| mesh.triangles.clone());
            depth_range(triangles.map(|triangle| scene.triangle_in_world(triangle)), view, window, shape)
        };
        let (nearest_receiver_m, farthest_receiver_m) = range(|mesh| mesh.receives)?;
        let nearest_caster_m = range(|mesh| mesh.casts).map_or(nearest_receiver_m, |casters| casters.0);
        Some(Self { nearest_caster_m, nearest_receiver_m, farthest_receiver_m })
    }

    /// Of two views together.
    pub(super) fn and(self, other: Self) -> Self {
        Self {
            nearest_caster_m: self.nearest_caster_m.min(other.nearest_caster_m),
            nearest_receiver_m: self.nearest_receiver_m.min(other.nearest_receiver_m),
            farthest_receiver_m: self.farthest_receiver_m.max(other.farthest_receiver_m),
        }
    }

    /// Near before the nearest caster (or, where casters before it are clamped to it, the nearest receiver), far behind
    /// the farthest receiver.
    pub(super) fn planes(self, light: &Light, shape: Shape, settings: &Settings) -> (f64, f64) {
        let nearest = match settings.near_mode {
            NearMode::Extend => self.nearest_caster_m.min(self.farthest_receiver_m),
            NearMode::DepthClamp | NearMode::FragmentClamp | NearMode::VertexClamp => {
                self.nearest_receiver_m - settings.near_margin_m
            }
        };
        let farthest = self.farthest_receiver_m.min(light.range_m);
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
}

impl Fit {
    /// The planes typed, or else those fitted.
    pub(super) fn planes_m(&self, fitted: (f64, f64)) -> Result<(f64, f64), Unsupported> {
        let (near_m, far_m) = (self.near_m.unwrap_or(fitted.0), self.far_m.unwrap_or(fitted.1));
        if near_m >= far_m {
            let why = format!("the light's near plane at {near_m} m is not before its far plane at {far_m} m");
            return Err(Unsupported::Degenerate { why });
        }
        Ok((near_m, far_m))
    }
}

/// Light view for a direction of travel: never singular, because up changes where the direction nears it, and always
/// the same rule, because it fixes the texel grid.
pub(super) fn look(eye: DVec3, travel: DVec3) -> DMat4 {
    /// |travel.y| above which Y no longer serves as up.
    const NEAR_VERTICAL: f64 = 0.999;
    look_with_up(eye, travel, if travel.y.abs() <= NEAR_VERTICAL { DVec3::Y } else { DVec3::NEG_Z })
}

/// Light view for a direction of travel and an up that is not parallel to it.
pub(super) fn look_with_up(eye: DVec3, travel: DVec3, up: DVec3) -> DMat4 {
    let side = travel.cross(up).normalize();
    let rotation = DMat3::from_cols(side, side.cross(travel), -travel).transpose();
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
}
