//! `slope`: the rasteriser's slope-scaled bias plus its constant.

use super::{AUTO_SLOPE, AUTO_UNITS, Amounts, Bias, Numbers};

/// See the module.
#[derive(Debug)]
pub(super) struct Slope;

impl Bias for Slope {
    fn name(&self) -> &'static str {
        "slope"
    }
    fn amounts(&self, numbers: &Numbers, _bias_kernel: f64) -> Amounts {
        numbers.amounts_with(AUTO_UNITS, AUTO_SLOPE)
    }
}
