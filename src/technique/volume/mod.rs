//! Stencil shadow volumes: count, per pixel, how many of the volumes behind casters hold the visible point.
//!
//! F. Crow, "Shadow Algorithms for Computer Graphics", 1977; T. Heidmann, "Real Shadows, Real Time", 1991; C. Everitt,
//! M. Kilgard, "Practical and Robust Stenciled Shadow Volumes for Hardware-Accelerated Rendering", 2002. Needs a
//! stencil buffer over the picture's own depth; point, directional and spot lights; any soup of triangles unless told
//! otherwise. Known failures: the near plane inside a volume when counting before the surface (`clipping-near`), a
//! finite far plane or reach (`clipping-far`), open casters with half their triangles (`open-mesh`), more volumes than
//! the stencil counts (`stencil-overflow`). Formulas: docs/volume.md.

mod assembly;
mod boundary;
mod casting;
mod count;
mod draws;
mod extrude;
mod eye;
mod facts;
mod near_projection;
mod open_mesh;
mod outline;
mod params;
mod passes;
mod pipelines;
mod prepared;
mod pyramid;
mod quads;
mod range;
mod remedies;
mod replay;
mod scissor;
mod settings;
mod silhouette;
mod states;
mod target;
mod volumes;
mod winding;

#[cfg(test)]
mod order_tests;

pub use pipelines::shader_modules;
pub use prepared::{PixelCounts, PreparedVolume};
pub use settings::{Caps, CasterSides, Count, Extrude, FarPlane, Format, Length, Settings};
pub(in crate::technique) use target::Target;

use super::param::Param;
use super::{Job, Prepared, Spec, Technique, TechniqueError, Unsupported};
use crate::cause::Cause;
use crate::gpu::Gpu;
use crate::scene::{Light, Scene};
use wgpu::Features;

/// The `volume` family.
#[derive(Debug, Clone, Copy)]
pub struct Volume;

impl Technique for Volume {
    fn id(&self) -> &'static str {
        "volume"
    }
    fn about(&self) -> &'static str {
        "stencil shadow volumes: counts the volumes behind casters that hold each visible point"
    }
    fn citation(&self) -> &'static str {
        "F. Crow, Shadow Algorithms for Computer Graphics, 1977"
    }
    fn params(&self) -> &'static [Param] {
        &params::PARAMS
    }
    fn supports(&self, spec: &Spec, scene: &Scene, _light: &Light, gpu: &Gpu) -> Result<(), Unsupported> {
        let settings = Settings::of(spec);
        if settings.format == Format::Depth32FloatStencil8 && !gpu.has(Features::DEPTH32FLOAT_STENCIL8) {
            let what = "depth32float-stencil8; format=depth24plus-stencil8 works everywhere".to_owned();
            return Err(Unsupported::MissingFeature { what });
        }
        if settings.far.clamps() && !gpu.has(Features::DEPTH_CLIP_CONTROL) {
            return Err(Unsupported::MissingFeature { what: "unclipped depth, which far=clamp needs".to_owned() });
        }
        if settings.count == Count::ZpPlus && settings.reach.is_some() {
            let why = "count=zp-plus projects casters through the near plane however far volumes reach; it needs extrusion=infinite".to_owned();
            return Err(Unsupported::Degenerate { why });
        }
        if settings.range_mask && settings.clamps_stencil {
            let why =
                "range_mask=on keeps its flag above the count, where stencil_ops=clamp does not stop at 0".to_owned();
            return Err(Unsupported::Degenerate { why });
        }
        if settings.extrude == Extrude::DegenerateQuads && settings.away_facing_back_cap {
            let why =
                "extrude=degenerate-quads closes volumes with reversed casters; it needs back_cap=reversed-facing"
                    .to_owned();
            return Err(Unsupported::Degenerate { why });
        }
        eye::Eye::new(scene, &settings).map(|_| ())
    }
    fn remedies(&self, spec: &Spec, cause: Cause) -> Vec<Spec> {
        remedies::remedies(spec, cause)
    }
    fn draws_the_picture(&self, _: &Spec) -> bool {
        true
    }
    fn prepare<'j>(&self, spec: &Spec, job: Job<'j>) -> Result<Box<dyn Prepared + 'j>, TechniqueError> {
        self.supports(spec, job.scene, job.light, job.gpu)?;
        Ok(Box::new(PreparedVolume::new(Settings::of(spec), job)?))
    }
}
