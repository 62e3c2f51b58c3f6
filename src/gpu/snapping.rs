//! How finely the adapter's rasteriser places vertices, measured: APIs promise a grid of 1/16 pixel, most devices have
//! 1/256, and no API tells. A vertex that is snapped carries its depth along, so maps hold the depths of planes that are
//! shifted by up to half a step.

use super::gbuffer::pipeline;
use super::{Gpu, GpuError};
use glam::{Mat4, UVec2};
use wgpu::{
    BufferUsages, Color, LoadOp, Operations, RenderPassColorAttachment, RenderPassDepthStencilAttachment,
    RenderPassDescriptor, StoreOp, TextureFormat, TextureUsages,
};

/// Pixels of the picture, one beside the other, each with a triangle whose upper side lies below the pixel's centre: by half
/// of [`OFFSET_PX`] in the first, by that much more in each of the others.
const PIXELS: u32 = 256;
/// A power of two, for f32 to hold every offset; the coarsest grid that is told from coarser ones is 1/8 pixel.
const OFFSET_PX: f64 = 1.0 / 4096.0;

/// The step of the grid that vertices are snapped to, pixels.
///
/// # Errors
/// What the device reported.
pub(super) fn vertex_step_px(gpu: &Gpu) -> Result<f64, GpuError> {
    let ids = gpu.scoped("measuring how vertices are snapped", || draw(gpu))?;
    let ids = gpu.read_texture::<u32>(&ids, "reading how vertices are snapped")?;
    // A side less than half a step below the centre is snapped onto it, and then the centre is covered.
    let covered = ids.iter().filter(|id| **id != 0).count();
    Ok(2.0 * OFFSET_PX * covered.max(1) as f64)
}

fn draw(gpu: &Gpu) -> wgpu::Texture {
    let size = UVec2::new(PIXELS, 1);
    let ids = gpu.texture(
        "snapped",
        size,
        TextureFormat::R32Uint,
        TextureUsages::RENDER_ATTACHMENT | TextureUsages::COPY_SRC,
    );
    let depth = gpu.texture("snapped depth", size, TextureFormat::Depth32Float, TextureUsages::RENDER_ATTACHMENT);
    let pipeline = pipeline(gpu);
    let identity = gpu.uniform("identity", Mat4::IDENTITY);
    let bindings = gpu.bind(&pipeline.get_bind_group_layout(0), &[identity.as_entire_binding()]);
    let corners: Vec<[f32; 3]> = (0..PIXELS).flat_map(triangle_below_centre).collect();
    let corners = gpu.buffer("triangles to snap", &corners, BufferUsages::VERTEX);
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    {
        let mut pass = encoder.begin_render_pass(&RenderPassDescriptor {
            label: Some("snapping"),
            color_attachments: &[Some(RenderPassColorAttachment {
                view: &ids.create_view(&Default::default()),
                depth_slice: None,
                resolve_target: None,
                ops: Operations { load: LoadOp::Clear(Color::TRANSPARENT), store: StoreOp::Store },
            })],
            depth_stencil_attachment: Some(RenderPassDepthStencilAttachment {
                view: &depth.create_view(&Default::default()),
                depth_ops: Some(Operations { load: LoadOp::Clear(0.0), store: StoreOp::Discard }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &bindings, &[]);
        pass.set_vertex_buffer(0, corners.slice(..));
        pass.draw(0..3 * PIXELS, 0..1);
    }
    gpu.queue.submit([encoder.finish()]);
    ids
}

/// Corners in clip space of a triangle from a pixel's left to its right side, down to its lower left corner.
fn triangle_below_centre(pixel: u32) -> [[f32; 3]; 3] {
    const DEPTH: f32 = 0.5;
    let at = |pixels: u32| (2.0 * f64::from(pixels) / f64::from(PIXELS) - 1.0) as f32;
    let upper = (-2.0 * (f64::from(pixel) + 0.5) * OFFSET_PX) as f32;
    [[at(pixel), upper, DEPTH], [at(pixel + 1), upper, DEPTH], [at(pixel), -1.0, DEPTH]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_step_is_a_power_of_two_and_none_is_coarser_than_apis_allow() {
        let gpu = Gpu::open().unwrap();
        let step = gpu.vertex_step_px();
        assert!((step.log2() - step.log2().round()).abs() < 1e-9, "{step}");
        assert!((1.0 / 4096.0..=1.0 / 16.0).contains(&step), "{step}");
    }
}
