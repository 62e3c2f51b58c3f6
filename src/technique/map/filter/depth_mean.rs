//! `depth-mean`: the mean of depths, compared once. The wrong way round, here to be seen: the mean of two surfaces' depths
//! is a depth where nothing is, so the shadow's edge stays as hard as it was and moves.
//!
//! W. Reeves, D. Salesin, R. Cook, "Rendering Antialiased Shadows with Depth Maps", 1987, who say why comparisons must be
//! averaged. As a moment filter it is the one with a single moment. Known failures: all of it (`light-bleeding` where the
//! edge moved into the shadow, `technique-model` where it moved out).

use super::Kernel;
use super::moments::Moments;
use crate::gpu::shader::{Wgsl, wgsl};
use glam::{DVec4, Vec4};

/// No moments but the mean.
#[derive(Debug)]
pub(super) struct DepthMean;

impl Moments for DepthMean {
    fn name(&self) -> &'static str {
        "depth-mean"
    }
    fn wgsl(&self) -> Wgsl {
        wgsl!("map/filter/depth_mean.wgsl")
    }
    fn own_numbers(&self, _kernel: &Kernel) -> DVec4 {
        DVec4::ZERO
    }
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
