//! `esm`: exponential shadow maps. e^(c z) grows so fast that its mean is that of the depths near the receiver's.
//!
//! T. Annen et al., "Exponential Shadow Maps", 2008. Assumes that nothing in the kernel lies far behind the receiver. Known
//! failures: contacts, where e^(c (z_b − z)) is near 1, and slopes that fall off behind the receiver (`light-bleeding`);
//! c z beyond what the format holds (`precision`).

use super::Kernel;
use super::moments::{Moments, OWN};
use crate::gpu::shader::{Wgsl, wgsl};
use glam::{DVec4, Vec4};

/// The mean of e^(c z).
#[derive(Debug)]
pub(super) struct Esm;

impl Moments for Esm {
    fn name(&self) -> &'static str {
        "esm"
    }
    fn wgsl(&self) -> Wgsl {
        wgsl!("map/filter/esm.wgsl")
    }
    fn own_numbers(&self, kernel: &Kernel) -> DVec4 {
        DVec4::new(kernel.exponent.unwrap_or(if kernel.is_half { 10.0 } else { 40.0 }), 0.0, 0.0, kernel.bleeding_cut)
    }
    fn count(&self) -> u32 {
        1
    }
    fn of(&self, numbers: &[Vec4], z: f64) -> DVec4 {
        DVec4::new((f64::from(numbers[OWN].x) * z).exp(), 0.0, 0.0, 0.0)
    }
    fn bound(&self, numbers: &[Vec4], z: f64, mean: DVec4) -> f64 {
        mean.x * (-f64::from(numbers[OWN].x) * z).exp()
    }
}
