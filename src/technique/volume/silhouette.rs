//! Silhouettes as boundary chains: the edges at which the casting triangles of an object end.
//!
//! Turn every casting triangle towards the light and add up how often each edge is run in either direction; what does
//! not cancel is the silhouette. On a closed 2-manifold this is the classic rule "between a triangle that faces the
//! light and one that does not" (P. Bergeron, "A General Version of Crow's Shadow Volumes", 1986, for all triangles of
//! open meshes); it holds for any soup of triangles, crowded and open edges included, because a sum of volumes has the
//! sum of their boundaries (B. Kim, K. Kim, G. Turk, "A Shadow-Volume Algorithm for Opaque and Transparent Nonmanifold
//! Casters", 2008).

use crate::inspect::edges_of;

/// An edge of the silhouette between welded vertices; the casting side lies to its left as seen from the light.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct SilhouetteEdge {
    /// Where it starts.
    pub(super) from: u32,
    /// Where it ends.
    pub(super) to: u32,
    /// How many side faces it needs, at least 1.
    pub(super) times: u32,
}

/// The silhouette of casting triangles, given by welded indices counter-clockwise as seen from the light.
pub(super) fn silhouette(towards_light: &[[u32; 3]]) -> Vec<SilhouetteEdge> {
    let edges = edges_of(towards_light).into_iter();
    edges
        .filter(|edge| !edge.is_balanced())
        .map(|edge| {
            let times = edge.forward.abs_diff(edge.backward);
            let (from, to) = if edge.forward > edge.backward { (edge.low, edge.high) } else { (edge.high, edge.low) };
            SilhouetteEdge { from, to, times }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inspect::fixtures::{Shape, pyramid, scene_of, torus};
    use crate::inspect::weld;
    use glam::{DVec3, DVec4};
    use std::collections::HashMap;

    /// Corners on the base, apex 4, base centre 5 when counted from 1.
    fn square_pyramid() -> Shape {
        let corner = |x: f64, z: f64| DVec3::new(x, 0.0, z);
        Shape {
            positions: vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(0.0, 1.0), DVec3::Y * 2.0],
            triangles: vec![[0, 3, 1], [1, 3, 2], [2, 3, 0], [0, 1, 2]],
        }
    }

    fn facing_only(shape: &Shape, light: DVec4) -> Vec<SilhouetteEdge> {
        let scene = scene_of(std::slice::from_ref(shape));
        let welded = weld(&scene.positions);
        let used: Vec<[u32; 3]> = (0..scene.triangles.len() as u32)
            .filter(|&triangle| scene.facing(triangle, light) > 0.0)
            .map(|triangle| scene.triangles[triangle as usize].map(|v| welded.index_of_vertex[v as usize]))
            .collect();
        silhouette(&used)
    }

    fn undirected(edges: &[SilhouetteEdge]) -> Vec<(u32, u32)> {
        edges.iter().map(|edge| (edge.from.min(edge.to), edge.from.max(edge.to))).collect()
    }

    #[test]
    fn a_pyramid_under_a_light_shows_its_base() {
        let above = DVec3::Y.extend(0.0);
        assert_eq!(undirected(&facing_only(&square_pyramid(), above)), [(0, 1), (0, 2), (1, 2)]);
    }

    #[test]
    fn a_light_inside_a_convex_mesh_sees_no_silhouette() {
        let inside = DVec3::new(0.0, 0.5, 0.0).extend(1.0);
        assert_eq!(facing_only(&square_pyramid(), inside), []);
        assert_eq!(facing_only(&pyramid(), inside), []);
    }

    #[test]
    fn an_edge_of_three_faces_is_counted_by_what_is_left() {
        let crowded = silhouette(&[[0, 1, 2], [0, 1, 3], [1, 0, 4]]);
        assert!(crowded.contains(&SilhouetteEdge { from: 0, to: 1, times: 1 }));
        let doubled = silhouette(&[[0, 1, 2], [0, 1, 2]]);
        assert!(doubled.iter().all(|edge| edge.times == 2));
    }

    #[test]
    fn a_silhouette_leaves_every_vertex_as_often_as_it_enters() {
        for light in [DVec4::new(3.0, 2.0, 1.0, 1.0), DVec4::new(0.3, 1.0, 0.2, 0.0)] {
            let mut balance: HashMap<u32, i64> = HashMap::new();
            for edge in facing_only(&torus(24, 12), light) {
                *balance.entry(edge.from).or_default() += i64::from(edge.times);
                *balance.entry(edge.to).or_default() -= i64::from(edge.times);
            }
            assert!(!balance.is_empty() && balance.values().all(|sum| *sum == 0));
        }
    }
}
