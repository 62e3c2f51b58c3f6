//! Which open edge is to blame where an open mesh casts one-sided and too little.

use super::casting::{CastingObject, OpenEdge};
use super::prepared::PreparedVolume;
use crate::receiver::Receiver;
use glam::DVec3;

impl PreparedVolume<'_> {
    /// The ends of an edge, rebased world.
    pub(super) fn ends_of(&self, edge: OpenEdge) -> [DVec3; 2] {
        edge.ends.map(|welded| self.volumes.position(super::assembly::near(welded)).truncate())
    }

    /// The open object that a receiver's shadow ray crosses through triangles that do not cast, and through none that
    /// does, with the open edge nearest to the first crossing.
    pub(super) fn hole_before(&self, receiver: &Receiver) -> Option<(&CastingObject, OpenEdge)> {
        let crossed = self.counter.all_crossed(receiver.point_in_world, Some(receiver.triangle));
        let mesh_of = |triangle: u32| self.job.scene.meshes.iter().position(|mesh| mesh.triangles.contains(&triangle));
        let object = |(triangle, _): &(u32, DVec3)| {
            let mesh = mesh_of(*triangle)?;
            self.volumes.objects.iter().find(|object| object.mesh == mesh)
        };
        let casts = |hit: &(u32, DVec3)| object(hit).is_some_and(|object| object.used.contains(&hit.0));
        if crossed.iter().any(casts) {
            return None;
        }
        let (object, point) = crossed.iter().find_map(|hit| Some((object(hit)?, hit.1)))?;
        let distance = |edge: &OpenEdge| distance_to_segment(point, self.ends_of(*edge));
        let nearest = object.open_edges.iter().min_by(|one, other| distance(one).total_cmp(&distance(other)))?;
        object.is_open_and_one_sided().then_some((object, *nearest))
    }
}

fn distance_to_segment(point: DVec3, [from, to]: [DVec3; 2]) -> f64 {
    let along = to - from;
    let share = ((point - from).dot(along) / along.length_squared()).clamp(0.0, 1.0);
    point.distance(from + share * along)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_to_the_segment_and_not_to_its_line() {
        let segment = [DVec3::ZERO, DVec3::X];
        assert_eq!(distance_to_segment(DVec3::new(0.5, 2.0, 0.0), segment), 2.0);
        assert_eq!(distance_to_segment(DVec3::new(4.0, 4.0, 0.0), segment), 5.0);
    }
}
