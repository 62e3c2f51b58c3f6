//! Which triangles touch: the question behind telling a surface's shadow on itself from another surface's.

use super::weld::weld;
use crate::scene::Scene;

/// The welded corners of every triangle.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Adjacency {
    welded_triangles: Vec<[u32; 3]>,
}

/// Welds all meshes of a scene together, so that triangles of different meshes touch too.
#[must_use]
pub fn neighbours(scene: &Scene) -> Adjacency {
    Adjacency { welded_triangles: weld(&scene.positions).triangles(&scene.triangles) }
}

impl Adjacency {
    /// Whether two triangles, by id, have a corner at the same place. A triangle shares its vertices with itself.
    #[must_use]
    pub fn shares_vertex(&self, a: u32, b: u32) -> bool {
        let [a, b] = [a, b].map(|id| self.welded_triangles[id as usize]);
        a.iter().any(|corner| b.contains(corner))
    }
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{Shape, cube, scene_of};
    use super::*;
    use glam::DVec3;

    #[test]
    fn triangles_touch_through_welded_vertices_only() {
        let fan = Shape {
            positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ZERO, DVec3::Z, -DVec3::X, DVec3::ONE],
            triangles: vec![[0, 1, 2], [3, 4, 5], [4, 5, 6]],
        };
        let touching = neighbours(&scene_of(&[fan]));
        assert!(touching.shares_vertex(0, 1), "vertices 0 and 3 are one place");
        assert!(touching.shares_vertex(1, 2) && touching.shares_vertex(2, 2));
        assert!(!touching.shares_vertex(0, 2) && !touching.shares_vertex(2, 0));
    }

    #[test]
    fn meshes_that_touch_are_neighbours() {
        let touching = neighbours(&scene_of(&[cube(DVec3::ZERO), cube(DVec3::ONE)]));
        let across = |touching: &Adjacency| (0..12).any(|a| (12..24).any(|b| touching.shares_vertex(a, b)));
        assert!(across(&touching));
        assert!(!across(&neighbours(&scene_of(&[cube(DVec3::ZERO), cube(DVec3::ONE * 1.5)]))));
    }
}
