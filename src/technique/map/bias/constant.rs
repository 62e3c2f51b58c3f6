//! `constant`: the rasteriser's constant bias, in units of the depth format.

use super::{AUTO_UNITS, Amounts, Bias, Numbers};

/// See the module.
#[derive(Debug)]
pub(super) struct Constant;

impl Bias for Constant {
    fn name(&self) -> &'static str {
        "constant"
    }
    fn amounts(&self, numbers: &Numbers, _bias_kernel: f64) -> Amounts {
        numbers.amounts_with(AUTO_UNITS, 0.0)
    }
}
