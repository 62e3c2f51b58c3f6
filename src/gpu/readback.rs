//! Bytes back from the device: buffers, and textures of any width (wgpu pads rows to 256 bytes).

use super::{Gpu, GpuError};
use bytemuck::Pod;
use wgpu::{
    Buffer, BufferDescriptor, BufferUsages, COPY_BYTES_PER_ROW_ALIGNMENT, Extent3d, MapMode, PollType,
    TexelCopyBufferInfo, TexelCopyBufferLayout, TexelCopyTextureInfo, Texture, TextureAspect,
};

impl Gpu {
    /// All of a buffer (usage `COPY_SRC`) as values.
    pub(crate) fn read_buffer<T: Pod>(&self, buffer: &Buffer, during: &str) -> Result<Vec<T>, GpuError> {
        let staging = self.scoped(during, || {
            let staging = self.staging(buffer.size());
            let mut encoder = self.device.create_command_encoder(&Default::default());
            encoder.copy_buffer_to_buffer(buffer, 0, &staging, 0, buffer.size());
            self.queue.submit([encoder.finish()]);
            staging
        })?;
        self.map(&staging, during, |bytes| bytemuck::pod_collect_to_vec(bytes))
    }

    /// A colour texture (usage `COPY_SRC`) of texels the size of `T`, row by row without padding.
    pub(crate) fn read_texture<T: Pod>(&self, texture: &Texture, during: &str) -> Result<Vec<T>, GpuError> {
        self.read_aspect(texture, TextureAspect::All, during)
    }

    /// The stencil of a texture (usage `COPY_SRC`), row by row without padding.
    pub(crate) fn read_stencil(&self, texture: &Texture, during: &str) -> Result<Vec<u8>, GpuError> {
        self.read_aspect(texture, TextureAspect::StencilOnly, during)
    }

    fn read_aspect<T: Pod>(&self, texture: &Texture, aspect: TextureAspect, during: &str) -> Result<Vec<T>, GpuError> {
        let (width, height) = (texture.width(), texture.height());
        let row_bytes = width * size_of::<T>() as u32;
        let padded_row_bytes = row_bytes.next_multiple_of(COPY_BYTES_PER_ROW_ALIGNMENT);
        let staging = self.scoped(during, || {
            let staging = self.staging(u64::from(padded_row_bytes) * u64::from(height));
            let mut encoder = self.device.create_command_encoder(&Default::default());
            encoder.copy_texture_to_buffer(
                TexelCopyTextureInfo { aspect, ..texture.as_image_copy() },
                TexelCopyBufferInfo {
                    buffer: &staging,
                    layout: TexelCopyBufferLayout {
                        offset: 0,
                        bytes_per_row: Some(padded_row_bytes),
                        rows_per_image: None,
                    },
                },
                Extent3d { width, height, depth_or_array_layers: 1 },
            );
            self.queue.submit([encoder.finish()]);
            staging
        })?;
        self.map(&staging, during, |bytes| {
            bytes
                .chunks_exact(padded_row_bytes as usize)
                .flat_map(|row| bytemuck::pod_collect_to_vec(&row[..row_bytes as usize]))
                .collect()
        })
    }

    fn staging(&self, size: u64) -> Buffer {
        self.device.create_buffer(&BufferDescriptor {
            label: Some("readback"),
            size,
            usage: BufferUsages::COPY_DST | BufferUsages::MAP_READ,
            mapped_at_creation: false,
        })
    }

    fn map<R>(&self, staging: &Buffer, during: &str, read: impl FnOnce(&[u8]) -> R) -> Result<R, GpuError> {
        let lost = |why: String| GpuError::Lost { during: during.to_owned(), why };
        let (tell, told) = std::sync::mpsc::channel();
        staging.map_async(MapMode::Read, .., move |result| {
            // The receiver outlives the wait below; if it is gone there is nobody to tell.
            let _ = tell.send(result);
        });
        self.device.poll(PollType::wait_indefinitely()).map_err(|error| lost(error.to_string()))?;
        told.recv().map_err(|error| lost(error.to_string()))?.map_err(|error| lost(error.to_string()))?;
        let view = staging.slice(..).get_mapped_range().map_err(|error| lost(error.to_string()))?;
        let values = read(&view);
        drop(view);
        staging.unmap();
        Ok(values)
    }
}
