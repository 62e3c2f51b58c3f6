//! The GPU side of a projective texture: draw the casters black, look every receiver up.

use super::Settings;
use crate::gpu::shader::{Wgsl, wgsl};
use crate::gpu::{CORNER_LAYOUT, Drawing, GpuError, PassRecord, Recorder};
use crate::technique::map::{Lookup, filter};
use crate::technique::receiver_buffer::LookUp;
use crate::technique::{Job, ReceiverBuffer};
use bytemuck::{Pod, Zeroable};
use glam::Mat4;
use wgpu::util::{BufferInitDescriptor, DeviceExt};
use wgpu::{
    BindGroup, BindGroupDescriptor, BindGroupEntry, BindingResource, BufferUsages, Color, ColorTargetState,
    ColorWrites, ComputePipeline, Extent3d, LoadOp, Operations, RenderPassColorAttachment, RenderPipeline, StoreOp,
    TextureDescriptor, TextureDimension, TextureFormat, TextureUsages, TextureView,
};

const CASTER: Wgsl = wgsl!("projective_texture/caster.wgsl");
const LOOKUP: Wgsl = wgsl!("projective_texture/lookup.wgsl");
const RECEIVER: Wgsl = wgsl!("shared/receiver.wgsl");

/// Every shader module this family can build, as label and files: what tests parse and validate without a GPU.
#[must_use]
pub fn shader_modules() -> Vec<(String, Vec<Wgsl>)> {
    let lookup = |filter: &&dyn filter::Filter| {
        let label = format!("projective texture lookup {}", filter.choice().name);
        (label, vec![RECEIVER, LOOKUP, filter.shader()])
    };
    let caster = ("projective texture caster".to_owned(), vec![CASTER]);
    std::iter::once(caster).chain(filter::registry().iter().filter(|f| !f.reads_map()).map(lookup)).collect()
}

/// 0 where a caster is, 1 elsewhere; one byte per texel.
const PICTURE: TextureFormat = TextureFormat::R8Unorm;

/// `Lookup` of `shaders/projective_texture/lookup.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
struct LookupUniform {
    map_from_world: Mat4,
    texels: [f32; 2],
    kernel: u32,
    padding: u32,
}

/// Texture, pipelines and bindings of one picture and its lookups.
pub(super) struct PicturePasses {
    picture: TextureView,
    caster_pipeline: RenderPipeline,
    caster_bindings: BindGroup,
    lookup_pipeline: ComputePipeline,
    lookup_bindings: Vec<BindGroup>,
    bytes: u64,
}

impl PicturePasses {
    /// Builds everything once.
    pub(super) fn new(
        job: &Job<'_>,
        settings: &Settings,
        lookup: &Lookup,
        receivers: &ReceiverBuffer,
    ) -> Result<Self, GpuError> {
        let gpu = job.gpu;
        gpu.scoped("the projective texture's set-up", || {
            let view = &lookup.views[0];
            let texels = view.texels;
            let picture = gpu.device.create_texture(&TextureDescriptor {
                label: Some("projective texture"),
                size: Extent3d { width: texels.x, height: texels.y, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: TextureDimension::D2,
                format: PICTURE,
                usage: TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            });
            let picture = picture.create_view(&Default::default());
            let buffer = |contents: &[u8], usage: BufferUsages| {
                gpu.device.create_buffer_init(&BufferInitDescriptor { label: None, contents, usage })
            };
            let light = buffer(bytemuck::bytes_of(&view.clip_from_world), BufferUsages::UNIFORM);
            let uniform = LookupUniform {
                map_from_world: view.map_from_world(),
                texels: texels.as_vec2().to_array(),
                kernel: settings.map.kernel.number,
                padding: 0,
            };
            let uniform = buffer(bytemuck::bytes_of(&uniform), BufferUsages::UNIFORM);
            let takes_shadow: Vec<u32> = (job.scene.meshes.iter())
                .flat_map(|mesh| mesh.triangles.clone().map(|_| settings.takes_shadow(mesh).into()))
                .collect();
            let takes_shadow = buffer(bytemuck::cast_slice(&takes_shadow), BufferUsages::STORAGE);
            let caster_pipeline = caster_pipeline(job);
            let caster_bindings = gpu.device.create_bind_group(&BindGroupDescriptor {
                label: None,
                layout: &caster_pipeline.get_bind_group_layout(0),
                entries: &[BindGroupEntry { binding: 0, resource: light.as_entire_binding() }],
            });
            let lookup_pipeline = lookup_pipeline(job, settings);
            let bind = |resources: [BindingResource<'_>; 5]| {
                let mut binding = 0..;
                let entry = |resource| BindGroupEntry { binding: binding.next().unwrap_or_default(), resource };
                gpu.device.create_bind_group(&BindGroupDescriptor {
                    label: None,
                    layout: &lookup_pipeline.get_bind_group_layout(0),
                    entries: &resources.map(entry),
                })
            };
            let lookup_bindings = receivers
                .chunks()
                .iter()
                .map(|chunk| {
                    bind([
                        chunk.receivers.as_entire_binding(),
                        chunk.visibilities.as_entire_binding(),
                        uniform.as_entire_binding(),
                        takes_shadow.as_entire_binding(),
                        BindingResource::TextureView(&picture),
                    ])
                })
                .collect();
            let of_texels = u64::from(texels.x) * u64::from(texels.y);
            Self {
                bytes: of_texels + light.size() + uniform.size() + takes_shadow.size(),
                picture,
                caster_pipeline,
                caster_bindings,
                lookup_pipeline,
                lookup_bindings,
            }
        })
    }

    /// Draws the picture and looks every receiver up.
    pub(super) fn run(&self, job: &Job<'_>, receivers: &ReceiverBuffer) -> Result<Vec<PassRecord>, GpuError> {
        let recorder = job.gpu.scoped("recording the projective texture", || {
            let mut recorder = Recorder::new(job.gpu);
            let picture = Some(RenderPassColorAttachment {
                view: &self.picture,
                depth_slice: None,
                resolve_target: None,
                ops: Operations { load: LoadOp::Clear(Color::WHITE), store: StoreOp::Store },
            });
            recorder.render("picture", &[picture], None, |pass| {
                pass.set_pipeline(&self.caster_pipeline);
                pass.set_bind_group(0, &self.caster_bindings, &[]);
                job.geometry.draw_casters(pass);
            });
            let (pipeline, bindings) = (&self.lookup_pipeline, self.lookup_bindings.as_slice());
            receivers.look_up(&mut recorder, &LookUp { name: "lookup", pipeline, bindings, texel_reads: 1 });
            recorder
        })?;
        recorder.finish("the projective texture")
    }

    /// Bytes of the picture and its buffers.
    pub(super) fn bytes(&self) -> u64 {
        self.bytes
    }
}

fn caster_pipeline(job: &Job<'_>) -> RenderPipeline {
    job.gpu.render_pipeline(&Drawing {
        label: "projective texture caster",
        files: &[CASTER],
        vertices: &[Some(CORNER_LAYOUT)],
        targets: &[Some(ColorTargetState { format: PICTURE, blend: None, write_mask: ColorWrites::ALL })],
        ..Drawing::default()
    })
}

fn lookup_pipeline(job: &Job<'_>, settings: &Settings) -> ComputePipeline {
    job.gpu.compute_pipeline("projective texture lookup", &[RECEIVER, LOOKUP, settings.map.filter.shader()])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::shader::concatenated;
    use std::mem::offset_of;

    #[test]
    fn the_uniform_is_laid_out_as_the_shader_reads_it() {
        let nearest = filter::by_name("nearest").shader();
        let module = naga::front::wgsl::parse_str(&concatenated(&[RECEIVER, LOOKUP, nearest])).unwrap();
        let lookup = module.types.iter().find(|(_, kind)| kind.name.as_deref() == Some("Lookup")).unwrap().1;
        let naga::TypeInner::Struct { members, span } = &lookup.inner else { panic!("{lookup:?}") };
        let offsets: Vec<usize> = members.iter().map(|member| member.offset as usize).collect();
        let expected = [
            offset_of!(LookupUniform, map_from_world),
            offset_of!(LookupUniform, texels),
            offset_of!(LookupUniform, kernel),
            offset_of!(LookupUniform, padding),
        ];
        assert_eq!(offsets, expected);
        assert_eq!(*span as usize, size_of::<LookupUniform>());
    }
}
