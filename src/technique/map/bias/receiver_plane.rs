//! `receiver-plane`: every tap is compared with the depth that the receiver's own plane has at the centre of the texel,
//! plus the rounding of depth format, rasteriser and f32 position (docs/map.md#bias). No kernel is too wide for it.
//!
//! J. Isidoro, "Shadow Mapping: GPU-based Tips and Techniques", GDC 2006. Known failure: where the surface bends or ends
//! within the kernel, the plane runs on without it (`curvature`, `acne`).

use super::{Amounts, Bias, Clearance, Numbers};

/// See the module.
#[derive(Debug)]
pub(super) struct ReceiverPlane;

impl Bias for ReceiverPlane {
    fn name(&self) -> &'static str {
        "receiver-plane"
    }
    fn amounts(&self, numbers: &Numbers, bias_kernel: f64) -> Amounts {
        numbers.amounts_that_clear(Clearance::ReceiverPlane, bias_kernel)
    }
}
