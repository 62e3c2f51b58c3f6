//! The ledger: every error booked to the approximation that made it.
//!
//! A replay turns the exact answer into the technique's, one approximation (stage) at a time. The signed change of each
//! stage is one entry, booked to the cause that the stage names for that pixel; the entries of a pixel add up to its
//! error. Entries may cancel, so a pixel that ends up wrong is *named* after the last stage at which its value left the
//! truth (|value − truth| rose above the threshold) and never came back.
//!
//! The ledger believes nothing: a replay that starts beside the truth, ends beside the mask or forgets a pixel is an
//! error, not a rounding difference.

use super::{DIFFERING_ABOVE, Verdict};
use crate::cause::{Cause, Replay};
use crate::mask::{Mask, Truth, TruthMask};
use std::collections::BTreeMap;

/// Largest |residue| of a pixel's entries. Values are multiples of f32 steps or averages of at most a few thousand taps,
/// which f64 adds up with errors below 1e-12; anything above this is a replay of something else.
pub const RESIDUE_ABOVE: f64 = 1e-9;

/// What one cause is answerable for.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CauseShare {
    /// Wrong pixels named after it.
    pub pixels: u64,
    /// Pixels named after it that differ without being wrong.
    pub merely_differing: u64,
    /// Sum of its entries over all pixels, in units of one pixel's full visibility; negative is too dark.
    pub sum: f64,
}

/// One line of a pixel's account.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Entry {
    /// The stage.
    pub stage: &'static str,
    /// Visibility after the stage, 0..=1.
    pub value: f64,
    /// Change of visibility by the stage, −1..=1.
    pub contribution: f64,
    /// The cause that owns the change.
    pub cause: Cause,
}

/// Who is to blame for what.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Ledger {
    /// The causes that changed any pixel. The sums add up to the verdict's signed error × asked pixels.
    pub causes: BTreeMap<Cause, CauseShare>,
    /// Wrong pixels (`y * width + x`), ascending, each with the cause it is named after.
    pub wrong: Vec<(u32, Cause)>,
    /// The same for pixels that differ without being wrong.
    pub merely_differing: Vec<(u32, Cause)>,
}

impl Ledger {
    /// The cause a wrong or differing pixel (`y * width + x`) is named after; `None` for every other pixel.
    #[must_use]
    pub fn cause_of(&self, pixel: u32) -> Option<Cause> {
        let look_up =
            |named: &[(u32, Cause)]| named.binary_search_by_key(&pixel, |&(pixel, _)| pixel).ok().map(|at| named[at].1);
        look_up(&self.wrong).or_else(|| look_up(&self.merely_differing))
    }
}

/// Why a replay does not explain a verdict.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LedgerError {
    /// Lists of different lengths, pixels out of order, or a value that is no visibility.
    #[error("the replay is malformed: {0}")]
    Malformed(String),
    /// Truth, mask and verdict are not of the same picture.
    #[error("truth, mask and verdict are not of the same picture")]
    Foreign,
    /// A replayed pixel on which there is no verdict.
    #[error("the replay has pixel {pixel}, which was not compared")]
    NotCompared {
        /// The pixel, `y * width + x`.
        pixel: u32,
    },
    /// A pixel with an error that the replay leaves out.
    #[error("pixel {pixel} is off by {error}, but the replay leaves it out")]
    Missing {
        /// The pixel, `y * width + x`.
        pixel: u32,
        /// Its signed error.
        error: f64,
    },
    /// A chain that does not lead from the truth to the technique's answer.
    #[error("pixel {pixel} goes {chain}, but the truth is {truth} and the technique's answer is {answer}")]
    Residue {
        /// The pixel, `y * width + x`.
        pixel: u32,
        /// The exact visibility.
        truth: f64,
        /// The technique's visibility.
        answer: f64,
        /// The replayed stages and values in order.
        chain: String,
    },
}

/// Books the errors of `verdict` (on `mask`, by `truth`) to the stages of `replay`. The chain of a pixel starts at the
/// visibility that the truth mask holds and ends at the one that the mask holds, f32 rounding included.
///
/// # Errors
/// A malformed replay, one that leaves out a pixel with an error or holds one without a verdict, and one whose chain for
/// some pixel does not start at the truth or end at the mask's answer (within [`RESIDUE_ABOVE`]).
pub fn ledger(verdict: &Verdict, truth: &TruthMask, mask: &Mask, replay: &Replay) -> Result<Ledger, LedgerError> {
    check_form(replay)?;
    let lengths = [truth.pixels.len(), mask.pixels.len()];
    if lengths != [verdict.signed_error.len(); 2] {
        return Err(LedgerError::Foreign);
    }
    check_coverage(verdict, replay)?;
    let mut ledger = Ledger::default();
    for (slot, &pixel) in replay.pixels.iter().enumerate() {
        let ends = ends_of(pixel, verdict, truth, mask)?;
        check_chain(pixel, slot, ends, replay)?;
        ledger.book(pixel, slot, ends, verdict, replay);
    }
    Ok(ledger)
}

/// The account of one pixel (`y * width + x`), stage by stage; `None` if the replay leaves it out.
#[must_use]
pub fn entries_of_pixel(replay: &Replay, pixel: u32) -> Option<Vec<Entry>> {
    let slot = replay.pixels.binary_search(&pixel).ok()?;
    Some(entries(replay, slot).collect())
}

/// The entries of the pixel in one slot of a well-formed replay.
fn entries(replay: &Replay, slot: usize) -> impl Iterator<Item = Entry> {
    replay.stages.iter().scan(replay.exact[slot], move |before, stage| {
        let value = stage.values[slot];
        let contribution = value - std::mem::replace(before, value);
        Some(Entry { stage: stage.name, value, contribution, cause: stage.causes[slot] })
    })
}

/// Where a pixel's chain has to start and end.
#[derive(Clone, Copy)]
struct Ends {
    truth: f64,
    answer: f64,
}

fn ends_of(pixel: u32, verdict: &Verdict, truth: &TruthMask, mask: &Mask) -> Result<Ends, LedgerError> {
    let at = pixel as usize;
    let error = verdict.signed_error.get(at).copied().flatten().ok_or(LedgerError::NotCompared { pixel })?;
    match (truth.pixels[at], mask.pixels[at]) {
        (Some(Truth::Known(truth)), Some(answer)) => {
            let ends = Ends { truth: f64::from(truth.get()), answer: f64::from(answer.get()) };
            let same_error = (ends.answer - ends.truth - error).abs() <= RESIDUE_ABOVE;
            same_error.then_some(ends).ok_or(LedgerError::Foreign)
        }
        _ => Err(LedgerError::Foreign),
    }
}

fn check_form(replay: &Replay) -> Result<(), LedgerError> {
    let count = replay.pixels.len();
    let malformed = |what: String| Err(LedgerError::Malformed(what));
    if !replay.pixels.is_sorted_by(|a, b| a < b) {
        return malformed("its pixels do not ascend".to_owned());
    }
    let exact = ("exact answer", &replay.exact, count);
    let stages = replay.stages.iter().map(|stage| (stage.name, &stage.values, stage.causes.len()));
    for (name, values, causes) in std::iter::once(exact).chain(stages) {
        if values.len() != count || causes != count {
            return malformed(format!("{name} has {} values and {causes} causes for {count} pixels", values.len()));
        }
        if let Some(slot) = values.iter().position(|value| !(-RESIDUE_ABOVE..=1.0 + RESIDUE_ABOVE).contains(value)) {
            return malformed(format!("{name} gives pixel {} the visibility {}", replay.pixels[slot], values[slot]));
        }
    }
    Ok(())
}

fn check_coverage(verdict: &Verdict, replay: &Replay) -> Result<(), LedgerError> {
    let mut replayed = replay.pixels.iter().peekable();
    for (pixel, error) in (0_u32..).zip(&verdict.signed_error) {
        let found = replayed.next_if_eq(&&pixel).is_some();
        match *error {
            Some(error) if error.abs() > 0.0 && !found => return Err(LedgerError::Missing { pixel, error }),
            _ => {}
        }
    }
    Ok(())
}

fn check_chain(pixel: u32, slot: usize, ends: Ends, replay: &Replay) -> Result<(), LedgerError> {
    let near = |value: f64, end: f64| (value - end).abs() <= RESIDUE_ABOVE;
    let starts = near(replay.exact[slot], ends.truth);
    let last = replay.stages.last().map_or(replay.exact[slot], |stage| stage.values[slot]);
    let booked: f64 = entries(replay, slot).map(|entry| entry.contribution).sum();
    if starts && near(last, ends.answer) && near(booked, ends.answer - ends.truth) {
        return Ok(());
    }
    let stages = entries(replay, slot).map(|entry| format!("{} {}", entry.stage, entry.value));
    let chain: Vec<String> = std::iter::once(format!("exact {}", replay.exact[slot])).chain(stages).collect();
    Err(LedgerError::Residue { pixel, truth: ends.truth, answer: ends.answer, chain: chain.join(", ") })
}

impl Ledger {
    fn book(&mut self, pixel: u32, slot: usize, ends: Ends, verdict: &Verdict, replay: &Replay) {
        for entry in entries(replay, slot).filter(|entry| entry.contribution.abs() > 0.0) {
            self.causes.entry(entry.cause).or_default().sum += entry.contribution;
        }
        let wrong = verdict.is_wrong(pixel as usize);
        let threshold = if wrong { verdict.wrong_above } else { DIFFERING_ABOVE };
        if !wrong && !verdict.is_differing(pixel as usize) {
            return;
        }
        if let Some(cause) = departure(replay, slot, ends.truth, threshold) {
            let share = self.causes.entry(cause).or_default();
            if wrong {
                share.pixels += 1;
                self.wrong.push((pixel, cause));
            } else {
                share.merely_differing += 1;
                self.merely_differing.push((pixel, cause));
            }
        }
    }
}

/// The cause of the last stage that took the value beyond `threshold` from the truth, never to come back: the one after
/// the last stage within it. The final stage, known to be beyond, need not be looked at.
fn departure(replay: &Replay, slot: usize, truth: f64, threshold: f64) -> Option<Cause> {
    let (_, inner) = replay.stages.split_last()?;
    let last_within = inner.iter().rposition(|stage| (stage.values[slot] - truth).abs() <= threshold);
    let departed = last_within.map_or(0, |within| within + 1);
    Some(replay.stages[departed].causes[slot])
}
