//! Set-up in one line each: textures, buffers, pipelines and bindings as every technique needs them. Pipelines take
//! their layouts from their shaders, whose entry points are called `vertex`, `fragment` and `main`.

use super::Gpu;
use super::shader::Wgsl;
use bytemuck::Pod;
use glam::UVec2;
use wgpu::util::{BufferInitDescriptor, DeviceExt};
use wgpu::{
    BindGroup, BindGroupDescriptor, BindGroupEntry, BindGroupLayout, BindingResource, Buffer, BufferUsages,
    ColorTargetState, CompareFunction, ComputePipeline, ComputePipelineDescriptor, DepthStencilState, Extent3d,
    FilterMode, FragmentState, PrimitiveState, RenderPipeline, RenderPipelineDescriptor, Sampler, SamplerDescriptor,
    Texture, TextureDescriptor, TextureDimension, TextureFormat, TextureUsages, VertexBufferLayout, VertexState,
};

/// A render pipeline to be built.
#[derive(Debug, Default)]
pub(crate) struct Drawing<'d> {
    /// Its name in error messages.
    pub(crate) label: &'d str,
    /// Its WGSL files.
    pub(crate) files: &'d [Wgsl],
    /// Vertex buffers by slot; none for a shader that works vertices out by itself.
    pub(crate) vertices: &'d [Option<VertexBufferLayout<'d>>],
    /// Topology, culling and depth clipping.
    pub(crate) primitive: PrimitiveState,
    /// Depth and stencil, where there are any.
    pub(crate) depth_stencil: Option<DepthStencilState>,
    /// Colour targets; none for a pipeline without a fragment shader.
    pub(crate) targets: &'d [Option<ColorTargetState>],
}

impl Gpu {
    /// A two-dimensional texture of one level and one sample.
    pub(crate) fn texture(&self, label: &str, size: UVec2, format: TextureFormat, usage: TextureUsages) -> Texture {
        self.texture_array(label, size, 1, format, usage)
    }

    /// Layers of two-dimensional textures of one level and one sample.
    pub(crate) fn texture_array(
        &self,
        label: &str,
        size: UVec2,
        layers: u32,
        format: TextureFormat,
        usage: TextureUsages,
    ) -> Texture {
        self.device.create_texture(&TextureDescriptor {
            label: Some(label),
            size: Extent3d { width: size.x, height: size.y, depth_or_array_layers: layers },
            mip_level_count: 1,
            sample_count: 1,
            dimension: TextureDimension::D2,
            format,
            usage,
            view_formats: &[],
        })
    }

    /// A buffer that holds `contents`.
    pub(crate) fn buffer<T: Pod>(&self, label: &str, contents: &[T], usage: BufferUsages) -> Buffer {
        let contents = bytemuck::cast_slice(contents);
        self.device.create_buffer_init(&BufferInitDescriptor { label: Some(label), contents, usage })
    }

    /// A uniform buffer that holds one value.
    pub(crate) fn uniform<T: Pod>(&self, label: &str, value: T) -> Buffer {
        self.buffer(label, &[value], BufferUsages::UNIFORM)
    }

    /// A sampler that compares with the four texels around a place and weighs the answers.
    pub(crate) fn comparing_sampler(&self, compare: CompareFunction) -> Sampler {
        self.device.create_sampler(&SamplerDescriptor {
            label: Some("comparing"),
            mag_filter: FilterMode::Linear,
            min_filter: FilterMode::Linear,
            compare: Some(compare),
            ..SamplerDescriptor::default()
        })
    }

    /// Resources bound in the order of their binding numbers, from 0.
    pub(crate) fn bind(&self, layout: &BindGroupLayout, resources: &[BindingResource<'_>]) -> BindGroup {
        let entries: Vec<BindGroupEntry<'_>> = (0..)
            .zip(resources)
            .map(|(binding, resource)| BindGroupEntry { binding, resource: resource.clone() })
            .collect();
        self.device.create_bind_group(&BindGroupDescriptor { label: None, layout, entries: &entries })
    }

    /// Resources bound by number, for shaders that use some of many.
    pub(crate) fn bind_at(&self, layout: &BindGroupLayout, resources: &[(u32, BindingResource<'_>)]) -> BindGroup {
        let entries: Vec<BindGroupEntry<'_>> = resources
            .iter()
            .map(|(binding, resource)| BindGroupEntry { binding: *binding, resource: resource.clone() })
            .collect();
        self.device.create_bind_group(&BindGroupDescriptor { label: None, layout, entries: &entries })
    }

    /// A compute pipeline.
    pub(crate) fn compute_pipeline(&self, label: &str, files: &[Wgsl]) -> ComputePipeline {
        let text = self.text(files);
        self.pipelines.compute(text.clone(), || {
            self.device.create_compute_pipeline(&ComputePipelineDescriptor {
                label: Some(label),
                layout: None,
                module: &self.module(label, text),
                entry_point: Some("main"),
                compilation_options: Default::default(),
                cache: None,
            })
        })
    }

    /// A render pipeline without multisampling.
    pub(crate) fn render_pipeline(&self, drawing: &Drawing<'_>) -> RenderPipeline {
        let text = self.text(drawing.files);
        let Drawing { label: _, files: _, vertices, primitive, depth_stencil, targets } = drawing;
        let state = format!("{vertices:?} {primitive:?} {depth_stencil:?} {targets:?}");
        self.pipelines.render(text.clone() + &state, || {
            let module = &self.module(drawing.label, text);
            let fragment = (!targets.is_empty()).then(|| FragmentState {
                module,
                entry_point: Some("fragment"),
                compilation_options: Default::default(),
                targets,
            });
            self.device.create_render_pipeline(&RenderPipelineDescriptor {
                label: Some(drawing.label),
                layout: None,
                vertex: VertexState {
                    module,
                    entry_point: Some("vertex"),
                    compilation_options: Default::default(),
                    buffers: vertices,
                },
                primitive: *primitive,
                depth_stencil: depth_stencil.clone(),
                multisample: Default::default(),
                fragment,
                multiview_mask: None,
                cache: None,
            })
        })
    }
}
