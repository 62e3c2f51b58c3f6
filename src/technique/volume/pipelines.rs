//! Pipelines of shadow volumes. Everything that writes or compares depth runs the same vertex code, so that a cap has
//! the depth of the surface it lies on, bit for bit.

use super::settings::Settings;
use super::states::{Counting, Half, Side};
use crate::gpu::shader::{Wgsl, wgsl};
use crate::gpu::{CORNER_LAYOUT, Drawing, Gpu};
use wgpu::{
    CompareFunction, ComputePipeline, DepthStencilState, Face, PrimitiveState, RenderPipeline, StencilFaceState,
    StencilOperation, StencilState, VertexAttribute, VertexBufferLayout, VertexFormat, VertexStepMode,
};

const CLIP: Wgsl = wgsl!("volume/clip.wgsl");
const GIVEN: Wgsl = wgsl!("volume/given.wgsl");
const EXTRUDED: Wgsl = wgsl!("volume/extruded.wgsl");
const NEAR: Wgsl = wgsl!("volume/near.wgsl");
const RESOLVE: Wgsl = wgsl!("volume/resolve.wgsl");
const RECEIVER: Wgsl = wgsl!("shared/receiver.wgsl");

/// Every shader module this family can build, as label and files: what tests parse and validate without a GPU.
#[must_use]
pub fn shader_modules() -> Vec<(String, Vec<Wgsl>)> {
    [
        ("volume given", vec![CLIP, GIVEN]),
        ("volume extruded", vec![CLIP, EXTRUDED]),
        ("volume near", vec![NEAR]),
        ("volume resolve", vec![RECEIVER, RESOLVE]),
    ]
    .map(|(label, files)| (label.to_owned(), files))
    .to_vec()
}

/// Where vertices come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Source {
    /// The scene's corners.
    Scene,
    /// Volume vertices.
    Volumes(VolumeShader),
}

/// How volume vertices become positions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum VolumeShader {
    /// They are.
    Given,
    /// Those with w = 0 are moved away from the light.
    Extruded,
}

const VOLUME_LAYOUT: VertexBufferLayout<'static> = VertexBufferLayout {
    array_stride: size_of::<super::assembly::VolumeVertex>() as u64,
    step_mode: VertexStepMode::Vertex,
    attributes: &[VertexAttribute { format: VertexFormat::Float32x4, offset: 0, shader_location: 0 }],
};

impl Source {
    fn files(self) -> [Wgsl; 2] {
        match self {
            Self::Scene | Self::Volumes(VolumeShader::Given) => [CLIP, GIVEN],
            Self::Volumes(VolumeShader::Extruded) => [CLIP, EXTRUDED],
        }
    }
    fn layout(self) -> VertexBufferLayout<'static> {
        if self == Self::Scene { CORNER_LAYOUT } else { VOLUME_LAYOUT }
    }
}

/// Draws the scene's depth; the stencil stays as it is.
pub(super) fn scene_pipeline(gpu: &Gpu, settings: &Settings) -> RenderPipeline {
    let compare = if settings.reversed { CompareFunction::Greater } else { CompareFunction::Less };
    let depth_stencil = depth_stencil(settings, true, compare, StencilState::default());
    pipeline(gpu, "scene depth", &Source::Scene.files(), Source::Scene.layout(), primitive(None, false), depth_stencil)
}

/// Counts volume faces: all of them, or one half.
pub(super) fn volume_pipeline(
    gpu: &Gpu,
    settings: &Settings,
    source: Source,
    counting: Counting,
    half: Option<Half>,
) -> RenderPipeline {
    let [front, back] = counting.faces();
    let stencil = StencilState { front, back, read_mask: !0, write_mask: !0 };
    let depth_stencil = depth_stencil(settings, false, counting.depth_compare(settings.reversed), stencil);
    // What lies before the near plane must not be counted before the surface; behind it, it never is.
    let unclipped = settings.far.clamps() && counting.side == Side::Behind;
    let primitive = primitive(half.map(|half| counting.culled(half)), unclipped);
    pipeline(gpu, "volume faces", &source.files(), source.layout(), primitive, depth_stencil)
}

/// Adds one for every caster projected onto the near plane.
pub(super) fn near_pipeline(gpu: &Gpu, settings: &Settings) -> RenderPipeline {
    let pass_op =
        if settings.clamps_stencil { StencilOperation::IncrementClamp } else { StencilOperation::IncrementWrap };
    let add = StencilFaceState { compare: CompareFunction::Always, pass_op, ..StencilFaceState::IGNORE };
    let stencil = StencilState { front: add, back: add, read_mask: !0, write_mask: !0 };
    let depth_stencil = depth_stencil(settings, false, CompareFunction::Always, stencil);
    pipeline(gpu, "near counts", &[NEAR], CORNER_LAYOUT, primitive(None, false), depth_stencil)
}

/// Turns counts into visibilities.
pub(super) fn resolve_pipeline(gpu: &Gpu) -> ComputePipeline {
    gpu.compute_pipeline("volume resolve", &[RECEIVER, RESOLVE])
}

fn primitive(cull_mode: Option<Face>, unclipped_depth: bool) -> PrimitiveState {
    PrimitiveState { cull_mode, unclipped_depth, ..PrimitiveState::default() }
}

fn depth_stencil(
    settings: &Settings,
    writes_depth: bool,
    compare: CompareFunction,
    stencil: StencilState,
) -> DepthStencilState {
    DepthStencilState {
        format: settings.format.texture_format(),
        depth_write_enabled: Some(writes_depth),
        depth_compare: Some(compare),
        stencil,
        bias: Default::default(),
    }
}

fn pipeline(
    gpu: &Gpu,
    label: &str,
    files: &[Wgsl],
    layout: VertexBufferLayout<'static>,
    primitive: PrimitiveState,
    depth_stencil: DepthStencilState,
) -> RenderPipeline {
    let (vertices, depth_stencil) = (&[Some(layout)], Some(depth_stencil));
    gpu.render_pipeline(&Drawing { label, files, vertices, primitive, depth_stencil, ..Drawing::default() })
}
