//! One view of a map: how world points get into one layer of its texture.
//!
//! Whatever the projection, a view is five rows, rounded once to f32 and from then on shared by the GPU and its f64 twin:
//! u, v and depth are quotients of them. Depth has a divisor of its own, so that a warp of u and v need not warp depth.
//! A [`Layout`] says how the rows are read. Formulas: docs/map.md#matrices.

use super::drawn::Drawn;
use super::site::Site;
use crate::scene::{Bounds, Segment};
use bytemuck::{Pod, Zeroable};
use glam::{DMat4, DVec2, DVec3, DVec4, IVec2, Mat4, UVec2, Vec4};
use std::sync::Arc;

/// How the rows of a view are read.
pub trait Layout: std::fmt::Debug + Sync {
    /// Where a world point lies; the f64 twin of `project` in its WGSL file.
    fn project(&self, rows: &Rows, point_in_world: DVec3) -> InMap;
    /// How u, v and depth change around a point that lies at `at`; the f64 twin of `gradients`.
    fn gradients(&self, rows: &Rows, point_in_world: DVec3, at: &InMap) -> Gradients;
    /// The world point that `uv` looks at, beside a point that lies at `at`; the f64 twin of `point_beside`.
    fn point_beside(&self, rows: &Rows, point_in_world: DVec3, at: &InMap, uv: DVec2) -> DVec3;
    /// All world points within `bounds` that lie at `uv`, nearest to the light first; `None` where there are none.
    fn ray_through(&self, rows: &Rows, uv: DVec2, bounds: &Bounds, depth_sign: f64) -> Option<Segment>;
    /// By how much rounding, and drawing in straight pieces, can move the depths of a plane through a site against each
    /// other, beyond its slope; the f64 twin of `slack`. `reach_texels`: how far away the texel is that is read.
    fn slack(&self, site: &Site<'_>, normal_in_world: DVec3, slope_per_texel: DVec2, reach_texels: DVec2) -> f64;
    /// How fast depth bends along u and along v on a plane, per texel; 0 where it does not, or only its slope is known.
    fn bend_per_texel(&self, _site: &Site<'_>, _normal_in_world: DVec3) -> DVec2 {
        DVec2::ZERO
    }
    /// The texel of the view that is nearest to one which may lie beyond its side; the f64 twin of `nearest_texel`.
    fn nearest_texel(&self, texel: IVec2, texels: UVec2) -> IVec2;
}

/// The rows of a view, each a linear function of a homogeneous world point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rows {
    /// u × q.
    pub u: Vec4,
    /// v × q.
    pub v: Vec4,
    /// q, positive where the view looks.
    pub q: Vec4,
    /// depth × its divisor.
    pub depth: Vec4,
    /// The divisor of depth.
    pub depth_q: Vec4,
}

/// Where a world point lies in a view.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InMap {
    /// Map coordinates, v down; inside the view in 0..1.
    pub uv: DVec2,
    /// Depth; inside the view in 0..=1.
    pub depth: f64,
    /// Not positive where the view does not look.
    pub q: f64,
}

/// How map coordinates change with the world position, per metre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gradients {
    /// Of u.
    pub u: DVec3,
    /// Of v.
    pub v: DVec3,
    /// Of depth.
    pub depth: DVec3,
}

/// One view of a map, one layer of its texture.
#[derive(Debug, Clone)]
pub struct View {
    /// What people call it.
    pub name: String,
    /// Its cross-section, for people.
    pub window: String,
    /// Its near and far plane, for people.
    pub near_far: String,
    /// How its rows are read.
    pub layout: &'static dyn Layout,
    /// Map coordinates.
    pub rows: Rows,
    /// World to wgpu clip space, for the rasteriser.
    pub clip_from_world: Mat4,
    /// What the projection selects views by; each projection says what it holds.
    pub selector: Vec4,
    /// How fast it is blended in before the projection would select it, per metre; 0 where it is not.
    pub blend_per_m: f32,
    /// +1 where depth grows away from the light, −1 where it shrinks.
    pub depth_sign: f64,
    /// Width and height in texels, the same for every view of a map.
    pub texels: UVec2,
    /// What is drawn in place of the casters, where the layout bends their edges and the rasteriser does not.
    pub(in crate::technique::map) drawn: Option<Arc<Drawn>>,
}

/// The map's coordinates from clip space: the one place where v is flipped.
const MAP_FROM_CLIP: DMat4 = DMat4::from_cols(
    DVec4::new(0.5, 0.0, 0.0, 0.0),
    DVec4::new(0.0, -0.5, 0.0, 0.0),
    DVec4::new(0.0, 0.0, 1.0, 0.0),
    DVec4::new(0.5, 0.5, 0.0, 1.0),
);

impl Rows {
    /// Of a projection to clip space, computed in f64 and rounded here.
    #[must_use]
    pub fn of_clip(clip_from_world: &DMat4) -> Self {
        let map_from_world = MAP_FROM_CLIP * *clip_from_world;
        let row = |i: usize| map_from_world.row(i).as_vec4();
        Self { u: row(0), v: row(1), q: row(3), depth: row(2), depth_q: row(3) }
    }
}

/// A rounded row applied to a point, in f64.
pub(super) fn apply(row: Vec4, point_in_world: DVec3) -> f64 {
    row.as_dvec4().dot(point_in_world.extend(1.0))
}

impl View {
    /// The same view with another projection to clip space, computed in f64 and rounded here.
    #[must_use]
    pub fn of_clip(view: Self, clip_from_world: &DMat4, depth_sign: f64) -> Self {
        Self { rows: Rows::of_clip(clip_from_world), clip_from_world: clip_from_world.as_mat4(), depth_sign, ..view }
    }

    /// Where a world point lies.
    #[must_use]
    pub fn project(&self, point_in_world: DVec3) -> InMap {
        self.layout.project(&self.rows, point_in_world)
    }

    /// A world point with what is around it.
    #[must_use]
    pub fn site(&self, point_in_world: DVec3) -> Site<'_> {
        let at = self.project(point_in_world);
        Site { view: self, point_in_world, at, gradients: self.layout.gradients(&self.rows, point_in_world, &at) }
    }

    /// What is stored where nothing casts: the depth farthest from the light.
    #[must_use]
    pub fn cleared(&self) -> f64 {
        if self.depth_sign > 0.0 { 1.0 } else { 0.0 }
    }

    /// Whether depth `a` is nearer to the light than `b`.
    #[must_use]
    pub fn is_nearer(&self, a: f64, b: f64) -> bool {
        self.depth_sign * (a - b) < 0.0
    }

    /// Whether a texel belongs to the view, which need not fill its square.
    #[must_use]
    pub fn holds(&self, texel: IVec2) -> bool {
        self.layout.nearest_texel(texel, self.texels) == texel
    }

    /// Largest angle that a drawn edge spans as seen from the light, radians; 0 where edges are drawn as they are.
    #[must_use]
    pub fn edge_rad(&self) -> f64 {
        self.drawn.as_ref().map_or(0.0, |drawn| drawn.longest_rad)
    }

    /// All world points within `bounds` that a map position looks along.
    #[must_use]
    pub fn ray_through(&self, position_in_texels: DVec2, bounds: &Bounds) -> Option<Segment> {
        let uv = position_in_texels / self.texels.as_dvec2();
        self.layout.ray_through(&self.rows, uv, bounds, self.depth_sign)
    }

    /// +1 where the rasteriser sees a triangle counter-clockwise whose normal, by its winding, faces the light; else −1.
    #[must_use]
    pub fn winding(&self, light: DVec4) -> f64 {
        // The three rows without depth vanish together at the light only; the sign of the common factor is the winding.
        let clip = self.clip_from_world.as_dmat4();
        let [x, y, w] = [clip.row(0), clip.row(1), clip.row(3)];
        let minor = |i: usize| {
            let keep = |row: DVec4| {
                let kept: Vec<f64> = (0..4).filter(|column| *column != i).map(|column| row[column]).collect();
                DVec3::new(kept[0], kept[1], kept[2])
            };
            keep(x).dot(keep(y).cross(keep(w)))
        };
        let vanishing = DVec4::new(minor(0), -minor(1), minor(2), -minor(3));
        vanishing.dot(light).signum()
    }

    /// World to (u q, v q, depth q, q), for layouts whose depth has no divisor of its own.
    #[must_use]
    pub fn map_from_world(&self) -> Mat4 {
        let Rows { u, v, q, depth, .. } = self.rows;
        Mat4::from_cols(u, v, depth, q).transpose()
    }

    /// As the shaders read it.
    pub(in crate::technique) fn gpu(&self) -> GpuView {
        let Rows { u, v, q, depth, depth_q } = self.rows;
        let (edge_rad, padding) = (self.edge_rad() as f32, 0);
        let [u_row, v_row, q_row, depth_row, depth_q_row] = [u, v, q, depth, depth_q].map(|row| row.to_array());
        let selector = self.selector.to_array();
        let (depth_sign, blend_per_m) = (self.depth_sign as f32, self.blend_per_m);
        GpuView { u_row, v_row, q_row, depth_row, depth_q_row, selector, depth_sign, blend_per_m, edge_rad, padding }
    }
}

/// `View` of `shaders/map/view.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(in crate::technique) struct GpuView {
    pub(in crate::technique) u_row: [f32; 4],
    pub(in crate::technique) v_row: [f32; 4],
    pub(in crate::technique) q_row: [f32; 4],
    pub(in crate::technique) depth_row: [f32; 4],
    pub(in crate::technique) depth_q_row: [f32; 4],
    pub(in crate::technique) selector: [f32; 4],
    pub(in crate::technique) depth_sign: f32,
    pub(in crate::technique) blend_per_m: f32,
    pub(in crate::technique) edge_rad: f32,
    pub(in crate::technique) padding: u32,
}
