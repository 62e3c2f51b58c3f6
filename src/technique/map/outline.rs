//! What a silhouette map has besides depths: one point of the true outline per cell of the grid between texel centres.
//! A receiver is answered by that corner of its cell on whose side of the outline it lies.
//!
//! P. Sen, M. Cammarano, P. Hanrahan, "Shadow Silhouette Maps", 2003. `shaders/silhouette/` has the twins.

use super::projection::View;
use crate::gpu::shader::{Wgsl, wgsl};
use crate::gpu::{Drawing, Gpu, GpuError, Recorder};
use glam::{DVec2, DVec3, IVec2, UVec2, Vec2};
use wgpu::{
    BindGroup, BindingResource, Buffer, BufferUsages, Color, LoadOp, Operations, PrimitiveState, PrimitiveTopology,
    RenderPassColorAttachment, RenderPipeline, StoreOp, Texture, TextureFormat, TextureUsages, TextureView,
};

/// In place of a filter's file.
pub(super) const WEDGES: Wgsl = wgsl!("silhouette/wedges.wgsl");
/// Draws the points.
pub(super) const POINTS: [Wgsl; 3] =
    [wgsl!("map/view.wgsl"), wgsl!("map/homogeneous.wgsl"), wgsl!("silhouette/points.wgsl")];

/// A place within a cell.
const FORMAT: TextureFormat = TextureFormat::Rg32Float;
/// No place within a cell.
const EMPTY: f64 = 2.0;
/// Where cells without a point are cut.
const CENTRE: DVec2 = DVec2::splat(0.5);

/// The points of every cell, read back.
#[derive(Debug, Clone)]
pub(super) struct Points {
    pub(super) cells: UVec2,
    pub(super) points: Vec<Vec2>,
}

/// Least distance from the light at which an edge is cut, relative to its far end.
const NEAREST: f64 = 1e-4;
/// Cells by which an edge may miss one that it is tried in: rounding, and edges along a border, which touch both sides.
const RIM: f64 = 0.001;
/// An edge is hidden if it is farther than all four corners by more than this, in units of depth.
const HIDDEN: f64 = 1e-6;

impl Points {
    /// What the edges leave in the cells of a view whose texels hold `depths` (row by row): the f64 twin of
    /// `shaders/silhouette/points.wgsl`.
    pub(super) fn drawn(edges_in_world: &[[DVec3; 2]], view: &View, depths: &[f64]) -> Self {
        let cells = (view.texels - 1).max(UVec2::ONE);
        let mut drawn = Self { cells, points: vec![Vec2::splat(EMPTY as f32); cells.element_product() as usize] };
        let stored = |texel: UVec2| depths[(texel.y * view.texels.x + texel.x) as usize];
        for [start, end] in edges_in_world.iter().filter_map(|edge| before_the_light(view, *edge)) {
            let [a, b] = [start, end].map(|point| view.project(point));
            let [from, to] = [a, b].map(|at| at.uv * view.texels.as_dvec2() - 0.5);
            let limit = cells.as_dvec2() - 1.0;
            let clamped = |place: DVec2| place.floor().clamp(DVec2::ZERO, limit).as_uvec2();
            let (low, high) = (clamped(from.min(to) - RIM), clamped(from.max(to) + RIM));
            for cell in (low.y..=high.y).flat_map(|y| (low.x..=high.x).map(move |x| UVec2::new(x, y))) {
                let corner = cell.as_dvec2();
                let Some(middle) = middle_in_cell(from, to, corner) else { continue };
                let depth = a.depth + middle * (b.depth - a.depth);
                let corners = [UVec2::ZERO, UVec2::X, UVec2::Y, UVec2::ONE].map(|step| cell + step);
                let is_behind = |texel: &UVec2| view.depth_sign * (depth - stored(*texel)) > HIDDEN;
                if !corners.iter().all(is_behind) {
                    let point = (from.lerp(to, middle) - corner).clamp(DVec2::ZERO, DVec2::ONE);
                    drawn.points[(cell.y * cells.x + cell.x) as usize] = point.as_vec2();
                }
            }
        }
        drawn
    }

    /// The texel that answers for a place in the map: the corner of its cell whose wedge holds it.
    pub(super) fn texel(&self, position_in_texels: DVec2) -> IVec2 {
        let in_cells = position_in_texels - 0.5;
        let cell = in_cells.floor().as_ivec2();
        let own = self.point_of(cell);
        let towards = |step: IVec2| self.point_of(cell + step) + step.as_dvec2() - own;
        let [left, top, right, bottom] = [IVec2::NEG_X, IVec2::NEG_Y, IVec2::X, IVec2::Y].map(towards);
        let place = in_cells - cell.as_dvec2() - own;
        if is_in_wedge(left, top, place) {
            cell
        } else if is_in_wedge(top, right, place) {
            cell + IVec2::X
        } else if is_in_wedge(right, bottom, place) {
            cell + IVec2::ONE
        } else {
            cell + IVec2::Y
        }
    }

    fn point_of(&self, cell: IVec2) -> DVec2 {
        if cell.min_element() < 0 || cell.cmpge(self.cells.as_ivec2()).any() {
            return CENTRE;
        }
        let stored = self.points[(cell.y as u32 * self.cells.x + cell.x as u32) as usize];
        if stored.x > 1.0 { CENTRE } else { stored.as_dvec2() }
    }
}

/// An edge without what lies behind the light or next to it; `None` if that is all of it.
fn before_the_light(view: &View, [near, far]: [DVec3; 2]) -> Option<[DVec3; 2]> {
    let [q_near, q_far] = [near, far].map(|point| view.rows.q.as_dvec4().dot(point.extend(1.0)));
    let least = NEAREST * q_near.max(q_far);
    let start = if q_near < least { near.lerp(far, (least - q_near) / (q_far - q_near)) } else { near };
    let end = if q_far < least { far.lerp(near, (least - q_far) / (q_near - q_far)) } else { far };
    (least > 0.0).then_some([start, end])
}

/// Where along a segment the middle of its part in a closed cell lies; `None` if it has none. The cells on both sides of a
/// border find the same place on it, so that no rounding parts them: those of a segment are 4-connected.
fn middle_in_cell(from: DVec2, to: DVec2, cell: DVec2) -> Option<f64> {
    let along = to - from;
    let (mut first, mut last) = (0.0_f64, 1.0_f64);
    for axis in 0..2 {
        let borders = [cell[axis], cell[axis] + 1.0];
        if along[axis] == 0.0 {
            if !(borders[0]..=borders[1]).contains(&from[axis]) {
                return None;
            }
        } else {
            let [enter, leave] = borders.map(|border| (border - from[axis]) / along[axis]);
            (first, last) = (first.max(enter.min(leave)), last.min(enter.max(leave)));
        }
    }
    (first <= last).then_some(0.5 * (first + last))
}

/// Whether a direction lies between two others, turning from the first to the second as from x to y.
fn is_in_wedge(first: DVec2, second: DVec2, place: DVec2) -> bool {
    if first.perp_dot(second) >= 0.0 {
        first.perp_dot(place) >= 0.0 && place.perp_dot(second) >= 0.0
    } else {
        !(second.perp_dot(place) > 0.0 && place.perp_dot(first) > 0.0)
    }
}

/// Draws the points of some edges after the map.
pub(super) struct PointPass {
    target: Texture,
    pub(super) view: TextureView,
    pipeline: RenderPipeline,
    bindings: BindGroup,
    edges: u32,
}

impl PointPass {
    /// For a map of `texels`, whose views and layers are given.
    pub(super) fn new(
        gpu: &Gpu,
        texels: UVec2,
        views: &Buffer,
        layers: &TextureView,
        edges_in_world: &[[DVec3; 2]],
    ) -> Self {
        let usage = TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_SRC;
        let target = gpu.texture("silhouette points", (texels - 1).max(UVec2::ONE), FORMAT, usage);
        let strip = PrimitiveState { topology: PrimitiveTopology::TriangleStrip, ..PrimitiveState::default() };
        let pipeline = gpu.render_pipeline(&Drawing {
            label: "silhouette points",
            files: &POINTS,
            primitive: strip,
            targets: &[Some(FORMAT.into())],
            ..Drawing::default()
        });
        let mut ends: Vec<[f32; 4]> =
            edges_in_world.iter().flatten().map(|end| end.as_vec3().extend(1.0).to_array()).collect();
        // A binding is never empty.
        ends.resize(ends.len().max(2), [0.0; 4]);
        let edges = gpu.buffer("silhouette edges", &ends, BufferUsages::STORAGE);
        let resources = [views.as_entire_binding(), edges.as_entire_binding(), BindingResource::TextureView(layers)];
        Self {
            view: target.create_view(&Default::default()),
            bindings: gpu.bind(&pipeline.get_bind_group_layout(0), &resources),
            edges: edges_in_world.len() as u32,
            target,
            pipeline,
        }
    }

    pub(super) fn record(&self, recorder: &mut Recorder<'_>) {
        let clear = Color { r: EMPTY, g: EMPTY, b: 0.0, a: 0.0 };
        let attachment = RenderPassColorAttachment {
            view: &self.view,
            depth_slice: None,
            resolve_target: None,
            ops: Operations { load: LoadOp::Clear(clear), store: StoreOp::Store },
        };
        recorder.render("silhouette points", &[Some(attachment)], None, |pass| {
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &self.bindings, &[]);
            pass.draw(0..4, 0..self.edges);
        });
    }

    /// What the last run drew.
    pub(super) fn read(&self, gpu: &Gpu) -> Result<Points, GpuError> {
        let points = gpu.read_texture::<[f32; 2]>(&self.target, "reading the silhouette's points")?;
        let cells = UVec2::new(self.target.width(), self.target.height());
        Ok(Points { cells, points: points.into_iter().map(Vec2::from_array).collect() })
    }

    /// Bytes of the points and the edges.
    pub(super) fn bytes(&self) -> u64 {
        let of_edge = 2 * size_of::<[f32; 4]>() as u64;
        u64::from(self.target.width()) * u64::from(self.target.height()) * size_of::<[f32; 2]>() as u64
            + u64::from(self.edges) * of_edge
    }
}
