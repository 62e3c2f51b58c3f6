//! Which knob of shadow volumes to turn against which cause.

use crate::cause::Cause;
use crate::technique::Spec;

/// One knob changed in each; only changes that change anything.
pub(super) fn remedies(spec: &Spec, cause: Cause) -> Vec<Spec> {
    let changes: &[(&str, &str)] = match cause {
        Cause::OpenMesh => &[("caster_sides", "auto"), ("caster_sides", "all")],
        Cause::ClippingNear => {
            &[("count", "mixed"), ("count", "z-fail"), ("count", "zp-plus"), ("stencil_init", "eye-count")]
        }
        Cause::ClippingFar => &[("far", "infinite"), ("far", "clamp"), ("extrusion", "infinite"), ("length_m", "auto")],
        Cause::ClippingFrustum => &[("scissor", "off"), ("range_mask", "off")],
        Cause::StencilOverflow => &[
            ("stencil_ops", "wrap"),
            ("range_mask", "off"),
            ("caster_sides", "auto"),
            ("shape", "silhouette"),
            ("count", "z-fail"),
        ],
        Cause::TechniqueModel => &[("cap_compare", "strict"), ("caps", "auto"), ("back_cap", "reversed-facing")],
        Cause::Precision => {
            &[("depth_convention", "reversed"), ("format", "depth32float-stencil8"), ("count", "z-fail")]
        }
        Cause::EdgeAliasing
        | Cause::PerspectiveAliasing
        | Cause::ProjectiveAliasing
        | Cause::Acne
        | Cause::Curvature
        | Cause::PeterPanning
        | Cause::PlanarModel
        | Cause::AntiShadow
        | Cause::FalseShadowBehindPlane
        | Cause::FilterWidth
        | Cause::LightBleeding => &[],
    };
    let changed = changes.iter().filter_map(|(key, value)| spec.with(key, value).ok());
    changed.filter(|changed| changed != spec).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_remedy_changes_something_and_stays_legal() {
        let spec = Spec::parse("volume:count=z-pass,cap_compare=inclusive").unwrap();
        for cause in Cause::ALL {
            assert!(remedies(&spec, cause).iter().all(|remedy| *remedy != spec));
        }
        assert_eq!(remedies(&spec, Cause::TechniqueModel)[0].short(), "volume:count=z-pass");
        assert!(remedies(&Spec::parse("volume").unwrap(), Cause::OpenMesh).len() == 1);
    }
}
