//! The asked receivers on the GPU, rounded to f32, and the visibilities that come back.

use super::TechniqueError;
use crate::gpu::{Gpu, GpuError, Recorder};
use crate::mask::{Mask, Visibility};
use crate::receiver::{PixelClass, Receivers};
use bytemuck::{Pod, Zeroable};
use wgpu::util::{BufferInitDescriptor, DeviceExt};
use wgpu::{BindGroup, Buffer, BufferUsages, ComputePipeline};

/// A receiver as the shaders read it (`Receiver` in `shaders/shared/receiver.wgsl`).
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub(crate) struct GpuReceiver {
    /// Rebased world, metres.
    pub point_in_world: [f32; 3],
    /// Triangle id.
    pub triangle: u32,
    /// Unit geometric normal turned towards the eye.
    pub normal_in_world: [f32; 3],
    /// Pixel index.
    pub pixel: u32,
}

/// What a shader writes where it answers nothing: never a visibility.
const SENTINEL: f32 = -1.0;

/// Receivers of one buffer: 64 MiB, within every adapter's smallest storage binding limit.
const CHUNK: usize = 1 << 21;

/// Threads per workgroup of every lookup shader.
const WORKGROUP: usize = 64;

/// Most workgroups per dimension that wgpu guarantees.
const MAX_GROUPS: usize = 65_535;

/// The asked receivers in chunks, each with room for its visibilities. A clone shares them.
#[derive(Debug, Clone)]
pub struct ReceiverBuffer {
    chunks: Vec<Chunk>,
}

/// One chunk: buffers of receivers and of visibilities, entry by entry.
#[derive(Debug, Clone)]
pub(crate) struct Chunk {
    pub(crate) receivers: Buffer,
    pub(crate) visibilities: Buffer,
    pixels: Vec<u32>,
}

impl ReceiverBuffer {
    /// Uploads the receivers of all asked pixels.
    ///
    /// # Errors
    /// What the device reported.
    pub fn upload(gpu: &Gpu, receivers: &Receivers, classes: &[PixelClass]) -> Result<Self, GpuError> {
        let asked: Vec<GpuReceiver> = receivers
            .pixels
            .iter()
            .zip(classes)
            .enumerate()
            .filter(|(_, (_, class))| **class == PixelClass::Asked)
            .filter_map(|(pixel, (receiver, _))| receiver.map(|r| (pixel as u32, r)))
            .map(|(pixel, receiver)| GpuReceiver {
                point_in_world: receiver.point_in_world.as_vec3().to_array(),
                triangle: receiver.triangle,
                normal_in_world: receiver.normal_in_world.as_vec3().to_array(),
                pixel,
            })
            .collect();
        let buffer = |contents: &[u8]| {
            gpu.device.create_buffer_init(&BufferInitDescriptor {
                label: Some("receivers"),
                contents,
                usage: BufferUsages::STORAGE | BufferUsages::COPY_SRC,
            })
        };
        let chunks = gpu.scoped("receiver upload", || {
            let chunk = |part: &[GpuReceiver]| Chunk {
                receivers: buffer(bytemuck::cast_slice(part)),
                visibilities: buffer(bytemuck::cast_slice(&vec![SENTINEL; part.len()])),
                pixels: part.iter().map(|receiver| receiver.pixel).collect(),
            };
            asked.chunks(CHUNK).map(chunk).collect()
        })?;
        Ok(Self { chunks })
    }

    pub(crate) fn chunks(&self) -> &[Chunk] {
        &self.chunks
    }

    /// Bytes on the GPU.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.chunks.iter().map(|chunk| chunk.receivers.size() + chunk.visibilities.size()).sum()
    }

    /// The visibilities the shaders wrote, as a mask over the whole picture.
    ///
    /// # Errors
    /// [`TechniqueError::NoAnswer`] if an asked pixel has none.
    pub fn mask(&self, gpu: &Gpu, receivers: &Receivers) -> Result<Mask, TechniqueError> {
        let mut mask = Mask { size: receivers.size, pixels: vec![None; receivers.pixels.len()] };
        for chunk in &self.chunks {
            let values: Vec<f32> = gpu.read_buffer(&chunk.visibilities, "reading the mask")?;
            for (pixel, value) in chunk.pixels.iter().zip(values) {
                let (x, y) = (pixel % receivers.size.x, pixel / receivers.size.x);
                let answer = Visibility::new(value).ok_or(TechniqueError::NoAnswer { x, y, value })?;
                mask.pixels[*pixel as usize] = Some(answer);
            }
        }
        Ok(mask)
    }
}

/// What a lookup runs with.
pub(crate) struct LookUp<'l> {
    /// The pass's name.
    pub(crate) name: &'static str,
    /// A thread per receiver.
    pub(crate) pipeline: &'l ComputePipeline,
    /// One for each chunk.
    pub(crate) bindings: &'l [BindGroup],
    /// Texels that a receiver reads at most.
    pub(crate) texel_reads: u32,
}

impl ReceiverBuffer {
    /// Records a pass that looks every receiver up.
    pub(crate) fn look_up(&self, recorder: &mut Recorder<'_>, look_up: &LookUp<'_>) {
        let receivers: usize = self.chunks.iter().map(|chunk| chunk.pixels.len()).sum();
        recorder.compute(look_up.name, receivers as u64 * u64::from(look_up.texel_reads), |pass| {
            pass.set_pipeline(look_up.pipeline);
            for (chunk, bindings) in self.chunks.iter().zip(look_up.bindings) {
                pass.set_bind_group(0, bindings, &[]);
                chunk.dispatch(pass);
            }
        });
    }
}

impl Chunk {
    /// Pixel index of each receiver, in order.
    pub(crate) fn pixels(&self) -> &[u32] {
        &self.pixels
    }

    /// Dispatches one thread per receiver; shaders find theirs by `shared/receiver.wgsl`.
    pub(crate) fn dispatch(&self, pass: &mut wgpu::ComputePass<'_>) {
        let [columns, rows] = workgroups(self.pixels.len());
        pass.dispatch_workgroups(columns, rows, 1);
    }
}

/// Workgroups of 64 threads for `threads` of them, in two dimensions because one is too short.
pub(crate) fn workgroups(threads: usize) -> [u32; 2] {
    let groups = threads.div_ceil(WORKGROUP);
    let columns = groups.min(MAX_GROUPS);
    [columns as u32, groups.div_ceil(columns.max(1)) as u32]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::layout::{rust_layout, wgsl_layout};
    use crate::gpu::shader::wgsl;

    #[test]
    fn receivers_lie_as_the_shaders_read_them() {
        let in_rust = rust_layout!(GpuReceiver { point_in_world, triangle, normal_in_world, pixel });
        assert_eq!(wgsl_layout(&[wgsl!("shared/receiver.wgsl")], "Receiver"), in_rust);
    }

    #[test]
    fn enough_threads_for_every_receiver() {
        for threads in [0, 1, 64, 65, WORKGROUP * MAX_GROUPS + 1, 1 << 26] {
            let [columns, rows] = workgroups(threads);
            assert!(columns as usize * rows as usize * WORKGROUP >= threads);
            assert!(columns as usize <= MAX_GROUPS && rows as usize <= MAX_GROUPS);
        }
    }
}
