//! The GPU side: the scene's depth once, then per run the volumes into the stencil and the stencil into visibilities.

use super::assembly::Faces;
use super::extrude::Reach;
use super::eye::Eye;
use super::pipelines::{Source, VolumeShader, near_pipeline, resolve_pipeline, scene_pipeline, volume_pipeline};
use super::scissor::Rectangle;
use super::settings::{FarPlane, Format, Settings};
use super::states::{Counting, Half, Side};
use super::volumes::Volumes;
use crate::gpu::{Gpu, GpuError, PassRecord, Recorder};
use crate::technique::{Job, ReceiverBuffer};
use bytemuck::{Pod, Zeroable};
use glam::{DVec4, Mat4};
use wgpu::util::{BufferInitDescriptor, DeviceExt};
use wgpu::{
    BindGroup, BindGroupDescriptor, BindGroupEntry, BindingResource, Buffer, BufferUsages, ComputePipeline, Extent3d,
    IndexFormat, LoadOp, Operations, RenderPass, RenderPassDepthStencilAttachment, RenderPipeline, StoreOp, Texture,
    TextureAspect, TextureDescriptor, TextureDimension, TextureFormat, TextureUsages, TextureView,
    TextureViewDescriptor,
};

/// `Eye` of `shaders/volume/clip.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
struct EyeUniform {
    clip_from_world: Mat4,
    depth_at_infinity: f32,
    infinite: u32,
    padding: [u32; 2],
}

/// `Extrusion` of `shaders/volume/extruded.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
struct ExtrusionUniform {
    light: [f32; 4],
    length_m: f32,
    padding: [u32; 3],
}

/// One indexed draw.
struct Draw {
    pipeline: RenderPipeline,
    bindings: BindGroup,
    vertices: Buffer,
    indices: Buffer,
    count: u32,
}

/// The camera's depth and stencil, and everything that is drawn into it.
pub(super) struct VolumePasses {
    buffer: Texture,
    view: TextureView,
    /// Passes in order, each with its draws; the first clears the stencil.
    passes: Vec<(&'static str, Vec<Draw>)>,
    scissor: Rectangle,
    resolve: ComputePipeline,
    resolve_bindings: Vec<BindGroup>,
    buffer_bytes: u64,
}

/// Builds draws and counts the bytes of what they use.
struct Builder<'b> {
    gpu: &'b Gpu,
    settings: &'b Settings,
    eye_uniform: Buffer,
    extrusion_uniform: Buffer,
    corners: Option<Buffer>,
    vertices: Buffer,
    bytes: u64,
}

impl VolumePasses {
    /// Builds everything, and draws the scene's depth: that belongs to any renderer and is no cost of volumes.
    pub(super) fn new(
        job: &Job<'_>,
        settings: &Settings,
        eye: &Eye,
        volumes: &Volumes,
        receivers: &ReceiverBuffer,
    ) -> Result<Self, GpuError> {
        check_size(job.gpu, volumes)?;
        let passes =
            job.gpu.scoped("the shadow volumes' set-up", || Self::build(job, settings, eye, volumes, receivers))?;
        passes.draw_scene(job, settings, eye)?;
        Ok(passes)
    }

    fn build(job: &Job<'_>, settings: &Settings, eye: &Eye, volumes: &Volumes, receivers: &ReceiverBuffer) -> Self {
        let size = job.scene.image_size;
        let buffer = job.gpu.device.create_texture(&TextureDescriptor {
            label: Some("depth and stencil"),
            size: Extent3d { width: size.x, height: size.y, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: TextureDimension::D2,
            format: settings.format.texture_format(),
            usage: TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let mut builder = Builder::new(job, settings, eye, volumes);
        let mut passes = Vec::new();
        if let Some((clip_from_caster, corners)) = &volumes.near_casters {
            passes.push(("near counts", builder.near_draws(*clip_from_caster, corners)));
        }
        for (name, side, faces) in
            [("z-fail volumes", Side::Behind, &volumes.behind), ("z-pass volumes", Side::Before, &volumes.before)]
        {
            let draws = builder.volume_draws(side, faces);
            // A count without any volume still has to clear the stencil.
            if !draws.is_empty() || (side == Side::Before && passes.is_empty()) {
                passes.push((name, draws));
            }
        }
        let resolve = resolve_pipeline(job.gpu);
        let counts = buffer.create_view(&TextureViewDescriptor {
            aspect: TextureAspect::StencilOnly,
            ..TextureViewDescriptor::default()
        });
        let resolve_bindings = receivers.chunks().iter().map(|chunk| {
            let resources = [
                chunk.receivers.as_entire_binding(),
                chunk.visibilities.as_entire_binding(),
                BindingResource::TextureView(&counts),
            ];
            let mut binding = 0..;
            let entries =
                resources.map(|resource| BindGroupEntry { binding: binding.next().unwrap_or_default(), resource });
            let layout = &resolve.get_bind_group_layout(0);
            job.gpu.device.create_bind_group(&BindGroupDescriptor { label: None, layout, entries: &entries })
        });
        Self {
            view: buffer.create_view(&Default::default()),
            scissor: if settings.scissor {
                Rectangle::of_range(job.light, &job.scene.camera, size)
            } else {
                Rectangle::whole(size)
            },
            resolve_bindings: resolve_bindings.collect(),
            buffer_bytes: builder.bytes,
            buffer,
            passes,
            resolve,
        }
    }

    fn draw_scene(&self, job: &Job<'_>, settings: &Settings, eye: &Eye) -> Result<(), GpuError> {
        let recorder = job.gpu.scoped("recording the scene's depth", || {
            let pipeline = scene_pipeline(job.gpu, settings);
            let bindings = bind(job.gpu, &pipeline, &[&uniform(job.gpu, bytemuck::bytes_of(&eye_uniform(eye)))]);
            let mut recorder = Recorder::new(job.gpu);
            let clear = Operations { load: LoadOp::Clear(eye.clear_depth()), store: StoreOp::Store };
            let attachment = self.attachment(Some(clear), LoadOp::Clear(0));
            recorder.render("scene depth", &[], Some(attachment), |pass| {
                pass.set_pipeline(&pipeline);
                pass.set_bind_group(0, &bindings, &[]);
                job.geometry.draw_all(pass);
            });
            recorder
        })?;
        recorder.finish("the scene's depth").map(|_| ())
    }

    /// Counts volumes and answers every receiver.
    pub(super) fn run(&self, gpu: &Gpu, receivers: &ReceiverBuffer) -> Result<Vec<PassRecord>, GpuError> {
        let recorder = gpu.scoped("recording the shadow volumes", || {
            let mut recorder = Recorder::new(gpu);
            for (index, (name, draws)) in self.passes.iter().enumerate() {
                let stencil = if index == 0 { LoadOp::Clear(0) } else { LoadOp::Load };
                recorder.render(name, &[], Some(self.attachment(None, stencil)), |pass| self.draw(pass, draws));
            }
            recorder.compute("resolve", |pass| {
                pass.set_pipeline(&self.resolve);
                for (chunk, bindings) in receivers.chunks().iter().zip(&self.resolve_bindings) {
                    pass.set_bind_group(0, bindings, &[]);
                    chunk.dispatch(pass);
                }
            });
            recorder
        })?;
        recorder.finish("the shadow volumes")
    }

    fn draw(&self, pass: &mut RenderPass<'_>, draws: &[Draw]) {
        let (min, size) = (self.scissor.min, self.scissor.size());
        if size.min_element() == 0 {
            return;
        }
        pass.set_scissor_rect(min.x, min.y, size.x, size.y);
        for draw in draws {
            pass.set_pipeline(&draw.pipeline);
            pass.set_bind_group(0, &draw.bindings, &[]);
            pass.set_vertex_buffer(0, draw.vertices.slice(..));
            pass.set_index_buffer(draw.indices.slice(..), IndexFormat::Uint32);
            pass.draw_indexed(0..draw.count, 0, 0..1);
        }
    }

    /// Depth is read only where no operations are given.
    fn attachment(&self, depth: Option<Operations<f32>>, stencil: LoadOp<u32>) -> RenderPassDepthStencilAttachment<'_> {
        RenderPassDepthStencilAttachment {
            view: &self.view,
            depth_ops: depth,
            stencil_ops: Some(Operations { load: stencil, store: StoreOp::Store }),
        }
    }

    /// The counts that the last run left, one per pixel, row by row from the top.
    pub(super) fn stencil(&self, gpu: &Gpu) -> Result<Vec<u8>, GpuError> {
        gpu.read_stencil(&self.buffer, "reading the stencil")
    }

    /// The pixels that are drawn.
    pub(super) fn scissor(&self) -> Rectangle {
        self.scissor
    }

    /// Bytes of the volumes, their uniforms, and the stencil: the depth belongs to the picture.
    pub(super) fn bytes(&self) -> u64 {
        self.buffer_bytes + u64::from(self.buffer.width()) * u64::from(self.buffer.height())
    }
}

impl<'b> Builder<'b> {
    fn new(job: &Job<'b>, settings: &'b Settings, eye: &Eye, volumes: &Volumes) -> Self {
        let gpu = job.gpu;
        let light: DVec4 = job.light.homogeneous();
        let extrusion = ExtrusionUniform {
            light: light.as_vec4().to_array(),
            length_m: match volumes.reach {
                Reach::Infinite => 0.0,
                Reach::Metres(length_m) => length_m as f32,
            },
            padding: [0; 3],
        };
        let vertices = init(gpu, "volume vertices", bytemuck::cast_slice(&volumes.vertices), BufferUsages::VERTEX);
        let eye_uniform = uniform(gpu, bytemuck::bytes_of(&eye_uniform(eye)));
        let extrusion_uniform = uniform(gpu, bytemuck::bytes_of(&extrusion));
        let bytes = vertices.size() + eye_uniform.size() + extrusion_uniform.size();
        Self {
            gpu,
            settings,
            eye_uniform,
            extrusion_uniform,
            corners: job.geometry.corners().cloned(),
            vertices,
            bytes,
        }
    }

    /// Additions first, then subtractions, where faces take two passes.
    fn volume_draws(&mut self, side: Side, faces: &Faces) -> Vec<Draw> {
        let counting = |inward| Counting {
            side,
            inward,
            clamps: self.settings.clamps_stencil,
            inclusive: self.settings.inclusive_compare,
        };
        let (outward, inward) = (counting(false), counting(true));
        let shader = if self.settings.extrudes_on_gpu { VolumeShader::Extruded } else { VolumeShader::Given };
        let volume_faces = [faces.sides.as_slice(), &faces.back_caps].concat();
        let lists = [
            (Source::Volumes(shader), outward, self.indices(&volume_faces)),
            (Source::Scene, outward, self.indices(&faces.front_caps)),
            (Source::Scene, inward, self.indices(&faces.inward_front_caps)),
        ];
        let halves: &[Option<Half>] =
            if self.settings.two_pass { &[Some(Half::Additions), Some(Half::Subtractions)] } else { &[None] };
        let order = halves.iter().flat_map(|half| lists.iter().map(move |list| (*half, list)));
        order
            .filter_map(|(half, (source, counting, indices))| {
                let (indices, count) = indices.clone()?;
                let pipeline = volume_pipeline(self.gpu, self.settings, *source, *counting, half);
                let bindings = match source {
                    Source::Volumes(VolumeShader::Extruded) => {
                        bind(self.gpu, &pipeline, &[&self.eye_uniform, &self.extrusion_uniform])
                    }
                    Source::Volumes(VolumeShader::Given) | Source::Scene => {
                        bind(self.gpu, &pipeline, &[&self.eye_uniform])
                    }
                };
                let vertices = if *source == Source::Scene { self.corners.clone()? } else { self.vertices.clone() };
                Some(Draw { pipeline, bindings, vertices, indices, count })
            })
            .collect()
    }

    fn near_draws(&mut self, clip_from_caster: Mat4, corners: &[u32]) -> Vec<Draw> {
        let Some(((indices, count), vertices)) = self.indices(corners).zip(self.corners.clone()) else {
            return Vec::new();
        };
        let pipeline = near_pipeline(self.gpu, self.settings);
        let matrix = uniform(self.gpu, bytemuck::bytes_of(&clip_from_caster));
        self.bytes += matrix.size();
        let bindings = bind(self.gpu, &pipeline, &[&matrix]);
        vec![Draw { pipeline, bindings, vertices, indices, count }]
    }

    /// An index list on the device; `None` if it is empty.
    fn indices(&mut self, list: &[u32]) -> Option<(Buffer, u32)> {
        (!list.is_empty()).then(|| {
            let buffer = init(self.gpu, "volume indices", bytemuck::cast_slice(list), BufferUsages::INDEX);
            self.bytes += buffer.size();
            (buffer, list.len() as u32)
        })
    }
}

impl Format {
    /// wgpu's name for it.
    pub(super) fn texture_format(self) -> TextureFormat {
        match self {
            Self::Depth32FloatStencil8 => TextureFormat::Depth32FloatStencil8,
            Self::Depth24PlusStencil8 => TextureFormat::Depth24PlusStencil8,
        }
    }
}

impl FarPlane {
    /// True if volumes beyond the far plane are flattened onto it.
    pub(super) fn clamps(self) -> bool {
        matches!(self, Self::Clamp(_))
    }
}

fn check_size(gpu: &Gpu, volumes: &Volumes) -> Result<(), GpuError> {
    let limit = gpu.limits().buffer_bytes;
    let indices = |faces: &Faces| (faces.sides.len() + faces.back_caps.len()) * size_of::<u32>();
    let asked = size_of_val(volumes.vertices.as_slice()).max(indices(&volumes.behind)).max(indices(&volumes.before));
    if asked as u64 > limit {
        let what = "shadow volumes in bytes of one buffer".to_owned();
        return Err(GpuError::TooLarge { what, asked: asked as u64, limit });
    }
    Ok(())
}

fn eye_uniform(eye: &Eye) -> EyeUniform {
    EyeUniform {
        clip_from_world: eye.clip_from_world,
        depth_at_infinity: eye.depth_at_infinity.unwrap_or_default(),
        infinite: u32::from(eye.depth_at_infinity.is_some()),
        padding: [0; 2],
    }
}

fn uniform(gpu: &Gpu, contents: &[u8]) -> Buffer {
    init(gpu, "volume uniform", contents, BufferUsages::UNIFORM)
}

fn init(gpu: &Gpu, label: &str, contents: &[u8], usage: BufferUsages) -> Buffer {
    gpu.device.create_buffer_init(&BufferInitDescriptor { label: Some(label), contents, usage })
}

fn bind(gpu: &Gpu, pipeline: &RenderPipeline, uniforms: &[&Buffer]) -> BindGroup {
    let entries: Vec<BindGroupEntry<'_>> = (0..)
        .zip(uniforms)
        .map(|(binding, buffer)| BindGroupEntry { binding, resource: buffer.as_entire_binding() })
        .collect();
    let layout = &pipeline.get_bind_group_layout(0);
    gpu.device.create_bind_group(&BindGroupDescriptor { label: None, layout, entries: &entries })
}
