//! The exact ray core: whether, and where, an open segment meets the casting triangles of a scene. It serves the truth
//! and every replay of a technique, so it knows no epsilon: each verdict is the sign of exact determinants.
//!
//! A triangle *blocks* a segment p → q iff p and q lie strictly on opposite sides of its plane and the line through
//! them passes inside it, edges and vertices included. A blocker at exactly p or q is a miss. Neighbouring triangles
//! see the same signs at the edge they share, so closed meshes do not leak.
//!
//! Exactness is cheap because it is rarely needed. `ray` bounds the rounding error of Woop's f64 test once per ray,
//! `packed` decides all but the doubtful triangles with it, and for the rest `exact` has Shewchuk's predicates
//! ("Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates", 1997). `tree` finds
//! the triangles, `weld` makes coinciding ones one, and [`brute`] is the slow twin that checks it all.

pub mod brute;
mod exact;
mod occlusion;
mod packed;
mod ray;
#[cfg(test)]
pub(crate) mod testing;
#[cfg(test)]
mod tests;
mod tree;
mod weld;

pub use occlusion::Occlusion;

#[cfg(test)]
use crate::scene; // where `testing` looks for it, which the integration tests compile too
use crate::scene::{Bounds, Scene, Segment};
use glam::Vec3;
use packed::{Crossing, PackedTriangle};
use ray::Ray;
use std::ops::ControlFlow;
use tree::Tree;

/// A triangle that a segment crosses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Its id; of coinciding triangles the lowest that casts.
    pub triangle: u32,
    /// Where along the segment, 0..=1. Rounded, unlike the verdict that there is a crossing.
    pub t: f64,
}

impl Hit {
    /// The order of hits: along the segment, then by id.
    fn order(&self, other: &Self) -> std::cmp::Ordering {
        self.t.total_cmp(&other.t).then(self.triangle.cmp(&other.triangle))
    }
}

/// The casting triangles of a scene, ready for rays. All coordinates are in the scene's rebased world, metres.
#[derive(Debug)]
pub struct Casters {
    tree: Tree,
    /// In the order of the tree's leaves; coinciding triangles only once.
    triangles: Vec<PackedTriangle>,
    /// Per triangle of the scene the id that stands for all triangles in its place.
    surface_of: Vec<u32>,
    /// Per triangle of the scene its corners.
    corners_of: Vec<[Vec3; 3]>,
    bounds: Bounds,
    triangle_count: usize,
    content_hash: u64,
}

impl Casters {
    /// Prepares the casting triangles of `scene`. A scene without any is fine: nothing is ever hit.
    #[must_use]
    pub fn new(scene: &Scene) -> Self {
        let surface_of = weld::surface_of_triangles(scene);
        let corners_of: Vec<_> = (0..scene.triangles.len() as u32).map(|t| weld::corners(scene, t)).collect();
        let unique: Vec<u32> = scene.casting_triangles().filter(|&t| surface_of[t as usize] == t).collect();
        let unique_corners: Vec<_> = unique.iter().map(|&t| corners_of[t as usize]).collect();
        let (tree, order) = Tree::build(&unique_corners);
        let packed = |i: u32| PackedTriangle::new(unique[i as usize], unique_corners[i as usize]);
        Self {
            tree,
            triangles: order.into_iter().map(packed).collect(),
            surface_of,
            corners_of,
            bounds: scene.bounds_of(|mesh| mesh.casts),
            triangle_count: scene.casting_triangles().count(),
            content_hash: content_hash(scene),
        }
    }

    /// Some triangle that blocks `segment`. The `own` triangle and those in its place are left out, by id.
    #[must_use]
    pub fn any_hit(&self, segment: &Segment, own: Option<u32>) -> Option<u32> {
        let mut found = None;
        self.each_hit(segment, own, |triangle, _| {
            found = Some(triangle.id);
            ControlFlow::Break(())
        });
        found
    }

    /// The first blocker of `segment` from its start; of several at the same `t` the one with the lowest id.
    #[must_use]
    pub fn nearest_hit(&self, segment: &Segment, own: Option<u32>) -> Option<Hit> {
        let mut nearest: Option<Hit> = None;
        self.each_hit(segment, own, |triangle, limit| {
            let hit = Hit { triangle: triangle.id, t: exact::parameter(segment, &triangle.corners()) };
            if nearest.is_none_or(|known| hit.order(&known).is_lt()) {
                nearest = Some(hit);
                *limit = hit.t;
            }
            ControlFlow::Continue(())
        });
        nearest
    }

    /// Every blocker of `segment`, in order along it, written over what `hits` held. Coinciding triangles count once.
    pub fn all_hits(&self, segment: &Segment, own: Option<u32>, hits: &mut Vec<Hit>) {
        hits.clear();
        self.each_hit(segment, own, |triangle, _| {
            hits.push(Hit { triangle: triangle.id, t: exact::parameter(segment, &triangle.corners()) });
            ControlFlow::Continue(())
        });
        hits.sort_by(Hit::order);
    }

    /// Whether two triangles of the scene have the same three positions, in any order (−0 equals +0).
    #[must_use]
    pub fn same_surface(&self, a: u32, b: u32) -> bool {
        self.surface_of[a as usize] == self.surface_of[b as usize]
    }

    /// The id that stands for all triangles in the place of one: the id that hits carry.
    #[must_use]
    pub fn surface_of(&self, triangle: u32) -> u32 {
        self.surface_of[triangle as usize]
    }

    /// How many triangles cast, coinciding ones counted each. With [`Self::bounds`] and [`Self::content_hash`] another
    /// oracle proves that it was given the same casters.
    #[must_use]
    pub fn triangle_count(&self) -> usize {
        self.triangle_count
    }

    /// Box of the casting triangles, metres; a point at the origin if there are none.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// FNV-1a (64 bit) over the corner coordinates of all casting triangles in id order: x, y, z of each corner as
    /// little-endian f32, −0 written as +0.
    #[must_use]
    pub fn content_hash(&self) -> u64 {
        self.content_hash
    }

    /// Calls `on_hit` with every blocker that the tree finds up to the limit, which starts at 1 and which `on_hit`
    /// may lower.
    fn each_hit(
        &self,
        segment: &Segment,
        own: Option<u32>,
        mut on_hit: impl FnMut(&PackedTriangle, &mut f64) -> ControlFlow<()>,
    ) {
        let Some(ray) = Ray::new(segment, &self.bounds, 0.0) else { return };
        self.each_candidate(&ray, own, |triangle, limit| match triangle.crossing(&ray) {
            Crossing::Crossed => on_hit(triangle, limit),
            Crossing::Unsure { .. } if exact::crosses(segment, &triangle.corners()) => on_hit(triangle, limit),
            Crossing::Unsure { .. } | Crossing::Missed => ControlFlow::Continue(()),
        });
    }

    /// Calls `visit` with every triangle but the own whose leaf the ray enters before the limit.
    #[inline]
    fn each_candidate(
        &self,
        ray: &Ray,
        own: Option<u32>,
        mut visit: impl FnMut(&PackedTriangle, &mut f64) -> ControlFlow<()>,
    ) {
        let own_surface = own.map_or(NO_TRIANGLE, |own| self.surface_of[own as usize]);
        self.tree.walk(ray, |leaf, limit| {
            let mut others = self.triangles[leaf].iter().filter(|triangle| triangle.id != own_surface);
            others.try_for_each(|triangle| visit(triangle, limit))
        });
    }
}

/// Stands for "no own triangle"; scenes have fewer than 2³² − 1 triangles.
const NO_TRIANGLE: u32 = u32::MAX;

/// FNV-1a (Fowler, Noll, Vo) over the casting triangles' corners.
fn content_hash(scene: &Scene) -> u64 {
    const OFFSET_BASIS: u64 = 0xcbf2_9ce4_8422_2325;
    const PRIME: u64 = 0x0000_0100_0000_01b3;
    let coordinates =
        scene.casting_triangles().flat_map(|t| weld::corners(scene, t)).flat_map(|corner| corner.to_array());
    coordinates
        .flat_map(|x| weld::without_negative_zero(x).to_le_bytes())
        .fold(OFFSET_BASIS, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(PRIME))
}
