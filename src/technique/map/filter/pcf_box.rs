//! `pcf-box`: the mean of n × n comparisons around the receiver.
//!
//! W. Reeves, D. Salesin, R. Cook, "Rendering Antialiased Shadows with Depth Maps", 1987. Its penumbra is n texels wide
//! whatever the truth is (`filter-width`).

use super::{Filter, Kernel};
use crate::gpu::shader::{Wgsl, wgsl};
use crate::technique::param::{Choice, ChoiceNumber};
use glam::{DVec2, IVec2};

/// n × n taps of equal weight.
#[derive(Debug)]
pub(super) struct PcfBox;

impl Filter for PcfBox {
    fn choice(&self) -> Choice {
        Choice { name: "pcf-box", number: Some(ChoiceNumber { min: 1, max: 32, default: 3 }) }
    }
    fn shader(&self) -> Wgsl {
        wgsl!("map/filter/pcf_box.wgsl")
    }
    fn radius_texels(&self, kernel: &Kernel) -> f64 {
        f64::from(kernel.number / 2)
    }
    fn bias_kernel(&self, kernel: &Kernel) -> f64 {
        0.5 * f64::from(kernel.number)
    }
    fn taps(&self, kernel: &Kernel, position_in_texels: DVec2, tap: &mut dyn FnMut(IVec2, f64)) {
        let n = kernel.number as i32;
        let first = if n % 2 == 1 {
            position_in_texels.floor().as_ivec2() - (n - 1) / 2
        } else {
            (position_in_texels + 0.5).floor().as_ivec2() - n / 2
        };
        let weight = 1.0 / f64::from(n * n);
        for row in 0..n {
            for column in 0..n {
                tap(first + IVec2::new(column, row), weight);
            }
        }
    }
}
