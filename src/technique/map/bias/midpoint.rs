//! `midpoint`: a texel stores the middle between the nearest and the second nearest surface, so that neither compares with
//! its own depth. Where there is no second surface it stores nothing: what could be in the shadow of the first?
//!
//! A. Woo, "The Shadow Depth Map Revisited", Graphics Gems III, 1992. The middle is that of the stored depths, wherever it
//! lies in metres. Costs a second pass over the casters and two maps more. Known failures: acne and light where the two
//! surfaces are close, at outlines and on thin casters (`acne`, `curvature`); receivers that are not in the map because
//! they cast nothing, or casters that are all there is along a ray (`peter-panning`).

use super::{Amounts, Bias, Clearance, Numbers};

/// See the module.
#[derive(Debug)]
pub(super) struct Midpoint;

impl Bias for Midpoint {
    fn name(&self) -> &'static str {
        "midpoint"
    }
    fn amounts(&self, numbers: &Numbers, bias_kernel: f64) -> Amounts {
        numbers.amounts_that_clear(Clearance::Midpoint, bias_kernel)
    }
}
