//! `msm`: moment shadow maps. The least that four moments allow to lie before the receiver (the Hamburger problem).
//!
//! C. Peters, R. Klein, "Moment Shadow Mapping", 2015. `msm_bias` draws the moments towards those of a spread-out depth, so
//! that rounding cannot make them impossible; where they are all the same, or no depths have them at all, the mean is
//! compared. Exact for the receiver and one blocker, up to that bias. Known failure: three and more depths
//! (`light-bleeding`, a little).

use super::Kernel;
use super::moments::{Moments, OWN};
use crate::gpu::shader::{Wgsl, wgsl};
use glam::{DVec4, Vec4};

/// The means of the first four powers.
#[derive(Debug)]
pub(super) struct Msm;

impl Moments for Msm {
    fn name(&self) -> &'static str {
        "msm"
    }
    fn wgsl(&self) -> Wgsl {
        wgsl!("map/filter/msm.wgsl")
    }
    fn own_numbers(&self, kernel: &Kernel) -> DVec4 {
        DVec4::new(kernel.msm_bias.unwrap_or(if kernel.is_half { 5e-3 } else { 3e-5 }), 0.0, 0.0, kernel.bleeding_cut)
    }
    fn count(&self) -> u32 {
        4
    }
    fn of(&self, _numbers: &[Vec4], z: f64) -> DVec4 {
        DVec4::new(z, z * z, z * z * z, z * z * z * z)
    }
    fn bound(&self, numbers: &[Vec4], z: f64, mean: DVec4) -> f64 {
        let b = mean.lerp(DVec4::splat(0.5), f64::from(numbers[OWN].x));
        // [1 b.x b.y; b.x b.y b.z; b.y b.z b.w] c = (1, z, z²), by L D Lᵀ.
        let d2 = b.y - b.x * b.x;
        let l32 = (b.z - b.x * b.y) / d2;
        let d3 = b.w - b.y * b.y - l32 * l32 * d2;
        let hard = if z <= mean.x { 1.0 } else { 0.0 };
        if d2 <= 0.0 || d3 <= 0.0 {
            return hard;
        }
        let c2_forward = z - b.x;
        let c3 = (z * z - b.y - l32 * c2_forward) / d3;
        let c2 = c2_forward / d2 - l32 * c3;
        let c1 = 1.0 - b.x * c2 - b.y * c3;
        let middle = -0.5 * c2 / c3;
        let squared = middle * middle - c1 / c3;
        if squared <= 0.0 {
            return hard;
        }
        let (z2, z3) = (middle - squared.sqrt(), middle + squared.sqrt());
        if z <= z2 {
            1.0
        } else if z <= z3 {
            1.0 - (z * z3 - b.x * (z + z3) + b.y) / ((z3 - z2) * (z - z2))
        } else {
            (z2 * z3 - b.x * (z2 + z3) + b.y) / ((z - z2) * (z - z3))
        }
    }
}
