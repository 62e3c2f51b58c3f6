//! Projective textures: casters drawn black on white from the light, and that picture thrown on the receivers.
//!
//! M. Segal, C. Korobkin, R. van Widenfelt, J. Foran, P. Haeberli, "Fast Shadows and Lighting Effects Using Texture
//! Mapping", 1992. Assumes that every receiver lies behind every caster, because the picture has no depth. Known
//! failures: casters darken what is in front of them and do not shadow each other or themselves (`technique-model`);
//! the rest is that of any map: staircase edges (`edge-aliasing`), whatever lies outside the frustum (`clipping-*`).
//! Formulas: docs/projective_texture.md.

mod passes;
mod prepared;
mod remedies;
mod replay;
mod settings;

pub use passes::shader_modules;
pub use settings::{ReceiverChoice, Settings};

use super::map::{filter, fit_params};
use super::param::{Choice, Kind, Param, Value};
use super::{Job, Prepared, Spec, Technique, TechniqueError, Unsupported};
use crate::cause::Cause;
use crate::gpu::Gpu;
use crate::scene::{Light, Scene};
use std::sync::LazyLock;

/// The `projective-texture` family.
#[derive(Debug, Clone, Copy)]
pub struct ProjectiveTexture;

impl Technique for ProjectiveTexture {
    fn id(&self) -> &'static str {
        "projective-texture"
    }
    fn about(&self) -> &'static str {
        "projective texture: the casters' black and white picture from the light, thrown on receivers without depth"
    }
    fn citation(&self) -> &'static str {
        "M. Segal et al., Fast Shadows and Lighting Effects Using Texture Mapping, 1992"
    }
    fn params(&self) -> &'static [Param] {
        &PARAMS
    }
    fn supports(&self, spec: &Spec, scene: &Scene, light: &Light, gpu: &Gpu) -> Result<(), Unsupported> {
        let Settings { map, .. } = Settings::of(spec);
        let limit = gpu.limits().texture_side;
        if map.size > limit {
            let what = format!("pictures of {} texels a side (its limit is {limit})", map.size);
            return Err(Unsupported::MissingFeature { what });
        }
        map.projection.supports(scene, light, &map)
    }
    fn remedies(&self, spec: &Spec, cause: Cause) -> Vec<Spec> {
        remedies::remedies(spec, cause)
    }
    fn prepare<'j>(&self, spec: &Spec, job: Job<'j>) -> Result<Box<dyn Prepared + 'j>, TechniqueError> {
        self.supports(spec, job.scene, job.light, job.gpu)?;
        Ok(Box::new(prepared::PreparedPicture::new(&Settings::of(spec), job)?))
    }
}

static PARAMS: LazyLock<Vec<Param>> = LazyLock::new(|| {
    let param = |name, unit, kind, default, help| Param { name, unit, kind, default, help };
    let receivers = ["non-casters", "all"].into_iter().map(Choice::plain).collect();
    let filters =
        filter::registry().iter().filter(|filter| !filter.reads_map()).map(|filter| filter.choice()).collect();
    let mut params = vec![
        param("size", "texels", Kind::Integer { min: 1, max: 16_384 }, Value::Integer(1024), "side of the picture"),
        param(
            "receivers",
            "",
            Kind::Choice(receivers),
            Value::Choice("non-casters", None),
            "which meshes the picture is thrown on",
        ),
        param(
            "filter",
            "",
            Kind::Choice(filters),
            Value::Choice("nearest", None),
            "how black and white texels are averaged",
        ),
    ];
    params.extend(fit_params());
    params
});
