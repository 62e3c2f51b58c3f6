//! Irregular z-buffer: the light's image sampled exactly where the receivers are, so there is nothing to alias.
//!
//! G. Johnson, J. Lee, C. Burns, W. Mark, "The Irregular Z-Buffer", 2005; T. Aila, S. Laine, "Alias-Free Shadow Maps",
//! 2004; C. Wyman, R. Hoetzlein, A. Lefohn, "Frustum-Traced Raster Shadows", 2015. Receivers are sorted into the cells of
//! a grid seen from the light; every caster visits the cells it may cover and tests each receiver's own shadow ray.
//! Assumes nothing about casters and needs no bias. Known failure: f32, where a ray passes an edge within its rounding
//! (`precision`). Formulas: docs/irregular.md.

mod grids;
mod passes;
mod prepared;
mod replay;
mod samples;
mod segment_test;

pub use passes::shader_modules;
pub use prepared::PreparedIrregular;

use super::param::{Kind, Param, Value};
use super::{Job, Prepared, Spec, Technique, TechniqueError, Unsupported};
use crate::cause::Cause;
use crate::gpu::Gpu;
use crate::scene::{Light, Scene};

/// The `irregular` family.
#[derive(Debug, Clone, Copy)]
pub struct Irregular;

impl Technique for Irregular {
    fn id(&self) -> &'static str {
        "irregular"
    }
    fn about(&self) -> &'static str {
        "irregular z-buffer: every caster is tested against the receivers in the cells it covers, seen from the light"
    }
    fn citation(&self) -> &'static str {
        "G. Johnson et al., The Irregular Z-Buffer, 2005; T. Aila, S. Laine, Alias-Free Shadow Maps, 2004"
    }
    fn params(&self) -> &'static [Param] {
        &PARAMS
    }
    fn supports(&self, spec: &Spec, _scene: &Scene, _light: &Light, gpu: &Gpu) -> Result<(), Unsupported> {
        let (limit, grid) = (gpu.limits().texture_side, spec.integer("grid") as u32);
        if grid > limit {
            let what = format!("grids of {grid} cells a side (its limit is {limit})");
            return Err(Unsupported::MissingFeature { what });
        }
        passes::supports(gpu)
    }
    /// Its only error has no knob.
    fn remedies(&self, _spec: &Spec, _cause: Cause) -> Vec<Spec> {
        Vec::new()
    }
    fn prepare<'j>(&self, spec: &Spec, job: Job<'j>) -> Result<Box<dyn Prepared + 'j>, TechniqueError> {
        self.supports(spec, job.scene, job.light, job.gpu)?;
        Ok(Box::new(PreparedIrregular::new(spec.integer("grid") as u32, job)?))
    }
}

static PARAMS: [Param; 1] = [Param {
    name: "grid",
    unit: "cells",
    kind: Kind::Integer { min: 1, max: 4096 },
    default: Value::Integer(512),
    help: "side of the grid that receivers are sorted into; changes the cost, never the answer",
}];
