//! The verdict on one mask: every asked pixel compared with the exact truth.
//!
//! Counts come from exact per-pixel comparison, not from a mean score: 200 pixels of acne vanish in the mean of a
//! megapixel picture. Sums run in f64, row by row, then over the rows in order, so that threads do not change them.

use super::counts::{ErrorStats, PixelCounts, WorstCase};
use super::edge::{Side, edge_distance, side_of};
use super::{DIFFERING_ABOVE, blobs};
use crate::mask::{Mask, Truth, TruthMask};
use crate::receiver::PixelClass;
use glam::UVec2;
use rayon::prelude::*;

/// What one mask is worth.
#[derive(Debug, Clone, PartialEq)]
pub struct Verdict {
    /// Width and height in pixels.
    pub size: UVec2,
    /// The |technique − truth| above which a pixel is wrong.
    pub wrong_above: f64,
    /// How many pixels of which kind.
    pub pixels: PixelCounts,
    /// How large the errors are.
    pub error: ErrorStats,
    /// The same with every undecided pixel as wrong as can be.
    pub worst_case: WorstCase,
    /// technique − truth of each asked and decided pixel, −1..=1 (negative is too dark); one entry per pixel.
    pub signed_error: Vec<Option<f64>>,
}

impl Verdict {
    /// Whether a pixel (`y * width + x`) is wrong. False beyond the picture and where nothing is compared.
    #[must_use]
    pub fn is_wrong(&self, pixel: usize) -> bool {
        self.exceeds(pixel, self.wrong_above)
    }

    /// Whether a pixel (`y * width + x`) differs; every wrong pixel does.
    #[must_use]
    pub fn is_differing(&self, pixel: usize) -> bool {
        self.exceeds(pixel, DIFFERING_ABOVE)
    }

    fn exceeds(&self, pixel: usize, threshold: f64) -> bool {
        self.signed_error.get(pixel).copied().flatten().is_some_and(|error| error.abs() > threshold)
    }
}

/// Why a mask cannot be judged.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum VerdictError {
    /// Two of the inputs are not of the same picture.
    #[error("the {what} has {found} pixels, but the truth is {} x {} pixels large", expected.x, expected.y)]
    Size {
        /// Which input.
        what: &'static str,
        /// Entries it has.
        found: usize,
        /// The truth's width and height.
        expected: UVec2,
    },
    /// The mask's width and height differ from the truth's.
    #[error("the mask is {} x {} pixels large, the truth {} x {}", mask.x, mask.y, truth.x, truth.y)]
    Shape {
        /// The mask's width and height.
        mask: UVec2,
        /// The truth's width and height.
        truth: UVec2,
    },
    /// Asked pixels without an entry in one of the masks.
    #[error("the {what} leaves {count} asked pixels unanswered, the first at ({}, {})", first.x, first.y)]
    Unanswered {
        /// Which mask.
        what: &'static str,
        /// How many pixels.
        count: u64,
        /// The first of them in reading order: column and row.
        first: UVec2,
    },
    /// The threshold is no number a visibility error can exceed or stay within.
    #[error("a pixel cannot be wrong above {0}: it takes a number from {DIFFERING_ABOVE} to 1")]
    Threshold(f64),
}

/// Compares `mask` with `truth` wherever `classes` says that the light was asked about and the truth is decided.
///
/// # Errors
/// Inputs of different sizes, an asked pixel that the truth or (unless undecided) the mask leaves unanswered, and a
/// `wrong_above` outside [`DIFFERING_ABOVE`]..=1.
pub fn judge(
    classes: &[PixelClass],
    truth: &TruthMask,
    mask: &Mask,
    wrong_above: f64,
) -> Result<Verdict, VerdictError> {
    if !(DIFFERING_ABOVE..=1.0).contains(&wrong_above) {
        return Err(VerdictError::Threshold(wrong_above));
    }
    check_sizes(classes, truth, mask)?;
    let Comparison { signed_error, tally } = compare(classes, truth, mask, wrong_above);
    if tally.unanswered_by_truth + tally.unanswered_by_mask > 0 {
        return Err(unanswered(classes, truth, mask, &tally));
    }
    let mut verdict = Verdict {
        size: truth.size,
        wrong_above,
        pixels: tally.counts,
        error: error_stats(&tally),
        worst_case: worst_case(&tally),
        signed_error,
    };
    if tally.counts.wrong > 0 {
        locate_wrong(&mut verdict, truth);
    }
    Ok(verdict)
}

fn check_sizes(classes: &[PixelClass], truth: &TruthMask, mask: &Mask) -> Result<(), VerdictError> {
    if mask.size != truth.size {
        return Err(VerdictError::Shape { mask: mask.size, truth: truth.size });
    }
    let area = truth.size.x as usize * truth.size.y as usize;
    let inputs = [("truth", truth.pixels.len()), ("mask", mask.pixels.len()), ("class list", classes.len())];
    match inputs.into_iter().find(|&(_, found)| found != area) {
        Some((what, found)) => Err(VerdictError::Size { what, found, expected: truth.size }),
        None => Ok(()),
    }
}

/// Every pixel's error, and what they come to.
struct Comparison {
    signed_error: Vec<Option<f64>>,
    tally: Tally,
}

/// Running counts and sums.
#[derive(Clone, Copy, Default)]
struct Tally {
    counts: PixelCounts,
    abs: f64,
    signed: f64,
    unanswered_by_truth: u64,
    unanswered_by_mask: u64,
}

fn compare(classes: &[PixelClass], truth: &TruthMask, mask: &Mask, wrong_above: f64) -> Comparison {
    let width = truth.size.x.max(1) as usize;
    let mut signed_error = vec![None; classes.len()];
    let rows: Vec<Tally> = signed_error
        .par_chunks_mut(width)
        .zip(classes.par_chunks(width))
        .zip(truth.pixels.par_chunks(width).zip(mask.pixels.par_chunks(width)))
        .map(|((errors, classes), (truths, answers))| {
            let mut tally = Tally::default();
            for (x, error) in errors.iter_mut().enumerate() {
                let answer = answers[x].map(|v| f64::from(v.get()));
                *error = tally.add(classes[x], truths[x], answer, wrong_above);
            }
            tally
        })
        .collect();
    Comparison { signed_error, tally: rows.into_iter().fold(Tally::default(), Tally::plus) }
}

impl Tally {
    /// Counts one pixel and returns its signed error if it has one.
    fn add(&mut self, class: PixelClass, truth: Option<Truth>, answer: Option<f64>, wrong_above: f64) -> Option<f64> {
        self.counts.total += 1;
        match class {
            PixelClass::Background => self.counts.background += 1,
            PixelClass::FacingAway => self.counts.facing_away += 1,
            PixelClass::NotLit => self.counts.not_lit += 1,
            PixelClass::Asked => match (truth, answer) {
                (None, _) => self.unanswered_by_truth += 1,
                (Some(Truth::Undecided), _) => self.counts.undecided += 1,
                (Some(Truth::Known(_)), None) => self.unanswered_by_mask += 1,
                (Some(Truth::Known(truth)), Some(answer)) => {
                    let error = answer - f64::from(truth.get());
                    self.add_error(error, wrong_above);
                    return Some(error);
                }
            },
        }
        None
    }

    fn add_error(&mut self, error: f64, wrong_above: f64) {
        self.counts.asked += 1;
        self.abs += error.abs();
        self.signed += error;
        let wrong = error.abs() > wrong_above;
        self.counts.wrong += u64::from(wrong);
        self.counts.differing += u64::from(error.abs() > DIFFERING_ABOVE);
        self.counts.false_shadow += u64::from(wrong && error < 0.0);
        self.counts.false_light += u64::from(wrong && error > 0.0);
    }

    fn plus(self, other: Self) -> Self {
        Self {
            counts: self.counts.plus(other.counts),
            abs: self.abs + other.abs,
            signed: self.signed + other.signed,
            unanswered_by_truth: self.unanswered_by_truth + other.unanswered_by_truth,
            unanswered_by_mask: self.unanswered_by_mask + other.unanswered_by_mask,
        }
    }
}

fn unanswered(classes: &[PixelClass], truth: &TruthMask, mask: &Mask, tally: &Tally) -> VerdictError {
    let without_truth = |i: usize| truth.pixels[i].is_none();
    let without_answer = |i: usize| matches!(truth.pixels[i], Some(Truth::Known(_))) && mask.pixels[i].is_none();
    let first_of = |blank: &dyn Fn(usize) -> bool| {
        let first = (0..classes.len()).find(|&i| classes[i] == PixelClass::Asked && blank(i)).unwrap_or(0) as u32;
        UVec2::new(first % truth.size.x, first / truth.size.x)
    };
    if tally.unanswered_by_truth > 0 {
        VerdictError::Unanswered { what: "truth", count: tally.unanswered_by_truth, first: first_of(&without_truth) }
    } else {
        VerdictError::Unanswered { what: "mask", count: tally.unanswered_by_mask, first: first_of(&without_answer) }
    }
}

fn error_stats(tally: &Tally) -> ErrorStats {
    let over_asked = |sum: f64| ratio(sum, tally.counts.asked);
    ErrorStats {
        mean_abs: over_asked(tally.abs),
        signed: over_asked(tally.signed),
        wrong_fraction: over_asked(tally.counts.wrong as f64),
        largest_blob_px: 0,
        edge_distance_px: None,
    }
}

fn worst_case(tally: &Tally) -> WorstCase {
    let undecided = tally.counts.undecided as f64;
    let over_both = |sum: f64| ratio(sum + undecided, tally.counts.asked + tally.counts.undecided);
    WorstCase { wrong_fraction: over_both(tally.counts.wrong as f64), mean_abs: over_both(tally.abs) }
}

fn ratio(sum: f64, count: u64) -> Option<f64> {
    (count > 0).then(|| sum / count as f64)
}

/// Fills in where the wrong pixels are: blobs and distances to the edge.
fn locate_wrong(verdict: &mut Verdict, truth: &TruthMask) {
    let wrong: Vec<bool> =
        (0..verdict.signed_error.len()).into_par_iter().map(|pixel| verdict.is_wrong(pixel)).collect();
    let compared = verdict.signed_error.par_iter().zip(&truth.pixels);
    let sides: Vec<Side> = compared.map(|(error, truth)| compared_side(*error, *truth)).collect();
    let (blobs, distance) = rayon::join(|| blobs(verdict.size, &wrong), || edge_distance(verdict.size, &sides, &wrong));
    verdict.error.largest_blob_px = blobs.iter().map(|blob| blob.pixels).max().unwrap_or(0);
    verdict.error.edge_distance_px = distance;
}

fn compared_side(error: Option<f64>, truth: Option<Truth>) -> Side {
    match (error, truth) {
        (Some(_), Some(Truth::Known(truth))) => Some(side_of(truth.get())),
        _ => None,
    }
}
