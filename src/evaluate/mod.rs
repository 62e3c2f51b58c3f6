//! One evaluation: a technique's answer and cost, the verdict on it, and the ledger of its errors.
//!
//! A [`View`] holds what does not depend on the light, a [`Question`] what does not depend on the technique; both are
//! made once and shared by every evaluation.

mod cost;
mod diagnose;
#[cfg(test)]
mod faults;
mod jitter;
#[cfg(test)]
mod lighting_tests;
mod motion;
mod occluders;
mod profile;
mod view;

pub use cost::time_in_turn;
pub use diagnose::{BiasVerdict, Diagnosis, Outcome, Trials, diagnose, search_bias};
pub use jitter::jittered;
pub use motion::{Flips, STEP_PX, flips};
pub use occluders::occluders;
pub use profile::{Penumbra, Sample, penumbras, predicted_at, profile};
pub use view::{Oracle, Question, TruthStore, View};

use crate::cause::Replay;
use crate::mask::{Mask, Truth, TruthMask};
use crate::scene::Light;
use crate::technique::{Cost, InView, Prepared, Spec, TechniqueError};
use crate::verdict::{Ledger, LedgerError, Seams, Verdict, VerdictError, judge, ledger, seams, wrong_above};
use crate::watch::{Interrupted, Watch};

/// How thorough an evaluation is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Effort {
    /// Timed runs after the warm-up; 0 runs once and measures no time.
    pub timed_runs: u32,
    /// Whether errors are booked to causes.
    pub explains: bool,
}

impl Effort {
    /// What `check` does.
    pub const FULL: Self = Self { timed_runs: 3, explains: true };
    /// Only the verdict.
    pub const VERDICT: Self = Self { timed_runs: 0, explains: false };
    /// The verdict and its causes, without a warm-up.
    pub const CAUSES: Self = Self { timed_runs: 0, explains: true };
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
    /// What it cost.
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
    let (prepared, prepare_ms) = cost::prepared(|| spec.technique().prepare(spec, job))?;
    let mut measured = cost::measure(prepared.as_ref(), effort.timed_runs, watch)?;
    measured.cost.prepare_ms = Some(prepare_ms);
    let verdict = judge(&question.classes, &question.truth.mask, &measured.mask, wrong_above(question.light))?;
    if watch.interrupted() {
        return Err(Interrupted.into());
    }
    let (replay, ledger) = if effort.explains {
        let is_off = |(_, error): &(usize, &Option<f64>)| error.is_some_and(|error| error != 0.0);
        let pixels: Vec<u32> =
            verdict.signed_error.iter().enumerate().filter(is_off).map(|(pixel, _)| pixel as u32).collect();
        let replay =
            replay_from_truth(prepared.as_ref(), spec, question.light, &question.truth.mask, &measured.mask, &pixels)?;
        let ledger = ledger(&verdict, &question.truth.mask, &measured.mask, &replay)?;
        (replay, ledger)
    } else {
        (Replay::default(), Ledger::default())
    };
    Ok(Evaluation { prepared, mask: measured.mask, verdict, replay, ledger, cost: measured.cost })
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
