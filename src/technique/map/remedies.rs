//! Which knob of a map to turn against which cause.

use crate::cause::Cause;
use crate::technique::Spec;
use crate::technique::map::filter;

/// Largest map the family knows, texels a side.
const LARGEST: i64 = 16_384;
/// How much farther a cap of the closed-form bias is tried.
const CAP_FACTOR: f64 = 4.0;
/// Where cutting casters begins, degrees.
const COARSEST_EDGE_DEG: f64 = 2.0;

/// One knob changed in each; only changes that are legal and change anything.
pub(super) fn remedies(spec: &Spec, cause: Cause) -> Vec<Spec> {
    let size = spec.integer("size");
    let larger = || ("size", (2 * size).min(LARGEST).to_string());
    let set = |key: &'static str, value: &str| (key, value.to_owned());
    let (filter_name, kernel) = spec.choice("filter");
    let changes = match cause {
        // Acne in spite of the closed form: its cap holds it back.
        Cause::Acne if spec.choice("bias").0 == "closed-form" => {
            vec![set("bias_cap_texels", &(CAP_FACTOR * spec.real("bias_cap_texels")).to_string()), larger()]
        }
        Cause::Acne => vec![set("bias", "closed-form"), set("bias", "slope"), larger()],
        Cause::Curvature => vec![set("bias_normal_texels", "1"), larger(), set("bias_slope", "4")],
        Cause::PeterPanning => vec![
            set("bias_depth_m", "0"),
            set("bias_depth_texels", "0"),
            set("bias_normal_texels", "0"),
            set("bias_slope", "auto"),
            set("bias_constant_ulps", "auto"),
            set("bias", "closed-form"),
            larger(),
            set("bias", "none"),
        ],
        Cause::PerspectiveAliasing if spec.choice("projection").0 == "single" => {
            vec![set("projection", "light-space-perspective"), larger(), set("fit", "receivers")]
        }
        Cause::EdgeAliasing | Cause::PerspectiveAliasing | Cause::ProjectiveAliasing => {
            vec![larger(), set("fit", "receivers")]
        }
        // Corners that are moved to the near plane bend triangles.
        Cause::ClippingNear if spec.choice("near_mode").0 == "vertex-clamp" => {
            vec![set("near_mode", "extend"), set("near_mode", "depth-clamp"), set("near_m", "auto")]
        }
        Cause::ClippingNear => vec![set("near_m", "auto"), set("pull_back_m", "auto"), set("fit", "scene")],
        Cause::ClippingFar => vec![set("far_m", "auto"), set("fit", "scene")],
        Cause::ClippingFrustum => vec![set("width_m", "auto"), set("fov_deg", "auto"), set("fit", "scene")],
        Cause::FilterWidth if filter_name == "pcss" => {
            vec![set("search_taps", "64"), set("filter", "pcss128"), larger()]
        }
        Cause::FilterWidth if kernel > 1 => vec![larger(), set("filter", "nearest")],
        Cause::FilterWidth => vec![larger()],
        // Moments that overflow, or lose what tells two surfaces apart.
        Cause::Precision if filter::by_name(filter_name).moments().is_some() => {
            vec![set("moment_format", "float32"), set("exponent", "auto")]
        }
        Cause::Precision => {
            vec![set("format", "depth32float"), set("depth_convention", "reversed"), set("bias", "closed-form")]
        }
        // What remains of the arcs that are drawn as chords.
        Cause::TechniqueModel if spec.choice("projection").0 == "dual-paraboloid" => {
            let edge_deg = spec.real("max_edge_deg");
            let finer_deg = if edge_deg > 0.0 { 0.5 * edge_deg } else { COARSEST_EDGE_DEG };
            vec![("max_edge_deg", finer_deg.to_string()), set("projection", "cube")]
        }
        Cause::LightBleeding => vec![
            set("bleeding_cut", "0.2"),
            set("filter", &format!("pcf-bilinear{kernel}")),
            set("filter", &format!("evsm{kernel}")),
        ],
        Cause::StencilOverflow
        | Cause::OpenMesh
        | Cause::PlanarModel
        | Cause::AntiShadow
        | Cause::FalseShadowBehindPlane
        | Cause::TechniqueModel => Vec::new(),
    };
    let changed = changes.into_iter().filter_map(|(key, value)| spec.with(key, &value).ok());
    changed.filter(|changed| changed != spec).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_remedy_changes_something_and_stays_legal() {
        let spec = Spec::parse("map:size=16384,bias=none").unwrap();
        for cause in Cause::ALL {
            assert!(remedies(&spec, cause).iter().all(|remedy| *remedy != spec));
        }
        let sizes = remedies(&spec, Cause::EdgeAliasing).into_iter().map(|remedy| remedy.integer("size"));
        assert!(sizes.eq([16_384]), "there is no larger map");
        assert_eq!(remedies(&spec, Cause::Acne)[0].short(), "map:size=16384");
        let capped = Spec::parse("map:bias_cap_texels=2").unwrap();
        assert_eq!(remedies(&capped, Cause::Acne)[0].short(), "map:bias_cap_texels=8");
    }
}
