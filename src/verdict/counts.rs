//! The figures of a verdict: how many pixels of which kind, and how large their errors are.

use serde::{Deserialize, Serialize};

/// How many pixels there are of each kind.
///
/// `total = background + facing_away + not_lit + undecided + asked`; `differing` includes the wrong ones, and
/// `wrong = false_shadow + false_light`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct PixelCounts {
    /// All pixels of the picture.
    pub total: u64,
    /// No geometry.
    pub background: u64,
    /// Turned away from the light.
    pub facing_away: u64,
    /// Outside the light's reach, or on a mesh that does not receive.
    pub not_lit: u64,
    /// Asked, but the truth changes within the receiver's own rounding error. Not compared.
    pub undecided: u64,
    /// Asked and decided: what is compared, and what ratios refer to.
    pub asked: u64,
    /// |technique − truth| is above the verdict's `wrong_above`.
    pub wrong: u64,
    /// |technique − truth| is above [`DIFFERING_ABOVE`](super::DIFFERING_ABOVE).
    pub differing: u64,
    /// Wrong and too dark.
    pub false_shadow: u64,
    /// Wrong and too bright.
    pub false_light: u64,
}

impl PixelCounts {
    /// Both counts together.
    #[must_use]
    pub(super) fn plus(self, other: Self) -> Self {
        Self {
            total: self.total + other.total,
            background: self.background + other.background,
            facing_away: self.facing_away + other.facing_away,
            not_lit: self.not_lit + other.not_lit,
            undecided: self.undecided + other.undecided,
            asked: self.asked + other.asked,
            wrong: self.wrong + other.wrong,
            differing: self.differing + other.differing,
            false_shadow: self.false_shadow + other.false_shadow,
            false_light: self.false_light + other.false_light,
        }
    }
}

/// How large the errors are. Ratios over no asked pixel are `None`.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct ErrorStats {
    /// Mean of |technique − truth| over the asked pixels, 0..=1.
    pub mean_abs: Option<f64>,
    /// Mean of technique − truth over the asked pixels, −1..=1: negative is too dark.
    pub signed: Option<f64>,
    /// Wrong pixels / asked pixels, 0..=1.
    pub wrong_fraction: Option<f64>,
    /// Pixels of the largest 8-connected component of wrong pixels.
    pub largest_blob_px: u64,
    /// How far wrong pixels are from the true shadow edge; `None` without wrong pixels or without an edge.
    pub edge_distance_px: Option<EdgeDistance>,
}

/// Distances of the wrong pixels from the true shadow edge, in pixels.
///
/// One distance is that between the centres of the wrong pixel and of the nearest decided pixel on the other side of the
/// edge, minus half a pixel. Percentiles are by nearest rank: the smallest distance that at least p % do not exceed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct EdgeDistance {
    /// The median.
    pub p50: f64,
    /// The 99th percentile.
    pub p99: f64,
    /// The largest.
    pub max: f64,
}

/// The figures if every undecided pixel were asked and as wrong as can be.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct WorstCase {
    /// (wrong + undecided) / (asked + undecided); `None` if that is 0 / 0.
    pub wrong_fraction: Option<f64>,
    /// The mean absolute error with an error of 1 for every undecided pixel.
    pub mean_abs: Option<f64>,
}
