//! Which knob of a projective texture to turn against which cause.

use crate::cause::Cause;
use crate::technique::Spec;

/// Largest picture the family knows, texels a side.
const LARGEST: i64 = 16_384;

/// One knob changed in each; only changes that are legal and change anything.
pub(super) fn remedies(spec: &Spec, cause: Cause) -> Vec<Spec> {
    let larger = |factor: i64| ("size", (spec.integer("size") * factor).min(LARGEST).to_string());
    let set = |key: &'static str, value: &str| (key, value.to_owned());
    let changes = match cause {
        Cause::EdgeAliasing => vec![larger(2), larger(4)],
        Cause::PerspectiveAliasing | Cause::ProjectiveAliasing => vec![larger(2), larger(4), set("fit", "receivers")],
        Cause::ClippingNear => vec![set("near_m", "auto"), set("pull_back_m", "auto"), set("fit", "scene")],
        Cause::ClippingFar => vec![set("far_m", "auto"), set("fit", "scene")],
        Cause::ClippingFrustum => vec![set("width_m", "auto"), set("fov_deg", "auto"), set("fit", "scene")],
        Cause::FilterWidth => vec![larger(2), set("filter", "nearest")],
        Cause::TechniqueModel => vec![set("receivers", "non-casters")],
        _ => Vec::new(),
    };
    let changed = changes.into_iter().filter_map(|(key, value)| spec.with(key, &value).ok());
    changed.filter(|changed| changed != spec).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_remedy_changes_one_knob_that_matters() {
        let spec = Spec::parse("projective-texture:receivers=all,size=16384").unwrap();
        for cause in Cause::ALL {
            assert!(remedies(&spec, cause).iter().all(|remedy| *remedy != spec));
        }
        assert_eq!(remedies(&spec, Cause::TechniqueModel)[0].short(), "projective-texture:size=16384");
        assert!(remedies(&spec, Cause::EdgeAliasing).is_empty(), "there is no larger picture");
    }
}
