//! One evaluation: a technique's answer and cost, the verdict on it, and the ledger of its errors.
//!
//! A [`View`] holds what does not depend on the light, a [`Question`] what does not depend on the technique; both are
//! made once and shared by every evaluation.

mod diagnose;
#[cfg(test)]
mod faults;
mod jitter;
#[cfg(test)]
mod lighting_tests;
mod motion;
mod occluders;
mod profile;
mod timing;
mod view;

pub use diagnose::{BiasVerdict, Diagnosis, Outcome, Trials, diagnose, search_bias};
pub use jitter::jittered;
pub use motion::{Flips, Followed, STEP_PX, flips};
pub use occluders::occluders;
pub use profile::{Penumbra, Sample, penumbras, predicted_at, profile};
pub use timing::{TIMED_ROUNDS, Times, time_evaluations, time_in_turn};
pub use view::{Oracle, Question, TruthStore, View};

use crate::cause::Replay;
use crate::mask::{Mask, Truth, TruthMask};
use crate::scene::Light;
use crate::technique::{Cost, InView, Prepared, Spec, TechniqueError};
use crate::verdict::{Ledger, LedgerError, Seams, Verdict, VerdictError, judge, ledger, seams, wrong_above};
use crate::watch::{Interrupted, Watch};
use std::time::Instant;

/// How thorough an evaluation is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Effort {
    /// Whether errors are booked to causes.
    pub explains: bool,
}

impl Effort {
    /// Only the verdict.
    pub const VERDICT: Self = Self { explains: false };
    /// The verdict and its causes.
    pub const CAUSES: Self = Self { explains: true };
}

/// A technique evaluated for one light of one view.
pub struct Evaluation<'v> {
    /// The technique, ready to be asked for more.
    pub prepared: Box<dyn Prepared + 'v>,
    /// Its answer.
    pub mask: Mask,
    /// How good the answer is.
    pub verdict: Verdict,
    /// The replay of every pixel with an error; empty without [`Effort::explains`].
    pub replay: Replay,
    /// Why it is wrong; empty without [`Effort::explains`].
    pub ledger: Ledger,
    /// What it cost; without times until it is timed ([`time_evaluations`]).
    pub cost: Cost,
}

impl Evaluation<'_> {
    /// The errors by view and by distance to the seam; `None` for techniques with fewer than two views of the light.
    /// `wrong_above`: the |technique − truth| above which a pixel is wrong.
    #[must_use]
    pub fn seams(&self, wrong_above: f64) -> Option<Seams> {
        let names = self.prepared.view_names();
        let errors = &self.verdict.signed_error;
        let place = |(pixel, error): (u32, &Option<f64>)| error.and_then(|_| self.prepared.in_view(pixel));
        let places: Vec<Option<InView>> = (0..).zip(errors).map(place).collect();
        (names.len() > 1).then(|| seams(&names, &places, errors, wrong_above))
    }
}

impl std::fmt::Debug for Evaluation<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Evaluation").field("pixels", &self.verdict.pixels).finish_non_exhaustive()
    }
}

/// Why an evaluation has no result.
#[derive(Debug, thiserror::Error)]
pub enum EvaluateError {
    /// The technique gave no answer.
    #[error(transparent)]
    Technique(#[from] TechniqueError),
    /// The answer cannot be judged.
    #[error(transparent)]
    Verdict(#[from] VerdictError),
    /// The replay does not explain the answer: a bug of gnomon.
    #[error("the replay does not explain the answer: {0}")]
    Ledger(#[from] LedgerError),
    /// The user asked to stop.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
}

impl EvaluateError {
    /// Whether the work was told to stop.
    #[must_use]
    pub fn is_interrupt(&self) -> bool {
        matches!(self, Self::Interrupted(_) | Self::Technique(TechniqueError::Interrupted(_)))
    }
}

/// Evaluates one technique.
///
/// # Errors
/// [`EvaluateError`]; an unsupported technique is [`TechniqueError::Unsupported`].
pub fn evaluate<'v>(
    view: &'v View<'_>,
    question: &'v Question<'v>,
    spec: &Spec,
    effort: Effort,
    watch: &dyn Watch,
) -> Result<Evaluation<'v>, EvaluateError> {
    let job = view.job(question.light, &question.classes);
    let (start, built_ms) = (Instant::now(), view.gpu.building_ms());
    let prepared = spec.technique().prepare(spec, job)?;
    let prepare_ms = start.elapsed().as_secs_f64() * 1e3 - (view.gpu.building_ms() - built_ms);
    let answer = prepared.run()?;
    let cost = Cost::counted(&answer.passes, prepared.bytes(), prepare_ms);
    let mask = answer.mask;
    let verdict = judge(&question.classes, &question.truth.mask, &mask, wrong_above(question.light))?;
    if watch.interrupted() {
        return Err(Interrupted.into());
    }
    let (replay, ledger) = if effort.explains {
        let is_off = |(_, error): &(usize, &Option<f64>)| error.is_some_and(|error| error != 0.0);
        let pixels: Vec<u32> =
            verdict.signed_error.iter().enumerate().filter(is_off).map(|(pixel, _)| pixel as u32).collect();
        let replay = replay_from_truth(prepared.as_ref(), spec, question.light, &question.truth.mask, &mask, &pixels)?;
        let ledger = ledger(&verdict, &question.truth.mask, &mask, &replay)?;
        (replay, ledger)
    } else {
        (Replay::default(), Ledger::default())
    };
    Ok(Evaluation { prepared, mask, verdict, replay, ledger, cost })
}

/// Replays the given pixels (ascending indices of asked pixels) from the truth to `answer`. Where a technique takes an
/// area light for its centre, the first stage is that.
///
/// # Errors
/// As [`Prepared::replay`].
pub fn replay_from_truth(
    prepared: &dyn Prepared,
    spec: &Spec,
    light: &Light,
    truth: &TruthMask,
    answer: &Mask,
    pixels: &[u32],
) -> Result<Replay, TechniqueError> {
    let replay = prepared.replay(answer, pixels)?;
    let Some(cause) = spec.technique().blamed_for_centre(spec).filter(|_| light.is_area()) else {
        return Ok(replay);
    };
    let known = |pixel: &u32| match truth.pixels.get(*pixel as usize) {
        Some(Some(Truth::Known(visibility))) => f64::from(visibility.get()),
        _ => f64::NAN,
    };
    let exact = replay.pixels.iter().map(known).collect();
    Ok(replay.led_by(exact, "light's centre", cause))
}
