//! Welding: triangles with the same three positions are one surface, whatever their order, winding or mesh.
//!
//! Two such triangles bound nothing between them, so a receiver on one lies on both; and a tree builder that compares
//! neighbours by the size of their common box cannot tell them apart and takes quadratic time.

use crate::scene::Scene;
use glam::Vec3;
use std::collections::HashMap;

/// Three positions as bits, sorted: equal for triangles in the same place.
pub(super) type Place = [[u32; 3]; 3];

/// Where a triangle is.
pub(super) fn place(corners: [Vec3; 3]) -> Place {
    let mut place = corners.map(|corner| corner.to_array().map(|x| without_negative_zero(x).to_bits()));
    place.sort_unstable();
    place
}

/// The same number, but +0 for −0.
pub(super) fn without_negative_zero(x: f32) -> f32 {
    x + 0.0
}

/// Corners of a triangle as the scene stores them.
pub(super) fn corners(scene: &Scene, triangle: u32) -> [Vec3; 3] {
    scene.triangles[triangle as usize].map(|v| scene.positions[v as usize])
}

/// Per triangle of the scene the lowest id of a casting triangle in its place, or of any triangle if none casts.
pub(super) fn surface_of_triangles(scene: &Scene) -> Vec<u32> {
    let silent = scene.meshes.iter().filter(|mesh| !mesh.casts).flat_map(|mesh| mesh.triangles.clone());
    let mut first_at = HashMap::with_capacity(scene.triangles.len());
    let mut surface_of: Vec<u32> = vec![0; scene.triangles.len()];
    for triangle in scene.casting_triangles().chain(silent) {
        surface_of[triangle as usize] = *first_at.entry(place(corners(scene, triangle))).or_insert(triangle);
    }
    surface_of
}

#[cfg(test)]
mod tests {
    use super::*;

    const A: Vec3 = Vec3::new(1.0, 0.0, 0.0);
    const B: Vec3 = Vec3::new(0.0, 1.0, 0.0);
    const C: Vec3 = Vec3::new(0.0, 0.0, 1.0);

    #[test]
    fn order_and_sign_of_zero_do_not_matter_but_position_does() {
        assert_eq!(place([A, B, C]), place([C, A, B]));
        assert_eq!(place([A, B, C]), place([B, A, C]));
        assert_eq!(place([A, B, C]), place([Vec3::new(1.0, -0.0, 0.0), B, C]));
        assert_ne!(place([A, B, C]), place([A, B, Vec3::new(0.0, 0.0, 1.0f32.next_up())]));
        assert_ne!(place([A, B, C]), place([A, B, B]));
    }
}
