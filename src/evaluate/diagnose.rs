//! What is wrong with a technique's shadows, and which knob helps: every fix is tried, its effect and its side effects
//! are measured.

use super::timing::{TIMED_ROUNDS, time_in_turn};
use super::{Effort, EvaluateError, Evaluation, Question, View, evaluate};
use crate::cause::Cause;
use crate::technique::{Cost, Prepared, Spec, SpecError};
use crate::verdict::Ledger;
use crate::watch::{Interrupted, Quiet, Watch};
use std::collections::BTreeMap;

/// Remedies tried per cause.
const TRIED_PER_CAUSE: usize = 3;
/// Worst pixels named per cause.
const NAMED_PIXELS: usize = 3;
/// The biases that a search compares, and the rasteriser's slope factor with each.
const BIASES: [(&str, &str); 9] = [
    ("none", "auto"),
    ("slope", "0.5"),
    ("slope", "1"),
    ("slope", "2"),
    ("slope", "4"),
    ("normal", "auto"),
    ("midpoint", "auto"),
    ("receiver-plane", "auto"),
    ("closed-form", "auto"),
];

/// What one evaluation came to.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// Wrong pixels per cause.
    pub wrong_by_cause: BTreeMap<Cause, u64>,
    /// All wrong pixels.
    pub wrong: u64,
    /// What it cost.
    pub cost: Cost,
    /// Its GPU time over that of the configuration it is to mend, both timed in turn; `None` without timestamps, and
    /// where nobody asked.
    pub ms_ratio: Option<f64>,
}

/// One cause that is present, and what was tried against it.
#[derive(Debug, Clone)]
pub struct Diagnosis {
    /// The cause.
    pub cause: Cause,
    /// Wrong pixels named after it.
    pub pixels: u64,
    /// Its share of all wrong pixels, 0..=1.
    pub share: f64,
    /// Signed sum of its contributions, in pixels of full visibility.
    pub sum: f64,
    /// Some of its pixels (`y * width + x`), the largest error first.
    pub worst: Vec<u32>,
    /// The fixes tried, and what came of each; a fix that cannot run says why.
    pub trials: Vec<(Spec, Result<Outcome, String>)>,
}

/// Whether some bias is free of both self-shadowing and detached contacts.
#[derive(Debug, Clone)]
pub struct BiasVerdict {
    /// The first bias tried that is free of both.
    pub free_of_both: Option<Spec>,
    /// Every bias tried, with its pixels of self-shadowing (acne and curvature) and of peter-panning.
    pub tried: Vec<(Spec, u64, u64)>,
}

impl Outcome {
    /// Sums up an evaluation.
    #[must_use]
    pub fn of(evaluation: &Evaluation<'_>) -> Self {
        let wrong_by_cause = by_cause(&evaluation.ledger);
        let (wrong, cost) = (evaluation.verdict.pixels.wrong, evaluation.cost.clone());
        Self { wrong_by_cause, wrong, cost, ms_ratio: None }
    }

    /// Wrong pixels of one cause.
    #[must_use]
    pub fn of_cause(&self, cause: Cause) -> u64 {
        self.wrong_by_cause.get(&cause).copied().unwrap_or(0)
    }
}

fn by_cause(ledger: &Ledger) -> BTreeMap<Cause, u64> {
    ledger.causes.iter().filter(|(_, share)| share.pixels > 0).map(|(cause, share)| (*cause, share.pixels)).collect()
}

/// Variants of one question's evaluation, each evaluated once however often it is asked for.
#[derive(Debug)]
pub struct Trials<'t> {
    view: &'t View<'t>,
    question: &'t Question<'t>,
    known: Vec<(Spec, Result<Outcome, String>)>,
}

impl<'t> Trials<'t> {
    /// None yet.
    #[must_use]
    pub fn new(view: &'t View<'_>, question: &'t Question<'t>) -> Self {
        Self { view, question, known: Vec::new() }
    }

    /// What a specification comes to, timed in turn with what it is to mend; a failure in words.
    fn outcome(
        &mut self,
        spec: &Spec,
        beside: Option<&dyn Prepared>,
        watch: &dyn Watch,
    ) -> Result<Result<Outcome, String>, Interrupted> {
        if let Some((_, outcome)) = self.known.iter().find(|(known, _)| known == spec) {
            return Ok(outcome.clone());
        }
        let tried = evaluate(self.view, self.question, spec, Effort::CAUSES, watch).and_then(|evaluation| {
            let outcome = Outcome::of(&evaluation);
            let Some(beside) = beside else { return Ok(outcome) };
            let times = time_in_turn(self.view, &[beside, evaluation.prepared.as_ref()], TIMED_ROUNDS, &Quiet(watch))?;
            let ms: Option<Vec<f64>> = times.iter().map(|times| Some(times.gpu_ms?.median)).collect();
            Ok(Outcome { ms_ratio: ms.map(|ms| ms[1] / ms[0]), ..outcome })
        });
        let outcome = match tried {
            Ok(outcome) => Ok(outcome),
            Err(EvaluateError::Interrupted(interrupted)) => return Err(interrupted),
            Err(error) => Err(error.to_string()),
        };
        self.known.push((spec.clone(), outcome.clone()));
        Ok(outcome)
    }
}

/// Diagnoses an evaluation of `spec`: the causes present, the most frequent first.
///
/// # Errors
/// [`Interrupted`] if the user asked to stop; a fix that fails is part of the answer.
pub fn diagnose(
    trials: &mut Trials<'_>,
    spec: &Spec,
    evaluation: &Evaluation<'_>,
    watch: &dyn Watch,
) -> Result<Vec<Diagnosis>, Interrupted> {
    trials.known.push((spec.clone(), Ok(Outcome::of(evaluation))));
    let mut present: Vec<(Cause, u64)> = by_cause(&evaluation.ledger).into_iter().collect();
    present.sort_by_key(|(_, pixels)| std::cmp::Reverse(*pixels));
    let remedies = |cause| spec.technique().remedies(spec, cause).into_iter().take(TRIED_PER_CAUSE);
    watch.start("trying fixes", present.iter().map(|(cause, _)| remedies(*cause).count() as u64).sum());
    let mut diagnoses = Vec::new();
    for (cause, pixels) in present {
        let mut tried = Vec::new();
        for remedy in remedies(cause) {
            let outcome = trials.outcome(&remedy, Some(evaluation.prepared.as_ref()), watch)?;
            tried.push((remedy, outcome));
            watch.advance(1);
        }
        diagnoses.push(Diagnosis {
            cause,
            pixels,
            share: pixels as f64 / evaluation.verdict.pixels.wrong as f64,
            sum: evaluation.ledger.causes.get(&cause).map_or(0.0, |share| share.sum),
            worst: worst_pixels(evaluation, cause),
            trials: tried,
        });
    }
    Ok(diagnoses)
}

fn worst_pixels(evaluation: &Evaluation<'_>, cause: Cause) -> Vec<u32> {
    let of_cause = evaluation.ledger.wrong.iter().filter(|(_, named)| *named == cause);
    let mut pixels: Vec<u32> = of_cause.map(|(pixel, _)| *pixel).collect();
    let error = |pixel: &u32| evaluation.verdict.signed_error[*pixel as usize].map_or(0.0, f64::abs);
    pixels.sort_by(|a, b| error(b).total_cmp(&error(a)).then(a.cmp(b)));
    // Spread over the list: neighbours on one edge tell the same story.
    let step = (pixels.len() / NAMED_PIXELS).max(1);
    pixels.into_iter().step_by(step).take(NAMED_PIXELS).collect()
}

/// Looks for a bias that is free of self-shadowing and of detached contacts: none, the rasteriser's slope with growing
/// factors, those that follow from the receiver's plane, the middle of two surfaces, each in place of whatever bias `spec`
/// has; `None` where the technique knows no bias.
///
/// # Errors
/// [`Interrupted`] if the user asked to stop.
pub fn search_bias(
    trials: &mut Trials<'_>,
    spec: &Spec,
    watch: &dyn Watch,
) -> Result<Option<BiasVerdict>, Interrupted> {
    let candidates: Vec<Spec> = BIASES.into_iter().filter_map(|bias| with_bias(spec, bias).ok()).collect();
    watch.start("searching a bias", candidates.len() as u64);
    let mut verdict = BiasVerdict { free_of_both: None, tried: Vec::new() };
    for candidate in candidates {
        watch.advance(1);
        let Ok(outcome) = trials.outcome(&candidate, None, watch)? else { continue };
        let self_shadow = outcome.of_cause(Cause::Acne) + outcome.of_cause(Cause::Curvature);
        let detached = outcome.of_cause(Cause::PeterPanning);
        if self_shadow == 0 && detached == 0 && verdict.free_of_both.is_none() {
            verdict.free_of_both = Some(candidate.clone());
        }
        verdict.tried.push((candidate, self_shadow, detached));
    }
    Ok((!verdict.tried.is_empty()).then_some(verdict))
}

/// How the parameters begin that add to a bias; by default they add nothing.
const AMOUNTS: &str = "bias_";

/// The specification with a bias and a slope factor in place of all that it says about bias.
fn with_bias(spec: &Spec, (bias, slope): (&str, &str)) -> Result<Spec, SpecError> {
    let amounts = spec.technique().params().iter().filter(|param| param.name.starts_with(AMOUNTS));
    let without = amounts.map(|amount| (amount.name, amount.default.to_string()));
    let changes = without.chain([("bias", bias.to_owned()), ("bias_slope", slope.to_owned())]);
    changes.into_iter().try_fold(spec.clone(), |spec, (key, value)| spec.with(key, &value))
}
