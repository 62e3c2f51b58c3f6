//! `vsm`: variance shadow maps. Mean and variance of depth bound how much can lie behind the receiver (P. Chebyshev).
//!
//! W. Donnelly, A. Lauritzen, "Variance Shadow Maps", 2006. Assumes one blocker and the receiver within the kernel: then it
//! is exact. Known failure: two blockers at different depths (`light-bleeding`).

use super::Kernel;
use super::moments::{Moments, OWN, chebyshev};
use crate::gpu::shader::{Wgsl, wgsl};
use glam::{DVec4, Vec4};

/// Mean and mean square.
#[derive(Debug)]
pub(super) struct Vsm;

impl Moments for Vsm {
    fn name(&self) -> &'static str {
        "vsm"
    }
    fn wgsl(&self) -> Wgsl {
        wgsl!("map/filter/vsm.wgsl")
    }
    fn own_numbers(&self, kernel: &Kernel) -> DVec4 {
        DVec4::new(kernel.min_variance, 0.0, 0.0, kernel.bleeding_cut)
    }
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
