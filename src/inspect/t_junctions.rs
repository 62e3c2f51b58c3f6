//! T-junctions: the end of an open edge lies inside another open edge.
//!
//! Such a pair of edges looks joined but is not: rays and silhouettes pass through the crack. *Exact* junctions are
//! collinear in exact arithmetic (J. R. Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast Robust
//! Geometric Predicates", 1997); *near* ones miss the edge by rounding, within a tolerance.

use super::edges::Edge;
use super::point_tree::PointTree;
use glam::DVec3;
use robust::{Coord, orient2d};

/// The end of an open edge, inside another open edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct TJunction {
    /// Welded index of the end.
    pub vertex: u32,
    /// Welded indices of the edge it lies on, ascending.
    pub edge: [u32; 2],
    /// Whether it lies on the edge's line exactly, rather than within the tolerance.
    pub is_exact: bool,
}

/// How much farther than the tolerance the tree looks, so that its rounding loses nothing.
const SEARCH_MARGIN: f64 = 2.0;

/// The T-junctions of one mesh, sorted by vertex. `positions` are indexed by welded index and are f32 numbers, exact in f64.
#[must_use]
pub fn t_junctions(edges: &[Edge], positions: &[DVec3], tolerance_m: f64) -> Vec<TJunction> {
    let place = |v: u32| positions[v as usize];
    let tree = PointTree::build(ends(edges).into_iter().map(|v| (place(v), v)).collect());
    let mut found = Vec::new();
    for edge in edges.iter().filter(|edge| edge.is_open()) {
        let (a, b) = (place(edge.low), place(edge.high));
        tree.near_segment(a, b, SEARCH_MARGIN * tolerance_m, &mut |point, vertex| {
            if let Some(is_exact) = lies_inside(point, a, b, tolerance_m) {
                found.push(TJunction { vertex, edge: [edge.low, edge.high], is_exact });
            }
        });
    }
    found.sort_unstable();
    found
}

/// The distinct ends of the open edges, ascending.
fn ends(edges: &[Edge]) -> Vec<u32> {
    let mut ends: Vec<u32> = edges.iter().filter(|edge| edge.is_open()).flat_map(|e| [e.low, e.high]).collect();
    ends.sort_unstable();
    ends.dedup();
    ends
}

/// Whether `v` lies strictly between `a` and `b` and within the tolerance of their line; if so, whether exactly on it.
///
/// The signs of the two dot products are right for collinear points: their terms have equal signs and do not cancel.
fn lies_inside(v: DVec3, a: DVec3, b: DVec3, tolerance_m: f64) -> Option<bool> {
    let along = b - a;
    let is_between = (v - a).dot(along) > 0.0 && (b - v).dot(along) > 0.0;
    let is_near = (v - a).cross(along).length() <= tolerance_m * along.length();
    (is_between && is_near).then(|| is_collinear(v, a, b))
}

/// Three points are collinear exactly when their shadows on all three coordinate planes are.
fn is_collinear(a: DVec3, b: DVec3, c: DVec3) -> bool {
    [(0, 1), (1, 2), (2, 0)].into_iter().all(|(x, y)| {
        let [a, b, c] = [a, b, c].map(|p| Coord { x: p[x], y: p[y] });
        orient2d(a, b, c) == 0.0
    })
}

#[cfg(test)]
mod tests {
    use super::super::edges::edges_of;
    use super::*;
    use glam::Vec3;

    const TOLERANCE_M: f64 = 1e-6;

    /// The definition, tried on every pair.
    fn by_brute_force(edges: &[Edge], positions: &[DVec3], tolerance_m: f64) -> Vec<TJunction> {
        let mut found = Vec::new();
        for edge in edges.iter().filter(|edge| edge.is_open()) {
            let [a, b] = [edge.low, edge.high].map(|v| positions[v as usize]);
            for vertex in ends(edges) {
                if let Some(is_exact) = lies_inside(positions[vertex as usize], a, b, tolerance_m) {
                    found.push(TJunction { vertex, edge: [edge.low, edge.high], is_exact });
                }
            }
        }
        found.sort_unstable();
        found
    }

    /// One triangle on one side of the edge 0–1, two on the other side that meet at `middle`.
    fn split_edge(middle: DVec3) -> Vec<TJunction> {
        let positions = [DVec3::ZERO, DVec3::new(3.0, 1.0, 2.0), DVec3::Z, middle, DVec3::new(2.0, -3.0, 0.0)];
        t_junctions(&edges_of(&[[0, 1, 2], [0, 4, 3], [3, 4, 1]]), &positions, TOLERANCE_M)
    }

    #[test]
    fn the_middle_of_an_edge_is_exact_and_its_neighbour_near() {
        let middle = DVec3::new(1.5, 0.5, 1.0);
        assert_eq!(split_edge(middle), [TJunction { vertex: 3, edge: [0, 1], is_exact: true }]);
        let beside = middle + DVec3::Y * 1e-7;
        assert_eq!(split_edge(beside), [TJunction { vertex: 3, edge: [0, 1], is_exact: false }]);
    }

    #[test]
    fn beyond_the_tolerance_or_beyond_the_ends_there_is_none() {
        assert_eq!(split_edge(DVec3::new(1.5, 0.5, 1.0) + DVec3::Y * 1e-5), []);
        assert!(split_edge(DVec3::new(6.0, 2.0, 4.0)).iter().all(|junction| junction.vertex != 3));
    }

    #[test]
    fn the_tree_finds_what_brute_force_finds() {
        // A soup on a coarse lattice: thousands of exact hits, all axes and diagonals, edges of all lengths.
        let mut state = 7_u32;
        let mut next = |below: u32| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 16) % below
        };
        let positions: Vec<_> =
            (0..216).map(|i| Vec3::new((i % 6) as f32, (i / 6 % 6) as f32, (i / 36) as f32).as_dvec3()).collect();
        let triangles: Vec<_> = (0..300).map(|_| [next(216), next(216), next(216)]).collect();
        let edges = edges_of(&triangles);
        // One tolerance for exact hits only, one wide enough for thousands of near ones.
        for tolerance_m in [TOLERANCE_M, 0.3] {
            let found = t_junctions(&edges, &positions, tolerance_m);
            assert!(found.len() > 100);
            assert_eq!(found, by_brute_force(&edges, &positions, tolerance_m));
        }
        let half = t_junctions(&edges[..edges.len() / 2], &positions, TOLERANCE_M);
        assert_ne!(half, by_brute_force(&edges, &positions, TOLERANCE_M), "the comparison notices missing edges");
    }
}
