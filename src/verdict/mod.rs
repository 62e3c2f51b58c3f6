//! Verdicts: how far a technique's mask is from the truth, where, and by which cause.
//!
//! [`judge()`] compares a mask with the truth pixel by pixel; [`ledger`](ledger()) books every error to the stages of the
//! technique's replay. Both are pure functions of what they are given: same input, same bytes out, whatever the number
//! of threads.

mod blobs;
mod counts;
mod distance;
mod edge;
mod judge;
#[cfg(test)]
mod judge_tests;
mod ledger;
#[cfg(test)]
mod ledger_tests;
mod radiance;
mod seams;

pub use blobs::{Blob, blobs};
pub use counts::{EdgeDistance, ErrorStats, PixelCounts, WorstCase};
pub use judge::{Verdict, VerdictError, judge};
pub use ledger::{CauseShare, Entry, Ledger, LedgerError, RESIDUE_ABOVE, entries_of_pixel, ledger};
pub use radiance::{Noise, RADIANCE_TOLERANCE, RadianceDifference, compare_radiance, critical_deviation, near_edges};
pub use seams::{BinError, DistanceError, Seams, ViewError, seams};

use crate::scene::Light;

/// A pixel lit by a point, directional or spot light is wrong above this |technique − truth|.
pub const WRONG_ABOVE_HARD: f64 = 0.5;

/// A pixel lit by a rectangle or sphere light is wrong above this |technique − truth|.
pub const WRONG_ABOVE_SOFT: f64 = 0.1;

/// The |technique − truth| above which a pixel lit by `light` is wrong.
#[must_use]
pub fn wrong_above(light: &Light) -> f64 {
    if light.is_area() { WRONG_ABOVE_SOFT } else { WRONG_ABOVE_HARD }
}

/// A pixel differs above this |technique − truth|: half of one step of an 8-bit picture.
pub const DIFFERING_ABOVE: f64 = 1.0 / 512.0;

/// The truth counts as lit from this visibility on; the true shadow edge runs between lit and shadowed pixels.
pub const LIT_FROM: f32 = 0.5;
