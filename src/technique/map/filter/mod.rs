//! The filter axis: which texels a lookup compares, and with which weights. Comparisons are averaged, never depths.
//!
//! Adding one: a file here, a WGSL file of the same stem in `shaders/map/filter/` that defines `filter_visibility`, a
//! line in [`registry`].

mod depth_mean;
mod esm;
mod evsm;
mod kernel;
pub(super) mod moments;
mod msm;
mod nearest;
mod pcf_bilinear;
mod pcf_box;
mod pcf_edge_masked;
mod pcf_hardware;
mod pcf_poisson;
mod pcss;
mod turn;
mod vsm;

pub use kernel::{Kernel, params};
pub use moments::Moments;

use super::lookup::Placed;
use super::projection::View;
use crate::gpu::shader::{Wgsl, wgsl};
use crate::scene::Light;
use crate::technique::param::Choice;
use glam::{DVec2, DVec4, IVec2, Vec4};

/// `numbers` of the shaders.
const NUMBERS: Wgsl = wgsl!("map/numbers.wgsl");

/// Every filter.
#[must_use]
pub fn registry() -> &'static [&'static dyn Filter] {
    &[
        &nearest::Nearest,
        &pcf_box::PcfBox,
        &pcf_bilinear::PcfBilinear,
        &pcf_hardware::PcfHardware,
        &pcf_poisson::PcfPoisson,
        &pcf_edge_masked::PcfEdgeMasked,
        &pcss::Pcss,
        &vsm::Vsm,
        &esm::Esm,
        &evsm::Evsm,
        &msm::Msm,
        &depth_mean::DepthMean,
    ]
}

/// A filter over comparison results.
pub trait Filter: Sync {
    /// Its name, and the number that may trail it (the kernel).
    fn choice(&self) -> Choice;
    /// The WGSL that defines `filter_visibility`.
    fn shader(&self) -> Wgsl;
    /// What that builds on besides the lookup.
    fn builds_on(&self) -> &'static [Wgsl] {
        &[]
    }
    /// How far beyond the receiver's own texel a tap may lie, texels.
    fn radius_texels(&self, kernel: &Kernel) -> f64;
    /// How many texel widths of depth slope an acne-free bias needs (docs/map.md#bias).
    fn bias_kernel(&self, kernel: &Kernel) -> f64;
    /// Calls `tap` with each texel and its weight for a lookup at `position_in_texels`; the f64 twin of the WGSL, in the
    /// same order. Weights add up to 1.
    fn taps(&self, kernel: &Kernel, position_in_texels: DVec2, tap: &mut dyn FnMut(IVec2, f64));

    /// Texels that a lookup reads at most.
    fn texel_reads(&self, kernel: &Kernel) -> u32 {
        if self.moments().is_some() {
            return moments::READS;
        }
        let mut reads = 0;
        self.taps(kernel, DVec2::ZERO, &mut |_, _| reads += 1);
        reads
    }

    /// The same where taps follow from what the map holds. `blocker` gives the depth of a texel of the receiver's view, or
    /// of one beyond its side that measures depth alike, if it is nearer to the light than the receiver; `None` for
    /// others. No taps at all: lit.
    fn taps_at(&self, asked: &Asked<'_>, _blocker: Blocker<'_>, tap: &mut dyn FnMut(IVec2, f64)) {
        self.taps(asked.kernel, asked.placed.position_in_texels, tap);
    }
    /// Whether its shader reads the map itself, not only which of its texels are lit.
    fn reads_map(&self) -> bool {
        self.moments().is_some()
    }
    /// Whether it reckons with distances, so that depth must be linear.
    fn needs_linear_depth(&self) -> bool {
        self.moments().is_some()
    }
    /// Whether it answers for the whole of an area light, not for its centre.
    fn softens(&self) -> bool {
        false
    }
    /// Whether each tap is compared with a bias for as far as it is, for kernels that differ by receiver.
    fn reaches_by_tap(&self) -> bool {
        false
    }
    /// Whether its shader compares by a sampler, four texels with one reference.
    fn samples(&self) -> bool {
        false
    }
    /// Of what blocks of texels its shader reads the extremes: 2 to this many a side.
    fn mask_level(&self, _kernel: &Kernel) -> Option<u32> {
        None
    }
    /// What its shader reads as `numbers`, and its twin in [`Asked::numbers`].
    fn numbers(&self, _kernel: &Kernel, _light: &Light) -> Vec<Vec4> {
        Vec::new()
    }
    /// What it averages in place of answers, where it does; its kernel is that of `taps` all the same.
    fn moments(&self) -> Option<&dyn Moments> {
        None
    }
}

/// See [`Filter::taps_at`].
pub type Blocker<'b> = &'b mut dyn FnMut(IVec2) -> Option<f64>;

/// A lookup that a filter is asked to answer.
#[derive(Debug, Clone, Copy)]
pub struct Asked<'a> {
    /// What is typed about the filter.
    pub kernel: &'a Kernel,
    /// [`Filter::numbers`].
    pub numbers: &'a [Vec4],
    /// Index of the receiver's pixel.
    pub pixel: u32,
    /// The receiver's view.
    pub view: &'a View,
    /// The receiver in it.
    pub placed: &'a Placed,
    /// The light: w = 1, or 0 with a vector towards it.
    pub light: DVec4,
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
        by_name(name).taps(&Kernel::wide(kernel), at, &mut |texel, weight| taps.push((texel, weight)));
        taps
    }

    proptest! {
        #[test]
        fn weights_add_up_to_one_within_the_radius(u in 0.0..64.0_f64, v in 0.0..64.0_f64, number in 1..=32_u32) {
            for filter in registry() {
                let name = filter.choice().name;
                let kernel = filter.choice().number.map_or(1, |range| number.clamp(range.min, range.max));
                let taps = taps(name, kernel, DVec2::new(u, v));
                prop_assert!((taps.iter().map(|t| t.1).sum::<f64>() - 1.0).abs() < 1e-12);
                let own = DVec2::new(u, v).floor();
                let farthest = taps.iter().map(|t| (t.0.as_dvec2() - own).abs().max_element()).fold(0.0, f64::max);
                prop_assert!(farthest <= filter.radius_texels(&Kernel::wide(kernel)), "{} {farthest}", name);
            }
        }

        #[test]
        fn one_tap_is_nearest(u in 0.0..64.0_f64, v in 0.0..64.0_f64) {
            let at = DVec2::new(u, v);
            prop_assert_eq!(taps("pcf-box", 1, at), taps("nearest", 1, at));
            prop_assert_eq!(taps("pcf-poisson", 1, at), taps("nearest", 1, at));
        }

        /// FI-3: within a texel a box of odd width never changes, and across its sides a bilinear kernel does not jump.
        #[test]
        fn boxes_step_at_texels_and_bilinear_kernels_nowhere(u in 8.0..56.0_f64, v in 8.0..56.0_f64, n in 1..=16_u32) {
            const STEP: f64 = 1e-6;
            let at = DVec2::new(u, v);
            let odd = 2 * (n / 2) + 1;
            prop_assert_eq!(taps("pcf-box", odd, at), taps("pcf-box", odd, at.floor() + 0.5));
            let lit_left_of = |edge: i32, at: DVec2| -> f64 {
                taps("pcf-bilinear", n, at).iter().filter(|(texel, _)| texel.x < edge).map(|(_, weight)| weight).sum()
            };
            let on_side = DVec2::new(at.x.floor(), at.y);
            for edge in [on_side.x as i32, on_side.x as i32 + 1] {
                let change = lit_left_of(edge, on_side + STEP * DVec2::X) - lit_left_of(edge, on_side - STEP * DVec2::X);
                prop_assert!(change.abs() <= 2.1 * STEP, "{}", change);
            }
        }

        #[test]
        fn the_weight_left_of_an_edge_along_the_texels_is_the_kernels_coverage(u in 20.0..44.0_f64, n in 1..=16_u32) {
            const EDGE: i32 = 32;
            let left_of_edge = |name| {
                let taps = taps(name, n, DVec2::new(u, 0.5));
                taps.iter().filter(|(texel, _)| texel.x < EDGE).map(|(_, weight)| weight).sum::<f64>()
            };
            let from_edge = f64::from(EDGE) - u;
            // A window of n texels' width, moved continuously; a box snaps to whole texels.
            let n = f64::from(n);
            let coverage = (0.5 + from_edge / n).clamp(0.0, 1.0);
            prop_assert!((left_of_edge("pcf-bilinear") - coverage).abs() < 1e-12);
            prop_assert!((left_of_edge("pcf-box") - coverage).abs() <= 0.5 / n + 1e-12);
        }
    }
}
