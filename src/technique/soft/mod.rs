//! Soft shadows by sampling: some points of an area light, each with the hard shadow of another technique, averaged.
//!
//! P. Heckbert, M. Herf, "Simulating Soft Shadows with Graphics Hardware", 1997. Assumes nothing of its own: whatever
//! the inner technique needs. Known failures: bands where a penumbra is wider than its points are dense
//! (`filter-width`); a sphere's points are fixed, not turned to each receiver (`technique-model`); and the inner
//! technique's own, point by point. Formulas: docs/soft.md.

mod pattern;
mod points;
mod prepared;
mod replay;

pub use pattern::Pattern;

use super::param::{Choice, Kind, Param, Value};
use super::{Job, Prepared, Spec, Technique, TechniqueError, Unsupported};
use crate::cause::Cause;
use crate::gpu::Gpu;
use crate::scene::{Light, Scene};
use std::sync::LazyLock;

/// The `soft` family.
#[derive(Debug, Clone, Copy)]
pub struct Soft;

/// How many times more points a remedy tries.
const MORE_POINTS: i64 = 4;
const MAX_POINTS: i64 = 4096;

impl Technique for Soft {
    fn id(&self) -> &'static str {
        "soft"
    }
    fn about(&self) -> &'static str {
        "soft shadows: the hard shadows of points on an area light, averaged"
    }
    fn citation(&self) -> &'static str {
        "P. Heckbert, M. Herf, Simulating Soft Shadows with Graphics Hardware, 1997"
    }
    fn params(&self) -> &'static [Param] {
        &PARAMS
    }
    fn supports(&self, spec: &Spec, scene: &Scene, light: &Light, gpu: &Gpu) -> Result<(), Unsupported> {
        if !light.is_area() {
            return Err(Unsupported::Light { kind: light.kind_name(), handled: "rectangle, sphere and sun lights" });
        }
        let inner = spec.nested("inner");
        inner.technique().supports(&inner, scene, &points::at_centre(light), gpu)
    }
    fn remedies(&self, spec: &Spec, cause: Cause) -> Vec<Spec> {
        let inner = spec.nested("inner");
        let of_inner = inner.technique().remedies(&inner, cause);
        let more_points = (cause == Cause::FilterWidth && spec.integer("samples") * MORE_POINTS <= MAX_POINTS)
            .then(|| spec.with("samples", &(spec.integer("samples") * MORE_POINTS).to_string()).ok());
        let nested = of_inner.into_iter().filter_map(|inner| spec.with("inner", &format!("({})", inner.short())).ok());
        more_points.flatten().into_iter().chain(nested).collect()
    }
    fn blamed_for_centre(&self, _spec: &Spec) -> Option<Cause> {
        None
    }
    fn draws_the_picture(&self, spec: &Spec) -> bool {
        let inner = spec.nested("inner");
        inner.technique().draws_the_picture(&inner)
    }
    fn prepare<'j>(&self, spec: &Spec, job: Job<'j>) -> Result<Box<dyn Prepared + 'j>, TechniqueError> {
        self.supports(spec, job.scene, job.light, job.gpu)?;
        Ok(Box::new(prepared::PreparedSoft::new(spec, job)?))
    }
}

static PARAMS: LazyLock<Vec<Param>> = LazyLock::new(|| {
    let param = |name, kind, default, help| Param { name, unit: "", kind, default, help };
    let patterns = Pattern::ALL.iter().map(|(name, _)| Choice::plain(name)).collect();
    vec![
        param(
            "method",
            Kind::Choice(vec![Choice::plain("area-sampled")]),
            Value::Choice("area-sampled", None),
            "how the light's extent is taken into account",
        ),
        param("inner", Kind::Technique, Value::Technique("volume"), "the technique of each point's hard shadow"),
        param("samples", Kind::Integer { min: 1, max: MAX_POINTS }, Value::Integer(16), "points on the light"),
        param(
            "pattern",
            Kind::Choice(patterns),
            Value::Choice("truth", None),
            "where they lie; truth: as those that the truth counts",
        ),
        param("seed", Kind::Integer { min: 0, max: i64::MAX }, Value::Integer(0), "of stratified and hammersley"),
    ]
});
