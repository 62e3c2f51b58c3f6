//! Which knob of planar shadows to turn against which cause.

use crate::cause::Cause;
use crate::technique::Spec;

/// One knob changed in each; only changes that are legal and change anything.
pub(super) fn remedies(spec: &Spec, cause: Cause) -> Vec<Spec> {
    let set = |key: &'static str, value: &str| (key, value.to_owned());
    let changes = match cause {
        Cause::PlanarModel if spec.choice("projection").0 == "shear" => {
            vec![set("projection", "clipped"), set("planes", "all")]
        }
        Cause::PlanarModel => vec![set("planes", "all")],
        Cause::AntiShadow | Cause::FalseShadowBehindPlane => vec![set("projection", "clipped")],
        Cause::ClippingFar => vec![("kappa", SMALLEST_KAPPA.to_string())],
        Cause::ClippingFrustum => vec![set("placement", "receiver-mask")],
        Cause::TechniqueModel => vec![set("overlap", "stencil"), set("darkening", "1")],
        Cause::Precision => vec![set("placement", "receiver-mask")],
        _ => Vec::new(),
    };
    let changed = changes.into_iter().filter_map(|(key, value)| spec.with(key, &value).ok());
    changed.filter(|changed| changed != spec).collect()
}

/// The least that `kappa` may be.
pub(super) const SMALLEST_KAPPA: f64 = 1e-9;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_remedy_changes_one_knob_that_matters() {
        let shear = Spec::parse("planar:projection=shear,planes=only1").unwrap();
        let typed: Vec<String> = remedies(&shear, Cause::PlanarModel).iter().map(Spec::short).collect();
        assert_eq!(typed, ["planar:planes=only1", "planar:projection=shear"]);
        let plain = Spec::parse("planar").unwrap();
        assert!(remedies(&plain, Cause::AntiShadow).is_empty(), "it is clipped already");
        for cause in Cause::ALL {
            assert!(remedies(&shear, cause).iter().all(|remedy| *remedy != shear));
        }
    }
}
