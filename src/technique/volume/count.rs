//! The integer truth of a stencil: in how many volumes a point lies, which is how many casting triangles the segment to
//! the light crosses.

use super::extrude::{Reach, reaches};
use super::states::Side;
use super::volumes::Volumes;
use crate::cast::{Casters, Hit};
use crate::inspect::Adjacency;
use crate::scene::{Light, Scene};
use glam::DVec3;

/// Two crossings this close along a segment, of triangles that touch, are one place: an edge or a corner, which both
/// triangles hold.
const SAME_PLACE: f64 = 1e-12;

/// How many volumes hold a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Count {
    /// If volumes had no end.
    pub(super) endless: i64,
    /// Within their reach, those counted behind the surface.
    pub(super) behind: i64,
    /// Within their reach, those counted before it.
    pub(super) before: i64,
    /// True if the segment runs through an edge or a corner, where a volume's side begins and the count is a matter of
    /// the last bit.
    pub(super) is_tied: bool,
}

impl Count {
    /// Within their reach.
    pub(super) fn reached(&self) -> i64 {
        self.behind + self.before
    }
}

/// Counts for points of one scene and light.
pub(super) struct Counter<'s> {
    scene: &'s Scene,
    light: &'s Light,
    casters: &'s Casters,
    adjacency: &'s Adjacency,
    reach: Reach,
    scene_centre: DVec3,
    scene_radius_m: f64,
    /// Per triangle id as hits carry it: how many triangles in use lie in its place, counted behind and before.
    used: Vec<[i64; 2]>,
}

impl<'s> Counter<'s> {
    pub(super) fn new(
        scene: &'s Scene,
        light: &'s Light,
        casters: &'s Casters,
        adjacency: &'s Adjacency,
        volumes: &Volumes,
    ) -> Self {
        let mut used = vec![[0, 0]; scene.triangles.len()];
        for (object, side) in volumes.objects.iter().zip(&volumes.sides) {
            for &triangle in &object.used {
                used[casters.surface_of(triangle) as usize][usize::from(*side == Side::Before)] += 1;
            }
        }
        let bounds = scene.bounds();
        let (scene_centre, scene_radius_m) = (bounds.centre(), bounds.radius());
        Self { scene, light, casters, adjacency, reach: volumes.reach, scene_centre, scene_radius_m, used }
    }

    /// The count at a point. A point on a surface names its triangle, which then does not count: eye and light are on
    /// the same side of it at every pixel that is asked.
    pub(super) fn at(&self, point_in_world: DVec3, own: Option<u32>) -> Count {
        let mut count = Count::default();
        let mut place: Option<(Hit, [i64; 2])> = None;
        for hit in self.crossings(point_in_world, own) {
            let used = self.used[hit.triangle as usize];
            // An edge or a corner belongs to every triangle around it and is crossed once.
            let same = place.filter(|(last, _)| {
                hit.t - last.t <= SAME_PLACE && self.adjacency.shares_vertex(hit.triangle, last.triangle)
            });
            count.is_tied |= same.is_some();
            let counted = same.map_or([0, 0], |(_, counted)| counted);
            let now = [counted[0].max(used[0]), counted[1].max(used[1])];
            let [behind, before] = [now[0] - counted[0], now[1] - counted[1]];
            place = Some((hit, now));
            count.endless += behind + before;
            let corners = self.scene.triangle_in_world(hit.triangle);
            if reaches(corners, self.light.homogeneous(), self.reach, point_in_world) {
                count.behind += behind;
                count.before += before;
            }
        }
        count
    }

    /// Casting triangles between a point and the light, used or not, from the point on.
    fn crossings(&self, point_in_world: DVec3, own: Option<u32>) -> Vec<Hit> {
        // A directional light's segment is as long as its radius says; a point may lie far outside the scene.
        let radius_m = self.scene_radius_m.max(point_in_world.distance(self.scene_centre));
        let mut hits = Vec::new();
        self.casters.all_hits(&self.light.segment_from(point_in_world, radius_m), own, &mut hits);
        hits
    }

    /// Casting triangles in use between a point and the light, from the point on.
    pub(super) fn crossed(&self, point_in_world: DVec3, own: Option<u32>) -> Vec<u32> {
        let ids = self.crossings(point_in_world, own).into_iter().map(|hit| hit.triangle);
        ids.filter(|&triangle| self.used[triangle as usize] != [0, 0]).collect()
    }
}
