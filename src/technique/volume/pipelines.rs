//! Pipelines of shadow volumes. Everything that writes or compares depth runs the same vertex code, so that a cap has
//! the depth of the surface it lies on, bit for bit.

use super::range::FLAG;
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
const EXTRUSION: Wgsl = wgsl!("volume/extrusion.wgsl");
const EXTRUDED: Wgsl = wgsl!("volume/extruded.wgsl");
const QUADS: Wgsl = wgsl!("volume/quads.wgsl");
const RANGE: Wgsl = wgsl!("volume/range.wgsl");
const NEAR: Wgsl = wgsl!("volume/near.wgsl");
const MASK: Wgsl = wgsl!("volume/mask.wgsl");
const COUNT: Wgsl = wgsl!("volume/count.wgsl");
const RESOLVE: Wgsl = wgsl!("volume/resolve.wgsl");
const RESOLVE_MASKED: Wgsl = wgsl!("volume/resolve_masked.wgsl");
const RECEIVER: Wgsl = wgsl!("shared/receiver.wgsl");

/// Every shader module this family can build, as label and files: what tests parse and validate without a GPU.
#[must_use]
pub fn shader_modules() -> Vec<(String, Vec<Wgsl>)> {
    [
        ("volume given", vec![CLIP, GIVEN]),
        ("volume extruded", vec![CLIP, EXTRUSION, EXTRUDED]),
        ("volume quads", vec![CLIP, EXTRUSION, QUADS]),
        ("volume range", vec![RANGE]),
        ("volume near", vec![NEAR]),
        ("volume mask", vec![MASK]),
        ("volume resolve", vec![RECEIVER, COUNT, RESOLVE]),
        ("volume resolve masked", vec![RECEIVER, COUNT, RESOLVE_MASKED]),
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
    /// Faces that the vertex shader unfolds.
    Quads,
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
    fn files(self) -> Vec<Wgsl> {
        match self {
            Self::Scene | Self::Volumes(VolumeShader::Given) => vec![CLIP, GIVEN],
            Self::Volumes(VolumeShader::Extruded) => vec![CLIP, EXTRUSION, EXTRUDED],
            Self::Quads => vec![CLIP, EXTRUSION, QUADS],
        }
    }
    fn layout(self) -> Option<VertexBufferLayout<'static>> {
        match self {
            Self::Scene => Some(CORNER_LAYOUT),
            Self::Volumes(_) => Some(VOLUME_LAYOUT),
            Self::Quads => None,
        }
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
    let stencil = counting_state(settings, [front, back]);
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
    let stencil = counting_state(settings, [add, add]);
    let depth_stencil = depth_stencil(settings, false, CompareFunction::Always, stencil);
    pipeline(gpu, "near counts", &[NEAR], Some(CORNER_LAYOUT), primitive(None, false), depth_stencil)
}

/// Where what is seen lies behind the triangle, or at its depth, the flag becomes that of the stencil's reference.
pub(super) fn range_pipeline(gpu: &Gpu, settings: &Settings) -> RenderPipeline {
    let compare = if settings.reversed { CompareFunction::GreaterEqual } else { CompareFunction::LessEqual };
    let replace = StencilFaceState {
        compare: CompareFunction::Always,
        pass_op: StencilOperation::Replace,
        ..StencilFaceState::IGNORE
    };
    let stencil = StencilState { front: replace, back: replace, read_mask: 0, write_mask: FLAG.into() };
    let depth_stencil = depth_stencil(settings, false, compare, stencil);
    pipeline(gpu, "range mask", &[RANGE], None, primitive(None, false), depth_stencil)
}

/// Sets the flag at the pixels of a mask, whatever is seen there.
pub(super) fn mask_pipeline(gpu: &Gpu, settings: &Settings) -> RenderPipeline {
    let replace = StencilFaceState {
        compare: CompareFunction::Always,
        pass_op: StencilOperation::Replace,
        ..StencilFaceState::IGNORE
    };
    let stencil = StencilState { front: replace, back: replace, read_mask: 0, write_mask: FLAG.into() };
    gpu.render_pipeline(&Drawing {
        label: "volume mask",
        files: &[MASK],
        depth_stencil: Some(depth_stencil(settings, false, CompareFunction::Always, stencil)),
        targets: &[None],
        ..Drawing::default()
    })
}

/// Counts with the bits that count; under a mask only where the flag is set.
fn counting_state(settings: &Settings, faces: [StencilFaceState; 2]) -> StencilState {
    let [front, back] = faces;
    if settings.has_flag() {
        let flagged = |face| StencilFaceState { compare: CompareFunction::Equal, ..face };
        let (read_mask, write_mask) = (FLAG.into(), (!FLAG).into());
        StencilState { front: flagged(front), back: flagged(back), read_mask, write_mask }
    } else {
        StencilState { front, back, read_mask: !0, write_mask: !0 }
    }
}

/// Turns counts into visibilities, of all receivers or of those at the pixels of a mask.
pub(super) fn resolve_pipeline(gpu: &Gpu, settings: &Settings) -> ComputePipeline {
    let resolve = if settings.is_masked { RESOLVE_MASKED } else { RESOLVE };
    gpu.compute_pipeline("volume resolve", &[RECEIVER, COUNT, resolve])
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
    layout: Option<VertexBufferLayout<'static>>,
    primitive: PrimitiveState,
    depth_stencil: DepthStencilState,
) -> RenderPipeline {
    let vertices: Vec<_> = layout.into_iter().map(Some).collect();
    let (vertices, depth_stencil) = (vertices.as_slice(), Some(depth_stencil));
    gpu.render_pipeline(&Drawing { label, files, vertices, primitive, depth_stencil, ..Drawing::default() })
}
