//! Where the surface of the volumes meets the surface that is seen: there the count is a matter of the rasteriser's grid
//! and of the depth buffer's last bits. Formulas: docs/volume.md#count-edges.
//!
//! A count edge in the picture is a pixel whose neighbour counts differently. Not every one shows there. Along a
//! silhouette edge at an outline of the picture the volume begins and ends in one pixel, and over a facet that light
//! grazes a volume's side runs along the facet a few depth steps away.

use super::prepared::PreparedVolume;
use glam::{DVec2, DVec3, DVec4};

/// Rasterisers snap vertices to a grid of 1/256 pixel.
const SNAP_PX: f64 = 1.0 / 256.0;

/// Largest error of an interpolated depth in units of 2⁻²⁴ (|dz/dx| x + |dz/dy| y + z), measured on a software
/// rasteriser over perspective triangles.
const DEPTH_UNITS: f64 = 28.0;

/// Error of a depth's slope in roundings of pixel coordinates over the triangle's height: four products of differences
/// make the slope, and it is carried to the pixel from the picture's corner.
const SLOPE_UNITS: f64 = 4.0;

/// Rounding of f32.
const UNIT: f64 = 1.0 / (1 << 24) as f64;

/// A triangle as the rasteriser sees it, in pixels and inverse view depth.
struct Face {
    /// Lines through the sides, positive inside, scaled to pixels.
    sides: [DVec3; 3],
    /// Inverse view depth at (x, y, 1) pixels, 1/m.
    inverse_depth: DVec3,
    /// Its least height, pixels; infinite if all corners are behind the eye.
    height_px: f64,
}

impl Face {
    /// From homogeneous corners in clip space; `None` edge-on.
    fn new(clip: [DVec4; 3], size: DVec2) -> Option<Self> {
        let [a, b, c] = clip.map(|p| DVec3::new(0.5 * (p.w + p.x) * size.x, 0.5 * (p.w - p.y) * size.y, p.w));
        let determinant = a.dot(b.cross(c));
        let lines = [b.cross(c), c.cross(a), a.cross(b)];
        let scaled = |line: DVec3| line * determinant.signum() / line.truncate().length();
        let sides = lines.map(scaled);
        let heights = sides.iter().zip([a, b, c]).filter(|(_, corner)| corner.z > 0.0);
        let height_px = heights.map(|(side, corner)| side.dot(corner / corner.z).abs()).fold(f64::INFINITY, f64::min);
        let inverse_depth = (lines[0] + lines[1] + lines[2]) / determinant;
        let is_seen = determinant != 0.0 && sides.iter().all(|side| side.is_finite());
        is_seen.then_some(Self { sides, inverse_depth, height_px })
    }

    /// How far its depth at a pixel's centre may be off, 1/m.
    fn doubt(&self, at: DVec3) -> f64 {
        let slope = self.inverse_depth.truncate().abs();
        let carried = slope.dot(at.truncate());
        let rounding = DEPTH_UNITS * (carried + self.inverse_depth.dot(at).abs());
        let of_slope = SLOPE_UNITS * carried * at.truncate().length() / self.height_px;
        slope.length() * SNAP_PX + UNIT * (rounding + of_slope)
    }
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
        let face = |corners: [DVec4; 3]| Face::new(corners.map(|p| clip_from_world * p), size.as_dvec2());
        let Some(surface) = face(self.corners_of(receiver.triangle)) else { return true };
        let touches = |face: &Face| {
            let gap = (face.inverse_depth - surface.inverse_depth).dot(at).abs();
            face.sides.iter().all(|side| side.dot(at) >= -SNAP_PX) && gap <= face.doubt(at) + surface.doubt(at)
        };
        let is_own = |triangle: &u32| *triangle == receiver.triangle;
        let caps = self.volumes.objects.iter().flat_map(|object| &object.used).filter(|triangle| !is_own(triangle));
        self.drawn_faces()
            .chain(caps.map(|&triangle| self.corners_of(triangle)))
            .filter_map(face)
            .any(|face| touches(&face))
    }

    /// Sides and back caps, as the CPU extrudes them.
    fn drawn_faces(&self) -> impl Iterator<Item = [DVec4; 3]> {
        let lists = [&self.volumes.behind, &self.volumes.before].into_iter();
        let indices =
            lists.flat_map(|faces| faces.sides.as_chunks::<3>().0.iter().chain(faces.back_caps.as_chunks::<3>().0));
        indices.map(|corners| corners.map(|corner| self.volumes.position(corner)))
    }

    fn corners_of(&self, triangle: u32) -> [DVec4; 3] {
        self.job.scene.triangle_in_world(triangle).map(|corner| corner.extend(1.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DMat4, dcamera::rh};

    const SIZE: DVec2 = DVec2::new(100.0, 100.0);

    fn face(corners: [DVec3; 3]) -> Face {
        let clip_from_world: DMat4 = rh::proj::directx::perspective_infinite_reverse(1.0, 1.0, 0.1);
        Face::new(corners.map(|p| clip_from_world * p.extend(1.0)), SIZE).unwrap()
    }

    #[test]
    fn a_face_knows_its_sides_and_its_depth() {
        let corners = [DVec3::new(-1.0, -1.0, -4.0), DVec3::new(1.0, -1.0, -4.0), DVec3::new(0.0, 1.0, -4.0)];
        let centre = DVec3::new(50.0, 50.0, 1.0);
        for face in [face(corners), face([corners[1], corners[0], corners[2]])] {
            assert!((face.inverse_depth.dot(centre) - 0.25).abs() < 1e-12);
            assert!(face.sides.iter().all(|side| side.dot(centre) > 0.0));
            assert!(face.sides.iter().any(|side| side.dot(DVec3::new(99.0, 99.0, 1.0)) < 0.0));
            // Facing the eye it has no slope: only rounding is in doubt.
            assert!(face.doubt(centre) < 1e-6);
        }
        let steep = face([DVec3::new(-1.0, -0.1, -4.0), DVec3::new(1.0, -0.1, -4.0), DVec3::new(0.0, -0.1, -8.0)]);
        assert!(steep.doubt(centre) > 1e-6);
    }

    #[test]
    fn a_face_behind_the_eye_is_none_in_the_picture() {
        let behind = face([DVec3::new(-1.0, -1.0, 4.0), DVec3::new(1.0, -1.0, 4.0), DVec3::new(0.0, 1.0, 4.0)]);
        let centre = DVec3::new(50.0, 50.0, 1.0);
        assert!(behind.inverse_depth.dot(centre) < 0.0);
    }
}
