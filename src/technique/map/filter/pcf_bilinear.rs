//! `pcf-bilinear`: the mean of n × n bilinear lookups, each of which weighs the answers of four texels by how near the
//! receiver is to their centres. The penumbra is continuous, and n + 1 texels wide.
//!
//! W. Reeves, D. Salesin, R. Cook, "Rendering Antialiased Shadows with Depth Maps", 1987, weighted as texture hardware
//! does it. Neighbouring lookups share texels, so (n + 1)² comparisons are enough.

use super::{Filter, Kernel};
use crate::gpu::shader::{Wgsl, wgsl};
use crate::technique::param::{Choice, ChoiceNumber};
use glam::{DVec2, IVec2};

/// (n + 1) × (n + 1) taps; those on the rim count by how much of them the kernel covers.
#[derive(Debug)]
pub(super) struct PcfBilinear;

impl Filter for PcfBilinear {
    fn choice(&self) -> Choice {
        Choice { name: "pcf-bilinear", number: Some(ChoiceNumber { min: 1, max: 16, default: 1 }) }
    }
    fn shader(&self) -> Wgsl {
        wgsl!("map/filter/pcf_bilinear.wgsl")
    }
    fn radius_texels(&self, kernel: &Kernel) -> f64 {
        f64::from(kernel.number.div_ceil(2))
    }
    fn bias_kernel(&self, kernel: &Kernel) -> f64 {
        0.5 * f64::from(kernel.number + 1)
    }
    fn taps(&self, kernel: &Kernel, position_in_texels: DVec2, tap: &mut dyn FnMut(IVec2, f64)) {
        let n = kernel.number as i32;
        let start = position_in_texels - 0.5 * f64::from(n);
        let first = start.floor();
        let part = start - first;
        let weight = |step: i32, part: f64| {
            if step == 0 {
                1.0 - part
            } else if step == n {
                part
            } else {
                1.0
            }
        };
        for row in 0..=n {
            for column in 0..=n {
                let share = weight(column, part.x) * weight(row, part.y) / f64::from(n * n);
                tap(first.as_ivec2() + IVec2::new(column, row), share);
            }
        }
    }
}
