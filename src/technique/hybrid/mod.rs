//! Shadow maps and shadow volumes together: a small map answers wherever the texels around a receiver agree, and where they
//! do not, at the silhouettes, volumes do.
//!
//! E. Chan, F. Durand, "An Efficient Hybrid Shadow Rendering Algorithm", 2004. Assumes what the map and the volumes
//! assume. Known failures: shadows thinner than a texel, which no texel holds, are missed (`edge-aliasing`); the map's own
//! away from silhouettes; more than 127 volumes (`stencil-overflow`). Formulas: docs/hybrid.md.

mod prepared;
mod replay;

use super::param::{Kind, Param, Value};
use super::{Job, Prepared, Spec, Technique, TechniqueError, Unsupported, map, volume};
use crate::cause::Cause;
use crate::gpu::Gpu;
use crate::gpu::shader::Wgsl;
use crate::scene::{Light, Scene};
use std::sync::LazyLock;

/// The `hybrid` family.
#[derive(Debug, Clone, Copy)]
pub struct Hybrid;

/// Every shader module this family can build by itself, as label and files.
#[must_use]
pub fn shader_modules() -> Vec<(String, Vec<Wgsl>)> {
    prepared::shader_modules()
}

/// Largest map, texels a side.
const LARGEST: i64 = 16_384;

impl Technique for Hybrid {
    fn id(&self) -> &'static str {
        "hybrid"
    }
    fn about(&self) -> &'static str {
        "hybrid: a small shadow map, and shadow volumes only at the silhouettes that it finds"
    }
    fn citation(&self) -> &'static str {
        "E. Chan, F. Durand, An Efficient Hybrid Shadow Rendering Algorithm, 2004"
    }
    fn params(&self) -> &'static [Param] {
        &PARAMS
    }
    fn supports(&self, spec: &Spec, scene: &Scene, light: &Light, gpu: &Gpu) -> Result<(), Unsupported> {
        let (map, volume) = (spec.nested("map"), spec.nested("volume"));
        for (inner, id) in [(&map, "map"), (&volume, "volume")] {
            if inner.technique().id() != id {
                let why = format!("{id}=({}) is no {id}", inner.short());
                return Err(Unsupported::Combination { why });
            }
        }
        if map.integer("size") != own_size_of_maps() {
            let why = "the hybrid's own size= is that of its map: map=(...) takes none".to_owned();
            return Err(Unsupported::Combination { why });
        }
        if map.choice("filter").0 != "nearest" {
            let why = "the texels around a receiver are compared, not filtered: map=(...) takes no filter".to_owned();
            return Err(Unsupported::Combination { why });
        }
        let settings = volume::Settings::of(&volume);
        if settings.range_mask || settings.clamps_stencil {
            let why = "the stencil's highest bit marks silhouettes: volume=(...) takes no range_mask=on and no \
                       stencil_ops=clamp";
            return Err(Unsupported::Combination { why: why.to_owned() });
        }
        volume.technique().supports(&volume, scene, light, gpu)?;
        let compared = compared(spec);
        compared.technique().supports(&compared, scene, light, gpu)
    }
    fn remedies(&self, spec: &Spec, cause: Cause) -> Vec<Spec> {
        let own = match cause {
            Cause::EdgeAliasing | Cause::PerspectiveAliasing | Cause::ProjectiveAliasing => vec![
                ("size", (2 * spec.integer("size")).min(LARGEST).to_string()),
                ("widen_texels", (spec.integer("widen_texels") + 1).min(MOST_WIDENED).to_string()),
            ],
            _ => Vec::new(),
        };
        let nested = ["map", "volume"].into_iter().flat_map(|name| {
            let inner = spec.nested(name);
            let fixes = inner.technique().remedies(&inner, cause).into_iter();
            let takes = |fix: &Spec| name != "map" || fix.integer("size") == own_size_of_maps();
            fixes.filter(takes).map(|fix| (name, format!("({})", fix.short()))).collect::<Vec<_>>()
        });
        let changed = own.into_iter().chain(nested).filter_map(|(key, value)| spec.with(key, &value).ok());
        changed.filter(|changed| changed != spec).collect()
    }
    fn draws_the_picture(&self, _: &Spec) -> bool {
        true
    }
    fn prepare<'j>(&self, spec: &Spec, job: Job<'j>) -> Result<Box<dyn Prepared + 'j>, TechniqueError> {
        self.supports(spec, job.scene, job.light, job.gpu)?;
        let map = map::Settings::of(&compared(spec));
        let volume = volume::Settings::of(&spec.nested("volume")).masked();
        Ok(Box::new(prepared::PreparedHybrid::new(&map, volume, job)?))
    }
}

/// The size of a map that nobody typed.
fn own_size_of_maps() -> i64 {
    map::Map
        .params()
        .iter()
        .find_map(|param| match (param.name, param.default) {
            ("size", Value::Integer(size)) => Some(size),
            _ => None,
        })
        .unwrap_or_default()
}

/// The map whose answer is neither 0 nor 1 where the texels around a receiver disagree: a box of even width holds the
/// nearest four, or so many more on each side.
fn compared(spec: &Spec) -> Spec {
    let map = spec.nested("map");
    let texels = 2 + 2 * spec.integer("widen_texels");
    let sized = map.with("size", &spec.integer("size").to_string()).unwrap_or_else(|_| map.clone());
    sized.with("filter", &format!("pcf-box{texels}")).unwrap_or(sized)
}

/// Most texels that a silhouette is widened by.
const MOST_WIDENED: i64 = 8;

static PARAMS: LazyLock<Vec<Param>> = LazyLock::new(|| {
    let param = |name, unit, kind, default, help| Param { name, unit, kind, default, help };
    vec![
        param("size", "texels", Kind::Integer { min: 1, max: LARGEST }, Value::Integer(256), "side of the map"),
        param(
            "widen_texels",
            "texels",
            Kind::Integer { min: 0, max: MOST_WIDENED },
            Value::Integer(0),
            "how much wider than the nearest four texels it looks for a silhouette, on each side",
        ),
        param("map", "", Kind::Technique, Value::Technique("map"), "the map, but for its size"),
        param("volume", "", Kind::Technique, Value::Technique("volume"), "the volumes at silhouettes"),
    ]
});

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_texels_are_compared_and_more_when_widened() {
        let of = |typed: &str| compared(&Spec::parse(typed).unwrap()).short();
        assert_eq!(of("hybrid"), "map:size=256,filter=pcf-box2");
        assert_eq!(of("hybrid:size=64,widen_texels=3,map=(map:bias=slope)"), "map:size=64,filter=pcf-box8,bias=slope");
    }

    #[test]
    fn a_remedy_changes_something() {
        let spec = Spec::parse("hybrid").unwrap();
        let short: Vec<String> = Hybrid.remedies(&spec, Cause::EdgeAliasing).iter().map(Spec::short).collect();
        assert_eq!(short[..2], ["hybrid:size=512", "hybrid:widen_texels=1"]);
        assert!(Cause::ALL.into_iter().all(|cause| Hybrid.remedies(&spec, cause).iter().all(|fix| *fix != spec)));
    }
}
