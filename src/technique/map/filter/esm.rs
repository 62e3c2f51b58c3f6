//! `esm`: exponential shadow maps. e^(c z) grows so fast that its mean is that of the depths near the receiver's.
//!
//! T. Annen et al., "Exponential Shadow Maps", 2008. Assumes that nothing in the kernel lies far behind the receiver. Known
//! failures: contacts, where e^(c (z_b − z)) is near 1, and slopes that fall off behind the receiver (`light-bleeding`);
//! c z beyond what the format holds (`precision`).

use super::moments::{self, Moments, OWN};
use super::pcf_bilinear::PcfBilinear;
use super::{Filter, Kernel};
use crate::gpu::shader::{Wgsl, wgsl};
use crate::scene::Light;
use crate::technique::param::Choice;
use glam::{DVec2, DVec4, IVec2, Vec4};

/// The mean of e^(c z).
#[derive(Debug)]
pub(super) struct Esm;

impl Filter for Esm {
    fn choice(&self) -> Choice {
        moments::choice("esm")
    }
    fn shader(&self) -> Wgsl {
        wgsl!("map/filter/esm.wgsl")
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
                kernel.exponent.unwrap_or(if kernel.is_half { 10.0 } else { 40.0 }),
                0.0,
                0.0,
                kernel.bleeding_cut,
            )
            .as_vec4(),
        ]
    }
    fn moments(&self) -> Option<&dyn Moments> {
        Some(self)
    }
}

impl Moments for Esm {
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
