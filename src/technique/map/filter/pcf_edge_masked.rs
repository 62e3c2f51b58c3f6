//! `pcf-edge-masked`: `pcf-box`, but where the nearest and the farthest depth around the receiver are both before it or
//! both behind it, that answers for all of the kernel: dense work at shadow edges only.
//!
//! K. Dmitriev, Y. Uralsky, "Soft Shadows Using Hierarchical Min-Max Shadow Maps", 2007. The nearest and farthest depths are those of blocks of 2^`mask_level` texels a side that hold the kernel, so the
//! shortcut never differs from the whole: bit for bit the answer is that of `pcf-box`.

use super::pcf_box::PcfBox;
use super::{Filter, Kernel};
use crate::gpu::shader::{Wgsl, wgsl};
use crate::technique::param::{Choice, ChoiceNumber};
use glam::{DVec2, IVec2};

/// n × n taps of equal weight, where they are needed.
#[derive(Debug)]
pub(super) struct PcfEdgeMasked;

impl Filter for PcfEdgeMasked {
    fn choice(&self) -> Choice {
        Choice { name: "pcf-edge-masked", number: Some(ChoiceNumber { min: 1, max: 32, default: 5 }) }
    }
    fn shader(&self) -> Wgsl {
        wgsl!("map/filter/pcf_edge_masked.wgsl")
    }
    fn radius_texels(&self, kernel: &Kernel) -> f64 {
        PcfBox.radius_texels(kernel)
    }
    fn bias_kernel(&self, kernel: &Kernel) -> f64 {
        PcfBox.bias_kernel(kernel)
    }
    fn taps(&self, kernel: &Kernel, position_in_texels: DVec2, tap: &mut dyn FnMut(IVec2, f64)) {
        PcfBox.taps(kernel, position_in_texels, tap);
    }
    fn texel_reads(&self, kernel: &Kernel) -> u32 {
        let blocks = (kernel.number - 1).div_ceil(1 << kernel.mask_level) + 1;
        blocks * blocks + kernel.number * kernel.number
    }
    fn reads_map(&self) -> bool {
        true
    }
    fn mask_level(&self, kernel: &Kernel) -> Option<u32> {
        Some(kernel.mask_level)
    }
}
