//! What is drawn into the stencil: index lists on the device, each with its pipeline and uniforms.

use super::assembly::Faces;
use super::extrude::Reach;
use super::eye::Eye;
use super::pipelines::{Source, VolumeShader, mask_pipeline, near_pipeline, range_pipeline, volume_pipeline};
use super::quads::Quads;
use super::range::FLAG;
use super::settings::{Extrude, Settings};
use super::states::{Counting, Half, Side};
use super::volumes::Volumes;
use crate::gpu::Gpu;
use crate::technique::Job;
use bytemuck::{Pod, Zeroable};
use glam::Mat4;
use wgpu::{BindGroup, Buffer, BufferUsages, IndexFormat, RenderPass, RenderPipeline};

/// `Eye` of `shaders/volume/clip.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
struct EyeUniform {
    clip_from_world: Mat4,
    depth_at_infinity: f32,
    infinite: u32,
    padding: [u32; 2],
}

/// `Extrusion` of `shaders/volume/extrusion.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
struct ExtrusionUniform {
    light: [f32; 4],
    length_m: f32,
    padding: u32,
    more_padding: [u32; 2],
}

/// `Bound` of `shaders/volume/range.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
struct BoundUniform {
    depth: f32,
    padding: u32,
    more_padding: [u32; 2],
}

/// One draw.
pub(super) struct Draw {
    pipeline: RenderPipeline,
    bindings: BindGroup,
    /// Vertices and indices; none where the vertex shader fetches them itself.
    buffers: Option<[Buffer; 2]>,
    count: u32,
    stencil_reference: u8,
}

/// Builds draws and counts the bytes of what they use.
pub(super) struct Builder<'b> {
    gpu: &'b Gpu,
    settings: &'b Settings,
    eye_uniform: Buffer,
    extrusion_uniform: Buffer,
    corners: Option<Buffer>,
    vertices: Buffer,
    casters: Option<Buffer>,
    pub(super) bytes: u64,
}

impl Draw {
    /// Records it.
    pub(super) fn record(&self, pass: &mut RenderPass<'_>) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.bindings, &[]);
        pass.set_stencil_reference(self.stencil_reference.into());
        match &self.buffers {
            Some([vertices, indices]) => {
                pass.set_vertex_buffer(0, vertices.slice(..));
                pass.set_index_buffer(indices.slice(..), IndexFormat::Uint32);
                pass.draw_indexed(0..self.count, 0, 0..1);
            }
            None => pass.draw(0..self.count, 0..1),
        }
    }
}

impl<'b> Builder<'b> {
    pub(super) fn new(job: &Job<'b>, settings: &'b Settings, eye: &Eye, volumes: &Volumes) -> Self {
        let gpu = job.gpu;
        let extrusion = ExtrusionUniform {
            light: job.light.homogeneous().as_vec4().to_array(),
            length_m: match volumes.reach {
                Reach::Infinite => 0.0,
                Reach::Metres(length_m) => length_m as f32,
            },
            padding: 0,
            more_padding: [0; 2],
        };
        let vertices = gpu.buffer("volume vertices", &volumes.vertices, BufferUsages::VERTEX | BufferUsages::STORAGE);
        let eye_uniform = eye_buffer(gpu, eye);
        let extrusion_uniform = gpu.uniform("extrusion", extrusion);
        let casters =
            (!volumes.casters.is_empty()).then(|| gpu.buffer("casters", &volumes.casters, BufferUsages::STORAGE));
        let bytes =
            vertices.size() + eye_uniform.size() + extrusion_uniform.size() + casters.as_ref().map_or(0, Buffer::size);
        Self {
            gpu,
            settings,
            eye_uniform,
            extrusion_uniform,
            corners: job.geometry.corners().cloned(),
            vertices,
            casters,
            bytes,
        }
    }

    /// Additions first, then subtractions, where faces take two passes; `quads` for a vertex shader that unfolds them.
    pub(super) fn volume_draws(&mut self, side: Side, faces: &Faces, quads: Option<&Quads>) -> Vec<Draw> {
        let counting = |inward| Counting {
            side,
            inward,
            clamps: self.settings.clamps_stencil,
            inclusive: self.settings.inclusive_compare,
        };
        let (outward, inward) = (counting(false), counting(true));
        let shader = match self.settings.extrude {
            Extrude::Cpu => VolumeShader::Given,
            Extrude::Gpu => VolumeShader::Extruded,
            Extrude::DegenerateQuads => return self.quad_draws(quads, [outward, inward]),
        };
        let volume_faces = [faces.sides.as_slice(), &faces.back_caps].concat();
        let lists = [
            (Source::Volumes(shader), outward, self.indices(&volume_faces)),
            (Source::Scene, outward, self.indices(&faces.front_caps)),
            (Source::Scene, inward, self.indices(&faces.inward_front_caps)),
        ];
        let order = self.halves().iter().flat_map(|half| lists.iter().map(move |list| (*half, list)));
        order
            .filter_map(|(half, (source, counting, indices))| {
                let (indices, count) = indices.clone()?;
                let pipeline = volume_pipeline(self.gpu, self.settings, *source, *counting, half);
                let bindings = match source {
                    Source::Volumes(VolumeShader::Extruded) => {
                        bind(self.gpu, &pipeline, &[&self.eye_uniform, &self.extrusion_uniform])
                    }
                    _ => bind(self.gpu, &pipeline, &[&self.eye_uniform]),
                };
                let vertices = if *source == Source::Scene { self.corners.clone()? } else { self.vertices.clone() };
                Some(self.draw(pipeline, bindings, Some([vertices, indices]), count))
            })
            .collect()
    }

    fn halves(&self) -> &'static [Option<Half>] {
        if self.settings.two_pass { &[Some(Half::Additions), Some(Half::Subtractions)] } else { &[None] }
    }

    fn draw(&self, pipeline: RenderPipeline, bindings: BindGroup, buffers: Option<[Buffer; 2]>, count: u32) -> Draw {
        // Volumes are drawn where the flag is set.
        let stencil_reference = if self.settings.has_flag() { FLAG } else { 0 };
        Draw { pipeline, bindings, buffers, count, stencil_reference }
    }

    /// Faces that the vertex shader unfolds.
    fn quad_draws(&mut self, quads: Option<&Quads>, [outward, inward]: [Counting; 2]) -> Vec<Draw> {
        let (Some(quads), Some(casters)) = (quads, self.casters.clone()) else { return Vec::new() };
        let lists: Vec<(Counting, Buffer, u32)> = [(outward, &quads.outward), (inward, &quads.inward)]
            .into_iter()
            .filter(|(_, faces)| !faces.is_empty())
            .map(|(counting, faces)| {
                let buffer = self.gpu.buffer("volume quads", faces, BufferUsages::STORAGE);
                self.bytes += buffer.size();
                (counting, buffer, 3 * faces.len() as u32)
            })
            .collect();
        let order = self.halves().iter().flat_map(|half| lists.iter().map(move |list| (*half, list)));
        order
            .map(|(half, (counting, faces, count))| {
                let pipeline = volume_pipeline(self.gpu, self.settings, Source::Quads, *counting, half);
                let buffers = [&self.eye_uniform, &self.extrusion_uniform, &self.vertices, &casters, faces];
                let bindings = bind(self.gpu, &pipeline, &buffers);
                self.draw(pipeline, bindings, None, *count)
            })
            .collect()
    }

    /// Sets the flag from the first distance on and clears it from the second on.
    pub(super) fn range_draws(&mut self, eye: &Eye, [from_m, to_m]: [f64; 2]) -> Vec<Draw> {
        let bounds = [(from_m, FLAG), (to_m, 0)].into_iter().filter(|(distance_m, _)| distance_m.is_finite());
        bounds
            .map(|(distance_m, stencil_reference)| {
                let pipeline = range_pipeline(self.gpu, self.settings);
                let depth = eye.depth_at(distance_m);
                let bound = self.gpu.uniform("range", BoundUniform { depth, padding: 0, more_padding: [0; 2] });
                self.bytes += bound.size();
                let bindings = bind(self.gpu, &pipeline, &[&bound]);
                Draw { pipeline, bindings, buffers: None, count: 3, stencil_reference }
            })
            .collect()
    }

    /// Sets the flag at the pixels of a mask, in a picture so many pixels wide.
    pub(super) fn mask_draw(&mut self, mask: &Buffer, width: u32) -> Draw {
        let pipeline = mask_pipeline(self.gpu, self.settings);
        let picture = self.gpu.uniform("picture", [width, 0, 0, 0]);
        self.bytes += picture.size();
        let bindings = bind(self.gpu, &pipeline, &[&picture, mask]);
        Draw { pipeline, bindings, buffers: None, count: 3, stencil_reference: FLAG }
    }

    pub(super) fn near_draws(&mut self, clip_from_caster: Mat4, corners: &[u32]) -> Vec<Draw> {
        let Some(((indices, count), vertices)) = self.indices(corners).zip(self.corners.clone()) else {
            return Vec::new();
        };
        let pipeline = near_pipeline(self.gpu, self.settings);
        let matrix = self.gpu.uniform("near projection", clip_from_caster);
        self.bytes += matrix.size();
        let bindings = bind(self.gpu, &pipeline, &[&matrix]);
        vec![self.draw(pipeline, bindings, Some([vertices, indices]), count)]
    }

    /// An index list on the device; `None` if it is empty.
    fn indices(&mut self, list: &[u32]) -> Option<(Buffer, u32)> {
        (!list.is_empty()).then(|| {
            let buffer = self.gpu.buffer("volume indices", list, BufferUsages::INDEX);
            self.bytes += buffer.size();
            (buffer, list.len() as u32)
        })
    }
}

/// The camera's uniform on the device.
pub(super) fn eye_buffer(gpu: &Gpu, eye: &Eye) -> Buffer {
    gpu.uniform("eye", eye_uniform(eye))
}

fn eye_uniform(eye: &Eye) -> EyeUniform {
    EyeUniform {
        clip_from_world: eye.clip_from_world,
        depth_at_infinity: eye.depth_at_infinity.unwrap_or_default(),
        infinite: u32::from(eye.depth_at_infinity.is_some()),
        padding: [0; 2],
    }
}

/// Buffers bound in order.
fn bind(gpu: &Gpu, pipeline: &RenderPipeline, buffers: &[&Buffer]) -> BindGroup {
    let resources: Vec<_> = buffers.iter().map(|buffer| buffer.as_entire_binding()).collect();
    gpu.bind(&pipeline.get_bind_group_layout(0), &resources)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::layout::{rust_layout, wgsl_layout};
    use crate::technique::volume::pipelines::shader_modules;

    #[test]
    fn uniforms_lie_where_the_shaders_read_them() {
        let modules = shader_modules();
        let (_, files) = modules.iter().find(|(label, _)| label == "volume extruded").unwrap();
        let eye = rust_layout!(EyeUniform { clip_from_world, depth_at_infinity, infinite, padding });
        assert_eq!(wgsl_layout(files, "Eye"), eye);
        let extrusion = rust_layout!(ExtrusionUniform { light, length_m, padding, more_padding });
        assert_eq!(wgsl_layout(files, "Extrusion"), extrusion);
        let (_, files) = modules.iter().find(|(label, _)| label == "volume range").unwrap();
        assert_eq!(wgsl_layout(files, "Bound"), rust_layout!(BoundUniform { depth, padding, more_padding }));
        assert_ne!(eye, extrusion);
    }
}
