//! What came of one task of a check: an answer with its verdict and causes, or why there is none.

use super::args::CheckArgs;
use super::report;
use super::tasks::Task;
use crate::evaluate::{Effort, EvaluateError, Evaluation, Flips, Question, View, evaluate, flips, jittered};
use crate::report::model::{self, Jitter, Motion, Run};
use crate::technique::TechniqueError;
use crate::watch::Watch;

/// A task with its outcome.
pub(super) struct Answered<'t, 'v> {
    pub(super) task: &'t Task<'t>,
    pub(super) outcome: Result<Answer<'v>, TaskError>,
}

/// An answer, judged and explained.
pub(super) struct Answer<'v> {
    pub(super) evaluation: Evaluation<'v>,
    /// The share of wrong pixels in each texel phase.
    phases: Vec<f64>,
    moved: Flips,
}

/// Why a task has no answer: not applicable, or failed, in words. Either is a row of the report.
pub(super) enum TaskError {
    Unsupported(String),
    Failed(String),
}

impl<'t, 'v> Answered<'t, 'v> {
    /// Works it out; only an interrupt is an error.
    pub(super) fn new(
        view: &'v View<'_>,
        question: &'v Question<'v>,
        task: &'t Task<'t>,
        args: &CheckArgs,
        watch: &dyn Watch,
    ) -> Result<Self, EvaluateError> {
        let answer = || -> Result<Answer<'v>, EvaluateError> {
            let evaluation = evaluate(view, question, &task.spec, Effort::CAUSES, watch)?;
            let phases = jittered(view, question, &task.spec, args.jitter, watch)?;
            let moved = flips(view, question, &task.spec, args.motion, watch)?;
            Ok(Answer { evaluation, phases: phases.into_iter().map(|(_, wrong)| wrong).collect(), moved })
        };
        let outcome = answer().map_or_else(
            |error| match error {
                error if error.is_interrupt() => Err(error),
                EvaluateError::Technique(TechniqueError::Unsupported(why)) => {
                    Ok(Err(TaskError::Unsupported(why.to_string())))
                }
                error => Ok(Err(TaskError::Failed(error.to_string()))),
            },
            |answer| Ok(Ok(answer)),
        )?;
        Ok(Self { task, outcome })
    }

    pub(super) fn evaluation(&mut self) -> Option<&mut Evaluation<'v>> {
        self.outcome.as_mut().ok().map(|answer| &mut answer.evaluation)
    }

    /// Memory of an answer, about: what it has on the GPU, and the mask and errors of every pixel.
    pub(super) fn bytes(&self) -> usize {
        const BYTES_PER_PIXEL: usize = 64;
        self.outcome.as_ref().map_or(0, |Answer { evaluation, .. }| {
            evaluation.cost.bytes as usize + BYTES_PER_PIXEL * evaluation.mask.pixels.len()
        })
    }

    /// Its row of the report.
    pub(super) fn run(&self, asked: model::Question, question: &Question<'_>) -> Run {
        let Answer { evaluation, phases, moved } = match &self.outcome {
            Ok(answer) => answer,
            Err(TaskError::Unsupported(why)) => return Run::unsupported(asked, why.clone()),
            Err(TaskError::Failed(why)) => return Run::failed(asked, why.clone()),
        };
        let mut run = Run::judged(asked, &evaluation.verdict).explained_by(&evaluation.ledger);
        run.cost = Some(evaluation.cost.clone());
        run.truth = Some(report::truth_source(question));
        run.jitter = Jitter::of(phases);
        run.motion = Motion::of(moved);
        run.seams = evaluation.seams(run.wrong_above);
        run.bias = Some(evaluation.prepared.bias()).filter(|views| !views.is_empty());
        run.budget = self.task.limits.outcome(&evaluation.verdict, run.jitter);
        run
    }
}
