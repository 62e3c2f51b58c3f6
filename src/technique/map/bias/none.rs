//! `none`: no bias unless numbers are typed: shows the acne.

use super::{Amounts, Bias, Numbers};

/// See the module.
#[derive(Debug)]
pub(super) struct None;

impl Bias for None {
    fn name(&self) -> &'static str {
        "none"
    }
    fn amounts(&self, numbers: &Numbers, _bias_kernel: f64) -> Amounts {
        numbers.amounts_with(0.0, 0.0)
    }
}
