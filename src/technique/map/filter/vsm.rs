//! `vsm`: variance shadow maps. Mean and variance of depth bound how much can lie behind the receiver (P. Chebyshev).
//!
//! W. Donnelly, A. Lauritzen, "Variance Shadow Maps", 2006. Assumes one blocker and the receiver within the kernel: then it
//! is exact. Known failure: two blockers at different depths (`light-bleeding`).

use super::moments::{self, Moments, OWN, chebyshev};
use super::pcf_bilinear::PcfBilinear;
use super::{Filter, Kernel};
use crate::gpu::shader::{Wgsl, wgsl};
use crate::scene::Light;
use crate::technique::param::Choice;
use glam::{DVec2, DVec4, IVec2, Vec4};

/// Mean and mean square.
#[derive(Debug)]
pub(super) struct Vsm;

impl Filter for Vsm {
    fn choice(&self) -> Choice {
        moments::choice("vsm")
    }
    fn shader(&self) -> Wgsl {
        wgsl!("map/filter/vsm.wgsl")
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
        vec![DVec4::new(kernel.min_variance, 0.0, 0.0, kernel.bleeding_cut).as_vec4()]
    }
    fn moments(&self) -> Option<&dyn Moments> {
        Some(self)
    }
}

impl Moments for Vsm {
    fn count(&self) -> u32 {
        2
    }
    fn of(&self, _numbers: &[Vec4], z: f64) -> DVec4 {
        DVec4::new(z, z * z, 0.0, 0.0)
    }
    fn bound(&self, numbers: &[Vec4], z: f64, mean: DVec4) -> f64 {
        let min_variance = f64::from(numbers[OWN].x);
        chebyshev(z, mean.x, (mean.y - mean.x * mean.x).max(min_variance))
    }
}
