//! Welding: vertices at exactly the same place become one vertex.
//!
//! Files repeat a position wherever a normal or a texture coordinate changes. Topology must not see such seams, so two
//! vertices are one when their f32 coordinates are equal (−0 counts as +0). There is no tolerance: what a file keeps
//! apart by one ulp is apart for every ray, and stays apart here.

use glam::{DVec3, Vec3};
use std::collections::HashMap;

/// Which vertices are the same place.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Welded {
    /// Welded index per vertex, numbered in order of first appearance.
    pub index_of_vertex: Vec<u32>,
    /// Number of distinct places.
    pub count: u32,
}

/// Welds vertices by position.
#[must_use]
pub fn weld(positions: &[Vec3]) -> Welded {
    let mut index_of_place = HashMap::with_capacity(positions.len());
    let mut count = 0;
    let index_of_vertex = positions
        .iter()
        .map(|&position| {
            *index_of_place.entry(bits(position)).or_insert_with(|| {
                count += 1;
                count - 1
            })
        })
        .collect();
    Welded { index_of_vertex, count }
}

/// The coordinates as integers that are equal exactly when the places are; adding zero turns −0 into +0.
fn bits(position: Vec3) -> [u32; 3] {
    (position + Vec3::ZERO).to_array().map(f32::to_bits)
}

impl Welded {
    /// Triangles with welded indices in place of vertex indices.
    #[must_use]
    pub fn triangles(&self, triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
        triangles.iter().map(|corners| corners.map(|v| self.index_of_vertex[v as usize])).collect()
    }

    /// The place of every welded index; `positions` are those that were welded.
    #[must_use]
    pub fn positions(&self, positions: &[Vec3]) -> Vec<DVec3> {
        let mut places = vec![DVec3::ZERO; self.count as usize];
        for (&welded, position) in self.index_of_vertex.iter().zip(positions) {
            places[welded as usize] = position.as_dvec3();
        }
        places
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_places_get_one_index_in_order_of_appearance() {
        let positions = [Vec3::X, Vec3::Y, Vec3::X, Vec3::Z, Vec3::Y];
        let welded = weld(&positions);
        assert_eq!(welded, Welded { index_of_vertex: vec![0, 1, 0, 2, 1], count: 3 });
        assert_eq!(welded.triangles(&[[2, 4, 3]]), [[0, 1, 2]]);
        assert_eq!(welded.positions(&positions), [DVec3::X, DVec3::Y, DVec3::Z]);
    }

    #[test]
    fn minus_zero_is_zero() {
        assert_eq!(weld(&[Vec3::new(0.0, -0.0, 1.0), Vec3::new(-0.0, 0.0, 1.0)]).count, 1);
    }

    #[test]
    fn one_ulp_apart_stays_apart() {
        assert_eq!(weld(&[Vec3::X, Vec3::X * 1.0_f32.next_up()]).count, 2);
    }
}
