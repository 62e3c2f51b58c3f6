//! The GPU side of a map: draw it, look it up, read chosen texels back.

use super::lookup::Lookup;
use super::{Settings, filter};
use crate::gpu::shader::{Wgsl, wgsl};
use crate::gpu::{Geometry, Gpu, GpuError, PassRecord, Recorder};
use crate::technique::receiver_buffer::{ReceiverBuffer, workgroups};
use wgpu::util::{BufferInitDescriptor, DeviceExt};
use wgpu::{
    BindGroup, BindGroupDescriptor, BindGroupEntry, BindingResource, Buffer, BufferUsages, CompareFunction,
    ComputePipeline, ComputePipelineDescriptor, DepthBiasState, DepthStencilState, Extent3d, LoadOp, Operations,
    RenderPassDepthStencilAttachment, RenderPipeline, RenderPipelineDescriptor, StoreOp, Texture, TextureDescriptor,
    TextureDimension, TextureUsages, TextureView, VertexState,
};

const CASTER: Wgsl = wgsl!("map/caster.wgsl");
const LOOKUP: Wgsl = wgsl!("map/lookup.wgsl");
const GATHER: Wgsl = wgsl!("map/gather.wgsl");
const RECEIVER: Wgsl = wgsl!("shared/receiver.wgsl");

/// Every shader module this family can build, as label and files: what tests parse and validate without a GPU.
#[must_use]
pub fn shader_modules() -> Vec<(String, Vec<Wgsl>)> {
    let mut modules = vec![("map caster".to_owned(), vec![CASTER]), ("map gather".to_owned(), vec![GATHER])];
    modules.extend(
        filter::registry()
            .iter()
            .map(|f| (format!("map lookup {}", f.choice().name), vec![RECEIVER, LOOKUP, f.shader()])),
    );
    modules
}

/// Texture, pipelines and bindings of one map and its lookups.
pub(super) struct MapPasses {
    map: Texture,
    view: TextureView,
    caster_pipeline: RenderPipeline,
    caster_bindings: BindGroup,
    lookup_pipeline: ComputePipeline,
    lookup_bindings: Vec<BindGroup>,
    clear_depth: f32,
    uniform_bytes: u64,
}

impl MapPasses {
    /// Builds everything once.
    pub(super) fn new(
        gpu: &Gpu,
        settings: &Settings,
        lookup: &Lookup,
        receivers: &ReceiverBuffer,
    ) -> Result<Self, GpuError> {
        gpu.scoped("the shadow map's set-up", || {
            let map = gpu.device.create_texture(&TextureDescriptor {
                label: Some("shadow map"),
                size: Extent3d {
                    width: lookup.frustum.texels.x,
                    height: lookup.frustum.texels.y,
                    depth_or_array_layers: 1,
                },
                mip_level_count: 1,
                sample_count: 1,
                dimension: TextureDimension::D2,
                format: settings.format.texture_format(),
                usage: TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            });
            let view = map.create_view(&Default::default());
            let uniform = |contents: &[u8]| {
                let usage = BufferUsages::UNIFORM;
                gpu.device.create_buffer_init(&BufferInitDescriptor { label: None, contents, usage })
            };
            let light_uniform = uniform(bytemuck::bytes_of(&lookup.frustum.light_clip_from_world));
            let lookup_uniform = uniform(bytemuck::bytes_of(&lookup.uniform(settings.kernel)));
            let caster_pipeline = caster_pipeline(gpu, settings, lookup);
            let caster_bindings = gpu.device.create_bind_group(&BindGroupDescriptor {
                label: None,
                layout: &caster_pipeline.get_bind_group_layout(0),
                entries: &[BindGroupEntry { binding: 0, resource: light_uniform.as_entire_binding() }],
            });
            let lookup_pipeline = compute_pipeline(gpu, "map lookup", &[RECEIVER, LOOKUP, settings.filter.shader()]);
            let lookup_bindings = receivers
                .chunks()
                .iter()
                .map(|chunk| {
                    let resources = [
                        chunk.receivers.as_entire_binding(),
                        chunk.visibilities.as_entire_binding(),
                        lookup_uniform.as_entire_binding(),
                        BindingResource::TextureView(&view),
                    ];
                    bind(gpu, &lookup_pipeline, resources)
                })
                .collect();
            Self {
                uniform_bytes: light_uniform.size() + lookup_uniform.size(),
                clear_depth: if settings.reversed { 0.0 } else { 1.0 },
                map,
                view,
                caster_pipeline,
                caster_bindings,
                lookup_pipeline,
                lookup_bindings,
            }
        })
    }

    /// Draws the map and looks every receiver up.
    pub(super) fn run(
        &self,
        gpu: &Gpu,
        geometry: &Geometry,
        receivers: &ReceiverBuffer,
    ) -> Result<Vec<PassRecord>, GpuError> {
        let recorder = gpu.scoped("recording the shadow map", || {
            let mut recorder = Recorder::new(gpu);
            let depth = RenderPassDepthStencilAttachment {
                view: &self.view,
                depth_ops: Some(Operations { load: LoadOp::Clear(self.clear_depth), store: StoreOp::Store }),
                stencil_ops: None,
            };
            recorder.render("map", &[], Some(depth), |pass| {
                pass.set_pipeline(&self.caster_pipeline);
                pass.set_bind_group(0, &self.caster_bindings, &[]);
                geometry.draw_casters(pass);
            });
            recorder.compute("lookup", |pass| {
                pass.set_pipeline(&self.lookup_pipeline);
                for (chunk, bindings) in receivers.chunks().iter().zip(&self.lookup_bindings) {
                    pass.set_bind_group(0, bindings, &[]);
                    chunk.dispatch(pass);
                }
            });
            recorder
        })?;
        recorder.finish("the shadow map")
    }

    /// The stored depths of some texels (indices row by row), as the GPU holds them.
    pub(super) fn gather(&self, gpu: &Gpu, texels: &[u32]) -> Result<Vec<f64>, GpuError> {
        if texels.is_empty() {
            return Ok(Vec::new());
        }
        let width = self.map.width();
        let positions: Vec<[u32; 2]> = texels.iter().map(|texel| [texel % width, texel / width]).collect();
        let depths: Buffer = gpu.scoped("gathering texels", || {
            let buffer = |contents: &[u8]| {
                let usage = BufferUsages::STORAGE | BufferUsages::COPY_SRC;
                gpu.device.create_buffer_init(&BufferInitDescriptor { label: None, contents, usage })
            };
            let input = buffer(bytemuck::cast_slice(&positions));
            let output = buffer(bytemuck::cast_slice(&vec![0.0_f32; texels.len()]));
            let pipeline = compute_pipeline(gpu, "map gather", &[GATHER]);
            let resources =
                [input.as_entire_binding(), output.as_entire_binding(), BindingResource::TextureView(&self.view)];
            let bindings = bind(gpu, &pipeline, resources);
            let mut encoder = gpu.device.create_command_encoder(&Default::default());
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(&pipeline);
            pass.set_bind_group(0, &bindings, &[]);
            let [columns, rows] = workgroups(texels.len());
            pass.dispatch_workgroups(columns, rows, 1);
            drop(pass);
            gpu.queue.submit([encoder.finish()]);
            output
        })?;
        let values: Vec<f32> = gpu.read_buffer(&depths, "reading gathered texels")?;
        Ok(values.into_iter().map(f64::from).collect())
    }

    /// Bytes of the map and its uniforms.
    pub(super) fn bytes(&self, settings: &Settings) -> u64 {
        let texels = u64::from(self.map.width()) * u64::from(self.map.height());
        texels * settings.format.bytes() + self.uniform_bytes
    }
}

fn bind<const N: usize>(gpu: &Gpu, pipeline: &ComputePipeline, resources: [BindingResource<'_>; N]) -> BindGroup {
    let mut binding = 0..;
    let entries = resources.map(|resource| BindGroupEntry { binding: binding.next().unwrap_or_default(), resource });
    let layout = &pipeline.get_bind_group_layout(0);
    gpu.device.create_bind_group(&BindGroupDescriptor { label: None, layout, entries: &entries })
}

fn compute_pipeline(gpu: &Gpu, label: &str, files: &[Wgsl]) -> ComputePipeline {
    gpu.device.create_compute_pipeline(&ComputePipelineDescriptor {
        label: Some(label),
        layout: None,
        module: &gpu.shader(label, files),
        entry_point: Some("main"),
        compilation_options: Default::default(),
        cache: None,
    })
}

fn caster_pipeline(gpu: &Gpu, settings: &Settings, lookup: &Lookup) -> RenderPipeline {
    let module = gpu.shader("map caster", &[CASTER]);
    let sign = lookup.frustum.depth_sign();
    gpu.device.create_render_pipeline(&RenderPipelineDescriptor {
        label: Some("map caster"),
        layout: None,
        vertex: VertexState {
            module: &module,
            entry_point: Some("vertex"),
            compilation_options: Default::default(),
            buffers: &[Some(crate::gpu::CORNER_LAYOUT)],
        },
        primitive: Default::default(),
        depth_stencil: Some(DepthStencilState {
            format: settings.format.texture_format(),
            depth_write_enabled: Some(true),
            depth_compare: Some(if settings.reversed { CompareFunction::Greater } else { CompareFunction::Less }),
            stencil: Default::default(),
            bias: DepthBiasState {
                constant: lookup.bias.constant_units * sign as i32,
                slope_scale: (lookup.bias.slope * sign) as f32,
                clamp: (lookup.bias.clamp * sign) as f32,
            },
        }),
        multisample: Default::default(),
        fragment: None,
        multiview_mask: None,
        cache: None,
    })
}
