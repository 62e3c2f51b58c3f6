//! What moment filters share: instead of depths they keep powers of depth, whose means may be taken before the lookup,
//! and turn those into a bound of the share that is lit.
//!
//! z is depth from the light: 0 at the near plane, 1 at the far one. The means are taken over n × n texels and looked up
//! bilinearly, which together weighs texels as `pcf-bilinear` does. Formulas: docs/map.md#moments.

use super::pcf_bilinear::PcfBilinear;
use super::{Filter, Kernel, NUMBERS};
use crate::gpu::shader::{Wgsl, wgsl};
use crate::scene::Light;
use crate::technique::param::{Choice, ChoiceNumber};
use glam::{DVec2, DVec4, IVec2, Vec4};

/// A filter's own part.
pub trait Moments: Sync {
    /// The filter's name.
    fn name(&self) -> &'static str;
    /// The WGSL that defines `moments_of` and `bound`.
    fn wgsl(&self) -> Wgsl;
    /// What that is told.
    fn own_numbers(&self, kernel: &Kernel) -> DVec4;
    /// How many there are: 1, 2 or 4.
    fn count(&self) -> u32;
    /// Of one depth; the f64 twin of `moments_of`.
    fn of(&self, numbers: &[Vec4], z: f64) -> DVec4;
    /// An upper bound, as far as the moments tell, of the share of depths that z does not lie behind; the f64 twin of
    /// `bound`. Not limited to 0..=1.
    fn bound(&self, numbers: &[Vec4], z: f64, mean: DVec4) -> f64;
}

impl<M: Moments> Filter for M {
    fn choice(&self) -> Choice {
        Choice { name: self.name(), number: Some(ChoiceNumber { min: 1, max: 32, default: 3 }) }
    }
    fn shader(&self) -> Wgsl {
        self.wgsl()
    }
    fn builds_on(&self) -> &'static [Wgsl] {
        LOOKUP
    }
    fn radius_texels(&self, kernel: &Kernel) -> f64 {
        PcfBilinear.radius_texels(kernel)
    }
    fn bias_kernel(&self, kernel: &Kernel) -> f64 {
        PcfBilinear.bias_kernel(kernel)
    }
    fn taps(&self, kernel: &Kernel, position_in_texels: DVec2, tap: &mut dyn FnMut(IVec2, f64)) {
        PcfBilinear.taps(kernel, position_in_texels, tap);
    }
    fn numbers(&self, kernel: &Kernel, _light: &Light) -> Vec<Vec4> {
        vec![self.own_numbers(kernel).as_vec4()]
    }
    fn moments(&self) -> Option<&dyn Moments> {
        Some(self)
    }
}

/// Means that a lookup reads.
pub(super) const READS: u32 = 4;
/// What layouts build on.
const VIEW: Wgsl = wgsl!("map/view.wgsl");
/// `z_of` of the shaders.
const Z: Wgsl = wgsl!("map/moments/z.wgsl");
/// What lookups of moment filters build on.
const LOOKUP: &[Wgsl] = &[NUMBERS, Z, CHEBYSHEV, wgsl!("map/moments/lookup.wgsl")];
const CHEBYSHEV: Wgsl = wgsl!("map/moments/chebyshev.wgsl");
/// The means along rows, and of those along columns.
const ROWS: Wgsl = wgsl!("map/moments/rows.wgsl");
const COLUMNS: Wgsl = wgsl!("map/moments/columns.wgsl");

/// Index of the filter's own numbers, behind those of the mean.
pub(super) const OWN: usize = 1;

/// What a map of moments is stored in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::technique::map) struct Storage {
    /// The texture's format.
    pub(in crate::technique::map) format: wgpu::TextureFormat,
    file: Wgsl,
}

impl Storage {
    /// For so many moments, as 16-bit floats or 32-bit ones. Of half floats every device writes four at a time only.
    #[must_use]
    pub(in crate::technique::map) fn of(count: u32, is_half: bool) -> Self {
        use wgpu::TextureFormat::{R32Float, Rg32Float, Rgba16Float, Rgba32Float};
        let (format, file) = match (is_half, count) {
            (true, _) => (Rgba16Float, wgsl!("map/moments/rgba16float.wgsl")),
            (false, 1) => (R32Float, wgsl!("map/moments/r32float.wgsl")),
            (false, 2) => (Rg32Float, wgsl!("map/moments/rg32float.wgsl")),
            (false, _) => (Rgba32Float, wgsl!("map/moments/rgba32float.wgsl")),
        };
        Self { format, file }
    }

    /// Bytes of a texel.
    pub(in crate::technique::map) fn bytes(self) -> u64 {
        self.format.block_copy_size(None).unwrap_or(0).into()
    }

    /// The modules that take the means, along rows and along columns, of views with some layout.
    pub(in crate::technique::map) fn modules(self, filter: Wgsl, layout: Wgsl) -> [Vec<Wgsl>; 2] {
        [vec![NUMBERS, self.file, Z, CHEBYSHEV, VIEW, layout, filter, ROWS], vec![NUMBERS, self.file, COLUMNS]]
    }
}

/// Everything that the shaders of a moment filter read as numbers: the texels that a mean goes over, the z of what lies
/// beyond the border (negative: of its nearest texel) and the sign of depth; the filter's own; the moments of that z.
pub(in crate::technique::map) fn numbers(
    moments: &dyn Moments,
    own: Vec<Vec4>,
    texels: u32,
    z_beyond: Option<f64>,
    depth_sign: f64,
) -> Vec<Vec4> {
    let of_means = Vec4::new(texels as f32, z_beyond.map_or(-1.0, |z| z as f32), depth_sign as f32, 0.0);
    let mut numbers = vec![of_means];
    numbers.extend(own);
    numbers.push(moments.of(&numbers, z_beyond.unwrap_or(0.0)).as_vec4());
    numbers
}

/// The z of a depth; the f64 twin of `z_of`.
pub(in crate::technique::map) fn z_of(numbers: &[Vec4], depth: f64) -> f64 {
    if numbers[0].z > 0.0 { depth } else { 1.0 - depth }
}

/// The moments of what lies beyond the border, where that is not the nearest texel.
pub(in crate::technique::map) fn beyond(moments: &dyn Moments, numbers: &[Vec4]) -> DVec4 {
    moments.of(numbers, numbers[0].y.into())
}

/// The visibility at z for mean moments: their bound, less what it is cut by against bleeding. Lit where moments are not
/// finite.
pub(in crate::technique::map) fn visibility(moments: &dyn Moments, numbers: &[Vec4], z: f64, mean: DVec4) -> f64 {
    let bound = moments.bound(numbers, z, mean);
    let cut = f64::from(numbers[OWN].w);
    if mean.is_finite() && bound.is_finite() { ((bound - cut) / (1.0 - cut)).clamp(0.0, 1.0) } else { 1.0 }
}

/// P. Chebyshev's one-sided inequality: how much can lie at z or beyond, of what has that mean and variance.
pub(super) fn chebyshev(z: f64, mean: f64, variance: f64) -> f64 {
    if z <= mean { 1.0 } else { variance / (variance + (z - mean) * (z - mean)) }
}

#[cfg(test)]
mod tests {
    use super::super::{Kernel, by_name};
    use super::*;
    use crate::cast::testing::{Random, scene_of};
    use glam::Vec3;

    const ALL: [&str; 4] = ["vsm", "esm", "evsm", "msm"];

    /// Visibility at z of depths with weights, in f64 or with everything that is stored rounded to f32.
    fn visibility_at(name: &str, kernel: &Kernel, z: f64, depths: &[(f64, f64)], is_rounded: bool) -> f64 {
        // Moments know nothing of the light.
        let (filter, scene) = (by_name(name), scene_of(&[], Vec3::Y));
        let moments = filter.moments().unwrap();
        let numbers = numbers(moments, filter.numbers(kernel, &scene.lights[0]), 1, None, 1.0);
        let mean: DVec4 = depths.iter().map(|(depth, weight)| moments.of(&numbers, *depth) * *weight).sum();
        let mean = if is_rounded { mean.as_vec4().as_dvec4() } else { mean };
        visibility(moments, &numbers, z, mean)
    }

    /// A few depths with weights that add up to 1.
    fn distribution(random: &mut Random, most: u64) -> Vec<(f64, f64)> {
        let count = 1 + random.next() % most;
        let drawn: Vec<(f64, f64)> = (0..count).map(|_| (random.unit(), random.unit())).collect();
        let total: f64 = drawn.iter().map(|(_, weight)| weight).sum();
        drawn.into_iter().map(|(depth, weight)| (depth, weight / total)).collect()
    }

    fn lit(z: f64, depths: &[(f64, f64)]) -> f64 {
        depths.iter().filter(|(depth, _)| z <= *depth).map(|(_, weight)| weight).sum()
    }

    /// MO-1: never less light than there is; and how much more, on average.
    #[test]
    fn every_bound_is_an_upper_bound() {
        /// What the biases of `msm` and rounding in f64 may take away.
        const SLACK: f64 = 2e-3;
        for name in ALL {
            let mut random = Random(7);
            let mut excess = 0.0;
            const TRIALS: u32 = 20_000;
            for _ in 0..TRIALS {
                let (z, depths) = (random.unit(), distribution(&mut random, 8));
                let over = visibility_at(name, &Kernel::wide(1), z, &depths, false) - lit(z, &depths);
                assert!(over > -SLACK, "{name}: {over} at {z} of {depths:?}");
                excess += over;
            }
            let mean = excess / f64::from(TRIALS);
            assert!((0.02..0.3).contains(&mean), "{name}: {mean}");
            // Control: a receiver taken for nearer than it is would get more.
            let depths = [(0.3, 1.0)];
            assert!(
                visibility_at(name, &Kernel::wide(1), 0.31, &depths, false)
                    < visibility_at(name, &Kernel::wide(1), 0.29, &depths, false)
            );
        }
    }

    /// MO-2: one blocker and the receiver itself.
    #[test]
    fn variance_and_four_moments_are_exact_for_one_blocker() {
        let exact = Kernel { min_variance: 0.0, msm_bias: Some(0.0), ..Kernel::wide(1) };
        for (blocker, z, share) in [(0.2, 0.9, 0.3), (0.4, 0.6, 0.7), (0.1, 0.15, 0.5)] {
            let depths = [(blocker, 1.0 - share), (z, share)];
            let vsm = visibility_at("vsm", &exact, z, &depths, false);
            assert!((vsm - share).abs() < 1e-9, "{vsm} {share}");
            let msm = visibility_at("msm", &Kernel { msm_bias: Some(1e-7), ..exact }, z, &depths, false);
            assert!((msm - share).abs() < 0.02, "{msm} {share}");
        }
    }

    /// MO-3: how much light bleeds through two blockers.
    #[test]
    fn light_bleeds_as_predicted() {
        let exact = Kernel { min_variance: 0.0, ..Kernel::wide(1) };
        for (a, b, z, expected) in [(0.2, 0.5, 0.6, 0.2647), (0.2, 0.5, 0.9, 0.0692), (0.45, 0.5, 0.6, 0.0385)] {
            let (depths, p) = ([(a, 0.5), (b, 0.5)], 0.5);
            let (apart, behind) = (b - a, z - b);
            let variance = p * (1.0 - p) * apart * apart;
            let predicted = variance / (variance + (behind + p * apart) * (behind + p * apart));
            let vsm = visibility_at("vsm", &exact, z, &depths, false);
            assert!((vsm - predicted).abs() < 1e-9 && (predicted - expected).abs() < 1e-4, "{vsm} {predicted}");
            let cut = visibility_at("vsm", &Kernel { bleeding_cut: 0.3, ..exact }, z, &depths, false);
            assert_eq!(cut, 0.0);
            let msm = visibility_at("msm", &Kernel { msm_bias: Some(1e-6), ..exact }, z, &depths, false);
            assert!(msm < 3e-4, "{msm}");
        }
    }

    /// MO-6: without a bias f32 makes moments that no depths have; the guard answers then.
    #[test]
    fn rounded_moments_need_a_bias_or_the_guard() {
        let fallen_back = |bias: f64| {
            let kernel = Kernel { msm_bias: Some(bias), ..Kernel::wide(1) };
            let mut random = Random(11);
            let hard = (0..4000).filter(|_| {
                let (z, depths) = (random.unit(), distribution(&mut random, 3));
                let mean: f64 = depths.iter().map(|(depth, weight)| depth * weight).sum();
                let answer = visibility_at("msm", &kernel, z, &depths, true);
                assert!((0.0..=1.0).contains(&answer), "{answer}");
                z > mean && answer == 0.0
            });
            hard.count()
        };
        let [none, little, enough] = [0.0, 3e-6, 3e-4].map(fallen_back);
        assert!(none > 20 * little.max(1) && enough <= little, "{none} {little} {enough}");
    }

    /// The constant that makes a bound of all depths the mean's alone is the wrong one; it keeps its edge hard.
    #[test]
    fn the_mean_of_depths_is_lit_or_dark() {
        let depths = [(0.2, 0.5), (0.8, 0.5)];
        let at = |z: f64| visibility_at("depth-mean", &Kernel::wide(1), z, &depths, false);
        assert_eq!([0.1, 0.49, 0.51, 0.9].map(at), [1.0, 1.0, 0.0, 0.0]);
    }
}
