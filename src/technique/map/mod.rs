//! Shadow maps: one depth image from the light; a receiver is in shadow if something nearer is stored at its texel.
//!
//! L. Williams, "Casting Curved Shadows on Curved Surfaces", 1978; M. Segal et al., "Fast Shadows and Lighting Effects
//! Using Texture Mapping", 1992. Assumes nothing about the casters. Known failures: staircase edges (`edge-aliasing`),
//! self-shadow speckle (`acne`), detached contacts (`peter-panning`), whatever lies outside the frustum (`clipping-*`),
//! quantised depth (`precision`). Formulas: docs/map.md.
//!
//! Three orthogonal axes, each a registry: [`projection`] × [`filter`] × [`bias`].

pub mod bias;
mod combinations;
mod depth_format;
mod drawing;
mod exact_texels;
pub mod filter;
mod gather;
mod layers;
mod lookup;
mod lookup_facts;
mod mask_pass;
mod means;
mod midpoint;
mod moment_passes;
mod offset;
mod outline;
#[cfg(test)]
mod outline_tests;
mod own_surface;
mod passes;
mod prepared;
pub mod projection;
mod reading;
mod remedies;
mod replay;
mod scout;
mod settings;
mod texel_footprint;

pub use depth_format::DepthFormat;
pub(in crate::technique) use exact_texels::ExactTexels;
pub use lookup::{Lookup, Outside, Placed, Tap};
pub use passes::shader_modules;
pub(in crate::technique) use prepared::PreparedMap;
pub use settings::{Around, Border, CasterSides, DepthMetric, Fit, NearMode, Seam, Settings};
pub(in crate::technique) use texel_footprint::texel_footprint;

use super::param::{Choice, Kind, Param, Value};
use super::{Job, Prepared, Spec, Technique, TechniqueError, Unsupported};
use crate::cause::Cause;
use crate::gpu::Gpu;
use crate::scene::{Light, Scene};
use std::sync::LazyLock;

/// The `map` family.
#[derive(Debug, Clone, Copy)]
pub struct Map;

impl Technique for Map {
    fn id(&self) -> &'static str {
        "map"
    }
    fn about(&self) -> &'static str {
        "shadow map: depth seen from the light, compared at each receiver"
    }
    fn citation(&self) -> &'static str {
        "L. Williams, Casting Curved Shadows on Curved Surfaces, 1978"
    }
    fn params(&self) -> &'static [Param] {
        &PARAMS
    }
    fn needs_of_picture(&self, spec: &Spec) -> &'static [&'static str] {
        Settings::of(spec).projection.needs_of_picture()
    }
    fn supports(&self, spec: &Spec, scene: &Scene, light: &Light, gpu: &Gpu) -> Result<(), Unsupported> {
        let settings = Settings::of(spec);
        let has_moments = settings.filter.moments().is_some();
        let limit = gpu.limits().texture_side - if has_moments { moment_passes::side(0) } else { 0 };
        let texels = settings.projection.layer_texels(&settings);
        if texels > limit {
            let what = format!("maps of {texels} texels a side (its limit is {limit})");
            return Err(Unsupported::MissingFeature { what });
        }
        let (layers, limit) = (settings.projection.most_views(&settings), gpu.limits().texture_layers);
        if layers > limit {
            let what = format!("maps of {layers} layers (its limit is {limit})");
            return Err(Unsupported::MissingFeature { what });
        }
        if settings.near_mode == NearMode::DepthClamp && !gpu.has(wgpu::Features::DEPTH_CLIP_CONTROL) {
            let what = "unclipped depth; near_mode=fragment-clamp needs none".to_owned();
            return Err(Unsupported::MissingFeature { what });
        }
        combinations::fits_together(&settings, light)?;
        settings.projection.supports(scene, light, &settings)
    }
    fn remedies(&self, spec: &Spec, cause: Cause) -> Vec<Spec> {
        remedies::remedies(spec, cause)
    }
    fn blamed_for_centre(&self, spec: &Spec) -> Option<Cause> {
        // A filter that makes up for taking the light for its centre owns what it leaves.
        Some(if Settings::of(spec).filter.softens() { Cause::FilterWidth } else { Cause::TechniqueModel })
    }
    fn prepare<'j>(&self, spec: &Spec, job: Job<'j>) -> Result<Box<dyn Prepared + 'j>, TechniqueError> {
        self.supports(spec, job.scene, job.light, job.gpu)?;
        Ok(Box::new(PreparedMap::new(&Settings::of(spec), job, None)?))
    }
}

/// Far beyond any scene f32 can hold with useful precision.
const MAX_M: f64 = 1e12;
/// Below any scene f32 can hold with useful precision.
const MIN_M: f64 = 1e-12;

/// The parameters of a light frustum's fit, which every technique with such a frustum declares.
#[must_use]
pub(in crate::technique) fn fit_params() -> Vec<Param> {
    let param = |name, unit, kind, default, help| Param { name, unit, kind, default, help };
    let real = |min, max| Kind::Real { min, max, auto: false };
    let auto = |min, max| Kind::Real { min, max, auto: true };
    let around = ["scene", "receivers", "manual"].into_iter().map(Choice::plain).collect();
    vec![
        param(
            "fit",
            "",
            Kind::Choice(around),
            Value::Choice("scene", None),
            "what the light frustum encloses; manual: width 10 m, near 1 m, far 30 m, 5 m back, unless given",
        ),
        param(
            "fit_margin_texels",
            "texels",
            real(0.0, 8.0),
            Value::Real(1.0),
            "rim around the fit beyond the kernel's radius and one texel",
        ),
        param("near_m", "m", auto(MIN_M, MAX_M), Value::Auto, "light's near plane; auto: fitted"),
        param("far_m", "m", auto(MIN_M, MAX_M), Value::Auto, "light's far plane; auto: fitted"),
        param("width_m", "m", auto(MIN_M, MAX_M), Value::Auto, "width of a directional light's map; auto: fitted"),
        param(
            "pull_back_m",
            "m",
            auto(0.0, MAX_M),
            Value::Auto,
            "how far behind the scene's centre a directional light's view starts; auto: the scene's radius",
        ),
        param("fov_deg", "degrees", auto(0.01, 170.0), Value::Auto, "full angle of a point or spot light's map"),
        param("phase_u_texels", "texels", real(-1.0, 1.0), Value::Real(0.0), "map shifted sideways, for jitter"),
        param("phase_v_texels", "texels", real(-1.0, 1.0), Value::Real(0.0), "map shifted upwards, for jitter"),
    ]
}

/// The parameters of stored depth and of bias, which every technique that compares depths declares.
#[must_use]
pub(in crate::technique) fn bias_params() -> Vec<Param> {
    let plain = |names: &[&'static str]| Kind::Choice(names.iter().copied().map(Choice::plain).collect());
    let param = |name, unit, kind, default, help| Param { name, unit, kind, default, help };
    let real = |min, max| Kind::Real { min, max, auto: false };
    let auto = |min, max| Kind::Real { min, max, auto: true };
    vec![
        param(
            "bias",
            "",
            Kind::Choice(bias::registry().iter().map(|b| Choice::plain(b.name())).collect()),
            Value::Choice("closed-form", None),
            "what keeps a surface from shadowing itself",
        ),
        param(
            "format",
            "",
            plain(&["depth32float", "depth24plus", "depth16unorm"]),
            Value::Choice("depth32float", None),
            "what a texel stores",
        ),
        param(
            "depth_convention",
            "",
            plain(&["reversed", "forward"]),
            Value::Choice("reversed", None),
            "which end of the depth range is near the light",
        ),
        param(
            "bias_constant_ulps",
            "hardware units",
            auto(-1e6, 1e6),
            Value::Auto,
            "rasteriser's constant bias; auto: 2 with bias=constant or slope, else 0",
        ),
        param(
            "bias_slope",
            "hardware factor",
            auto(0.0, 64.0),
            Value::Auto,
            "rasteriser's bias per depth slope; auto: 1 with bias=slope, else 0",
        ),
        param("bias_clamp", "depth", real(0.0, 1.0), Value::Real(0.0), "largest hardware bias; 0: no limit"),
        param("bias_depth_m", "m", real(0.0, MAX_M), Value::Real(0.0), "bias along the light at the receiver"),
        param(
            "bias_depth_texels",
            "texels",
            real(0.0, 1e4),
            Value::Real(0.0),
            "the same in widths of a texel at the receiver",
        ),
        param(
            "bias_normal_texels",
            "texels",
            real(0.0, 64.0),
            Value::Real(0.0),
            "receiver moved along its normal, times the sine of its tilt to the light",
        ),
        param(
            "bias_cap_texels",
            "texels",
            real(1.0, 1e4),
            Value::Real(64.0),
            "largest bias derived from the receiver's plane, at grazing light",
        ),
    ]
}

/// A map with the casters' silhouettes, whose edges are given, ready to run.
pub(in crate::technique) fn prepare_with_silhouettes<'j>(
    settings: &Settings,
    job: Job<'j>,
    edges_in_world: &[[glam::DVec3; 2]],
) -> Result<Box<dyn Prepared + 'j>, TechniqueError> {
    Ok(Box::new(PreparedMap::new(settings, job, Some(edges_in_world))?))
}

static PARAMS: LazyLock<Vec<Param>> = LazyLock::new(|| {
    let plain = |names: &[&'static str]| Kind::Choice(names.iter().copied().map(Choice::plain).collect());
    let param = |name, unit, kind, default, help| Param { name, unit, kind, default, help };
    let real = |min, max| Kind::Real { min, max, auto: false };
    let mut params = vec![
        param("size", "texels", Kind::Integer { min: 1, max: 16_384 }, Value::Integer(1024), "side of the map"),
        param(
            "projection",
            "",
            Kind::Choice(projection::registry().iter().map(|p| Choice::plain(p.name())).collect()),
            Value::Choice("single", None),
            "how the light's view is laid out in the map",
        ),
        param(
            "filter",
            "",
            Kind::Choice(filter::registry().iter().map(|f| f.choice()).collect()),
            Value::Choice("nearest", None),
            "how comparisons are averaged",
        ),
    ];
    params.extend(bias_params());
    params.extend([
        param(
            "near_mode",
            "",
            plain(&["extend", "depth-clamp", "fragment-clamp", "vertex-clamp"]),
            Value::Choice("extend", None),
            "casters before the near plane: fit it before them, or draw them at it, by the device, by each fragment, or by their corners, which bends them",
        ),
        param(
            "near_margin_m",
            "m",
            real(0.0, MAX_M),
            Value::Real(0.0),
            "near_mode=...-clamp: how far before what it is fitted to the near plane lies",
        ),
        param(
            "caster_sides",
            "",
            plain(&["all", "light-facing", "away-facing"]),
            Value::Choice("all", None),
            "which sides of casters are drawn",
        ),
        param(
            "depth_metric",
            "",
            plain(&["auto", "projected", "linear"]),
            Value::Choice("auto", None),
            "what depth measures: what the rasteriser gives, or the distance along the view; auto: linear where the filter needs it",
        ),
        param(
            "seam",
            "",
            plain(&["per-tap", "clamp"]),
            Value::Choice("per-tap", None),
            "what a filter's tap beyond the side of its view reads: the view it falls in, or the nearest texel",
        ),
        param(
            "border",
            "",
            plain(&["lit", "shadow", "clamp-edge"]),
            Value::Choice("lit", None),
            "what stands for the map beyond its border",
        ),
    ]);
    params.extend(filter::params());
    params.extend(projection::params());
    params.extend(fit_params());
    params
});
