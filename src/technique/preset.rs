//! Presets: specifications by name. Some are the short names of techniques, the others what engines ship by default, so
//! that users can score what they have. Sources and what cannot be expressed: docs/presets.md.

/// A specification with a name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Preset {
    /// Its name: behind `preset:`, or on its own for the short name of a technique.
    pub name: &'static str,
    /// What it stands for.
    pub spec: &'static str,
    /// One line: what it is.
    pub about: &'static str,
    /// Whether it stands on its own.
    pub is_short_name: bool,
}

const fn short(name: &'static str, spec: &'static str, about: &'static str) -> Preset {
    Preset { name, spec, about, is_short_name: true }
}

const fn engine(name: &'static str, spec: &'static str, about: &'static str) -> Preset {
    Preset { name, spec, about, is_short_name: false }
}

/// Every preset.
pub const PRESETS: [Preset; 31] = [
    short("planar-shear", "planar:projection=shear", "projected onto a coordinate plane by a shear"),
    short("volume-zpass", "volume:count=z-pass", "faces before the surface"),
    short("volume-zfail", "volume:count=z-fail", "faces behind the surface"),
    short("volume-mixed", "volume:count=mixed", "whichever is safe per object"),
    short("volume-zp-plus", "volume:count=zp-plus", "faces before the surface from the exact start"),
    short("volume-per-triangle", "volume:count=z-fail,shape=per-triangle", "one volume per triangle"),
    short("map-projective-texture", "projective-texture", "a picture of the casters without depth"),
    short("area-sampled", "soft", "hard shadows of points on an area light, averaged"),
    short("pcss", "map:filter=pcss", "penumbrae as wide as the blockers' mean depth says"),
    short("map-cube", "map:projection=cube", "six maps around a point light"),
    short("map-dual-paraboloid", "map:projection=dual-paraboloid", "two hemispheres around a point light"),
    short("map-cascaded", "map:projection=cascaded", "slices of the view, a map each"),
    short("map-perspective", "map:projection=perspective", "a map in the camera's perspective"),
    short("map-trapezoidal", "map:projection=trapezoidal", "what is seen, pulled to a square"),
    short("map-light-space-perspective", "map:projection=light-space-perspective", "a warp across the light"),
    short("map-adaptive", "map:projection=adaptive", "tiles refined where edges pass"),
    short("map-silhouette", "silhouette", "a map that knows the casters' outline"),
    short("hybrid-map-volume", "hybrid", "a small map, and volumes at its silhouettes"),
    short("map-irregular", "irregular", "the light's image sampled where the receivers are"),
    engine(
        "bevy-directional",
        "map:size=2048,projection=cascaded,min_distance_m=0.1,first_far_m=10,max_distance_m=150,lambda=1,overlap_ratio=0.2,filter=pcf-bilinear3,bias=none,bias_depth_m=0.02,bias_normal_texels=1.8,near_mode=depth-clamp",
        "Bevy's directional light",
    ),
    engine(
        "bevy-point",
        "map:size=1024,projection=cube,filter=pcf-bilinear3,bias=none,bias_depth_m=0.08,bias_normal_texels=0.6",
        "Bevy's point light",
    ),
    engine(
        "bevy-spot",
        "map:size=2048,filter=pcf-bilinear3,bias=none,bias_depth_m=0.02,bias_normal_texels=1.8",
        "Bevy's spot light",
    ),
    engine(
        "godot-directional",
        "map:size=2048,projection=cascaded,min_distance_m=0.05,splits_m=10.045/20.04/50.025,max_distance_m=100,filter=pcf-poisson16,bias=none,bias_depth_m=0.1,bias_normal_texels=2,near_mode=vertex-clamp,near_margin_m=20",
        "Godot's DirectionalLight3D",
    ),
    engine(
        "filament-directional",
        "map:size=1024,projection=light-space-perspective,filter=pcf-bilinear2,bias=none,bias_depth_m=0.001,bias_normal_texels=1,bias_slope=2,bias_constant_ulps=1",
        "Filament's sun",
    ),
    engine(
        "threejs-directional",
        "map:size=512,width_m=10,near_m=0.5,far_m=500,filter=pcf-bilinear2,bias=none",
        "three.js's DirectionalLight: no bias at all",
    ),
    engine("threejs-spot", "map:size=512,filter=pcf-bilinear2,bias=none", "three.js's SpotLight: no bias at all"),
    engine(
        "unity-urp-directional",
        "map:size=2048,projection=cascaded,cascades=1,max_distance_m=50,filter=pcf-bilinear1,bias=none,bias_depth_texels=1,bias_normal_texels=1,near_mode=vertex-clamp,near_margin_m=0.2",
        "Unity's Universal Render Pipeline, hard shadows",
    ),
    engine(
        "mjp-receiver-plane",
        "map:size=2048,filter=pcf-box7,bias=receiver-plane,bias_depth_m=0.005",
        "M. Pettineo's sample",
    ),
    engine(
        "ploszajczak",
        "map:size=1024,bias=none,bias_slope=3",
        "the offset of R. Ploszajczak's master's thesis, 2008",
    ),
    engine(
        "brasas-text",
        "map:size=1024,bias=none,bias_slope=2,bias_constant_ulps=4",
        "the offset in the text of M. Brasas' master's thesis, 2010",
    ),
    engine(
        "brasas-listing",
        "map:size=1024,bias=none,bias_slope=3,bias_constant_ulps=0",
        "the offset in the listing of the same thesis",
    ),
];

/// What a typed specification stands for: presets spelled out, everything else as it is. Keys behind a preset's name come
/// in addition, and in place of the preset's own.
#[must_use]
pub(super) fn expanded(typed: &str) -> Option<String> {
    let (name, rest) = match typed.strip_prefix("preset:") {
        Some(named) => named.split_once(',').unwrap_or((named, "")),
        None => typed.split_once(':').unwrap_or((typed, "")),
    };
    let is_named = typed.starts_with("preset:");
    let preset = PRESETS.iter().find(|preset| preset.name == name.trim() && (is_named || preset.is_short_name))?;
    let (family, own) = preset.spec.split_once(':').unwrap_or((preset.spec, ""));
    let key = |part: &str| part.split('=').next().unwrap_or("").trim().to_owned();
    let typed_keys: Vec<String> = rest.split(',').map(key).collect();
    let kept = own.split(',').filter(|part| !part.is_empty() && !typed_keys.contains(&key(part)));
    let parts: Vec<&str> = kept.chain(rest.split(',').filter(|part| !part.trim().is_empty())).collect();
    Some(format!("{family}:{}", parts.join(",")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::technique::{Spec, registry};
    use std::collections::BTreeSet;

    #[test]
    fn every_preset_is_a_legal_specification_of_its_own_name() {
        let names: BTreeSet<&str> = PRESETS.iter().map(|preset| preset.name).collect();
        assert_eq!(names.len(), PRESETS.len());
        for preset in PRESETS {
            let spelled = Spec::parse(preset.spec).unwrap();
            assert_eq!(Spec::parse(&format!("preset:{}", preset.name)).unwrap(), spelled, "{}", preset.name);
            assert_eq!(Spec::parse(preset.name).is_ok(), preset.is_short_name, "{}", preset.name);
            assert!(registry().iter().all(|technique| technique.id() != preset.name));
        }
    }

    #[test]
    fn the_page_lists_them_all() {
        let page = include_str!("../../docs/presets.md");
        let rows: Vec<&str> = page.lines().filter(|line| line.starts_with("| `")).collect();
        let row = |preset: &Preset| format!("| `{}` | `{}` | {} |", preset.name, preset.spec, preset.about);
        let expected: Vec<String> = PRESETS.iter().map(row).collect();
        assert_eq!(rows, expected, "the tables should read\n{}", expected.join("\n"));
    }

    #[test]
    fn keys_add_to_a_preset_and_replace_its_own() {
        let parsed = |typed: &str| Spec::parse(typed).unwrap();
        assert_eq!(parsed("preset:threejs-spot,size=64").short(), "map:size=64,filter=pcf-bilinear2,bias=none");
        assert_eq!(parsed("volume-zpass:scissor=on").short(), "volume:count=z-pass,scissor=on");
        assert_eq!(parsed("preset:threejs-spot").typed, "preset:threejs-spot");
        let mistake = Spec::parse("preset:threejs-sport").unwrap_err().to_string();
        assert!(mistake.contains("threejs-spot"), "{mistake}");
        assert!(Spec::parse("preset:threejs-spot,size=0").is_err());
    }
}
