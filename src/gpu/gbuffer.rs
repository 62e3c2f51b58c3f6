//! The G-buffer: which triangle each pixel centre shows.

use super::geometry::CORNER_LAYOUT;
use super::{Drawing, Geometry, Gpu, GpuError, PassRecord, Recorder, shader};
use crate::scene::Scene;
use glam::UVec2;
use wgpu::{
    BindGroup, Color, CompareFunction, DepthStencilState, LoadOp, Operations, RenderPassColorAttachment,
    RenderPassDepthStencilAttachment, RenderPipeline, StoreOp, Texture, TextureFormat, TextureUsages,
};

/// Triangle ids of one picture.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GBuffer {
    /// Width and height in pixels.
    pub size: UVec2,
    /// Triangle id per pixel centre, row by row from the top; `None` is background.
    pub triangles: Vec<Option<u32>>,
}

/// Most pixels of one picture. Receivers, truth and replay take about 130 bytes a pixel: this many need 8 GB.
const MAX_PIXELS: u64 = 1 << 26;

/// The pass that draws it, ready to run: every frame of a renderer has one like it, so it is also what other passes' times
/// are measured against.
#[derive(Debug)]
pub struct GBufferPass {
    size: UVec2,
    ids: Texture,
    depth: Texture,
    pipeline: RenderPipeline,
    bindings: BindGroup,
}

impl GBufferPass {
    /// For a scene from its camera: depth reversed, nothing culled.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`] if the picture exceeds the adapter's limit, or what the device reported.
    pub fn new(gpu: &Gpu, scene: &Scene) -> Result<Self, GpuError> {
        let size = scene.image_size;
        let too_large = |what: &str, asked: u64, limit: u64| GpuError::TooLarge { what: what.to_owned(), asked, limit };
        let limit = gpu.limits().texture_side;
        if size.max_element() > limit {
            return Err(too_large("a picture side in pixels", size.max_element().into(), limit.into()));
        }
        let pixels = u64::from(size.x) * u64::from(size.y);
        if pixels > MAX_PIXELS {
            return Err(too_large("a picture's number of pixels", pixels, MAX_PIXELS));
        }
        gpu.scoped("the G-buffer's set-up", || {
            let usage = TextureUsages::RENDER_ATTACHMENT | TextureUsages::COPY_SRC;
            let pipeline = pipeline(gpu);
            let camera = gpu.uniform("camera", scene.camera.clip_from_world(size).as_mat4());
            Self {
                size,
                ids: gpu.texture("ids", size, TextureFormat::R32Uint, usage),
                depth: gpu.texture("depth", size, TextureFormat::Depth32Float, TextureUsages::RENDER_ATTACHMENT),
                bindings: gpu.bind(&pipeline.get_bind_group_layout(0), &[camera.as_entire_binding()]),
                pipeline,
            }
        })
    }

    /// Rasterises the scene.
    ///
    /// # Errors
    /// What the device reported.
    pub fn run(&self, gpu: &Gpu, geometry: &Geometry) -> Result<Vec<PassRecord>, GpuError> {
        let recorder = gpu.scoped("recording the G-buffer", || {
            let mut recorder = Recorder::new(gpu);
            recorder.render(
                "g-buffer",
                &[Some(RenderPassColorAttachment {
                    view: &self.ids.create_view(&Default::default()),
                    depth_slice: None,
                    resolve_target: None,
                    ops: Operations { load: LoadOp::Clear(Color::TRANSPARENT), store: StoreOp::Store },
                })],
                Some(RenderPassDepthStencilAttachment {
                    view: &self.depth.create_view(&Default::default()),
                    depth_ops: Some(Operations { load: LoadOp::Clear(0.0), store: StoreOp::Discard }),
                    stencil_ops: None,
                }),
                |pass| {
                    pass.set_pipeline(&self.pipeline);
                    pass.set_bind_group(0, &self.bindings, &[]);
                    geometry.draw_all(pass);
                },
            );
            recorder
        })?;
        recorder.finish("the G-buffer")
    }

    /// What the last run drew.
    ///
    /// # Errors
    /// What the device reported.
    pub fn read(&self, gpu: &Gpu) -> Result<GBuffer, GpuError> {
        let ids = gpu.read_texture::<u32>(&self.ids, "the G-buffer's readback")?;
        Ok(GBuffer { size: self.size, triangles: ids.into_iter().map(|id| id.checked_sub(1)).collect() })
    }
}

/// How triangle ids are drawn: nearest first in reversed depth, nothing culled.
pub(super) fn pipeline(gpu: &Gpu) -> RenderPipeline {
    gpu.render_pipeline(&Drawing {
        label: "gbuffer",
        files: &[shader::GBUFFER],
        vertices: &[Some(CORNER_LAYOUT)],
        depth_stencil: Some(DepthStencilState {
            format: TextureFormat::Depth32Float,
            depth_write_enabled: Some(true),
            depth_compare: Some(CompareFunction::Greater),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        targets: &[Some(TextureFormat::R32Uint.into())],
        ..Drawing::default()
    })
}
