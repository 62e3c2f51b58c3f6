//! The GPU side: the casters in an acceleration structure, and one ray per receiver.

use crate::gpu::shader::{Wgsl, wgsl};
use crate::gpu::{Gpu, GpuError, PassRecord, Recorder};
use crate::technique::receiver_buffer::{Chunk, LookUp};
use crate::technique::{Job, ReceiverBuffer};
use bytemuck::{Pod, Zeroable};
use wgpu::{
    AccelerationStructureFlags, AccelerationStructureGeometryFlags, AccelerationStructureUpdateMode, BindGroup,
    BlasBuildEntry, BlasGeometries, BlasGeometrySizeDescriptors, BlasTriangleGeometry,
    BlasTriangleGeometrySizeDescriptor, BufferUsages, ComputePipeline, CreateBlasDescriptor, CreateTlasDescriptor,
    Features, Tlas, TlasInstance, VertexFormat,
};

const SHADOW: [Wgsl; 2] = [wgsl!("ray_query/shadow.wgsl"), wgsl!("shared/receiver.wgsl")];
const CORNER_BYTES: u64 = size_of::<[f32; 3]>() as u64;
/// The scene stands where it is.
const IDENTITY: [f32; 12] = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0];
/// Beyond all geometry, in radii of the scene; the truth's rays end there too.
const BEYOND_RADII: f64 = 4.0;

/// Every shader module this family can build, as label and files: what tests parse and validate without a GPU.
#[must_use]
pub fn shader_modules() -> Vec<(String, Vec<Wgsl>)> {
    vec![("ray query".to_owned(), SHADOW.to_vec())]
}

/// Whether the device casts rays.
pub(super) fn supports(gpu: &Gpu) -> bool {
    gpu.has(Features::EXPERIMENTAL_RAY_QUERY)
}

/// `Light` of `shaders/ray_query/shadow.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
struct LightUniform {
    light: [f32; 4],
    reach: f32,
    padding: f32,
    more_padding: [f32; 2],
}

/// The acceleration structure, pipeline and bindings.
pub(super) struct RayPasses {
    pipeline: ComputePipeline,
    bindings: Vec<BindGroup>,
    bytes: u64,
}

impl RayPasses {
    /// Builds everything once. The structure belongs to any renderer that casts rays: building it is no cost of a run.
    pub(super) fn new(job: &Job<'_>, receivers: &ReceiverBuffer) -> Result<Self, GpuError> {
        job.gpu.scoped("the acceleration structure's set-up", || Self::build(job, receivers))
    }

    fn build(job: &Job<'_>, receivers: &ReceiverBuffer) -> Self {
        let (gpu, scene) = (job.gpu, job.scene);
        let surface_of = |triangle: u32| job.casters.surface_of(triangle);
        let casting: Vec<u32> = scene.casting_triangles().filter(|&t| surface_of(t) == t).collect();
        let structure = structure(job, &casting);
        let light = LightUniform {
            light: job.light.homogeneous().as_vec4().to_array(),
            reach: (BEYOND_RADII * scene.bounds().radius()) as f32,
            padding: 0.0,
            more_padding: [0.0; 2],
        };
        let light = gpu.uniform("shadow ray light", light);
        let of_triangle: Vec<u32> = (0..scene.triangles.len() as u32).map(surface_of).collect();
        // A binding is never empty.
        let of_primitive = if casting.is_empty() { vec![0] } else { casting };
        let of_primitive = gpu.buffer("surfaces of primitives", &of_primitive, BufferUsages::STORAGE);
        let of_triangle = gpu.buffer("surfaces of triangles", &of_triangle, BufferUsages::STORAGE);
        let pipeline = gpu.compute_pipeline("ray query", &SHADOW);
        let bind = |chunk: &Chunk| {
            let resources = [
                chunk.receivers.as_entire_binding(),
                chunk.visibilities.as_entire_binding(),
                light.as_entire_binding(),
                structure.as_binding(),
                of_primitive.as_entire_binding(),
                of_triangle.as_entire_binding(),
            ];
            gpu.bind(&pipeline.get_bind_group_layout(0), &resources)
        };
        let bindings = receivers.chunks().iter().map(bind).collect();
        let bytes = light.size() + of_primitive.size() + of_triangle.size();
        Self { bindings, bytes, pipeline }
    }

    /// Casts a ray for every receiver.
    pub(super) fn run(&self, gpu: &Gpu, receivers: &ReceiverBuffer) -> Result<Vec<PassRecord>, GpuError> {
        let recorder = gpu.scoped("recording the shadow rays", || {
            let mut recorder = Recorder::new(gpu);
            let (pipeline, bindings) = (&self.pipeline, self.bindings.as_slice());
            receivers.look_up(&mut recorder, &LookUp { name: "shadow rays", pipeline, bindings, texel_reads: 0 });
            recorder
        })?;
        recorder.finish("the shadow rays")
    }

    /// Bytes of the buffers; what the acceleration structure takes the device does not tell.
    pub(super) fn bytes(&self) -> u64 {
        self.bytes
    }
}

/// An acceleration structure over some triangles, as one instance.
fn structure(job: &Job<'_>, casting: &[u32]) -> Tlas {
    let (gpu, scene) = (job.gpu, job.scene);
    let corner = |vertex: u32| scene.positions[vertex as usize].to_array();
    let corners: Vec<[f32; 3]> = casting.iter().flat_map(|&t| scene.triangles[t as usize].map(corner)).collect();
    let instances = u32::from(!corners.is_empty());
    let mut structure = gpu.device.create_tlas(&CreateTlasDescriptor {
        label: Some("casters"),
        max_instances: instances.max(1),
        flags: AccelerationStructureFlags::PREFER_FAST_TRACE,
        update_mode: AccelerationStructureUpdateMode::Build,
    });
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    if corners.is_empty() {
        encoder.build_acceleration_structures([], [&structure]);
    } else {
        let size = BlasTriangleGeometrySizeDescriptor {
            vertex_format: VertexFormat::Float32x3,
            vertex_count: corners.len() as u32,
            index_format: None,
            index_count: None,
            flags: AccelerationStructureGeometryFlags::NO_DUPLICATE_ANY_HIT_INVOCATION,
        };
        let triangles = gpu.device.create_blas(
            &CreateBlasDescriptor {
                label: Some("casters' triangles"),
                flags: AccelerationStructureFlags::PREFER_FAST_TRACE,
                update_mode: AccelerationStructureUpdateMode::Build,
            },
            BlasGeometrySizeDescriptors::Triangles { descriptors: vec![size.clone()] },
        );
        let buffer = gpu.buffer("casters' corners", &corners, BufferUsages::BLAS_INPUT);
        let geometry = BlasTriangleGeometry {
            size: &size,
            vertex_buffer: &buffer,
            first_vertex: 0,
            vertex_stride: CORNER_BYTES,
            index_buffer: None,
            first_index: None,
            transform_buffer: None,
            transform_buffer_offset: None,
        };
        structure[0] = Some(TlasInstance::new(&triangles, IDENTITY, 0, 0xff));
        let entry = BlasBuildEntry { blas: &triangles, geometry: BlasGeometries::TriangleGeometries(vec![geometry]) };
        encoder.build_acceleration_structures([&entry], [&structure]);
    }
    gpu.queue.submit([encoder.finish()]);
    structure
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::layout::{rust_layout, wgsl_layout};

    #[test]
    fn the_uniform_lies_as_the_shader_reads_it() {
        let in_rust = rust_layout!(LightUniform { light, reach, padding, more_padding });
        assert_eq!(wgsl_layout(&SHADOW, "Light"), in_rust);
    }
}
