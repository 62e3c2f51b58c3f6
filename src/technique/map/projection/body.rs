//! What a map that follows the camera must hold: the receivers that are seen, and whatever may cast a shadow on them.
//! That is everything between them and the light, so the points where their rays leave the casters' box, together with
//! the receivers themselves, span it.

use crate::scene::{Bounds, Light, Scene};
use glam::DVec3;

/// Receivers and the far ends of their rays.
#[derive(Debug)]
pub(super) struct Body {
    pub(super) receivers: Vec<DVec3>,
    /// Where the ray of the receiver of the same index leaves the casters, towards the light; the receiver itself if it
    /// meets none.
    pub(super) ray_ends: Vec<DVec3>,
}

impl Body {
    /// Of what is visible; of everything where nothing is.
    pub(super) fn of(scene: &Scene, light: &Light, visible: &[DVec3]) -> Self {
        let receivers = if visible.is_empty() { scene.bounds().corners().to_vec() } else { visible.to_vec() };
        let casters = scene.bounds_of(|mesh| mesh.casts);
        let light = light.homogeneous();
        let ray_end = |receiver: &DVec3| {
            let towards_light = light.truncate() - *receiver * light.w;
            let leaves = leaving(&casters, *receiver, towards_light);
            // A light that is somewhere ends the ray at 1.
            let end = if light.w == 0.0 { leaves } else { leaves.min(1.0) };
            *receiver + towards_light * end.max(0.0)
        };
        Self { ray_ends: receivers.iter().map(ray_end).collect(), receivers }
    }

    /// All of its points.
    pub(super) fn points(&self) -> impl Iterator<Item = DVec3> + Clone + '_ {
        self.receivers.iter().chain(&self.ray_ends).copied()
    }
}

/// Where a ray leaves a box, in units of its direction; negative if it misses it.
fn leaving(bounds: &Bounds, from: DVec3, along: DVec3) -> f64 {
    let (mut enters, mut leaves) = (f64::NEG_INFINITY, f64::INFINITY);
    for axis in 0..3 {
        let [a, b] = [bounds.min, bounds.max].map(|side| (side[axis] - from[axis]) / along[axis]);
        // A ray within a side divides 0 by 0 and meets no side of that axis.
        if !(a.is_nan() || b.is_nan()) {
            enters = enters.max(a.min(b));
            leaves = leaves.min(a.max(b));
        }
    }
    if enters <= leaves && leaves.is_finite() { leaves } else { -1.0 }
}

/// Smallest and largest of some numbers; zero twice without any.
pub(super) fn range(values: impl IntoIterator<Item = f64>) -> (f64, f64) {
    let both = values.into_iter().fold(None, |range: Option<(f64, f64)>, value| {
        Some(range.map_or((value, value), |(least, most)| (least.min(value), most.max(value))))
    });
    both.unwrap_or((0.0, 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_leave_boxes_where_they_should() {
        let bounds = Bounds { min: DVec3::ZERO, max: DVec3::ONE };
        assert_eq!(leaving(&bounds, DVec3::splat(0.5), DVec3::Y), 0.5);
        assert_eq!(leaving(&bounds, DVec3::new(0.5, -1.0, 0.5), 2.0 * DVec3::Y), 1.0);
        assert!(leaving(&bounds, DVec3::new(3.0, 0.5, 0.5), DVec3::Y) < 0.0);
        assert_eq!(leaving(&bounds, DVec3::new(1.0, 0.5, 0.5), DVec3::Y), 0.5, "within a side");
    }
}
