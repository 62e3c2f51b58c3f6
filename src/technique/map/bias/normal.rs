//! `normal`: the receiver is moved along its normal by as much as clears its own plane of the filter's kernel, and no
//! more, plus the rounding of depth format, rasteriser and f32 position (docs/map.md#bias). Bounded at any tilt.
//!
//! D. Holbert, "Saying Goodbye to Shadow Acne", GDC 2011. Known failure: the place in the map moves along, so a shadow's
//! edge moves by up to the offset times the sine of the tilt (`peter-panning`).

use super::{Amounts, Bias, Clearance, Numbers};

/// See the module.
#[derive(Debug)]
pub(super) struct Normal;

impl Bias for Normal {
    fn name(&self) -> &'static str {
        "normal"
    }
    fn amounts(&self, numbers: &Numbers, bias_kernel: f64) -> Amounts {
        numbers.amounts_that_clear(Clearance::Normal, bias_kernel)
    }
}
