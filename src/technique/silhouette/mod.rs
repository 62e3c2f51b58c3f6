//! Silhouette maps: a shadow map that also knows, per texel, one point of the casters' true outline.
//!
//! P. Sen, M. Cammarano, P. Hanrahan, "Shadow Silhouette Maps", 2003. Assumes at most one outline per texel, and that
//! shadow edges come from mesh edges: where casters pass through each other there is none. Known failures: two outlines
//! in a texel, or none where there should be one (`edge-aliasing`, within a texel); all of a map's other errors.
//! Formulas: docs/silhouette.md.

mod edges;

use super::map::{self, Settings};
use super::param::{Kind, Param, Value};
use super::{Job, Prepared, Spec, Technique, TechniqueError, Unsupported};
use crate::cause::Cause;
use crate::gpu::Gpu;
use crate::scene::{Light, Scene};
use std::sync::LazyLock;

/// The `silhouette` family.
#[derive(Debug, Clone, Copy)]
pub struct Silhouette;

impl Technique for Silhouette {
    fn id(&self) -> &'static str {
        "silhouette"
    }
    fn about(&self) -> &'static str {
        "silhouette map: depth seen from the light, and a point of the casters' outline in every texel it crosses"
    }
    fn citation(&self) -> &'static str {
        "P. Sen, M. Cammarano, P. Hanrahan, Shadow Silhouette Maps, 2003"
    }
    fn params(&self) -> &'static [Param] {
        &PARAMS
    }
    fn supports(&self, spec: &Spec, scene: &Scene, light: &Light, gpu: &Gpu) -> Result<(), Unsupported> {
        let settings = Settings::with_silhouettes(spec);
        let limit = gpu.limits().texture_side;
        if settings.size > limit {
            let what = format!("maps of {} texels a side (its limit is {limit})", settings.size);
            return Err(Unsupported::MissingFeature { what });
        }
        if settings.stores_midpoint() {
            let why =
                "an outline is hidden or not by the nearest depths, which bias=midpoint does not store".to_owned();
            return Err(Unsupported::Combination { why });
        }
        settings.projection.supports(scene, light, &settings)
    }
    fn remedies(&self, spec: &Spec, cause: Cause) -> Vec<Spec> {
        let set = |key: &'static str, value: String| (key, value);
        let larger = || set("size", (2 * spec.integer("size")).min(LARGEST).to_string());
        let changes = match cause {
            Cause::EdgeAliasing | Cause::PerspectiveAliasing | Cause::ProjectiveAliasing => {
                vec![larger(), set("fit", "receivers".to_owned())]
            }
            Cause::Acne | Cause::Curvature => vec![set("bias", "closed-form".to_owned()), larger()],
            Cause::PeterPanning => {
                vec![larger(), set("bias_depth_m", "0".to_owned()), set("bias_depth_texels", "0".to_owned())]
            }
            Cause::ClippingNear | Cause::ClippingFar | Cause::ClippingFrustum => {
                ["near_m", "far_m", "width_m", "fov_deg"].map(|key| set(key, "auto".to_owned())).to_vec()
            }
            Cause::Precision => vec![set("format", "depth32float".to_owned())],
            _ => Vec::new(),
        };
        let changed = changes.into_iter().filter_map(|(key, value)| spec.with(key, &value).ok());
        changed.filter(|changed| changed != spec).collect()
    }
    fn prepare<'j>(&self, spec: &Spec, job: Job<'j>) -> Result<Box<dyn Prepared + 'j>, TechniqueError> {
        self.supports(spec, job.scene, job.light, job.gpu)?;
        let edges = edges::silhouette_edges(job.scene, job.light);
        map::prepare_with_silhouettes(&Settings::with_silhouettes(spec), job, &edges)
    }
}

/// Largest grid of outline points, texels a side: one less than the largest map.
const LARGEST: i64 = 16_383;

static PARAMS: LazyLock<Vec<Param>> = LazyLock::new(|| {
    let size = Param {
        name: "size",
        unit: "texels",
        kind: Kind::Integer { min: 1, max: LARGEST },
        default: Value::Integer(256),
        help: "side of the grid of outline points; depth has one texel more",
    };
    std::iter::once(size).chain(map::bias_params()).chain(map::fit_params()).collect()
});
