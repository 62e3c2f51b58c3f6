//! `evsm`: exponential variance shadow maps. Chebyshev's bound on two warps of depth, e^(c z) and −e^(−c z), of which the
//! lower counts.
//!
//! A. Lauritzen, M. McCool, "Layered Variance Shadow Maps", 2008. `min_variance` is that of z, carried over by the warps'
//! slope. Assumes that one warp or the other tells the blockers apart. Known failures: what both leave (`light-bleeding`);
//! exponents whose square the format cannot hold, 2 c > 88.7 in 32 bits and > 11.09 in 16 (`precision`).

use super::Kernel;
use super::moments::{Moments, OWN, chebyshev};
use crate::gpu::shader::{Wgsl, wgsl};
use glam::{DVec4, Vec4};

/// Mean and mean square of both warps.
#[derive(Debug)]
pub(super) struct Evsm;

impl Moments for Evsm {
    fn name(&self) -> &'static str {
        "evsm"
    }
    fn wgsl(&self) -> Wgsl {
        wgsl!("map/filter/evsm.wgsl")
    }
    fn own_numbers(&self, kernel: &Kernel) -> DVec4 {
        DVec4::new(
            kernel.exponent.unwrap_or(if kernel.is_half { 5.0 } else { 40.0 }),
            kernel.negative_exponent,
            kernel.min_variance,
            kernel.bleeding_cut,
        )
    }
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
