//! The volumes as lines and faces, for pictures of them.

use super::assembly::Plan;
use super::prepared::PreparedVolume;
use super::silhouette::SilhouetteEdge;
use crate::inspect::weld;
use glam::{DVec3, DVec4};

impl PreparedVolume<'_> {
    /// The silhouette edges as the light sees them, rebased world.
    #[must_use]
    pub fn silhouettes(&self) -> Vec<[DVec3; 2]> {
        let scene = self.job.scene;
        let positions = weld(&scene.positions).positions(&scene.positions);
        let plan = Plan::of(self.job.light, self.volumes.reach, &self.settings);
        let ends = |edge: SilhouetteEdge| [edge.from, edge.to].map(|index| positions[index as usize]);
        self.volumes.objects.iter().flat_map(|object| plan.edges(object)).map(ends).collect()
    }

    /// The volumes' sides as triangles, wound outward; homogeneous, rebased world.
    pub fn sides(&self) -> impl Iterator<Item = [DVec4; 3]> {
        let lists = [&self.volumes.behind, &self.volumes.before].into_iter();
        let corners = lists.flat_map(|faces| faces.sides.as_chunks::<3>().0);
        corners.map(|corners| corners.map(|corner| self.volumes.position(corner)))
    }

    /// Where a point of the casters is extruded to; homogeneous, rebased world.
    #[must_use]
    pub fn extruded(&self, point_in_world: DVec3) -> DVec4 {
        super::extrude::extrude(point_in_world.as_vec3(), self.job.light.homogeneous(), self.volumes.reach).as_dvec4()
    }
}
