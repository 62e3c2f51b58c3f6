//! The integer truth of a stencil: in how many volumes a point lies, which is how many casting triangles the segment to
//! the light crosses.

use super::extrude::{Reach, reaches};
use super::states::Side;
use super::volumes::Volumes;
use crate::cast::{Casters, Hit};
use crate::inspect::Adjacency;
use crate::scene::{Light, Scene, Segment};
use glam::DVec3;
use robust::{Coord3D, orient3d};

/// Two crossings of triangles that touch, on the boundary of each and this close along the segment, are one place: an
/// edge or a corner that both triangles hold.
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
    /// Radius of the scene's bounds, metres.
    pub(super) scene_radius_m: f64,
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
        let segment = self.segment_from(point_in_world);
        for hit in self.crossings(&segment, own) {
            let used = self.used[hit.triangle as usize];
            // An edge or a corner belongs to every triangle around it and is crossed once.
            let same = place.filter(|(last, _)| {
                hit.t - last.t <= SAME_PLACE
                    && self.adjacency.shares_vertex(hit.triangle, last.triangle)
                    && [hit, *last].iter().all(|hit| self.is_on_boundary(&segment, hit.triangle))
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

    /// Casting triangles in use between a point and the light, from the point on.
    pub(super) fn crossed(&self, point_in_world: DVec3, own: Option<u32>) -> Vec<u32> {
        let ids = self.crossings(&self.segment_from(point_in_world), own).into_iter().map(|hit| hit.triangle);
        ids.filter(|&triangle| self.used[triangle as usize] != [0, 0]).collect()
    }

    /// Triangles, used or not, that the segment to the light crosses, with the points.
    pub(super) fn all_crossed(&self, point_in_world: DVec3, own: Option<u32>) -> Vec<(u32, DVec3)> {
        let segment = self.segment_from(point_in_world);
        let at = |hit: Hit| (hit.triangle, segment.from.lerp(segment.to, hit.t));
        self.crossings(&segment, own).into_iter().map(at).collect()
    }

    /// A directional light's segment is as long as its radius says, and a point may lie far outside the scene.
    fn segment_from(&self, point_in_world: DVec3) -> Segment {
        let radius_m = self.scene_radius_m.max(point_in_world.distance(self.scene_centre));
        self.light.segment_from(point_in_world, radius_m)
    }

    /// Casting triangles that a segment crosses, used or not, from its start on.
    fn crossings(&self, segment: &Segment, own: Option<u32>) -> Vec<Hit> {
        let mut hits = Vec::new();
        self.casters.all_hits(segment, own, &mut hits);
        hits
    }

    /// Whether a segment that crosses a triangle runs exactly through its edges.
    fn is_on_boundary(&self, segment: &Segment, triangle: u32) -> bool {
        let [a, b, c] = self.scene.triangle_in_world(triangle);
        let side = |from: DVec3, to: DVec3| {
            let [p, q, from, to] = [segment.from, segment.to, from, to].map(|v| Coord3D { x: v.x, y: v.y, z: v.z });
            orient3d(p, q, from, to)
        };
        [side(a, b), side(b, c), side(c, a)].contains(&0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inspect::fixtures::{Shape, cube, scene_of};
    use crate::inspect::neighbours;
    use crate::scene::LightKind;
    use crate::technique::Spec;
    use crate::technique::volume::eye::Eye;
    use crate::technique::volume::settings::Settings;
    use glam::Vec3;

    fn count(shapes: &[Shape], typed: &str, light: Vec3, point: DVec3) -> Count {
        let mut scene = scene_of(shapes);
        scene.lights[0].kind = LightKind::Point { position: light, aim: Vec3::ZERO, attenuation: [1.0, 0.0, 0.0] };
        let settings = Settings::of(&Spec::parse(typed).unwrap());
        let eye = Eye::new(&scene, &settings).unwrap();
        let volumes = Volumes::new(&scene, &scene.lights[0], &settings, &eye);
        let (casters, adjacency) = (Casters::new(&scene), neighbours(&scene));
        Counter::new(&scene, &scene.lights[0], &casters, &adjacency, &volumes).at(point, None)
    }

    const ABOVE: Vec3 = Vec3::new(0.3, 5.0, 0.4);
    const BELOW: DVec3 = DVec3::new(0.3, -5.0, 0.4);

    #[test]
    fn a_closed_object_counts_once_or_twice_and_the_same_twice_again() {
        let one = [cube(DVec3::ZERO)];
        assert_eq!(count(&one, "volume", ABOVE, BELOW).endless, 1);
        assert_eq!(count(&one, "volume:caster_sides=all", ABOVE, BELOW).endless, 2);
        let coinciding = [cube(DVec3::ZERO), cube(DVec3::ZERO)];
        assert_eq!(count(&coinciding, "volume", ABOVE, BELOW).endless, 2);
    }

    #[test]
    fn a_diagonal_is_crossed_once_and_said_to_be_a_tie() {
        // The top's diagonal runs from (0, 1, 0) to (1, 1, 1).
        let (light, point) = (Vec3::new(0.5, 5.0, 0.5), DVec3::new(0.5, -5.0, 0.5));
        let through = count(&[cube(DVec3::ZERO)], "volume", light, point);
        assert_eq!((through.endless, through.is_tied), (1, true));
        assert!(!count(&[cube(DVec3::ZERO)], "volume", ABOVE, BELOW).is_tied);
    }

    #[test]
    fn triangles_that_overlap_in_one_plane_are_no_tie() {
        let shape = Shape {
            positions: vec![DVec3::ZERO, DVec3::Z, DVec3::X, DVec3::new(0.0, 0.0, 2.0), DVec3::X * 2.0],
            triangles: vec![[0, 1, 2], [0, 3, 4]],
        };
        let inside_both = count(&[shape], "volume", Vec3::new(0.2, 5.0, 0.3), DVec3::new(0.2, -5.0, 0.3));
        assert_eq!((inside_both.endless, inside_both.is_tied), (2, false));
    }

    #[test]
    fn a_finite_volume_ends() {
        let reached = |length: &str, point: DVec3| {
            let typed = format!("volume:extrusion=finite,length_m={length}");
            count(&[cube(DVec3::ZERO)], &typed, ABOVE, point).reached()
        };
        assert_eq!(reached("7", BELOW), 1);
        assert_eq!(reached("5", BELOW), 0);
    }
}
