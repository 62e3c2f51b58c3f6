//! The GPU side of planar shadows. The scene is drawn into depth and stencil, which then says for every pixel whose
//! plane it shows; each plane's flattened casters are drawn where the stencil says so. A stencil holds 255 planes, so
//! more of them take several rounds.

use super::membership::{Membership, runs};
use super::settings::{Overlap, Placement, Projection, Settings};
use super::{ShadowPlane, flatten};
use crate::gpu::shader::{self, Wgsl, wgsl};
use crate::gpu::{CORNER_LAYOUT, Drawing, Geometry, Gpu, GpuError, PassRecord, Recorder};
use crate::technique::Job;
use glam::DMat4;
use std::ops::Range;
use wgpu::{
    BindGroup, BlendComponent, BlendFactor, BlendOperation, BlendState, Color, ColorTargetState, ColorWrites,
    CompareFunction, DepthBiasState, DepthStencilState, Features, LoadOp, Operations, RenderPassColorAttachment,
    RenderPassDepthStencilAttachment, RenderPipeline, StencilFaceState, StencilOperation, StencilState, StoreOp,
    Texture, TextureFormat, TextureUsages, TextureView,
};

const SHADOW: Wgsl = wgsl!("planar/shadow.wgsl");

/// Every shader module this family can build, as label and files: what tests parse and validate without a GPU.
#[must_use]
pub fn shader_modules() -> Vec<(String, Vec<Wgsl>)> {
    vec![("planar receivers".to_owned(), vec![shader::GBUFFER]), ("planar shadow".to_owned(), vec![SHADOW])]
}

/// The G-buffer's depth, with a stencil beside it.
pub(super) const NEEDED_FEATURE: Features = Features::DEPTH32FLOAT_STENCIL8;
const DEPTH_STENCIL: TextureFormat = TextureFormat::Depth32FloatStencil8;
/// Bytes per pixel of depth and stencil.
const DEPTH_STENCIL_BYTES: u64 = 5;
/// Layers of shadow per pixel: counted in blended targets, 0 or 1 in others.
const LAYERS: TextureFormat = TextureFormat::R8Unorm;
/// Planes that one round's stencil tells apart; 0 is no plane.
const PLANES_PER_ROUND: usize = 255;

/// Textures, pipelines and draws of all planes.
pub(super) struct PlanarPasses {
    layers: Texture,
    layers_view: TextureView,
    depth_stencil: TextureView,
    receiver_pipeline: RenderPipeline,
    camera: BindGroup,
    shadow_pipeline: RenderPipeline,
    rounds: Vec<Round>,
    bytes: u64,
}

/// Up to 255 planes.
struct Round {
    /// The stencil reference of every triangle of the scene.
    receivers: Vec<(Range<u32>, u32)>,
    shadows: Vec<Shadow>,
}

/// The shadow on one plane.
struct Shadow {
    reference: u32,
    bindings: BindGroup,
    casters: Vec<Range<u32>>,
    /// Its own corners where they are flattened on the CPU.
    flattened: Option<Geometry>,
}

impl PlanarPasses {
    /// Builds everything once.
    pub(super) fn new(
        job: &Job<'_>,
        settings: &Settings,
        planes: &[ShadowPlane],
        members: &Membership,
    ) -> Result<Self, GpuError> {
        let (gpu, scene, size) = (job.gpu, job.scene, job.scene.image_size);
        let flattened: Vec<Option<Geometry>> = planes
            .iter()
            .map(|plane| match settings.projection {
                Projection::Clipped | Projection::Homogeneous => Ok(None),
                projection => Geometry::upload(gpu, &flatten::flattened(scene, plane, members, projection)).map(Some),
            })
            .collect::<Result<_, GpuError>>()?;
        gpu.scoped("the planar shadows' set-up", || {
            let usage = TextureUsages::RENDER_ATTACHMENT | TextureUsages::COPY_SRC;
            let layers = gpu.texture("layers of shadow", size, LAYERS, usage);
            let depth_stencil = gpu.texture("receivers", size, DEPTH_STENCIL, TextureUsages::RENDER_ATTACHMENT);
            let receiver_pipeline = receiver_pipeline(gpu);
            let shadow_pipeline = shadow_pipeline(gpu, settings);
            let clip_from_world = scene.camera.clip_from_world(size);
            let near_m = scene.camera.near_m;
            let pixels = u64::from(size.x) * u64::from(size.y);
            let of_flattened: u64 = flattened.iter().flatten().map(Geometry::bytes).sum();
            let mut shadows: Vec<Shadow> = planes
                .iter()
                .zip(flattened)
                .enumerate()
                .map(|(index, (plane, flattened))| Shadow {
                    reference: if is_masked(settings) { reference(index) } else { 0 },
                    bindings: matrix(
                        gpu,
                        &shadow_pipeline,
                        &clip_from_caster(settings, plane, &clip_from_world, near_m),
                    ),
                    casters: members.casters(scene, plane),
                    flattened,
                })
                .collect();
            let mut rounds = Vec::new();
            while !shadows.is_empty() {
                let first = rounds.len() * PLANES_PER_ROUND;
                let in_round = first..first + PLANES_PER_ROUND;
                let of_plane = |plane: &Option<usize>| {
                    plane.filter(|plane| is_masked(settings) && in_round.contains(plane)).map_or(0, reference)
                };
                let later = shadows.split_off(shadows.len().min(PLANES_PER_ROUND));
                rounds.push(Round { receivers: runs(members.plane_of.iter().map(of_plane)), shadows });
                shadows = later;
            }
            Self {
                bytes: pixels * (DEPTH_STENCIL_BYTES + 1)
                    + (planes.len() as u64 + 1) * size_of::<glam::Mat4>() as u64
                    + of_flattened,
                layers_view: layers.create_view(&Default::default()),
                layers,
                depth_stencil: depth_stencil.create_view(&Default::default()),
                camera: matrix(gpu, &receiver_pipeline, &clip_from_world),
                receiver_pipeline,
                shadow_pipeline,
                rounds,
            }
        })
    }

    /// Draws the receivers and the shadows on them.
    pub(super) fn run(&self, gpu: &Gpu, geometry: &Geometry) -> Result<Vec<PassRecord>, GpuError> {
        let recorder = gpu.scoped("recording the planar shadows", || {
            let mut recorder = Recorder::new(gpu);
            for (index, round) in self.rounds.iter().enumerate() {
                recorder.render(
                    "receivers",
                    &[],
                    Some(self.depth_stencil(LoadOp::Clear(0.0), LoadOp::Clear(0))),
                    |pass| {
                        pass.set_pipeline(&self.receiver_pipeline);
                        pass.set_bind_group(0, &self.camera, &[]);
                        for (triangles, reference) in &round.receivers {
                            pass.set_stencil_reference(*reference);
                            geometry.draw_triangles(pass, std::slice::from_ref(triangles));
                        }
                    },
                );
                let layers = Some(RenderPassColorAttachment {
                    view: &self.layers_view,
                    depth_slice: None,
                    resolve_target: None,
                    ops: Operations {
                        load: if index == 0 { LoadOp::Clear(Color::TRANSPARENT) } else { LoadOp::Load },
                        store: StoreOp::Store,
                    },
                });
                recorder.render("shadows", &[layers], Some(self.depth_stencil(LoadOp::Load, LoadOp::Load)), |pass| {
                    pass.set_pipeline(&self.shadow_pipeline);
                    for shadow in &round.shadows {
                        pass.set_bind_group(0, &shadow.bindings, &[]);
                        pass.set_stencil_reference(shadow.reference);
                        shadow.flattened.as_ref().unwrap_or(geometry).draw_triangles(pass, &shadow.casters);
                    }
                });
            }
            recorder
        })?;
        recorder.finish("the planar shadows")
    }

    /// How many layers of shadow the last run drew over each pixel, row by row.
    pub(super) fn layers(&self, gpu: &Gpu) -> Result<Vec<u8>, GpuError> {
        gpu.read_texture(&self.layers, "reading the shadow layers")
    }

    /// Bytes of textures, matrices and flattened corners.
    pub(super) fn bytes(&self) -> u64 {
        self.bytes
    }

    fn depth_stencil(&self, depth: LoadOp<f32>, stencil: LoadOp<u32>) -> RenderPassDepthStencilAttachment<'_> {
        RenderPassDepthStencilAttachment {
            view: &self.depth_stencil,
            depth_ops: Some(Operations { load: depth, store: StoreOp::Store }),
            stencil_ops: Some(Operations { load: stencil, store: StoreOp::Store }),
        }
    }
}

fn is_masked(settings: &Settings) -> bool {
    settings.placement == Placement::ReceiverMask
}

/// The stencil value of a plane within its round.
fn reference(plane: usize) -> u32 {
    (plane % PLANES_PER_ROUND) as u32 + 1
}

/// What takes a caster's corners, or its flattened ones, to the picture; rounded once.
fn clip_from_caster(settings: &Settings, plane: &ShadowPlane, clip_from_world: &DMat4, near_m: f64) -> DMat4 {
    match settings.projection {
        Projection::Clipped => plane.clipped(clip_from_world, settings.kappa * near_m),
        Projection::Homogeneous => *clip_from_world * plane.flat_from_world(),
        Projection::Divided | Projection::Shear => *clip_from_world,
    }
}

fn matrix(gpu: &Gpu, pipeline: &RenderPipeline, matrix: &DMat4) -> BindGroup {
    let uniform = gpu.uniform("planar matrix", matrix.as_mat4());
    gpu.bind(&pipeline.get_bind_group_layout(0), &[uniform.as_entire_binding()])
}

/// The nearest triangle of each pixel leaves its reference; drawn with the G-buffer's own vertex shader and state, so
/// that both find the same one.
fn receiver_pipeline(gpu: &Gpu) -> RenderPipeline {
    gpu.render_pipeline(&Drawing {
        label: "planar receivers",
        files: &[shader::GBUFFER],
        vertices: &[Some(CORNER_LAYOUT)],
        depth_stencil: Some(DepthStencilState {
            format: DEPTH_STENCIL,
            depth_write_enabled: Some(true),
            depth_compare: Some(CompareFunction::Greater),
            stencil: on_both_faces(CompareFunction::Always, StencilOperation::Replace),
            bias: Default::default(),
        }),
        ..Drawing::default()
    })
}

fn shadow_pipeline(gpu: &Gpu, settings: &Settings) -> RenderPipeline {
    // Once drawn, a pixel's stencil no longer equals the reference: zero for a mask, so that no plane's shadow is read
    // as another plane; one where all of the picture started at zero.
    let pass_op = match (settings.overlap, settings.placement) {
        (Overlap::Blend, _) => StencilOperation::Keep,
        (Overlap::Stencil, Placement::ReceiverMask) => StencilOperation::Zero,
        (Overlap::Stencil, Placement::DepthOffset) => StencilOperation::IncrementClamp,
    };
    let compared = match settings.placement {
        Placement::ReceiverMask => (CompareFunction::Always, DepthBiasState::default()),
        Placement::DepthOffset => {
            // Depth is reversed: towards the eye is up.
            let (constant, slope_scale) = (settings.offset_constant, settings.offset_slope as f32);
            (CompareFunction::GreaterEqual, DepthBiasState { constant, slope_scale, clamp: 0.0 })
        }
    };
    let added =
        BlendComponent { src_factor: BlendFactor::One, dst_factor: BlendFactor::One, operation: BlendOperation::Add };
    let blend = (settings.overlap == Overlap::Blend).then_some(BlendState { color: added, alpha: added });
    gpu.render_pipeline(&Drawing {
        label: "planar shadow",
        files: &[SHADOW],
        vertices: &[Some(CORNER_LAYOUT)],
        depth_stencil: Some(DepthStencilState {
            format: DEPTH_STENCIL,
            depth_write_enabled: Some(false),
            depth_compare: Some(compared.0),
            stencil: on_both_faces(CompareFunction::Equal, pass_op),
            bias: compared.1,
        }),
        targets: &[Some(ColorTargetState { format: LAYERS, blend, write_mask: ColorWrites::ALL })],
        ..Drawing::default()
    })
}

fn on_both_faces(compare: CompareFunction, pass_op: StencilOperation) -> StencilState {
    let keep = StencilOperation::Keep;
    let face = StencilFaceState { compare, pass_op, fail_op: keep, depth_fail_op: keep };
    StencilState { front: face, back: face, read_mask: 0xff, write_mask: 0xff }
}
