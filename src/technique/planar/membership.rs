//! Which triangles lie on a plane: they receive its shadow and are no casters of it. Decided per triangle, so that the
//! floor of a room is found in a mesh that also holds its walls.

use super::ShadowPlane;
use crate::scene::Scene;
use std::ops::Range;

/// What counts as flat, relative to the scene's extent: well above f32 rounding of a tilted plane's vertices, well below
/// anything a picture shows.
const RELATIVE_TOLERANCE: f64 = 1e-5;

/// The planes of a technique and the triangles on them.
#[derive(Debug)]
pub(super) struct Membership {
    /// Per triangle the index of the first plane it lies on.
    pub(super) plane_of: Vec<Option<usize>>,
    /// Largest distance of a corner, metres.
    pub(super) tolerance_m: f64,
}

impl Membership {
    pub(super) fn new(scene: &Scene, planes: &[ShadowPlane], tolerance_m: Option<f64>) -> Self {
        let tolerance_m = tolerance_m.unwrap_or(RELATIVE_TOLERANCE * scene.extent_m());
        let plane_of = |triangle| planes.iter().position(|plane| distance_m(scene, plane, triangle) <= tolerance_m);
        Self { plane_of: (0..scene.triangles.len() as u32).map(plane_of).collect(), tolerance_m }
    }

    /// Whether a triangle lies on a plane, whatever others it lies on.
    pub(super) fn lies_on(&self, scene: &Scene, plane: &ShadowPlane, triangle: u32) -> bool {
        distance_m(scene, plane, triangle) <= self.tolerance_m
    }

    /// The casters of a plane as ranges of triangle ids: what casts, but not the plane itself.
    pub(super) fn casters(&self, scene: &Scene, plane: &ShadowPlane) -> Vec<Range<u32>> {
        let casts = scene.meshes.iter().flat_map(|mesh| mesh.triangles.clone().map(|triangle| (triangle, mesh.casts)));
        let is_caster = casts.map(|(triangle, casts)| casts && !self.lies_on(scene, plane, triangle));
        runs(is_caster).into_iter().filter(|(_, is_caster)| *is_caster).map(|(range, _)| range).collect()
    }

    /// How many receiving triangles lie on a plane of that index.
    pub(super) fn receiver_count(&self, scene: &Scene, plane: usize) -> usize {
        let receiving = scene.meshes.iter().filter(|mesh| mesh.receives).flat_map(|mesh| mesh.triangles.clone());
        receiving.filter(|triangle| self.plane_of[*triangle as usize] == Some(plane)).count()
    }
}

/// Largest distance of a triangle's corners from a plane, metres.
pub(super) fn distance_m(scene: &Scene, plane: &ShadowPlane, triangle: u32) -> f64 {
    scene.triangle_in_world(triangle).map(|corner| plane.height_m(corner).abs()).into_iter().fold(0.0, f64::max)
}

/// Neighbouring equal values, one per triangle id from 0, as ranges of ids.
pub(super) fn runs<T: PartialEq>(values: impl Iterator<Item = T>) -> Vec<(Range<u32>, T)> {
    let mut runs: Vec<(Range<u32>, T)> = Vec::new();
    for (id, value) in (0..).zip(values) {
        match runs.last_mut() {
            Some((range, last)) if *last == value => range.end = id + 1,
            _ => runs.push((id..id + 1, value)),
        }
    }
    runs
}

#[cfg(test)]
mod tests {
    use super::runs;

    #[test]
    fn neighbours_of_one_value_are_one_run() {
        let values = [None, None, Some(1), Some(2), Some(2), None];
        assert_eq!(runs(values.into_iter()), vec![(0..2, None), (2..3, Some(1)), (3..5, Some(2)), (5..6, None)]);
        assert!(runs(std::iter::empty::<u32>()).is_empty());
    }
}
