//! The GPU side: receivers into lists, casters into rectangles of cells, every rectangle's receivers tested.

use super::grids::{Grids, ViewUniform};
use super::samples::GpuSample;
use crate::gpu::shader::{Wgsl, wgsl};
use crate::gpu::{Drawing, Gpu, GpuError, PassRecord, Recorder};
use crate::technique::receiver_buffer::{Chunk, workgroups};
use crate::technique::{Job, ReceiverBuffer, TechniqueError, Unsupported};
use glam::UVec2;
use wgpu::{
    BindGroup, Buffer, BufferDescriptor, BufferUsages, Color, ColorTargetState, ColorWrites, ComputePass,
    ComputePipeline, LoadOp, Operations, PrimitiveState, PrimitiveTopology, RenderPassColorAttachment, RenderPipeline,
    StoreOp, TextureFormat, TextureUsages, TextureView,
};

const VIEW: Wgsl = wgsl!("irregular/view.wgsl");
const CLEAR: [Wgsl; 1] = [wgsl!("irregular/clear.wgsl")];
const INSERT: [Wgsl; 2] = [VIEW, wgsl!("irregular/insert.wgsl")];
const RECTANGLES: [Wgsl; 2] = [VIEW, wgsl!("irregular/rectangles.wgsl")];
const CASTERS: [Wgsl; 2] = [VIEW, wgsl!("irregular/casters.wgsl")];
const RESOLVE: [Wgsl; 2] = [wgsl!("shared/receiver.wgsl"), wgsl!("irregular/resolve.wgsl")];

/// Storage buffers that the fragment stage reads and writes, the most of any stage.
const STORAGE_BUFFERS: u32 = 6;
/// Bytes of one `Rectangle` in the shaders.
const RECTANGLE_BYTES: u64 = 16;
/// Vertices, instances (none yet), first vertex, first instance: a strip of two triangles per rectangle.
const NO_RECTANGLES: [u32; 4] = [4, 0, 0, 0];
/// A draw needs a target; nothing is written to it.
const TARGET: TextureFormat = TextureFormat::R8Unorm;

/// Every shader module this family can build, as label and files: what tests parse and validate without a GPU.
#[must_use]
pub fn shader_modules() -> Vec<(String, Vec<Wgsl>)> {
    let modules: [(&str, &[Wgsl]); 5] = [
        ("irregular clear", &CLEAR),
        ("irregular insert", &INSERT),
        ("irregular rectangles", &RECTANGLES),
        ("irregular casters", &CASTERS),
        ("irregular resolve", &RESOLVE),
    ];
    modules.map(|(label, files)| (label.to_owned(), files.to_vec())).to_vec()
}

/// Whether shaders can write what this family writes.
pub(super) fn supports(gpu: &Gpu) -> Result<(), Unsupported> {
    let limit = gpu.device.limits().max_storage_buffers_per_shader_stage;
    if limit < STORAGE_BUFFERS {
        let what = format!("{STORAGE_BUFFERS} storage buffers per shader stage (its limit is {limit})");
        return Err(Unsupported::MissingFeature { what });
    }
    Ok(())
}

/// Buffers, pipelines and bindings of one light.
pub(super) struct IrregularPasses {
    clear: ComputePipeline,
    insert: ComputePipeline,
    rectangles: ComputePipeline,
    casters: RenderPipeline,
    resolve: ComputePipeline,
    chunks: Vec<Bindings>,
    rectangle_bindings: Option<BindGroup>,
    draw: Buffer,
    target: TextureView,
    triangles: usize,
    cells: usize,
    bytes: u64,
}

/// What one chunk of receivers is bound to.
struct Bindings {
    clear: BindGroup,
    insert: BindGroup,
    casters: BindGroup,
    resolve: BindGroup,
    receivers: usize,
}

/// What all chunks share.
struct Shared {
    view: Buffer,
    corners: Buffer,
    light_sides: Buffer,
    rectangles: Buffer,
    heads: Buffer,
}

impl IrregularPasses {
    /// Builds everything once. `light_sides` has, per triangle, the side the light is on, and 0 for what casts nothing.
    pub(super) fn new(
        job: &Job<'_>,
        grids: &Grids,
        light_sides: &[i32],
        receivers: &ReceiverBuffer,
    ) -> Result<Self, TechniqueError> {
        let cells = grids.faces.len() * (grids.grid as usize).pow(2);
        let casting = light_sides.iter().filter(|side| **side != 0).count();
        let rectangle_bytes = (casting * grids.faces.len()).max(1) as u64 * RECTANGLE_BYTES;
        let heads_bytes = (cells.max(1) * size_of::<u32>()) as u64;
        let limit = job.gpu.limits().storage_binding_bytes;
        let buffers = [("cells", heads_bytes), ("rectangles", rectangle_bytes), ("casters", job.geometry.bytes())];
        if let Some((of, bytes)) = buffers.into_iter().find(|(_, bytes)| *bytes > limit) {
            let what = format!("storage buffers of {bytes} bytes, which the {of} take (its limit is {limit})");
            return Err(Unsupported::MissingFeature { what }.into());
        }
        let passes = job.gpu.scoped("the irregular z-buffer's set-up", || {
            let gpu = job.gpu;
            let [clear, insert, rectangles, resolve]: [ComputePipeline; 4] =
                [("clear", &CLEAR[..]), ("insert", &INSERT), ("rectangles", &RECTANGLES), ("resolve", &RESOLVE)]
                    .map(|(name, files)| gpu.compute_pipeline(&format!("irregular {name}"), files));
            let casters = caster_pipeline(gpu);
            let shared = job.geometry.corners().map(|corners| Shared {
                view: gpu.uniform::<ViewUniform>("irregular view", grids.uniform()),
                corners: corners.clone(),
                light_sides: gpu.buffer("light sides", light_sides, BufferUsages::STORAGE),
                rectangles: scratch(gpu, "rectangles", rectangle_bytes),
                heads: scratch(gpu, "list heads", heads_bytes),
            });
            let draw = gpu.buffer(
                "rectangle draw",
                &NO_RECTANGLES,
                BufferUsages::STORAGE | BufferUsages::INDIRECT | BufferUsages::COPY_DST,
            );
            let side = grids.grid;
            let target = gpu
                .texture("cells", UVec2::splat(side), TARGET, TextureUsages::RENDER_ATTACHMENT)
                .create_view(&Default::default());
            let mut bytes = heads_bytes + rectangle_bytes + u64::from(side).pow(2) + size_of::<ViewUniform>() as u64;
            bytes += size_of_val(light_sides) as u64 + draw.size();
            let mut chunks = Vec::new();
            let mut rectangle_bindings = None;
            if let Some(shared) = &shared {
                rectangle_bindings = Some(gpu.bind(
                    &rectangles.get_bind_group_layout(0),
                    &[
                        shared.view.as_entire_binding(),
                        shared.corners.as_entire_binding(),
                        shared.light_sides.as_entire_binding(),
                        shared.rectangles.as_entire_binding(),
                        draw.as_entire_binding(),
                    ],
                ));
                for chunk in receivers.chunks() {
                    let pipelines = (&clear, &insert, &casters, &resolve);
                    let (bindings, of_chunk) = Bindings::new(job, grids, shared, chunk, pipelines);
                    chunks.push(bindings);
                    bytes += of_chunk;
                }
            }
            let triangles = light_sides.len();
            Self {
                clear,
                insert,
                rectangles,
                casters,
                resolve,
                chunks,
                rectangle_bindings,
                draw,
                target,
                triangles,
                cells,
                bytes,
            }
        })?;
        Ok(passes)
    }

    /// Sorts receivers and casters into cells and answers every receiver.
    pub(super) fn run(&self, gpu: &Gpu, receivers: &ReceiverBuffer) -> Result<Vec<PassRecord>, GpuError> {
        gpu.queue.write_buffer(&self.draw, 0, bytemuck::bytes_of(&NO_RECTANGLES));
        let recorder = gpu.scoped("recording the irregular z-buffer", || {
            let mut recorder = Recorder::new(gpu);
            recorder.compute("caster rectangles", 0, |pass| {
                dispatch(pass, &self.rectangles, self.rectangle_bindings.as_ref(), self.triangles);
            });
            for (chunk, bindings) in receivers.chunks().iter().zip(&self.chunks) {
                recorder.compute("receiver lists", 0, |pass| {
                    dispatch(pass, &self.clear, Some(&bindings.clear), self.cells.max(bindings.receivers));
                    dispatch(pass, &self.insert, Some(&bindings.insert), bindings.receivers);
                });
                recorder.render("edge tests", &[Some(self.attachment())], None, |pass| {
                    pass.set_pipeline(&self.casters);
                    pass.set_bind_group(0, &bindings.casters, &[]);
                    pass.draw_indirect(&self.draw, 0);
                });
                recorder.compute("resolve", 0, |pass| {
                    pass.set_pipeline(&self.resolve);
                    pass.set_bind_group(0, &bindings.resolve, &[]);
                    chunk.dispatch(pass);
                });
            }
            recorder
        })?;
        recorder.finish("the irregular z-buffer")
    }

    fn attachment(&self) -> RenderPassColorAttachment<'_> {
        RenderPassColorAttachment {
            view: &self.target,
            depth_slice: None,
            resolve_target: None,
            ops: Operations { load: LoadOp::Clear(Color::BLACK), store: StoreOp::Discard },
        }
    }

    /// Bytes of lists, rectangles and samples.
    pub(super) fn bytes(&self) -> u64 {
        self.bytes
    }
}

impl Bindings {
    /// Bindings of a chunk, and the bytes of its own buffers.
    fn new(
        job: &Job<'_>,
        grids: &Grids,
        shared: &Shared,
        chunk: &Chunk,
        (clear, insert, casters, resolve): (&ComputePipeline, &ComputePipeline, &RenderPipeline, &ComputePipeline),
    ) -> (Self, u64) {
        let gpu = job.gpu;
        let receivers = chunk.pixels().iter().filter_map(|pixel| job.receivers.pixels[*pixel as usize]);
        let samples: Vec<GpuSample> = receivers.map(|receiver| GpuSample::new(&receiver, job.casters, grids)).collect();
        let count = samples.len();
        let samples = gpu.buffer("samples", &samples, BufferUsages::STORAGE);
        let next = scratch(gpu, "list links", (count * size_of::<u32>()) as u64);
        let blocked = scratch(gpu, "blocked receivers", (count.div_ceil(32) * size_of::<u32>()) as u64);
        let bytes = samples.size() + next.size() + blocked.size();
        let bindings = Self {
            clear: gpu.bind(
                &clear.get_bind_group_layout(0),
                &[shared.heads.as_entire_binding(), blocked.as_entire_binding()],
            ),
            insert: gpu.bind(
                &insert.get_bind_group_layout(0),
                &[
                    shared.view.as_entire_binding(),
                    samples.as_entire_binding(),
                    shared.heads.as_entire_binding(),
                    next.as_entire_binding(),
                ],
            ),
            casters: gpu.bind(
                &casters.get_bind_group_layout(0),
                &[
                    shared.view.as_entire_binding(),
                    shared.rectangles.as_entire_binding(),
                    shared.corners.as_entire_binding(),
                    shared.light_sides.as_entire_binding(),
                    samples.as_entire_binding(),
                    shared.heads.as_entire_binding(),
                    next.as_entire_binding(),
                    blocked.as_entire_binding(),
                ],
            ),
            resolve: gpu.bind(
                &resolve.get_bind_group_layout(0),
                &[
                    chunk.receivers.as_entire_binding(),
                    chunk.visibilities.as_entire_binding(),
                    blocked.as_entire_binding(),
                ],
            ),
            receivers: count,
        };
        (bindings, bytes)
    }
}

/// A storage buffer that only shaders fill.
fn scratch(gpu: &Gpu, label: &str, bytes: u64) -> Buffer {
    gpu.device.create_buffer(&BufferDescriptor {
        label: Some(label),
        size: bytes,
        usage: BufferUsages::STORAGE,
        mapped_at_creation: false,
    })
}

fn dispatch(pass: &mut ComputePass<'_>, pipeline: &ComputePipeline, bindings: Option<&BindGroup>, threads: usize) {
    let Some(bindings) = bindings else { return };
    pass.set_pipeline(pipeline);
    pass.set_bind_group(0, bindings, &[]);
    let [columns, rows] = workgroups(threads);
    pass.dispatch_workgroups(columns, rows, 1);
}

fn caster_pipeline(gpu: &Gpu) -> RenderPipeline {
    let strip = PrimitiveState { topology: PrimitiveTopology::TriangleStrip, ..PrimitiveState::default() };
    let target = ColorTargetState { format: TARGET, blend: None, write_mask: ColorWrites::empty() };
    gpu.render_pipeline(&Drawing {
        label: "irregular casters",
        files: &CASTERS,
        primitive: strip,
        targets: &[Some(target)],
        ..Drawing::default()
    })
}
