//! The GPU side: the scene's depth once, then per run the volumes into the stencil and the stencil into visibilities.

use super::assembly::Faces;
use super::draws::{Builder, Draw, eye_buffer};
use super::eye::Eye;
use super::pipelines::{resolve_pipeline, scene_pipeline};
use super::range::distances_m;
use super::scissor::Rectangle;
use super::settings::{FarPlane, Format, Settings};
use super::states::Side;
use super::target::Target;
use super::volumes::Volumes;
use crate::gpu::{Gpu, GpuError, PassRecord, Recorder};
use crate::technique::receiver_buffer::LookUp;
use crate::technique::{Job, ReceiverBuffer};
use wgpu::{
    BindGroup, BindingResource, Buffer, ComputePipeline, LoadOp, Operations, RenderPass,
    RenderPassDepthStencilAttachment, StoreOp, Texture, TextureAspect, TextureFormat, TextureUsages, TextureView,
    TextureViewDescriptor,
};

/// The camera's depth and stencil, and everything that is drawn into it.
pub(super) struct VolumePasses {
    buffer: Texture,
    view: TextureView,
    /// What sets the flag at the pixels of a mask.
    mask: Option<Draw>,
    /// Passes in order, each with its draws; the first one of all clears the stencil.
    passes: Vec<(&'static str, Vec<Draw>)>,
    scissor: Rectangle,
    resolve: ComputePipeline,
    resolve_bindings: Vec<BindGroup>,
    buffer_bytes: u64,
    /// The stencil's bits that count.
    counting_mask: u8,
    /// What every count starts from.
    start: u8,
}

impl VolumePasses {
    /// Builds everything, and draws the scene's depth: that belongs to any renderer and is no cost of volumes.
    pub(super) fn new(
        job: &Job<'_>,
        settings: &Settings,
        eye: &Eye,
        volumes: &Volumes,
        target: &Target,
        start: i64,
    ) -> Result<Self, GpuError> {
        check_size(job.gpu, volumes)?;
        let start = start.rem_euclid(1 << settings.counting_bits()) as u8;
        let passes =
            job.gpu.scoped("the shadow volumes' set-up", || Self::build(job, settings, eye, volumes, target, start))?;
        passes.draw_scene(job, settings, eye)?;
        Ok(passes)
    }

    fn build(job: &Job<'_>, settings: &Settings, eye: &Eye, volumes: &Volumes, target: &Target, start: u8) -> Self {
        let size = job.scene.image_size;
        let usage = TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_SRC;
        let buffer = job.gpu.texture("depth and stencil", size, settings.format.texture_format(), usage);
        let mut builder = Builder::new(job, settings, eye, volumes);
        let mask = target.mask.as_ref().map(|mask| builder.mask_draw(mask, size.x));
        let mut passes = Vec::new();
        if settings.range_mask {
            passes.push(("range mask", builder.range_draws(eye, distances_m(job.light, eye))));
        }
        if let Some((clip_from_caster, corners)) = &volumes.near_casters {
            passes.push(("near counts", builder.near_draws(*clip_from_caster, corners)));
        }
        let [quads_behind, quads_before] = volumes.quads.as_ref().map_or([None; 2], |quads| quads.each_ref().map(Some));
        for (name, side, faces, quads) in [
            ("z-fail volumes", Side::Behind, &volumes.behind, quads_behind),
            ("z-pass volumes", Side::Before, &volumes.before, quads_before),
        ] {
            let draws = builder.volume_draws(side, faces, quads);
            // A count without any volume still has to clear the stencil.
            if !draws.is_empty() || (side == Side::Before && passes.is_empty()) {
                passes.push((name, draws));
            }
        }
        let resolve = resolve_pipeline(job.gpu, settings);
        let counting_mask = u8::MAX >> (u8::BITS - settings.counting_bits());
        let counting = job.gpu.uniform("counting", [u32::from(counting_mask), 0, 0, 0]);
        builder.bytes += counting.size();
        let counts = buffer.create_view(&TextureViewDescriptor {
            aspect: TextureAspect::StencilOnly,
            ..TextureViewDescriptor::default()
        });
        let resolve_bindings = target.receivers.chunks().iter().map(|chunk| {
            let mut resources = vec![
                chunk.receivers.as_entire_binding(),
                chunk.visibilities.as_entire_binding(),
                BindingResource::TextureView(&counts),
                counting.as_entire_binding(),
            ];
            resources.extend(target.mask.as_ref().map(Buffer::as_entire_binding));
            job.gpu.bind(&resolve.get_bind_group_layout(0), &resources)
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
            counting_mask,
            start,
            buffer,
            mask,
            passes,
            resolve,
        }
    }

    fn draw_scene(&self, job: &Job<'_>, settings: &Settings, eye: &Eye) -> Result<(), GpuError> {
        let recorder = job.gpu.scoped("recording the scene's depth", || {
            let pipeline = scene_pipeline(job.gpu, settings);
            let eye_uniform = eye_buffer(job.gpu, eye);
            let bindings = job.gpu.bind(&pipeline.get_bind_group_layout(0), &[eye_uniform.as_entire_binding()]);
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
            if let Some(mask) = &self.mask {
                let attachment = self.attachment(None, LoadOp::Clear(self.start.into()));
                recorder.render("mask", &[None], Some(attachment), |pass| self.draw(pass, std::slice::from_ref(mask)));
            }
            for (index, (name, draws)) in self.passes.iter().enumerate() {
                let is_first = index == 0 && self.mask.is_none();
                let stencil = if is_first { LoadOp::Clear(self.start.into()) } else { LoadOp::Load };
                recorder.render(name, &[], Some(self.attachment(None, stencil)), |pass| self.draw(pass, draws));
            }
            let (pipeline, bindings) = (&self.resolve, self.resolve_bindings.as_slice());
            receivers.look_up(&mut recorder, &LookUp { name: "resolve", pipeline, bindings, texel_reads: 1 });
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
        draws.iter().for_each(|draw| draw.record(pass));
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
        let stencil = gpu.read_stencil(&self.buffer, "reading the stencil")?;
        Ok(stencil.into_iter().map(|count| count & self.counting_mask).collect())
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
    let too_large = |what: &str, asked: usize, limit| {
        Err(GpuError::TooLarge { what: format!("{what} in bytes of one buffer"), asked: asked as u64, limit })
    };
    if asked as u64 > limit {
        return too_large("shadow volumes", asked, limit);
    }
    let quads = volumes.quads.iter().flatten().map(|quads| size_of_val(quads.outward.as_slice()));
    let (asked, limit) = (quads.max().unwrap_or(0), gpu.limits().storage_binding_bytes);
    if asked as u64 > limit { too_large("degenerate quads", asked, limit) } else { Ok(()) }
}
