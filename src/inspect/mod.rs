//! What a scene requires of a shadow technique, found before anything is drawn: which meshes are closed, where edges
//! crack, how deep the view and every light's map must reach.
//!
//! Only facts about the scene's own numbers stand here; what a technique makes of them is the technique's affair.

mod adjacency;
mod components;
mod edges;
#[cfg(test)]
pub(crate) mod fixtures;
mod frustum;
mod light_report;
mod mesh_report;
mod point_tree;
mod t_junctions;
mod weld;

pub use adjacency::{Adjacency, neighbours};
pub use edges::{Edge, edges_of, is_collapsed};
pub use frustum::DepthRange;
pub use light_report::LightReport;
pub use mesh_report::MeshReport;
pub use t_junctions::{TJunction, t_junctions};
pub use weld::{Welded, weld};

use crate::scene::Scene;
use frustum::Frustum;
use rayon::prelude::*;
use serde::Serialize;

/// What a scene is made of and what it demands.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SceneReport {
    /// One report per mesh, in the scene's order.
    pub meshes: Vec<MeshReport>,
    /// One report per light, in the scene's order.
    pub lights: Vec<LightReport>,
    /// Largest side of the scene's box, metres.
    pub extent_m: f64,
    /// Smallest corner of the box, rebased world.
    pub bounds_min_in_world: [f64; 3],
    /// Largest corner of the box, rebased world.
    pub bounds_max_in_world: [f64; 3],
    /// View depth of what is in the picture; `None` if nothing is.
    pub view_depth: Option<DepthRange>,
    /// The tightest near and far plane that cut nothing off, with a margin; `None` if nothing is in the picture.
    pub recommended_view: Option<DepthRange>,
    /// Number of receiver planes the scene declares.
    pub planes: usize,
}

/// Inspects a scene, its meshes in parallel.
#[must_use]
pub fn inspect(scene: &Scene) -> SceneReport {
    let (bounds, extent_m) = (scene.bounds(), scene.extent_m());
    let all_triangles = (0..scene.triangles.len() as u32).map(|id| scene.triangle_in_world(id));
    let view_depth = Frustum::of_camera(&scene.camera, scene.image_size).depth_range(all_triangles);
    SceneReport {
        meshes: scene.meshes.par_iter().map(|mesh| MeshReport::new(scene, mesh, extent_m)).collect(),
        lights: scene.lights.par_iter().map(|light| LightReport::new(scene, light)).collect(),
        extent_m,
        bounds_min_in_world: bounds.min.to_array(),
        bounds_max_in_world: bounds.max.to_array(),
        view_depth,
        recommended_view: view_depth.map(|seen| with_margin(seen, extent_m)),
        planes: scene.planes.len(),
    }
}

/// Share by which the recommended planes keep clear of the geometry: far more than depth rounding, too little to cost depth resolution.
const PLANE_MARGIN: f64 = 0.01;
/// Smallest recommended near distance per extent: geometry that touches the eye must not push the near plane to 0.
const SMALLEST_NEAR: f64 = 1e-6;

fn with_margin(seen: DepthRange, extent_m: f64) -> DepthRange {
    let nearest_m = (seen.nearest_m * (1.0 - PLANE_MARGIN)).max(SMALLEST_NEAR * extent_m);
    DepthRange { nearest_m, farthest_m: (seen.farthest_m * (1.0 + PLANE_MARGIN)).max(nearest_m * (1.0 + PLANE_MARGIN)) }
}

#[cfg(test)]
mod tests {
    use super::fixtures::{cube, pyramid, scene_of};
    use super::*;
    use glam::DVec3;

    #[test]
    fn a_scene_is_reported_mesh_by_mesh_and_light_by_light() {
        let scene = scene_of(&[cube(DVec3::splat(-0.5)), pyramid()]);
        let report = inspect(&scene);
        let names: Vec<_> = report.meshes.iter().map(|mesh| (mesh.name.as_str(), mesh.triangles)).collect();
        assert_eq!(names, [("mesh0", 12), ("mesh1", 6)]);
        assert_eq!((report.lights[0].name.as_str(), report.lights[0].kind), ("lamp", "point"));
        assert_eq!(report.extent_m, scene.extent_m());
        assert_eq!((report.bounds_min_in_world[1], report.bounds_max_in_world[1]), (-0.5, 2.0));
    }

    #[test]
    fn the_view_reaches_from_the_front_face_to_the_back_face() {
        let report = inspect(&scene_of(&[cube(DVec3::splat(-0.5))]));
        assert_eq!(report.view_depth, Some(DepthRange { nearest_m: 4.5, farthest_m: 5.5 }));
        let recommended = report.recommended_view.unwrap();
        assert!(recommended.nearest_m > 4.0 && recommended.nearest_m < 4.5);
        assert!(recommended.farthest_m > 5.5 && recommended.farthest_m < 6.0);
    }

    #[test]
    fn nothing_in_sight_recommends_nothing() {
        let report = inspect(&scene_of(&[cube(DVec3::Z * 9.0)]));
        assert_eq!((report.view_depth, report.recommended_view), (None, None));
    }

    #[test]
    fn geometry_at_the_eye_leaves_a_positive_near_plane() {
        let report = inspect(&scene_of(&[cube(DVec3::new(-0.5, -0.5, 5.0)), cube(DVec3::new(-0.5, -0.5, -0.5))]));
        assert_eq!(report.view_depth.map(|seen| seen.nearest_m), Some(0.0));
        assert!(report.recommended_view.is_some_and(|view| view.nearest_m > 0.0));
    }
}
