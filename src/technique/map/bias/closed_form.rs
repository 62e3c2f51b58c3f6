//! `closed-form`: exactly the bias that the receiver's own slope and the filter's kernel need (docs/map.md#bias), computed
//! at each receiver, plus the rounding of depth format, rasteriser and f32 position.

use super::{Amounts, Bias, Clearance, Numbers};

/// See the module.
#[derive(Debug)]
pub(super) struct ClosedForm;

impl Bias for ClosedForm {
    fn name(&self) -> &'static str {
        "closed-form"
    }
    fn amounts(&self, numbers: &Numbers, bias_kernel: f64) -> Amounts {
        numbers.amounts_that_clear(Clearance::ClosedForm, bias_kernel)
    }
}
