//! Chosen texels of layers read back, whatever their format: what replays compare with. As many at once as a binding holds.

use crate::gpu::shader::Wgsl;
use crate::gpu::{Gpu, GpuError};
use crate::technique::receiver_buffer::workgroups;
use bytemuck::Pod;
use wgpu::{BindingResource, BufferUsages, ComputePipeline, TextureView};

/// Column, row and layer of a texel, and 0.
pub(super) type Place = [u32; 4];

/// What is read from where.
pub(super) struct Gather<'g> {
    pub(super) gpu: &'g Gpu,
    /// What error messages call it.
    pub(super) label: &'static str,
    /// Reads a `T` at each place.
    pub(super) shader: Wgsl,
    /// All layers.
    pub(super) layers: &'g TextureView,
}

impl Gather<'_> {
    /// The texels at the places that `place` makes of `texels`, in order.
    pub(super) fn texels<I, T: Pod>(&self, texels: &[I], place: impl Fn(&I) -> Place) -> Result<Vec<T>, GpuError> {
        let limits = self.gpu.limits();
        self.texels_by(limits.storage_binding_bytes.min(limits.buffer_bytes), texels, place)
    }

    /// The same with bindings of at most so many bytes.
    fn texels_by<I, T: Pod>(
        &self,
        binding_bytes: u64,
        texels: &[I],
        place: impl Fn(&I) -> Place,
    ) -> Result<Vec<T>, GpuError> {
        let during = format!("building {}", self.label);
        let pipeline = self.gpu.scoped(&during, || self.gpu.compute_pipeline(self.label, &[self.shader]))?;
        let mut gathered = Vec::with_capacity(texels.len());
        for chunk in texels.chunks(texels_of_binding::<T>(binding_bytes)) {
            let places: Vec<Place> = chunk.iter().map(&place).collect();
            gathered.extend(self.chunk::<T>(&pipeline, &places)?);
        }
        Ok(gathered)
    }

    fn chunk<T: Pod>(&self, pipeline: &ComputePipeline, places: &[Place]) -> Result<Vec<T>, GpuError> {
        let gpu = self.gpu;
        let gathered = gpu.scoped(self.label, || {
            let usage = BufferUsages::STORAGE | BufferUsages::COPY_SRC;
            let input = gpu.buffer("places", places, usage);
            let output = gpu.buffer("gathered", &vec![T::zeroed(); places.len()], usage);
            let resources =
                [input.as_entire_binding(), output.as_entire_binding(), BindingResource::TextureView(self.layers)];
            let bindings = gpu.bind(&pipeline.get_bind_group_layout(0), &resources);
            let mut encoder = gpu.device.create_command_encoder(&Default::default());
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, &bindings, &[]);
            let [columns, rows] = workgroups(places.len());
            pass.dispatch_workgroups(columns, rows, 1);
            drop(pass);
            gpu.queue.submit([encoder.finish()]);
            output
        })?;
        gpu.read_buffer(&gathered, self.label)
    }
}

/// How many places, and as many texels read there, fit into a binding each; at least one.
fn texels_of_binding<T>(binding_bytes: u64) -> usize {
    let largest = size_of::<Place>().max(size_of::<T>()) as u64;
    usize::try_from(binding_bytes / largest).unwrap_or(usize::MAX).max(1)
}

#[cfg(test)]
mod tests {
    use super::super::moment_passes::GATHER;
    use super::*;
    use glam::UVec2;
    use wgpu::util::{DeviceExt, TextureDataOrder};
    use wgpu::{
        Extent3d, TextureDescriptor, TextureDimension, TextureFormat, TextureUsages, TextureViewDescriptor,
        TextureViewDimension,
    };

    #[test]
    fn bindings_hold_places_and_what_is_read_there() {
        assert_eq!((texels_of_binding::<f32>(64), texels_of_binding::<[f32; 4]>(79)), (4, 4));
        assert_eq!((texels_of_binding::<[f64; 4]>(64), texels_of_binding::<f32>(3)), (2, 1));
    }

    #[test]
    fn small_bindings_gather_what_one_large_one_does() {
        const SIZE: UVec2 = UVec2::new(5, 3);
        const LAYERS: u32 = 2;
        let gpu = Gpu::open().unwrap();
        let contents: Vec<[f32; 4]> =
            (0..SIZE.element_product() * LAYERS).map(|i| [i as f32, 0.5, -(i as f32), 1.0]).collect();
        let descriptor = TextureDescriptor {
            label: Some("numbered texels"),
            size: Extent3d { width: SIZE.x, height: SIZE.y, depth_or_array_layers: LAYERS },
            mip_level_count: 1,
            sample_count: 1,
            dimension: TextureDimension::D2,
            format: TextureFormat::Rgba32Float,
            usage: TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST,
            view_formats: &[],
        };
        let bytes = bytemuck::cast_slice(&contents);
        let texture = gpu.device.create_texture_with_data(&gpu.queue, &descriptor, TextureDataOrder::default(), bytes);
        let dimension = Some(TextureViewDimension::D2Array);
        let layers = &texture.create_view(&TextureViewDescriptor { dimension, ..Default::default() });
        let gather = Gather { gpu: &gpu, label: "gathering numbers", shader: GATHER, layers };
        let place = |i: &u32| [i % SIZE.x, i / SIZE.x % SIZE.y, i / SIZE.element_product(), 0];
        // Backwards, so that the order counts.
        let wanted: Vec<u32> = (0..contents.len() as u32).rev().collect();
        let expected: Vec<[f32; 4]> = contents.into_iter().rev().collect();
        for binding_bytes in [1, 64, 7 * 16, 30 * 16, 1 << 20] {
            let gathered: Vec<[f32; 4]> = gather.texels_by(binding_bytes, &wanted, place).unwrap();
            assert_eq!(gathered, expected, "{binding_bytes}");
        }
        assert_eq!(gather.texels::<_, [f32; 4]>(&wanted, place).unwrap(), expected);
        assert!(gather.texels::<_, [f32; 4]>(&[], place).unwrap().is_empty());
        // Control.
        assert_ne!(gather.texels::<_, [f32; 4]>(&wanted[1..], place).unwrap(), expected[..29]);
    }
}
