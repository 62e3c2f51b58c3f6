//! Ray queries: the device itself casts one shadow ray per receiver through its acceleration structure.
//!
//! Vulkan's VK_KHR_ray_query (Khronos, 2020), through wgpu's experimental feature. Assumes only that the adapter has it.
//! Rays start at the receiver with no offset, and the receiver's own triangle is left out by id, as in the truth. Known
//! failure: f32, in the receiver's position and in the device's own test, which no standard bounds (`precision`).
//! Formulas: docs/ray_query.md.

mod passes;
mod prepared;

pub use passes::shader_modules;

use super::param::Param;
use super::{Job, Prepared, Spec, Technique, TechniqueError, Unsupported};
use crate::cause::Cause;
use crate::gpu::Gpu;
use crate::scene::{Light, Scene};

/// The `ray-query` family.
#[derive(Debug, Clone, Copy)]
pub struct RayQuery;

/// What few adapters have.
const NEEDED: &str = "ray queries";

impl Technique for RayQuery {
    fn id(&self) -> &'static str {
        "ray-query"
    }
    fn about(&self) -> &'static str {
        "ray queries: the device casts one shadow ray per receiver"
    }
    fn citation(&self) -> &'static str {
        "Khronos, VK_KHR_ray_query, 2020"
    }
    fn params(&self) -> &'static [Param] {
        &[]
    }
    fn needs_of_adapter(&self) -> &'static [&'static str] {
        &[NEEDED]
    }
    fn supports(&self, _spec: &Spec, _scene: &Scene, _light: &Light, gpu: &Gpu) -> Result<(), Unsupported> {
        if passes::supports(gpu) { Ok(()) } else { Err(Unsupported::MissingFeature { what: NEEDED.to_owned() }) }
    }
    /// Its only error has no knob.
    fn remedies(&self, _spec: &Spec, _cause: Cause) -> Vec<Spec> {
        Vec::new()
    }
    fn prepare<'j>(&self, spec: &Spec, job: Job<'j>) -> Result<Box<dyn Prepared + 'j>, TechniqueError> {
        self.supports(spec, job.scene, job.light, job.gpu)?;
        Ok(Box::new(prepared::PreparedRays::new(job)?))
    }
}
