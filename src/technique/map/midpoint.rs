//! The GPU side of `bias=midpoint`: the nearest layer is drawn into a map of its own, what lies behind it into a second
//! one, and the middle between them into the map that is looked up.
//!
//! C. Everitt, "Interactive Order-Independent Transparency", 2001, peels layers likewise. Both maps hold f32, so that a
//! surface is told from itself whatever the map's format.

use super::Settings;
use super::layers::{Layer, layer_view, layers, record_layers};
use super::lookup::Lookup;
use crate::gpu::shader::{Wgsl, wgsl};
use crate::gpu::{Drawing, Geometry, Gpu, Recorder};
use bytemuck::{Pod, Zeroable};
use wgpu::{
    BindGroup, BindingResource, CompareFunction, DepthStencilState, LoadOp, Operations,
    RenderPassDepthStencilAttachment, RenderPipeline, StoreOp, Texture, TextureFormat, TextureUsages, TextureView,
};

/// Combines the two layers.
pub(super) const MIDPOINT: Wgsl = wgsl!("map/midpoint.wgsl");

/// Format of both layers.
const FORMAT: TextureFormat = TextureFormat::Depth32Float;

/// See the module.
pub(super) struct MidpointPass {
    nearest: Texture,
    second_layers: Vec<Layer>,
    pipeline: RenderPipeline,
    middles: Vec<Middle>,
}

/// The middle of one view.
struct Middle {
    target: TextureView,
    bindings: BindGroup,
    cleared: f32,
}

/// `Midpoint` of `shaders/map/midpoint.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
struct MidpointUniform {
    cleared: f32,
    padding: f32,
    more_padding: [f32; 2],
}

impl MidpointPass {
    /// For the map that is to hold the middles.
    pub(super) fn new(gpu: &Gpu, settings: &Settings, lookup: &Lookup, map: &Texture) -> Self {
        let usage = TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING;
        let layer_count = lookup.views.len() as u32;
        let layer = |label| gpu.texture_array(label, lookup.texels(), layer_count, FORMAT, usage);
        let (nearest, second) = (layer("nearest layer"), layer("second layer"));
        let pipeline = gpu.render_pipeline(&Drawing {
            label: "map midpoint",
            files: &[MIDPOINT],
            depth_stencil: Some(DepthStencilState {
                format: map.format(),
                depth_write_enabled: Some(true),
                depth_compare: Some(CompareFunction::Always),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            targets: &[None],
            ..Drawing::default()
        });
        let middle = |index: u32| {
            let cleared = lookup.views[index as usize].cleared() as f32;
            let uniform = MidpointUniform { cleared, padding: 0.0, more_padding: [0.0; 2] };
            let uniform = gpu.uniform("midpoint", uniform);
            let [nearest, second] = [&nearest, &second].map(|texture| layer_view(texture, index));
            let resources = [
                uniform.as_entire_binding(),
                BindingResource::TextureView(&nearest),
                BindingResource::TextureView(&second),
            ];
            let bindings = gpu.bind(&pipeline.get_bind_group_layout(0), &resources);
            Middle { target: layer_view(map, index), bindings, cleared }
        };
        Self {
            middles: (0..layer_count).map(middle).collect(),
            second_layers: layers(gpu, settings, lookup, &second, Some(&nearest)),
            nearest,
            pipeline,
        }
    }

    /// Where the nearest layer is to be drawn before this is recorded.
    pub(super) fn nearest(&self) -> &Texture {
        &self.nearest
    }

    /// Draws what lies behind the nearest layer, then the middles.
    pub(super) fn record(&self, recorder: &mut Recorder<'_>, geometry: &Geometry) {
        record_layers(recorder, "second layer", &self.second_layers, geometry);
        for middle in &self.middles {
            let depth = RenderPassDepthStencilAttachment {
                view: &middle.target,
                depth_ops: Some(Operations { load: LoadOp::Clear(middle.cleared), store: StoreOp::Store }),
                stencil_ops: None,
            };
            recorder.render("midpoint", &[None], Some(depth), |pass| {
                pass.set_pipeline(&self.pipeline);
                pass.set_bind_group(0, &middle.bindings, &[]);
                pass.draw(0..3, 0..1);
            });
        }
    }

    /// Bytes of both layers and of the uniforms.
    pub(super) fn bytes(&self) -> u64 {
        let texels = u64::from(self.nearest.width()) * u64::from(self.nearest.height());
        let of_view = 2 * texels * size_of::<f32>() as u64 + size_of::<MidpointUniform>() as u64;
        self.middles.len() as u64 * of_view
    }
}

#[cfg(test)]
mod tests {
    use super::{MIDPOINT, MidpointUniform};
    use crate::gpu::layout::{rust_layout, wgsl_layout};

    #[test]
    fn the_uniform_lies_as_the_shader_reads_it() {
        let in_rust = rust_layout!(MidpointUniform { cleared, padding, more_padding });
        assert_eq!(wgsl_layout(&[MIDPOINT], "Midpoint"), in_rust);
    }
}
