//! Where the surface of the volumes meets the surface that is seen: there the count is a matter of the rasteriser's grid
//! and of the depth buffer's last bits. Formulas: docs/volume.md#count-edges.
//!
//! A count edge in the picture is a pixel whose neighbour counts differently. Not every one shows there. Along a
//! silhouette edge at an outline of the picture the volume begins and ends in one pixel, and over a facet that light
//! grazes a volume's side runs along the facet a few depth steps away.

use super::prepared::PreparedVolume;
use crate::scene::ProjectedTriangle;
use glam::{DVec3, DVec4};

/// Largest error of an interpolated depth in units of 2⁻²⁴ (|dz/dx| x + |dz/dy| y + z), measured on a software
/// rasteriser over perspective triangles.
const DEPTH_UNITS: f64 = 28.0;

/// Rounding of f32.
const UNIT: f64 = 1.0 / (1 << 24) as f64;

/// How far a face's depth at a pixel's centre may be off, 1/m, where the rasteriser snaps vertices to a grid of `step_px`.
fn doubt(face: &ProjectedTriangle, at: DVec3, step_px: f64) -> f64 {
    let slope = face.inverse_depth.truncate().abs();
    let carried = slope.dot(at.truncate());
    let rounding = DEPTH_UNITS * (carried + face.inverse_depth.dot(at).abs());
    slope.length() * step_px + UNIT * rounding
}

impl PreparedVolume<'_> {
    /// Whether a face of a volume, other than the front cap that is the receiver's own triangle, meets the surface at
    /// a pixel's centre within the rasteriser's grid and the depth buffer's rounding.
    #[must_use]
    pub fn boundary_touches(&self, pixel: u32) -> bool {
        let Some(receiver) = self.receiver(pixel) else { return false };
        let size = self.job.scene.image_size;
        let at = DVec3::new(f64::from(pixel % size.x) + 0.5, f64::from(pixel / size.x) + 0.5, 1.0);
        let clip_from_world = self.eye.clip_from_world.as_dmat4();
        let face = |corners: [DVec4; 3]| ProjectedTriangle::new(corners, &clip_from_world, size.as_dvec2());
        let Some(surface) = face(self.corners_of(receiver.triangle)) else { return true };
        let step_px = self.job.gpu.vertex_step_px();
        let doubt = |face: &ProjectedTriangle| doubt(face, at, step_px);
        let touches = |face: &ProjectedTriangle| {
            let gap = (face.inverse_depth - surface.inverse_depth).dot(at).abs();
            face.sides.iter().all(|side| side.dot(at) >= -step_px) && gap <= doubt(face) + doubt(&surface)
        };
        let is_own = |triangle: &u32| *triangle == receiver.triangle;
        let caps = self.volumes.objects.iter().flat_map(|object| &object.used).filter(|triangle| !is_own(triangle));
        self.sides()
            .chain(self.back_caps())
            .chain(caps.map(|&triangle| self.corners_of(triangle)))
            .filter_map(face)
            .any(|face| touches(&face))
    }

    fn back_caps(&self) -> impl Iterator<Item = [DVec4; 3]> {
        let lists = [&self.volumes.behind, &self.volumes.before].into_iter();
        let corners = lists.flat_map(|faces| faces.back_caps.as_chunks::<3>().0);
        corners.map(|corners| corners.map(|corner| self.volumes.position(corner)))
    }

    fn corners_of(&self, triangle: u32) -> [DVec4; 3] {
        self.job.scene.triangle_in_world(triangle).map(|corner| corner.extend(1.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DVec2, dcamera::rh};

    #[test]
    fn steep_triangles_are_more_in_doubt() {
        let clip_from_world = rh::proj::directx::perspective_infinite_reverse(1.0, 1.0, 0.1);
        let centre = DVec3::new(50.0, 50.0, 1.0);
        let doubt_of = |corners: [DVec3; 3]| {
            let corners = corners.map(|p| p.extend(1.0));
            doubt(&ProjectedTriangle::new(corners, &clip_from_world, DVec2::splat(100.0)).unwrap(), centre, 1.0 / 256.0)
        };
        let upright = [DVec3::new(-1.0, -1.0, -4.0), DVec3::new(1.0, -1.0, -4.0), DVec3::new(0.0, 1.0, -4.0)];
        let steep = [DVec3::new(-1.0, -0.1, -4.0), DVec3::new(1.0, -0.1, -4.0), DVec3::new(0.0, -0.1, -8.0)];
        assert!(doubt_of(upright) < 1e-6, "only rounding");
        assert!(doubt_of(steep) > 1e-5);
    }
}
