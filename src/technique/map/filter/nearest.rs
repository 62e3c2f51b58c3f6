//! `nearest`: the texel that holds the receiver decides alone.

use super::{Filter, Kernel};
use crate::gpu::shader::{Wgsl, wgsl};
use crate::technique::param::Choice;
use glam::{DVec2, IVec2};

/// One tap.
#[derive(Debug)]
pub(super) struct Nearest;

impl Filter for Nearest {
    fn choice(&self) -> Choice {
        Choice::plain("nearest")
    }
    fn shader(&self) -> Wgsl {
        wgsl!("map/filter/nearest.wgsl")
    }
    fn radius_texels(&self, _kernel: &Kernel) -> f64 {
        0.0
    }
    fn bias_kernel(&self, _kernel: &Kernel) -> f64 {
        0.5
    }
    fn taps(&self, _kernel: &Kernel, position_in_texels: DVec2, tap: &mut dyn FnMut(IVec2, f64)) {
        tap(position_in_texels.floor().as_ivec2(), 1.0);
    }
}
