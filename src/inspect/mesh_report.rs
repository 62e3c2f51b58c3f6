//! What one mesh is made of, and whether techniques that need solid casters can use it.
//!
//! A *face* is a triangle with three different welded vertices; vertices, edges, components and the Euler
//! characteristic count faces only. Triangles that are none are counted as degenerate and keep their ids.

use super::components::vertices_and_components;
use super::edges::{Edge, edges_of, is_collapsed};
use super::t_junctions::t_junctions;
use super::weld::weld;
use crate::scene::{Bounds, Mesh, Scene};
use glam::{DVec3, Vec3};
use serde::Serialize;
use std::collections::HashSet;

/// Distance below which an open edge's end counts as lying on another one, per extent: 16 times the rounding of an f32 coordinate.
const T_JUNCTION_TOLERANCE: f64 = 1.0 / (1 << 20) as f64;
/// Twice the area below which a triangle counts as degenerate, per squared extent: the square of the same tolerance.
const DEGENERATE_AREA: f64 = T_JUNCTION_TOLERANCE * T_JUNCTION_TOLERANCE;

/// One mesh's topology and measure.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MeshReport {
    /// The mesh's name.
    pub name: String,
    /// Whether it casts shadows.
    pub casts: bool,
    /// Whether it is asked about shadows.
    pub receives: bool,
    /// All triangles.
    pub triangles: usize,
    /// Places that faces use.
    pub welded_vertices: usize,
    /// Edges of faces.
    pub edges: usize,
    /// Edges with one face.
    pub open_edges: usize,
    /// Edges with more than two faces.
    pub non_manifold_edges: usize,
    /// Edges whose two faces disagree about the outside.
    pub inconsistent_edges: usize,
    /// Ends of open edges exactly on another open edge.
    pub t_junctions_exact: usize,
    /// Ends of open edges on another open edge but for rounding.
    pub t_junctions_near: usize,
    /// Triangles that repeat a welded vertex or have next to no area.
    pub degenerate_triangles: usize,
    /// Triangles whose three places an earlier triangle has, in any order.
    pub duplicate_triangles: usize,
    /// Pieces that share no vertex.
    pub components: usize,
    /// Vertices − edges + faces: 2 for a sphere, 0 for a torus.
    pub euler: i64,
    /// Enclosed volume, m³, positive when wound outward. Of a mesh that is not closed: of the cone from its box's
    /// centre over its triangles.
    pub signed_volume_m3: f64,
    /// Every edge is run as often forward as backward.
    pub is_closed: bool,
    /// Exactly two faces that agree meet at every edge.
    pub is_manifold: bool,
    /// The signed volume is positive.
    pub is_outward: bool,
}

impl MeshReport {
    /// Inspects one mesh of a scene whose largest side is `extent_m`.
    #[must_use]
    pub fn new(scene: &Scene, mesh: &Mesh, extent_m: f64) -> Self {
        let ids = mesh.triangles.start as usize..mesh.triangles.end as usize;
        let corners: Vec<Vec3> =
            scene.triangles[ids].as_flattened().iter().map(|&v| scene.positions[v as usize]).collect();
        let welded = weld(&corners);
        let positions = &welded.positions(&corners);
        let (triangles, _) = welded.index_of_vertex.as_chunks::<3>();
        let faces: Vec<[u32; 3]> = triangles.iter().copied().filter(|&corners| !is_collapsed(corners)).collect();
        let edges = edges_of(&faces);
        let (welded_vertices, components) = vertices_and_components(&faces, positions.len());
        let junctions = t_junctions(&edges, positions, T_JUNCTION_TOLERANCE * extent_m);
        let t_junctions_exact = junctions.iter().filter(|junction| junction.is_exact).count();
        let edges_that = |is: fn(&Edge) -> bool| edges.iter().filter(|edge| is(edge)).count();
        let signed_volume_m3 = signed_volume(&faces, positions);
        Self {
            name: mesh.name.clone(),
            casts: mesh.casts,
            receives: mesh.receives,
            triangles: triangles.len(),
            welded_vertices,
            edges: edges.len(),
            open_edges: edges_that(Edge::is_open),
            non_manifold_edges: edges_that(Edge::is_non_manifold),
            inconsistent_edges: edges_that(Edge::is_inconsistent),
            t_junctions_exact,
            t_junctions_near: junctions.len() - t_junctions_exact,
            degenerate_triangles: degenerate_triangles(triangles, positions, extent_m),
            duplicate_triangles: duplicate_triangles(triangles),
            components,
            euler: welded_vertices as i64 - edges.len() as i64 + faces.len() as i64,
            signed_volume_m3,
            is_closed: !edges.is_empty() && edges.iter().all(Edge::is_balanced),
            is_manifold: !edges.is_empty() && edges.iter().all(Edge::is_manifold),
            is_outward: signed_volume_m3 > 0.0,
        }
    }
}

fn corners_of(triangle: [u32; 3], positions: &[DVec3]) -> [DVec3; 3] {
    triangle.map(|v| positions[v as usize])
}

fn degenerate_triangles(triangles: &[[u32; 3]], positions: &[DVec3], extent_m: f64) -> usize {
    let smallest = DEGENERATE_AREA * extent_m * extent_m;
    let is_degenerate = |&&triangle: &&[u32; 3]| {
        let [a, b, c] = corners_of(triangle, positions);
        is_collapsed(triangle) || (b - a).cross(c - a).length() <= smallest
    };
    triangles.iter().filter(is_degenerate).count()
}

fn duplicate_triangles(triangles: &[[u32; 3]]) -> usize {
    let mut seen = HashSet::with_capacity(triangles.len());
    let is_known = |mut places: [u32; 3]| {
        places.sort_unstable();
        !seen.insert(places)
    };
    triangles.iter().copied().map(is_known).filter(|&known| known).count()
}

/// The sum of the signed volumes of the tetrahedra between each face and the box's centre, which keeps the terms small.
fn signed_volume(faces: &[[u32; 3]], positions: &[DVec3]) -> f64 {
    let corners = || faces.iter().map(|&face| corners_of(face, positions));
    let Some(bounds) = Bounds::of(corners().flatten()) else { return 0.0 };
    let tetrahedron = |corners: [DVec3; 3]| {
        let [a, b, c] = corners.map(|p| p - bounds.centre());
        a.dot(b.cross(c)) / 6.0
    };
    corners().map(tetrahedron).sum()
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{Shape, cube, pyramid, scene_of, torus};
    use super::*;

    /// f32 coordinates of a unit-sized solid move its volume by less than this.
    const VOLUME_ROUNDING: f64 = 1e-6;

    fn report(shape: &Shape) -> MeshReport {
        let scene = scene_of(std::slice::from_ref(shape));
        MeshReport::new(&scene, &scene.meshes[0], scene.extent_m())
    }

    fn assert_is_solid(solid: &MeshReport) {
        assert!(solid.is_closed && solid.is_manifold && solid.is_outward, "{solid:?}");
        assert_eq!(2 * solid.edges, 3 * solid.triangles);
        let flaws = [
            solid.open_edges,
            solid.non_manifold_edges,
            solid.inconsistent_edges,
            solid.t_junctions_exact,
            solid.t_junctions_near,
            solid.degenerate_triangles,
            solid.duplicate_triangles,
        ];
        assert_eq!(flaws, [0; 7]);
    }

    #[test]
    fn pyramid_over_a_fan_of_three() {
        let solid = report(&pyramid());
        assert_is_solid(&solid);
        assert_eq!((solid.welded_vertices, solid.edges, solid.triangles, solid.euler), (5, 9, 6, 2));
        assert!((solid.signed_volume_m3 - 3.0_f64.sqrt() / 2.0).abs() < VOLUME_ROUNDING);
    }

    #[test]
    fn cube_and_torus() {
        let solid = report(&cube(DVec3::ZERO));
        assert_is_solid(&solid);
        assert_eq!((solid.welded_vertices, solid.edges, solid.euler, solid.components), (8, 18, 2, 1));
        assert!((solid.signed_volume_m3 - 1.0).abs() < VOLUME_ROUNDING);
        let ring = report(&torus(12, 8));
        assert_is_solid(&ring);
        assert_eq!((ring.welded_vertices, ring.edges, ring.euler), (96, 288, 0));
    }

    #[test]
    fn inverted_winding_is_closed_but_inward() {
        let inverted = report(&cube(DVec3::ZERO).inverted());
        assert!(inverted.is_closed && inverted.is_manifold && !inverted.is_outward);
        assert!((inverted.signed_volume_m3 + 1.0).abs() < VOLUME_ROUNDING);
    }

    #[test]
    fn one_face_turned_is_inconsistent() {
        let mut shape = pyramid();
        shape.triangles[0].reverse();
        let turned = report(&shape);
        assert_eq!((turned.inconsistent_edges, turned.open_edges), (3, 0));
        assert!(!turned.is_closed && !turned.is_manifold);
    }

    #[test]
    fn open_quad_has_four_open_edges() {
        let mut shape = cube(DVec3::ZERO);
        shape.triangles.truncate(2);
        let quad = report(&shape);
        assert_eq!((quad.open_edges, quad.edges, quad.welded_vertices, quad.euler), (4, 5, 4, 1));
        assert!(!quad.is_closed && !quad.is_manifold);
    }

    #[test]
    fn a_missing_triangle_opens_three_edges() {
        let mut shape = torus(12, 8);
        shape.triangles.pop();
        let holed = report(&shape);
        assert_eq!((holed.open_edges, holed.is_closed), (3, false));
    }

    #[test]
    fn t_junctions_are_counted_by_kind() {
        let split_at = |x: f64| {
            let positions = vec![DVec3::ZERO, DVec3::X * 4.0, DVec3::Z, DVec3::new(x, 0.0, 0.0), -DVec3::Y];
            report(&Shape { positions, triangles: vec![[0, 1, 2], [0, 4, 3], [3, 4, 1]] })
        };
        let on_axis = split_at(1.7);
        assert_eq!((on_axis.t_junctions_exact, on_axis.t_junctions_near), (1, 0));
        let mut bent = Shape {
            positions: vec![DVec3::ZERO, DVec3::ONE, DVec3::Z, DVec3::splat(0.3), -DVec3::Y],
            triangles: vec![[0, 1, 2], [0, 4, 3], [3, 4, 1]],
        };
        bent.positions[3].y += 1e-7;
        let beside = report(&bent);
        assert_eq!((beside.t_junctions_exact, beside.t_junctions_near), (0, 1));
    }

    #[test]
    fn two_cubes_sharing_an_edge_are_closed_but_not_manifold() {
        let pair = report(&cube(DVec3::ZERO).and(&cube(DVec3::new(1.0, 1.0, 0.0))));
        assert_eq!((pair.non_manifold_edges, pair.open_edges, pair.components), (1, 0, 1));
        assert!(pair.is_closed && !pair.is_manifold);
        let apart = report(&cube(DVec3::ZERO).and(&cube(DVec3::new(2.0, 1.0, 0.0))));
        assert_eq!((apart.non_manifold_edges, apart.components, apart.euler), (0, 2, 4));
    }

    #[test]
    fn duplicates_are_found_in_any_order() {
        let mut shape = cube(DVec3::ZERO);
        let [a, b, c] = shape.triangles[5];
        shape.triangles.extend([[b, c, a], [c, b, a]]);
        let doubled = report(&shape);
        assert_eq!((doubled.duplicate_triangles, doubled.triangles, doubled.is_manifold), (2, 14, false));
    }

    #[test]
    fn degenerate_triangles_are_counted_and_do_not_open_the_mesh() {
        let mut shape = cube(DVec3::ZERO);
        let [a, b, _] = shape.triangles[0];
        shape.triangles.push([a, a, b]);
        let collapsed = report(&shape);
        assert_eq!((collapsed.degenerate_triangles, collapsed.euler), (1, 2));
        assert!(collapsed.is_closed && collapsed.is_manifold);
        let line = Shape { positions: vec![DVec3::ZERO, DVec3::X, DVec3::X * 2.0], triangles: vec![[0, 1, 2]] };
        assert_eq!(report(&line).degenerate_triangles, 1, "three places on a line have no area");
    }

    #[test]
    fn a_mesh_of_nothing_is_not_closed() {
        let nothing = report(&Shape { positions: vec![DVec3::X], triangles: vec![[0, 0, 0]] });
        assert_eq!((nothing.welded_vertices, nothing.euler, nothing.degenerate_triangles), (0, 0, 1));
        assert!(!nothing.is_closed && !nothing.is_manifold && !nothing.is_outward);
    }
}
