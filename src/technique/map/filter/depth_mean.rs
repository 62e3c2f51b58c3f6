//! `depth-mean`: the mean of depths, compared once. The wrong way round, here to be seen: the mean of two surfaces' depths
//! is a depth where nothing is, so the shadow's edge stays as hard as it was and moves.
//!
//! W. Reeves, D. Salesin, R. Cook, "Rendering Antialiased Shadows with Depth Maps", 1987, who say why comparisons must be
//! averaged. As a moment filter it is the one with a single moment. Known failures: all of it (`light-bleeding` where the
//! edge moved into the shadow, `technique-model` where it moved out).

use super::moments::{self, Moments};
use super::pcf_bilinear::PcfBilinear;
use super::{Filter, Kernel};
use crate::gpu::shader::{Wgsl, wgsl};
use crate::scene::Light;
use crate::technique::param::Choice;
use glam::{DVec2, DVec4, IVec2, Vec4};

/// No moments but the mean.
#[derive(Debug)]
pub(super) struct DepthMean;

impl Filter for DepthMean {
    fn choice(&self) -> Choice {
        moments::choice("depth-mean")
    }
    fn shader(&self) -> Wgsl {
        wgsl!("map/filter/depth_mean.wgsl")
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
    fn numbers(&self, _kernel: &Kernel, _light: &Light) -> Vec<Vec4> {
        vec![Vec4::ZERO]
    }
    fn moments(&self) -> Option<&dyn Moments> {
        Some(self)
    }
}

impl Moments for DepthMean {
    fn count(&self) -> u32 {
        1
    }
    fn of(&self, _numbers: &[Vec4], z: f64) -> DVec4 {
        DVec4::new(z, 0.0, 0.0, 0.0)
    }
    fn bound(&self, _numbers: &[Vec4], z: f64, mean: DVec4) -> f64 {
        if z <= mean.x { 1.0 } else { 0.0 }
    }
}
