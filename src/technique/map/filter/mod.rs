//! The filter axis: which texels a lookup compares, and with which weights. Comparisons are averaged, never depths.
//!
//! Adding one: a file here, a WGSL file of the same stem in `shaders/map/filter/` that defines `filter_visibility`, a
//! line in [`registry`].

mod nearest;
mod pcf_box;

use crate::gpu::shader::Wgsl;
use crate::technique::param::Choice;
use glam::{DVec2, IVec2};

/// Every filter.
#[must_use]
pub fn registry() -> &'static [&'static dyn Filter] {
    &[&nearest::Nearest, &pcf_box::PcfBox]
}

/// A filter over comparison results.
pub trait Filter: Sync {
    /// Its name, and the number that may trail it (the kernel).
    fn choice(&self) -> Choice;
    /// The WGSL that defines `filter_visibility`.
    fn shader(&self) -> Wgsl;
    /// How far beyond the receiver's own texel a tap may lie, texels.
    fn radius_texels(&self, kernel: u32) -> f64;
    /// How many texel widths of depth slope an acne-free bias needs (docs/map.md#bias).
    fn bias_kernel(&self, kernel: u32) -> f64;
    /// Calls `tap` with each texel and its weight for a lookup at `position_in_texels`; the f64 twin of the WGSL, in the
    /// same order. Weights add up to 1.
    fn taps(&self, kernel: u32, position_in_texels: DVec2, tap: &mut dyn FnMut(IVec2, f64));
}

/// A registered filter; the first one for a name that no declared parameter can hold.
#[must_use]
pub fn by_name(name: &str) -> &'static dyn Filter {
    registry().iter().copied().find(|filter| filter.choice().name == name).unwrap_or(registry()[0])
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn taps(name: &str, kernel: u32, at: DVec2) -> Vec<(IVec2, f64)> {
        let mut taps = Vec::new();
        by_name(name).taps(kernel, at, &mut |texel, weight| taps.push((texel, weight)));
        taps
    }

    proptest! {
        #[test]
        fn weights_add_up_to_one_within_the_radius(u in 0.0..64.0_f64, v in 0.0..64.0_f64, kernel in 1..=32_u32) {
            for filter in registry() {
                let name = filter.choice().name;
                let taps = taps(name, kernel, DVec2::new(u, v));
                prop_assert!((taps.iter().map(|t| t.1).sum::<f64>() - 1.0).abs() < 1e-12);
                let own = DVec2::new(u, v).floor();
                let farthest = taps.iter().map(|t| (t.0.as_dvec2() - own).abs().max_element()).fold(0.0, f64::max);
                prop_assert!(farthest <= filter.radius_texels(kernel), "{} {farthest}", name);
            }
        }

        #[test]
        fn one_tap_box_is_nearest(u in 0.0..64.0_f64, v in 0.0..64.0_f64) {
            let at = DVec2::new(u, v);
            prop_assert_eq!(taps("pcf-box", 1, at), taps("nearest", 1, at));
        }
    }
}
