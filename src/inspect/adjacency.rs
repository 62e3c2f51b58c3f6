//! Which triangles touch: the question behind telling a surface's shadow on itself from another surface's.

use super::components::pieces;
use super::weld::weld;
use crate::scene::Scene;
use std::collections::HashSet;

/// The welded corners of every triangle, and the triangles around every welded corner.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Adjacency {
    welded_triangles: Vec<[u32; 3]>,
    /// The triangles around place `p` are `around[first_around[p]..first_around[p + 1]]`.
    first_around: Vec<u32>,
    around: Vec<u32>,
    /// Per place a number that all places of one connected piece share.
    piece_of_place: Vec<u32>,
}

/// Welds all meshes of a scene together, so that triangles of different meshes touch too.
#[must_use]
pub fn neighbours(scene: &Scene) -> Adjacency {
    let welded = weld(&scene.positions);
    let welded_triangles = welded.triangles(&scene.triangles);
    let places = welded.count as usize;
    let mut corners: Vec<(u32, u32)> =
        (0_u32..).zip(&welded_triangles).flat_map(|(id, places)| places.map(|place| (place, id))).collect();
    corners.sort_unstable();
    let first_around = (0..=welded.count).map(|place| corners.partition_point(|corner| corner.0 < place) as u32);
    Adjacency {
        first_around: first_around.collect(),
        around: corners.iter().map(|corner| corner.1).collect(),
        piece_of_place: pieces(&welded_triangles, places),
        welded_triangles,
    }
}

impl Adjacency {
    /// Whether two triangles, by id, have a corner at the same place. A triangle shares its vertices with itself.
    #[must_use]
    pub fn shares_vertex(&self, a: u32, b: u32) -> bool {
        let [a, b] = [a, b].map(|id| self.welded_triangles[id as usize]);
        a.iter().any(|corner| b.contains(corner))
    }

    /// Whether one can walk from a triangle to another through shared corners, entering only triangles that `open`
    /// accepts on the way (the last one need not be), and at most `most` of them.
    #[must_use]
    pub fn leads(&self, from: u32, to: u32, most: usize, open: impl Fn(u32) -> bool) -> bool {
        let places_of = |triangle: u32| self.welded_triangles[triangle as usize];
        let piece_of = |triangle: u32| self.piece_of_place[places_of(triangle)[0] as usize];
        if piece_of(from) != piece_of(to) {
            return false;
        }
        let mut entered = HashSet::from([from]);
        let mut seen = HashSet::from(places_of(from));
        let mut ahead = places_of(from).to_vec();
        while let Some(place) = ahead.pop() {
            for &triangle in self.triangles_around(place) {
                if triangle == to {
                    return true;
                }
                if !entered.contains(&triangle) && open(triangle) {
                    if entered.len() > most {
                        return false;
                    }
                    entered.insert(triangle);
                    ahead.extend(places_of(triangle).into_iter().filter(|place| seen.insert(*place)));
                }
            }
        }
        false
    }

    fn triangles_around(&self, place: u32) -> &[u32] {
        let [first, end] = [place, place + 1].map(|place| self.first_around[place as usize] as usize);
        &self.around[first..end]
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

    /// Five triangles in a row, each sharing one corner with the next; a sixth apart.
    fn row() -> Adjacency {
        let positions = (0..13).map(|i| DVec3::new(f64::from(i), f64::from(i % 2), 0.0)).collect();
        let triangles = (0..5).map(|i| [2 * i, 2 * i + 1, 2 * i + 2]).chain([[11, 12, 11]]).collect();
        neighbours(&scene_of(&[Shape { positions, triangles }]))
    }

    #[test]
    fn a_walk_needs_every_triangle_between_to_be_open() {
        let row = row();
        assert!(row.leads(0, 4, 100, |_| true) && row.leads(4, 0, 100, |_| true) && row.leads(2, 2, 0, |_| false));
        assert!(row.leads(0, 4, 100, |triangle| (1..=3).contains(&triangle)), "neither end need be open");
        assert!(row.leads(0, 1, 0, |_| false), "neighbours touch");
        assert!(!row.leads(0, 4, 100, |triangle| triangle != 2));
        assert!(!row.leads(0, 5, 100, |_| true), "another piece");
    }

    #[test]
    fn a_walk_ends_where_it_gets_too_long() {
        assert!(row().leads(0, 4, 3, |_| true));
        assert!(!row().leads(0, 4, 2, |_| true));
    }
}
