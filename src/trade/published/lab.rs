//! Where experiments are measured: several techniques on one light, judged, and timed in turn.

use crate::cause::Cause;
use crate::evaluate::{Effort, EvaluateError, Evaluation, Outcome, View, evaluate, time_in_turn};
use crate::gpu::{Gpu, GpuError};
use crate::scene::Scene;
use crate::technique::{Prepared, Spec, SpecError, TechniqueError};
use crate::watch::{Interrupted, Watch};

/// Rounds in which the techniques of one comparison are timed, in turn.
const ROUNDS: u32 = 5;

/// The device, and who watches.
pub struct Lab<'l> {
    gpu: &'l Gpu,
    watch: &'l dyn Watch,
}

/// What a technique showed.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Sample {
    /// GPU milliseconds, median; `None` without timestamps.
    pub(super) ms: Option<f64>,
    /// Counted work; `None` without pipeline statistics.
    pub(super) work: Option<f64>,
    /// Share of wrong pixels.
    pub(super) wrong: f64,
    /// Mean absolute error.
    pub(super) mean_abs: f64,
    /// The cause of most wrong pixels.
    pub(super) main_cause: Option<Cause>,
}

/// Why an experiment has no result.
#[derive(Debug, thiserror::Error)]
pub enum LabError {
    /// A specification of ours is not legal: a bug.
    #[error(transparent)]
    Spec(#[from] SpecError),
    /// A technique failed.
    #[error(transparent)]
    Evaluate(#[from] EvaluateError),
    /// The device failed.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// The user asked to stop.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
    /// A scene without light.
    #[error("scene '{0}' has no light")]
    Dark(String),
}

impl<'l> Lab<'l> {
    /// On this device.
    #[must_use]
    pub fn new(gpu: &'l Gpu, watch: &'l dyn Watch) -> Self {
        Self { gpu, watch }
    }

    /// Whether times stand for no real machine.
    #[must_use]
    pub fn is_software(&self) -> bool {
        self.gpu.adapter().is_software
    }

    /// Measures techniques on a scene's first light, timing them in turn; `Err` in a place for one that does not apply, in
    /// words.
    pub(super) fn measure(&self, scene: &Scene, typed: &[String]) -> Result<Vec<Result<Sample, String>>, LabError> {
        let light = scene.lights.first().ok_or_else(|| LabError::Dark(scene.name.clone()))?;
        let view = View::new(self.gpu, scene)?;
        let question = view.ask(light, self.watch)?;
        let mut evaluations: Vec<Result<Evaluation<'_>, String>> = Vec::new();
        for typed in typed {
            let spec = Spec::parse(typed)?;
            evaluations.push(match evaluate(&view, &question, &spec, Effort::CAUSES, self.watch) {
                Ok(evaluation) => Ok(evaluation),
                Err(EvaluateError::Technique(TechniqueError::Unsupported(why))) => Err(why.to_string()),
                Err(error) => return Err(error.into()),
            });
        }
        let prepared: Vec<&dyn Prepared> = evaluations.iter().flatten().map(|e| e.prepared.as_ref()).collect();
        let mut times = time_in_turn(&view, &prepared, ROUNDS, self.watch)?.into_iter();
        let mut sample = |evaluation: &Evaluation<'_>| {
            let causes = Outcome::of(evaluation).wrong_by_cause;
            Sample {
                ms: times.next().and_then(|times| Some(times.gpu_ms?.median)),
                work: evaluation.cost.work().map(|work| work as f64),
                wrong: evaluation.verdict.error.wrong_fraction.unwrap_or(0.0),
                mean_abs: evaluation.verdict.error.mean_abs.unwrap_or(0.0),
                main_cause: causes.into_iter().max_by_key(|(_, pixels)| *pixels).map(|(cause, _)| cause),
            }
        };
        Ok(evaluations.iter().map(|evaluation| evaluation.as_ref().map(&mut sample).map_err(String::clone)).collect())
    }

    /// The same where every technique applies.
    pub(super) fn samples(&self, scene: &Scene, typed: &[String]) -> Result<Vec<Sample>, LabError> {
        let samples: Result<Vec<Sample>, String> = self.measure(scene, typed)?.into_iter().collect();
        samples.map_err(|why| {
            LabError::Evaluate(TechniqueError::from(crate::technique::Unsupported::Degenerate { why }).into())
        })
    }

    /// What ranks here: time on a real adapter, counted work on a software one.
    pub(super) fn cost(&self, sample: &Sample) -> f64 {
        let figures = if self.is_software() { [sample.work, sample.ms] } else { [sample.ms, sample.work] };
        figures.into_iter().flatten().next().unwrap_or(f64::NAN)
    }
}

impl Sample {
    /// How wrong, in words.
    pub(super) fn error(&self) -> String {
        let cause = self.main_cause.map_or_else(String::new, |cause| format!(", mostly {}", cause.name()));
        format!("{:.4} % wrong, mean |e| {:.5}{cause}", 100.0 * self.wrong, self.mean_abs)
    }

    /// Its cost as multiples of another's: work, then time.
    pub(super) fn over(&self, base: &Self) -> String {
        let ratio = |own: Option<f64>, base: Option<f64>| own.zip(base).map(|(own, base)| super::times(own / base));
        let work = ratio(self.work, base.work).map(|ratio| format!("work × {ratio}"));
        let ms = ratio(self.ms, base.ms).map(|ratio| format!("ms × {ratio}"));
        [work, ms].into_iter().flatten().collect::<Vec<_>>().join(", ")
    }
}
