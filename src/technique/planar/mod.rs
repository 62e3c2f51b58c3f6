//! Planar shadows: every caster flattened onto a receiver plane by one matrix and drawn as its shadow.
//!
//! J. Blinn, "Me and My (Fake) Shadow", 1988; the clipping form after P. Heckbert, M. Herf, "Simulating Soft Shadows
//! with Graphics Hardware", 1997. Assumes that receivers lie on the scene's planes and that the light lies in none of
//! them; casters may be any triangles. Exact on the plane. Known failures: receivers off the plane (`planar-model`),
//! casters behind the plane or beyond the light where nothing clips them (`false-shadow-behind-plane`, `anti-shadow`),
//! shadow beside the receiver without a mask (`clipping-frustum`), z-fighting and rasterisation (`precision`).
//! Formulas: docs/planar.md.

mod flatten;
mod layers;
mod membership;
mod passes;
mod prepared;
mod remedies;
mod replay;
mod settings;
mod shadow_plane;

pub use passes::shader_modules;
pub use settings::{Overlap, Placement, Projection, Settings};
pub use shadow_plane::{ShadowPlane, Side};

use super::param::{Choice, ChoiceNumber, Kind, Param, Value};
use super::{Job, Prepared, Spec, Technique, TechniqueError, Unsupported};
use crate::cause::Cause;
use crate::gpu::Gpu;
use crate::scene::{Light, Scene};
use membership::Membership;
use remedies::SMALLEST_KAPPA;
use std::sync::LazyLock;

/// The `planar` family.
#[derive(Debug, Clone, Copy)]
pub struct Planar;

impl Technique for Planar {
    fn id(&self) -> &'static str {
        "planar"
    }
    fn about(&self) -> &'static str {
        "planar shadows: casters flattened onto each receiver plane and drawn"
    }
    fn citation(&self) -> &'static str {
        "J. Blinn, Me and My (Fake) Shadow, 1988; P. Heckbert, M. Herf, Simulating Soft Shadows with Graphics Hardware, 1997"
    }
    fn params(&self) -> &'static [Param] {
        &PARAMS
    }
    fn supports(&self, spec: &Spec, scene: &Scene, light: &Light, gpu: &Gpu) -> Result<(), Unsupported> {
        let settings = Settings::of(spec);
        if !gpu.has(passes::NEEDED_FEATURE) {
            return Err(Unsupported::MissingFeature { what: "a 32-bit depth buffer with a stencil".to_owned() });
        }
        if settings.projection == Projection::Clipped && settings.placement == Placement::DepthOffset {
            let why = "projection=clipped uses depth to clip and has none to test: placement=depth-offset needs \
                       projection=homogeneous";
            return Err(Unsupported::Degenerate { why: why.to_owned() });
        }
        let planes = planes(scene, light, &settings)?;
        some_receiver(scene, &planes, &Membership::new(scene, &planes, settings.plane_tolerance_m))
    }
    fn remedies(&self, spec: &Spec, cause: Cause) -> Vec<Spec> {
        remedies::remedies(spec, cause)
    }
    fn draws_the_picture(&self, _: &Spec) -> bool {
        true
    }
    fn prepare<'j>(&self, spec: &Spec, job: Job<'j>) -> Result<Box<dyn Prepared + 'j>, TechniqueError> {
        self.supports(spec, job.scene, job.light, job.gpu)?;
        let settings = Settings::of(spec);
        let planes = planes(job.scene, job.light, &settings)?;
        Ok(Box::new(prepared::PreparedPlanar::new(settings, planes, job)?))
    }
}

/// The planes that the settings choose, turned to the light.
fn planes(scene: &Scene, light: &Light, settings: &Settings) -> Result<Vec<ShadowPlane>, Unsupported> {
    let count = scene.planes.len();
    let chosen = match settings.only_plane {
        _ if count == 0 => return Err(Unsupported::NoPlane),
        Some(index) if index >= count => {
            return Err(Unsupported::Degenerate { why: format!("the scene has {count} planes, not {}", index + 1) });
        }
        Some(index) => index..index + 1,
        None => 0..count,
    };
    let least_height = least_light_height(scene, light);
    chosen
        .map(|index| {
            let plane = ShadowPlane::new(&scene.planes[index], light);
            let is_above = plane.light_height() > least_height;
            is_above.then_some(plane).ok_or(Unsupported::LightInPlane { plane: index + 1 })
        })
        .collect()
}

/// Below this, f32 rounding decides on which side of a plane the light is: one step of f32 at the largest coordinate of
/// scene and light, or of a unit vector towards the light.
fn least_light_height(scene: &Scene, light: &Light) -> f64 {
    let homogeneous = light.homogeneous();
    let bounds = scene.bounds();
    let largest = if homogeneous.w == 0.0 {
        1.0
    } else {
        let largest = bounds.min.abs().max(bounds.max.abs()).max(homogeneous.truncate().abs());
        largest.max_element()
    };
    largest * f64::from(f32::EPSILON)
}

/// Refuses a scene in which no plane has a receiver: every answer would be "lit".
fn some_receiver(scene: &Scene, planes: &[ShadowPlane], members: &Membership) -> Result<(), Unsupported> {
    if (0..planes.len()).any(|plane| members.receiver_count(scene, plane) > 0) {
        return Ok(());
    }
    let receiving = scene.meshes.iter().filter(|mesh| mesh.receives).flat_map(|mesh| mesh.triangles.clone());
    let distances =
        receiving.flat_map(|triangle| planes.iter().map(move |plane| membership::distance_m(scene, plane, triangle)));
    Err(Unsupported::NonPlanarReceiver { max_distance_m: distances.fold(f64::INFINITY, f64::min) })
}

static PARAMS: LazyLock<Vec<Param>> = LazyLock::new(|| {
    let plain = |names: &[&'static str]| Kind::Choice(names.iter().copied().map(Choice::plain).collect());
    let param = |name, unit, kind, default, help| Param { name, unit, kind, default, help };
    let choice = |name| Value::Choice(name, None);
    let real = |min, max| Kind::Real { min, max, auto: false };
    let only = Choice { name: "only", number: Some(ChoiceNumber { min: 1, max: 65_535, default: 1 }) };
    vec![
        param(
            "projection",
            "",
            plain(&["clipped", "homogeneous", "divided", "shear"]),
            choice("clipped"),
            "how casters are flattened",
        ),
        param(
            "planes",
            "",
            Kind::Choice(vec![Choice::plain("all"), only]),
            choice("all"),
            "every [[plane]] of the scene, or only the first, second …",
        ),
        param("overlap", "", plain(&["stencil", "blend"]), choice("stencil"), "whether layers darken once or each"),
        param("darkening", "", real(0.0, 1.0), Value::Real(0.5), "share of the light that one layer takes (blend)"),
        param(
            "placement",
            "",
            plain(&["receiver-mask", "depth-offset"]),
            choice("receiver-mask"),
            "what keeps the shadow on its plane",
        ),
        param(
            "offset_constant",
            "hardware units",
            Kind::Integer { min: -1000, max: 1000 },
            Value::Integer(0),
            "constant offset towards the eye (depth-offset)",
        ),
        param(
            "offset_slope",
            "hardware factor",
            real(-8.0, 8.0),
            Value::Real(0.0),
            "offset per depth slope towards the eye (depth-offset)",
        ),
        param(
            "kappa",
            "",
            real(SMALLEST_KAPPA, 1e-3),
            Value::Real(1e-6),
            "share of the light's height below it that is clipped too (clipped)",
        ),
        param(
            "plane_tolerance_m",
            "m",
            Kind::Real { min: 0.0, max: 1e12, auto: true },
            Value::Auto,
            "distance from a plane within which a triangle lies on it; auto: 1e-5 of the scene's extent",
        ),
    ]
});
