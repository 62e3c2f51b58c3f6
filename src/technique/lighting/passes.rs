//! The passes of each pipeline. Every pass after the first draws at exactly the depth that the first one stored, and none
//! of those that draw light changes the stencil: a left-over operation would make the picture depend on the draw order.

use super::buffers::{LightUniform, Part, SceneUniform, Shadow, corners, materials};
use super::{LightingPipeline, SHADOW, SURFACE};
use crate::gpu::{CORNER_LAYOUT, Drawing, Geometry, Gpu, GpuError, Recorder};
use crate::mask::{Mask, Visibility};
use crate::scene::{Light, Scene};
use glam::Vec3;
use half::f16;
use wgpu::{
    BindingResource, BlendComponent, BlendFactor, BlendOperation, BlendState, Buffer, BufferUsages, Color,
    ColorTargetState, ColorWrites, CompareFunction, DepthStencilState, Features, LoadOp, Operations,
    RenderPassColorAttachment, RenderPassDepthStencilAttachment, StencilFaceState, StencilOperation, StencilState,
    StoreOp, TexelCopyBufferLayout, TextureFormat, TextureUsages, TextureView,
};

/// Blendable on every adapter.
const COLOUR: TextureFormat = TextureFormat::Rgba16Float;

/// A scene to be lit.
pub(super) struct Lighting<'l> {
    pub(super) gpu: &'l Gpu,
    pub(super) scene: &'l Scene,
    pub(super) geometry: &'l Geometry,
    pub(super) pipeline: LightingPipeline,
    pub(super) background: Vec3,
}

/// How a pass of surfaces meets what is already there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Onto {
    /// The first pass: stores colour and depth.
    Nothing,
    /// The brighter of both, where the stencil is 0.
    Brighter,
    /// The sum, where the stencil is 0.
    Sum,
}

/// A triangle over the whole picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Quad {
    /// Sets the stencil to 1 in a light's shadow and to 0 elsewhere.
    Mask,
    /// Blends darkness over what the stencil says is in shadow.
    Darkness,
}

impl Quad {
    fn stencil(self) -> StencilState {
        match self {
            Self::Mask => {
                let set = StencilFaceState {
                    compare: CompareFunction::Always,
                    pass_op: StencilOperation::Replace,
                    ..StencilFaceState::IGNORE
                };
                StencilState { front: set, back: set, read_mask: !0, write_mask: !0 }
            }
            Self::Darkness => reading(CompareFunction::NotEqual),
        }
    }

    fn target(self) -> ColorTargetState {
        match self {
            Self::Mask => target(None, ColorWrites::empty()),
            Self::Darkness => target(Some(BlendState::ALPHA_BLENDING), ColorWrites::ALL),
        }
    }
}

/// One light on the device.
struct LightSource {
    uniform: Buffer,
    visibilities: TextureView,
}

/// What all passes share.
struct Shared {
    scene: Buffer,
    corners: Buffer,
    materials: Buffer,
    colour: TextureView,
    depth: TextureView,
}

fn target(blend: Option<BlendState>, write_mask: ColorWrites) -> ColorTargetState {
    ColorTargetState { format: COLOUR, blend, write_mask }
}

fn added(operation: BlendOperation) -> BlendState {
    let component = BlendComponent { src_factor: BlendFactor::One, dst_factor: BlendFactor::One, operation };
    BlendState { color: component, alpha: component }
}

impl Lighting<'_> {
    pub(super) fn run(&self, lights: &[(&Light, &Mask)]) -> Result<Vec<Vec3>, GpuError> {
        let gpu = self.gpu;
        let size = self.scene.image_size;
        if self.scene.triangles.is_empty() || lights.is_empty() {
            return Ok(vec![self.background; size.element_product() as usize]);
        }
        let (colour, recorder) = gpu.scoped("recording the lighting", || {
            let usage = TextureUsages::RENDER_ATTACHMENT | TextureUsages::COPY_SRC;
            let colour = gpu.texture("colour", size, COLOUR, usage);
            let depth = gpu.texture("depth and stencil", size, self.depth_format(), TextureUsages::RENDER_ATTACHMENT);
            let shared = Shared {
                scene: gpu.uniform("scene", SceneUniform::new(self.scene)),
                corners: gpu.buffer("corners", &corners(self.scene), BufferUsages::STORAGE),
                materials: gpu.buffer("materials", &materials(self.scene), BufferUsages::STORAGE),
                colour: colour.create_view(&Default::default()),
                depth: depth.create_view(&Default::default()),
            };
            let sources: Vec<LightSource> = lights.iter().map(|(light, mask)| self.source(light, mask)).collect();
            let mut recorder = Recorder::new(gpu);
            self.record(&mut recorder, &shared, &sources);
            (colour, recorder)
        })?;
        recorder.finish("the lighting")?;
        let pixels = gpu.read_texture::<[u16; 4]>(&colour, "reading the picture")?;
        let number = |bits: u16| f16::from_bits(bits).to_f32();
        Ok(pixels.into_iter().map(|[r, g, b, _]| Vec3::new(number(r), number(g), number(b))).collect())
    }

    fn record(&self, recorder: &mut Recorder<'_>, shared: &Shared, sources: &[LightSource]) {
        self.surfaces(recorder, shared, &sources[0], Part::base(self.pipeline), Onto::Nothing);
        match self.pipeline {
            LightingPipeline::AmbientLit => self.lit(recorder, shared, sources),
            LightingPipeline::Black => {
                for source in sources {
                    self.quad(recorder, shared, source, Quad::Mask);
                    self.surfaces(recorder, shared, source, Part::own_where_seen(), Onto::Brighter);
                }
                self.lit(recorder, shared, sources);
            }
            LightingPipeline::Darkening { .. } => {
                for source in sources {
                    self.surfaces(recorder, shared, source, Part::direct(), Onto::Sum);
                }
                for source in sources {
                    self.quad(recorder, shared, source, Quad::Mask);
                    self.quad(recorder, shared, source, Quad::Darkness);
                }
            }
        }
    }

    fn lit(&self, recorder: &mut Recorder<'_>, shared: &Shared, sources: &[LightSource]) {
        for source in sources {
            self.quad(recorder, shared, source, Quad::Mask);
            self.surfaces(recorder, shared, source, Part::direct_where_seen(), Onto::Sum);
        }
    }

    fn source(&self, light: &Light, mask: &Mask) -> LightSource {
        let visibility = |pixel: &Option<Visibility>| pixel.unwrap_or(Visibility::LIT).get();
        let values: Vec<f32> = mask.pixels.iter().map(visibility).collect();
        let usage = TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST;
        let texture = self.gpu.texture("visibilities", mask.size, TextureFormat::R32Float, usage);
        let layout = TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * mask.size.x), rows_per_image: None };
        self.gpu.queue.write_texture(texture.as_image_copy(), bytemuck::cast_slice(&values), layout, texture.size());
        LightSource {
            uniform: self.gpu.uniform("light", LightUniform::new(light, self.scene.mode)),
            visibilities: texture.create_view(&Default::default()),
        }
    }

    /// Draws the scene's surfaces under one light.
    fn surfaces(&self, recorder: &mut Recorder<'_>, shared: &Shared, source: &LightSource, part: Part, onto: Onto) {
        let (blend, name) = match onto {
            Onto::Nothing => (None, "base"),
            Onto::Brighter => (Some(added(BlendOperation::Max)), "ambient where seen"),
            Onto::Sum => (Some(added(BlendOperation::Add)), "light"),
        };
        let is_first = onto == Onto::Nothing;
        let stencil = if is_first { StencilState::default() } else { reading(CompareFunction::Equal) };
        let compare = if is_first { CompareFunction::Greater } else { CompareFunction::Equal };
        let pipeline = self.gpu.render_pipeline(&Drawing {
            label: "lighting surface",
            files: &[SURFACE],
            vertices: &[Some(CORNER_LAYOUT)],
            depth_stencil: Some(self.depth_stencil(is_first, compare, stencil)),
            targets: &[Some(target(blend, ColorWrites::ALL))],
            ..Drawing::default()
        });
        let part = self.gpu.uniform("part", part);
        let resources = [
            shared.scene.as_entire_binding(),
            shared.corners.as_entire_binding(),
            shared.materials.as_entire_binding(),
            source.uniform.as_entire_binding(),
            part.as_entire_binding(),
            BindingResource::TextureView(&source.visibilities),
        ];
        let bindings = self.gpu.bind(&pipeline.get_bind_group_layout(0), &resources);
        let clear = is_first.then_some(0);
        recorder.render(
            name,
            &[Some(self.onto(shared, is_first))],
            Some(onto_depth(shared, is_first, clear)),
            |pass| {
                pass.set_pipeline(&pipeline);
                pass.set_bind_group(0, &bindings, &[]);
                pass.set_stencil_reference(0);
                self.geometry.draw_all(pass);
            },
        );
    }

    /// Draws one triangle over the whole picture.
    fn quad(&self, recorder: &mut Recorder<'_>, shared: &Shared, source: &LightSource, quad: Quad) {
        let pipeline = self.gpu.render_pipeline(&Drawing {
            label: "lighting shadow",
            files: &[SHADOW],
            depth_stencil: Some(self.depth_stencil(false, CompareFunction::Always, quad.stencil())),
            targets: &[Some(quad.target())],
            ..Drawing::default()
        });
        let shadow = self.gpu.uniform("shadow", Shadow::new(self.pipeline));
        let resources = [shadow.as_entire_binding(), BindingResource::TextureView(&source.visibilities)];
        let bindings = self.gpu.bind(&pipeline.get_bind_group_layout(0), &resources);
        let (name, clear, reference) = match quad {
            Quad::Mask => ("shadow", Some(0), 1),
            Quad::Darkness => ("darkness", None, 0),
        };
        let depth = onto_depth(shared, false, clear);
        recorder.render(name, &[Some(self.onto(shared, false))], Some(depth), |pass| {
            pass.set_pipeline(&pipeline);
            pass.set_bind_group(0, &bindings, &[]);
            pass.set_stencil_reference(reference);
            pass.draw(0..3, 0..1);
        });
    }

    fn onto<'s>(&self, shared: &'s Shared, is_first: bool) -> RenderPassColorAttachment<'s> {
        let [r, g, b] = self.background.to_array().map(f64::from);
        let load = if is_first { LoadOp::Clear(Color { r, g, b, a: 1.0 }) } else { LoadOp::Load };
        RenderPassColorAttachment {
            view: &shared.colour,
            depth_slice: None,
            resolve_target: None,
            ops: Operations { load, store: StoreOp::Store },
        }
    }

    fn depth_format(&self) -> TextureFormat {
        if self.gpu.has(Features::DEPTH32FLOAT_STENCIL8) {
            TextureFormat::Depth32FloatStencil8
        } else {
            TextureFormat::Depth24PlusStencil8
        }
    }

    fn depth_stencil(&self, writes: bool, compare: CompareFunction, stencil: StencilState) -> DepthStencilState {
        DepthStencilState {
            format: self.depth_format(),
            depth_write_enabled: Some(writes),
            depth_compare: Some(compare),
            stencil,
            bias: Default::default(),
        }
    }
}

/// Compares with the stencil and changes nothing.
fn reading(compare: CompareFunction) -> StencilState {
    let face = StencilFaceState { compare, ..StencilFaceState::IGNORE };
    StencilState { front: face, back: face, read_mask: !0, write_mask: !0 }
}

fn onto_depth(shared: &Shared, clears_depth: bool, stencil: Option<u32>) -> RenderPassDepthStencilAttachment<'_> {
    let depth = if clears_depth { LoadOp::Clear(0.0) } else { LoadOp::Load };
    let stencil = stencil.map_or(LoadOp::Load, LoadOp::Clear);
    RenderPassDepthStencilAttachment {
        view: &shared.depth,
        depth_ops: Some(Operations { load: depth, store: StoreOp::Store }),
        stencil_ops: Some(Operations { load: stencil, store: StoreOp::Store }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether a draw leaves every stencil as it was, whatever its tests decide.
    fn keeps(state: &StencilState) -> bool {
        let operations = |face: StencilFaceState| [face.fail_op, face.depth_fail_op, face.pass_op];
        [state.front, state.back].into_iter().flat_map(operations).all(|operation| operation == StencilOperation::Keep)
    }

    #[test]
    fn passes_that_draw_light_or_darkness_keep_the_stencil() {
        assert!(keeps(&reading(CompareFunction::Equal)) && keeps(&Quad::Darkness.stencil()));
        assert!(!keeps(&Quad::Mask.stencil()));
        // Control: operations left over from counting volumes.
        let mut left_over = reading(CompareFunction::Equal);
        left_over.back.depth_fail_op = StencilOperation::IncrementWrap;
        assert!(!keeps(&left_over));
    }
}
