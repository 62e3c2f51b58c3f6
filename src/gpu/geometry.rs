//! The scene's triangles on the GPU: one vertex buffer of three corners per triangle, in triangle-id order, so that a
//! vertex shader knows its triangle as `vertex_index / 3` on every adapter.

use super::{Gpu, GpuError};
use crate::scene::{Mesh, Scene};
use std::ops::Range;
use wgpu::{
    Buffer, BufferUsages, VertexAttribute, VertexBufferLayout, VertexFormat, VertexStepMode,
    util::{BufferInitDescriptor, DeviceExt},
};

/// Uploaded triangles.
#[derive(Debug)]
pub struct Geometry {
    /// Three `Vec3` corners per triangle; `None` for a scene without triangles.
    corners: Option<Buffer>,
    every_range: Vec<Range<u32>>,
    casting_ranges: Vec<Range<u32>>,
}

const CORNER_BYTES: u64 = size_of::<[f32; 3]>() as u64;

/// Vertex buffer layout of [`Geometry`]: location 0 is the corner's position in the world.
pub(crate) const CORNER_LAYOUT: VertexBufferLayout<'static> = VertexBufferLayout {
    array_stride: CORNER_BYTES,
    step_mode: VertexStepMode::Vertex,
    attributes: &[VertexAttribute { format: VertexFormat::Float32x3, offset: 0, shader_location: 0 }],
};

impl Geometry {
    /// Uploads a scene's triangles.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`] or [`GpuError::OutOfMemory`].
    pub fn upload(gpu: &Gpu, scene: &Scene) -> Result<Self, GpuError> {
        let corners: Vec<[f32; 3]> =
            scene.triangles.iter().flatten().map(|v| scene.positions[*v as usize].to_array()).collect();
        let bytes = corners.len() as u64 * CORNER_BYTES;
        let limit = gpu.limits().buffer_bytes;
        if bytes > limit {
            return Err(GpuError::TooLarge { what: "geometry in bytes".to_owned(), asked: bytes, limit });
        }
        let corners = (!corners.is_empty())
            .then(|| {
                gpu.scoped("geometry upload", || {
                    gpu.device.create_buffer_init(&BufferInitDescriptor {
                        label: Some("corners"),
                        contents: bytemuck::cast_slice(&corners),
                        usage: BufferUsages::VERTEX | BufferUsages::STORAGE,
                    })
                })
            })
            .transpose()?;
        let ranges = |choose: fn(&Mesh) -> bool| {
            merged(scene.meshes.iter().filter(|mesh| choose(mesh)).map(|mesh| mesh.triangles.clone()))
        };
        Ok(Self { corners, every_range: ranges(|_| true), casting_ranges: ranges(|mesh| mesh.casts) })
    }

    /// Bytes on the GPU.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.corners.as_ref().map_or(0, Buffer::size)
    }

    /// Three corners per triangle, laid out as [`CORNER_LAYOUT`], for vertex or storage bindings; `None` for a scene
    /// without triangles.
    pub(crate) fn corners(&self) -> Option<&Buffer> {
        self.corners.as_ref()
    }

    /// Draws every triangle.
    pub(crate) fn draw_all(&self, pass: &mut wgpu::RenderPass<'_>) {
        self.draw_triangles(pass, &self.every_range);
    }

    /// Draws the triangles that cast shadows.
    pub(crate) fn draw_casters(&self, pass: &mut wgpu::RenderPass<'_>) {
        self.draw_triangles(pass, &self.casting_ranges);
    }

    /// Draws ranges of triangle ids.
    pub(crate) fn draw_triangles(&self, pass: &mut wgpu::RenderPass<'_>, triangle_ranges: &[Range<u32>]) {
        let Some(corners) = &self.corners else { return };
        pass.set_vertex_buffer(0, corners.slice(..));
        for range in triangle_ranges {
            pass.draw(range.start * 3..range.end * 3, 0..1);
        }
    }
}

/// Neighbouring ranges joined, so that a scene of many objects is few draws.
fn merged(ranges: impl Iterator<Item = Range<u32>>) -> Vec<Range<u32>> {
    let mut joined: Vec<Range<u32>> = Vec::new();
    for range in ranges.filter(|range| !range.is_empty()) {
        match joined.last_mut() {
            Some(last) if last.end == range.start => last.end = range.end,
            _ => joined.push(range),
        }
    }
    joined
}

#[cfg(test)]
mod tests {
    use super::merged;

    #[test]
    fn neighbouring_ranges_become_one_draw() {
        assert_eq!(merged([0..2, 2..2, 2..5, 7..9].into_iter()), vec![0..5, 7..9]);
    }
}
