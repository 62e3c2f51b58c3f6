//! Which points of the casters a view shows, and at which depth: by the side they show, by the near and far plane, and by
//! what becomes of the corners of their triangles.

use super::lookup::Lookup;
use super::projection::Pancaked;
use super::settings::{CasterSides, NearMode};
use crate::scene::Scene;
use glam::DVec3;

impl Lookup {
    /// Whether casters are drawn with that side towards the light.
    #[must_use]
    pub fn draws_side(&self, scene: &Scene, triangle: u32) -> bool {
        self.draws_facing(scene.facing(triangle, self.light))
    }

    /// The same for a side by which way it faces: positive towards the light.
    pub(super) fn draws_facing(&self, facing: f64) -> bool {
        match self.caster_sides {
            CasterSides::All => true,
            CasterSides::LightFacing => facing > 0.0,
            CasterSides::AwayFacing => facing < 0.0,
        }
    }

    /// The depth of a caster's point in a view if its triangle keeps its plane, not yet clamped to 0..=1; `None` if it is
    /// not drawn.
    #[must_use]
    pub fn drawn_depth(&self, view: usize, point_in_world: DVec3) -> Option<f64> {
        let at = self.views[view].project(point_in_world);
        (at.q > 0.0 && self.draws_depth(view, at.depth)).then_some(at.depth)
    }

    /// The same on the plane that the rasteriser gives the triangle.
    #[must_use]
    pub fn rasterised_depth(&self, view: usize, corners_in_world: [DVec3; 3], point_in_world: DVec3) -> Option<f64> {
        let Some(pancaked) = self.pancaked(view, corners_in_world) else {
            return self.drawn_depth(view, point_in_world);
        };
        let at = pancaked.site(&self.views[view], point_in_world).at;
        (at.q > 0.0 && self.draws_depth(view, at.depth)).then_some(at.depth)
    }

    /// Whether casters of that depth are drawn: in the range, or clamped to it.
    pub(super) fn draws_depth(&self, view: usize, depth: f64) -> bool {
        let view = &self.views[view];
        match self.near_mode {
            NearMode::Extend => (0.0..=1.0).contains(&depth),
            NearMode::DepthClamp | NearMode::FragmentClamp => true,
            NearMode::VertexClamp => !view.is_nearer(view.cleared(), depth),
        }
    }

    /// Whether corners before the near plane are moved to it.
    pub(super) fn moves_corners(&self) -> bool {
        self.near_mode == NearMode::VertexClamp
    }

    /// A triangle that this bends.
    pub(super) fn pancaked(&self, view: usize, corners_in_world: [DVec3; 3]) -> Option<Pancaked> {
        if self.moves_corners() { Pancaked::of(&self.views[view], corners_in_world) } else { None }
    }
}
