//! How casters are drawn into the layers of a map: one pass per view, by the rasteriser's depth or by one that fragments
//! write.

use super::lookup::Lookup;
use super::projection::{Drawn, View};
use super::settings::{CasterSides, NearMode};
use super::{DepthFormat, Settings};
use crate::gpu::shader::{Wgsl, wgsl};
use crate::gpu::{CORNER_LAYOUT, Drawing, Geometry, Gpu, Recorder};
use bytemuck::{Pod, Zeroable};
use glam::Mat4;
use wgpu::{
    BindGroup, BindingResource, Buffer, BufferUsages, CompareFunction, DepthBiasState, DepthStencilState, Face,
    FrontFace, LoadOp, Operations, PrimitiveState, RenderPassDepthStencilAttachment, RenderPipeline, StoreOp, Texture,
    TextureFormat, TextureView, TextureViewDescriptor, TextureViewDimension,
};

const CASTER: Wgsl = wgsl!("map/caster.wgsl");
const CASTER_PANCAKED: Wgsl = wgsl!("map/caster_pancaked.wgsl");
const CASTER_DEPTH: Wgsl = wgsl!("map/caster_depth.wgsl");
const CASTER_ROWS: Wgsl = wgsl!("map/caster_rows.wgsl");
const CASTER_PARABOLOID: Wgsl = wgsl!("map/caster_paraboloid.wgsl");
const NEAREST_LAYER: Wgsl = wgsl!("map/nearest_layer.wgsl");
const SECOND_LAYER: Wgsl = wgsl!("map/second_layer.wgsl");

/// The modules that draw casters, as label and files.
pub(super) fn shader_modules() -> Vec<(String, Vec<Wgsl>)> {
    let named = |name: &str, files: &[Wgsl]| (name.to_owned(), files.to_vec());
    vec![
        named("map caster", &[CASTER]),
        named("map caster pancaked", &[CASTER_PANCAKED]),
        named("map caster depth", &[CASTER_DEPTH, CASTER_ROWS, NEAREST_LAYER]),
        named("map caster paraboloid", &[CASTER_DEPTH, CASTER_PARABOLOID, NEAREST_LAYER]),
        named("map second layer", &[CASTER_DEPTH, CASTER_ROWS, SECOND_LAYER]),
        named("map second layer paraboloid", &[CASTER_DEPTH, CASTER_PARABOLOID, SECOND_LAYER]),
    ]
}

/// `Caster` of `shaders/map/caster_depth.wgsl`, which begins as those of `shaders/map/caster.wgsl` and
/// `shaders/map/caster_pancaked.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
struct CasterUniform {
    clip_from_world: Mat4,
    depth_row: [f32; 4],
    depth_q_row: [f32; 4],
    bias_constant: f32,
    bias_constant_ulps: f32,
    bias_slope: f32,
    bias_clamp: f32,
    depth_sign: f32,
    clamps: u32,
    padding: [u32; 2],
    u_row: [f32; 4],
    v_row: [f32; 4],
    q_row: [f32; 4],
}

/// How one view is drawn.
pub(super) struct Layer {
    target: TextureView,
    pipeline: RenderPipeline,
    bindings: BindGroup,
    clear_depth: f32,
    /// What is drawn in place of the casters, three corners per triangle.
    pieces: Option<Buffer>,
    /// Whether a fragment shader writes depth: its pipeline then declares one colour target, which is none.
    writes_depth: bool,
}

impl Layer {
    /// Bytes of its own buffers.
    pub(super) fn bytes(&self) -> u64 {
        size_of::<CasterUniform>() as u64 + self.pieces.as_ref().map_or(0, Buffer::size)
    }
}

/// Draws the casters into every view's layer.
pub(super) fn record_layers(recorder: &mut Recorder<'_>, name: &'static str, layers: &[Layer], geometry: &Geometry) {
    for layer in layers {
        let depth = RenderPassDepthStencilAttachment {
            view: &layer.target,
            depth_ops: Some(Operations { load: LoadOp::Clear(layer.clear_depth), store: StoreOp::Store }),
            stencil_ops: None,
        };
        let no_color = if layer.writes_depth { &[None][..] } else { &[] };
        recorder.render(name, no_color, Some(depth), |pass| {
            pass.set_pipeline(&layer.pipeline);
            pass.set_bind_group(0, &layer.bindings, &[]);
            match &layer.pieces {
                Some(corners) => {
                    pass.set_vertex_buffer(0, corners.slice(..));
                    pass.draw(0..(corners.size() / CORNER_LAYOUT.array_stride) as u32, 0..1);
                }
                None => geometry.draw_casters(pass),
            }
        });
    }
}

/// One layer of a texture.
pub(super) fn layer_view(map: &Texture, index: u32) -> TextureView {
    map.create_view(&TextureViewDescriptor {
        dimension: Some(TextureViewDimension::D2),
        base_array_layer: index,
        array_layer_count: Some(1),
        ..Default::default()
    })
}

/// How every view is drawn into its layer of `map`: everything, or what lies behind the layers of another map.
pub(super) fn layers(
    gpu: &Gpu,
    settings: &Settings,
    lookup: &Lookup,
    map: &Texture,
    behind: Option<&Texture>,
) -> Vec<Layer> {
    let mut pipelines: Vec<(Raster, RenderPipeline)> = Vec::new();
    let layer = |(index, view): (u32, &View)| {
        let raster = Raster::of(settings, lookup, view);
        let known = pipelines.iter().find(|(known, _)| *known == raster).map(|(_, pipeline)| pipeline.clone());
        let pipeline = known.unwrap_or_else(|| {
            let built = raster.pipeline(gpu, settings, lookup, map.format(), behind.is_some());
            pipelines.push((raster, built.clone()));
            built
        });
        let uniform = gpu.uniform("caster", caster_uniform(settings, lookup, view));
        let nearer = behind.map(|nearer| layer_view(nearer, index));
        let mut resources = vec![uniform.as_entire_binding()];
        resources.extend(nearer.as_ref().map(BindingResource::TextureView));
        Layer {
            target: layer_view(map, index),
            bindings: gpu.bind(&pipeline.get_bind_group_layout(0), &resources),
            pipeline,
            clear_depth: view.cleared() as f32,
            pieces: view.drawn.as_ref().map(|drawn| piece_corners(gpu, drawn)),
            writes_depth: raster.writes_depth,
        }
    };
    (0..).zip(&lookup.views).map(layer).collect()
}

/// The corners of pieces; a buffer is never empty.
fn piece_corners(gpu: &Gpu, drawn: &Drawn) -> Buffer {
    let mut corners: Vec<[f32; 3]> =
        drawn.pieces.iter().flat_map(|piece| piece.corners_in_world).map(|corner| corner.to_array()).collect();
    corners.resize(corners.len().max(3), [0.0; 3]);
    gpu.buffer("pieces of casters", &corners, BufferUsages::VERTEX)
}

fn caster_uniform(settings: &Settings, lookup: &Lookup, view: &View) -> CasterUniform {
    let fixed_unit = match settings.format {
        DepthFormat::Depth32Float => 0.0,
        fixed => fixed.hardware_unit(1.0),
    };
    let units = f64::from(lookup.bias.constant_units);
    CasterUniform {
        clip_from_world: view.clip_from_world,
        depth_row: view.rows.depth.to_array(),
        depth_q_row: view.rows.depth_q.to_array(),
        bias_constant: (units * fixed_unit) as f32,
        bias_constant_ulps: if fixed_unit == 0.0 { units as f32 } else { 0.0 },
        bias_slope: lookup.bias.slope as f32,
        bias_clamp: lookup.bias.clamp as f32,
        depth_sign: view.depth_sign as f32,
        clamps: u32::from(matches!(settings.near_mode, NearMode::DepthClamp | NearMode::FragmentClamp)),
        padding: [0; 2],
        u_row: view.rows.u.to_array(),
        v_row: view.rows.v.to_array(),
        q_row: view.rows.q.to_array(),
    }
}

/// What a view's pipeline depends on.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Raster {
    depth_sign: f64,
    winding: f64,
    /// Whether the fragment shader writes depth, because the rasteriser's is not what is stored.
    writes_depth: bool,
    /// Whether pieces are drawn on a paraboloid's disc.
    on_disc: bool,
}

impl Raster {
    fn of(settings: &Settings, lookup: &Lookup, view: &View) -> Self {
        let on_disc = view.drawn.is_some();
        let has_own_depth = match settings.near_mode {
            NearMode::Extend | NearMode::VertexClamp => false,
            NearMode::DepthClamp => on_disc,
            NearMode::FragmentClamp => true,
        };
        Self {
            on_disc,
            depth_sign: view.depth_sign,
            winding: view.winding(lookup.light()),
            writes_depth: has_own_depth || settings.stores_midpoint() || (!on_disc && view.rows.depth_q != view.rows.q),
        }
    }

    fn pipeline(
        &self,
        gpu: &Gpu,
        settings: &Settings,
        lookup: &Lookup,
        format: TextureFormat,
        is_second: bool,
    ) -> RenderPipeline {
        let placed = if self.on_disc { CASTER_PARABOLOID } else { CASTER_ROWS };
        let own_depth = [CASTER_DEPTH, placed, if is_second { SECOND_LAYER } else { NEAREST_LAYER }];
        let by_rasteriser = [if settings.near_mode == NearMode::VertexClamp { CASTER_PANCAKED } else { CASTER }];
        let bias = |amount: f64| if self.writes_depth { 0.0 } else { amount * self.depth_sign };
        gpu.render_pipeline(&Drawing {
            label: "map caster",
            files: if self.writes_depth || self.on_disc { &own_depth } else { &by_rasteriser },
            vertices: &[Some(CORNER_LAYOUT)],
            primitive: PrimitiveState {
                front_face: if self.winding > 0.0 { FrontFace::Ccw } else { FrontFace::Cw },
                cull_mode: match settings.caster_sides {
                    CasterSides::All => None,
                    CasterSides::LightFacing => Some(Face::Back),
                    CasterSides::AwayFacing => Some(Face::Front),
                },
                unclipped_depth: settings.near_mode == NearMode::DepthClamp && !self.writes_depth,
                ..PrimitiveState::default()
            },
            depth_stencil: Some(DepthStencilState {
                format,
                depth_write_enabled: Some(true),
                depth_compare: Some(if self.depth_sign > 0.0 {
                    CompareFunction::Less
                } else {
                    CompareFunction::Greater
                }),
                stencil: Default::default(),
                bias: DepthBiasState {
                    constant: bias(lookup.bias.constant_units.into()) as i32,
                    slope_scale: bias(lookup.bias.slope) as f32,
                    clamp: bias(lookup.bias.clamp) as f32,
                },
            }),
            targets: if self.writes_depth { &[None] } else { &[] },
        })
    }
}
