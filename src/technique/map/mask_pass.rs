//! The nearest and the farthest depth of every block of a map's texels, by which filters tell shadow edges apart.

use super::lookup::Lookup;
use crate::gpu::shader::{Wgsl, wgsl};
use crate::gpu::{Gpu, Recorder};
use bytemuck::{Pod, Zeroable};
use wgpu::{
    BindGroup, BindingResource, ComputePipeline, Texture, TextureFormat, TextureUsages, TextureView,
    TextureViewDescriptor, TextureViewDimension,
};

pub(super) const EXTREMES: Wgsl = wgsl!("map/extremes.wgsl");
/// Threads of a workgroup along each axis.
const WORKGROUP: u32 = 8;

/// `Blocks` of `shaders/map/extremes.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
struct Blocks {
    side: u32,
    depth_sign: f32,
    padding: [u32; 2],
}

/// Texture, pipeline and bindings.
pub(super) struct MaskPass {
    extremes: Texture,
    pipeline: ComputePipeline,
    bindings: BindGroup,
    texel_reads: u64,
}

impl MaskPass {
    /// For blocks of 2^`level` texels a side of a map whose layers are given.
    pub(super) fn new(gpu: &Gpu, lookup: &Lookup, layers: &TextureView, level: u32) -> Self {
        let side = 1 << level;
        let texels = lookup.texels();
        let (size, count) = ((texels + (side - 1)) / side, lookup.views.len() as u32);
        let usage = TextureUsages::STORAGE_BINDING | TextureUsages::TEXTURE_BINDING;
        let extremes = gpu.texture_array("depth extremes", size, count, TextureFormat::Rg32Float, usage);
        let pipeline = gpu.compute_pipeline("depth extremes", &[EXTREMES]);
        let blocks = Blocks { side, depth_sign: lookup.views[0].depth_sign as f32, padding: [0; 2] };
        let uniform = gpu.uniform("blocks", blocks);
        let written = array_view(&extremes);
        let resources =
            [uniform.as_entire_binding(), BindingResource::TextureView(layers), BindingResource::TextureView(&written)];
        Self {
            bindings: gpu.bind(&pipeline.get_bind_group_layout(0), &resources),
            texel_reads: u64::from(texels.element_product()) * u64::from(count),
            extremes,
            pipeline,
        }
    }

    /// What lookups read.
    pub(super) fn view(&self) -> TextureView {
        array_view(&self.extremes)
    }

    /// After the map is drawn.
    pub(super) fn record(&self, recorder: &mut Recorder<'_>) {
        recorder.compute("depth extremes", self.texel_reads, |pass| {
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &self.bindings, &[]);
            let groups = [self.extremes.width(), self.extremes.height()].map(|side| side.div_ceil(WORKGROUP));
            pass.dispatch_workgroups(groups[0], groups[1], self.extremes.depth_or_array_layers());
        });
    }

    /// Bytes of the texture.
    pub(super) fn bytes(&self) -> u64 {
        let texels = u64::from(self.extremes.width()) * u64::from(self.extremes.height());
        texels * u64::from(self.extremes.depth_or_array_layers()) * size_of::<[f32; 2]>() as u64
    }
}

fn array_view(texture: &Texture) -> TextureView {
    let dimension = Some(TextureViewDimension::D2Array);
    texture.create_view(&TextureViewDescriptor { dimension, ..Default::default() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::layout::{rust_layout, wgsl_layout};

    #[test]
    fn the_uniform_lies_as_the_shader_reads_it() {
        assert_eq!(wgsl_layout(&[EXTREMES], "Blocks"), rust_layout!(Blocks { side, depth_sign, padding }));
    }
}
