//! `pcf-hardware`: the mean of n × n bilinear lookups as texture hardware makes them: a sampler compares four texels with
//! one reference and weighs their answers.
//!
//! In hardware since 2001 (NVIDIA's GeForce 3). What it answers is what `pcf-bilinear` does, with weights that drivers
//! round, mostly to 1/256 (`precision`). Where four texels are not all in the receiver's view they are compared one by one.

use super::pcf_bilinear::PcfBilinear;
use super::{Filter, Kernel};
use crate::gpu::shader::{Wgsl, wgsl};
use crate::technique::param::{Choice, ChoiceNumber};
use glam::{DVec2, IVec2};

/// n × n samples of four texels each.
#[derive(Debug)]
pub(super) struct PcfHardware;

impl Filter for PcfHardware {
    fn choice(&self) -> Choice {
        Choice { name: "pcf-hardware", number: Some(ChoiceNumber { min: 1, max: 16, default: 1 }) }
    }
    fn shader(&self) -> Wgsl {
        wgsl!("map/filter/pcf_hardware.wgsl")
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
    fn texel_reads(&self, kernel: &Kernel) -> u32 {
        4 * kernel.number * kernel.number
    }
    fn reads_map(&self) -> bool {
        true
    }
    fn samples(&self) -> bool {
        true
    }
}
