//! One run of a report: a technique's answer for one light of one scene, or why there is none.

use super::figures::{BudgetOutcome, CauseEntry, Jitter, Motion, TruthSource};
use crate::cause::Cause;
use crate::technique::{Cost, EffectiveBias};
use crate::verdict::{ErrorStats, Ledger, PixelCounts, Seams, Verdict};
use glam::UVec2;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// What was asked in a run, known before anything is rendered.
#[derive(Debug, Clone, PartialEq)]
pub struct Question {
    /// The scene's folder name.
    pub scene: String,
    /// The light's name.
    pub light: String,
    /// The technique as somebody typed it.
    pub typed: String,
    /// Its canonical spelling, every parameter spelled out.
    pub technique: String,
    /// The exact command line that repeats this run.
    pub command: String,
    /// Width and height in pixels.
    pub image: UVec2,
    /// The |technique − truth| above which a pixel is wrong.
    pub wrong_above: f64,
}

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Status {
    /// It was judged.
    Ok,
    /// The technique does not apply to this scene, light or adapter.
    Unsupported,
    /// It should have worked.
    Failed,
}

/// One scene, light and technique.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// The scene's folder name.
    pub scene: String,
    /// The light's name.
    pub light: String,
    /// The technique as somebody typed it.
    pub typed: String,
    /// Its canonical spelling, every parameter spelled out.
    pub technique: String,
    /// The exact command line that repeats this run.
    pub command: String,
    /// How it ended.
    pub status: Status,
    /// Why there is no verdict.
    pub why: Option<String>,
    /// Width and height in pixels.
    pub image: [u32; 2],
    /// The |technique − truth| above which a pixel is wrong.
    pub wrong_above: f64,
    /// How many pixels of which kind.
    pub pixels: Option<PixelCounts>,
    /// How large the errors are.
    pub error: Option<ErrorStats>,
    /// What each cause is answerable for; the sums add up to `error.signed` × `pixels.asked`.
    pub causes: Option<BTreeMap<Cause, CauseEntry>>,
    /// What the technique cost.
    pub cost: Option<Cost>,
    /// Where the truth came from.
    pub truth: Option<TruthSource>,
    /// The budget and whether it was met; null without one.
    pub budget: Option<BudgetOutcome>,
    /// The spread over sub-texel shifts of the map; null for one that was not jittered.
    pub jitter: Option<Jitter>,
    /// What flips from frame to frame as camera and light move; null for a run that did not move.
    pub motion: Option<Motion>,
    /// The errors by view and by distance to the seam; null for techniques with fewer than two views of the light.
    pub seams: Option<Seams>,
    /// How far comparisons were really moved, view by view; null for a technique that compares no depths.
    pub bias: Option<Vec<EffectiveBias>>,
}

impl Run {
    /// A run with a verdict. Causes, cost, truth, budget, jitter, motion, seams and bias are null until somebody sets them.
    #[must_use]
    pub fn judged(question: Question, verdict: &Verdict) -> Self {
        Self {
            pixels: Some(verdict.pixels),
            error: Some(verdict.error),
            ..Self::without_figures(question, Status::Ok, None)
        }
    }

    /// Whether it has a budget that nothing was held against: no pixel was asked.
    #[must_use]
    pub fn is_unchecked(&self) -> bool {
        self.budget.is_some() && self.pixels.is_some_and(|pixels| pixels.asked == 0)
    }

    /// A run that does not apply, and why.
    #[must_use]
    pub fn unsupported(question: Question, why: String) -> Self {
        Self::without_figures(question, Status::Unsupported, Some(why))
    }

    /// A run that went wrong, and how.
    #[must_use]
    pub fn failed(question: Question, why: String) -> Self {
        Self::without_figures(question, Status::Failed, Some(why))
    }

    /// The same run with the causes of its errors.
    #[must_use]
    pub fn explained_by(mut self, ledger: &Ledger) -> Self {
        let entry = |(&cause, share): (&Cause, _)| (cause, CauseEntry::from(share));
        self.causes = Some(ledger.causes.iter().map(entry).collect());
        self
    }

    fn without_figures(question: Question, status: Status, why: Option<String>) -> Self {
        Self {
            scene: question.scene,
            light: question.light,
            typed: question.typed,
            technique: question.technique,
            command: question.command,
            status,
            why,
            image: question.image.to_array(),
            wrong_above: question.wrong_above,
            pixels: None,
            error: None,
            causes: None,
            cost: None,
            truth: None,
            budget: None,
            jitter: None,
            motion: None,
            seams: None,
            bias: None,
        }
    }
}
