//! `evsm`: exponential variance shadow maps. Chebyshev's bound on two warps of depth, e^(c z) and −e^(−c z), of which the
//! lower counts.
//!
//! A. Lauritzen, M. McCool, "Layered Variance Shadow Maps", 2008. `min_variance` is that of z, carried over by the warps'
//! slope. Assumes that one warp or the other tells the blockers apart. Known failures: what both leave (`light-bleeding`);
//! exponents whose square the format cannot hold, 2 c > 88.7 in 32 bits and > 11.09 in 16 (`precision`).

use super::moments::{self, Moments, OWN, chebyshev};
use super::pcf_bilinear::PcfBilinear;
use super::{Filter, Kernel};
use crate::gpu::shader::{Wgsl, wgsl};
use crate::scene::Light;
use crate::technique::param::Choice;
use glam::{DVec2, DVec4, IVec2, Vec4};

/// Mean and mean square of both warps.
#[derive(Debug)]
pub(super) struct Evsm;

impl Filter for Evsm {
    fn choice(&self) -> Choice {
        moments::choice("evsm")
    }
    fn shader(&self) -> Wgsl {
        wgsl!("map/filter/evsm.wgsl")
    }
    fn builds_on(&self) -> &'static [Wgsl] {
        moments::LOOKUP
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
        vec![
            DVec4::new(
                kernel.exponent.unwrap_or(if kernel.is_half { 5.0 } else { 40.0 }),
                kernel.negative_exponent,
                kernel.min_variance,
                kernel.bleeding_cut,
            )
            .as_vec4(),
        ]
    }
    fn moments(&self) -> Option<&dyn Moments> {
        Some(self)
    }
}

impl Moments for Evsm {
    fn count(&self) -> u32 {
        4
    }
    fn of(&self, numbers: &[Vec4], z: f64) -> DVec4 {
        let [p, q] = warps(numbers, z);
        DVec4::new(p, p * p, q, q * q)
    }
    fn bound(&self, numbers: &[Vec4], z: f64, mean: DVec4) -> f64 {
        let one = |exponent: f32, warped: f64, mean: f64, mean_square: f64| {
            let per_z = 2.0 * f64::from(exponent) * warped.abs();
            let least = f64::from(numbers[OWN].z) * per_z * per_z;
            chebyshev(warped, mean, (mean_square - mean * mean).max(least))
        };
        let [p, q] = warps(numbers, z);
        one(numbers[OWN].x, p, mean.x, mean.y).min(one(numbers[OWN].y, q, mean.z, mean.w))
    }
}

/// e^(c z) and −e^(−c z) of z stretched to −1..1.
fn warps(numbers: &[Vec4], z: f64) -> [f64; 2] {
    let around_zero = 2.0 * z - 1.0;
    [(f64::from(numbers[OWN].x) * around_zero).exp(), -(-f64::from(numbers[OWN].y) * around_zero).exp()]
}
