//! The GPU side of moment filters: the means of a map's moments, along rows and then along columns.

use super::Settings;
use super::filter::moments::{Moments, Storage};
use super::gather::{Gather, Place};
use super::lookup::Lookup;
use crate::gpu::shader::{Wgsl, wgsl};
use crate::gpu::{Gpu, GpuError, Recorder};
use glam::{DVec4, UVec2, Vec4};
use wgpu::{
    BindGroup, BindingResource, Buffer, BufferUsages, ComputePipeline, Texture, TextureUsages, TextureView,
    TextureViewDescriptor, TextureViewDimension,
};

/// Reads chosen means back.
pub(super) const GATHER: Wgsl = wgsl!("map/moments/gather.wgsl");
/// Texels more than the map's along each axis: every window that a lookup may ask for.
const WINDOWS_BEYOND: u32 = 2;
/// Threads of a workgroup along each axis.
const WORKGROUP: u32 = 8;

/// Textures, pipelines and bindings.
pub(super) struct MomentPasses {
    passes: [Pass; 2],
    means: Texture,
    overflowed: Buffer,
    bytes: u64,
    texel_reads: u64,
}

/// Means along one axis.
struct Pass {
    pipeline: ComputePipeline,
    bindings: BindGroup,
    groups: [u32; 3],
}

/// The side of the texture of means.
pub(super) fn side(map: u32) -> u32 {
    map + WINDOWS_BEYOND
}

impl MomentPasses {
    /// For a map whose layers and numbers are given.
    pub(super) fn new(
        gpu: &Gpu,
        settings: &Settings,
        moments: &dyn Moments,
        lookup: &Lookup,
        layers: &TextureView,
        numbers: &Buffer,
    ) -> Self {
        let storage = Storage::of(moments.count(), settings.kernel.is_half);
        let usage = TextureUsages::STORAGE_BINDING | TextureUsages::TEXTURE_BINDING;
        let count = lookup.views.len() as u32;
        let texels = lookup.texels();
        let texture = |label: &str, size: UVec2| gpu.texture_array(label, size, count, storage.format, usage);
        let rows = texture("moments by rows", UVec2::new(side(texels.x), texels.y));
        let means = texture("moments", UVec2::new(side(texels.x), side(texels.y)));
        let usage = BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST;
        let overflowed = gpu.buffer("overflowed moments", &[0_u32], usage);
        let [of_rows, of_columns] = storage.modules(settings.filter.shader(), settings.projection.layout());
        let pass = |label: &str, files: &[Wgsl], written: &Texture, bound: &[(u32, BindingResource<'_>)]| {
            let pipeline = gpu.compute_pipeline(label, files);
            let target = array_view(written);
            let shared = [(1, BindingResource::TextureView(&target)), (5, numbers.as_entire_binding())];
            Pass {
                bindings: gpu.bind_at(&pipeline.get_bind_group_layout(0), &[&shared, bound].concat()),
                groups: [written.width().div_ceil(WORKGROUP), written.height().div_ceil(WORKGROUP), count],
                pipeline,
            }
        };
        let by_rows = array_view(&rows);
        let from_rows = [(0, BindingResource::TextureView(&by_rows)), (3, overflowed.as_entire_binding())];
        let texels_of = |texture: &Texture| u64::from(texture.width()) * u64::from(texture.height());
        let written = u64::from(count) * (texels_of(&rows) + texels_of(&means));
        Self {
            passes: [
                pass("moments by rows", &of_rows, &rows, &[(0, BindingResource::TextureView(layers))]),
                pass("moments by columns", &of_columns, &means, &from_rows),
            ],
            bytes: storage.bytes() * written,
            texel_reads: u64::from(settings.kernel.number) * written,
            means,
            overflowed,
        }
    }

    /// What lookups read.
    pub(super) fn view(&self) -> TextureView {
        array_view(&self.means)
    }

    /// After the map is drawn.
    pub(super) fn record(&self, gpu: &Gpu, recorder: &mut Recorder<'_>) {
        gpu.queue.write_buffer(&self.overflowed, 0, &[0; size_of::<u32>()]);
        recorder.compute("moments", self.texel_reads, |recorded| {
            for pass in &self.passes {
                recorded.set_pipeline(&pass.pipeline);
                recorded.set_bind_group(0, &pass.bindings, &[]);
                let [x, y, z] = pass.groups;
                recorded.dispatch_workgroups(x, y, z);
            }
        });
    }

    /// How many means of the last run the format could not hold.
    pub(super) fn overflowed(&self, gpu: &Gpu) -> Result<u32, GpuError> {
        let counted: Vec<u32> = gpu.read_buffer(&self.overflowed, "counting overflowed moments")?;
        Ok(counted.into_iter().sum())
    }

    /// The means at some places, as the GPU holds them.
    pub(super) fn gather(&self, gpu: &Gpu, places: &[Place]) -> Result<Vec<DVec4>, GpuError> {
        let layers = &self.view();
        let gather = Gather { gpu, label: "gathering moments", shader: GATHER, layers };
        let means: Vec<[f32; 4]> = gather.texels(places, |place| *place)?;
        Ok(means.into_iter().map(|mean| Vec4::from_array(mean).as_dvec4()).collect())
    }

    /// Bytes of the textures.
    pub(super) fn bytes(&self) -> u64 {
        self.bytes
    }
}

fn array_view(texture: &Texture) -> TextureView {
    let dimension = Some(TextureViewDimension::D2Array);
    texture.create_view(&TextureViewDescriptor { dimension, ..Default::default() })
}
