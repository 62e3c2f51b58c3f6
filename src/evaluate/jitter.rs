//! One view is one sample of the texel phase. Jitter shifts the light frustum by sub-texel steps and reports the spread.

use super::{Effort, EvaluateError, Question, View, evaluate};
use crate::technique::{Spec, SpecError};
use crate::watch::Watch;

/// Share of wrong pixels over several texel phases.
#[derive(Debug, Clone, PartialEq)]
pub struct JitterStats {
    /// The specification of each phase and its share of wrong pixels, in order.
    pub phases: Vec<(Spec, f64)>,
}

impl JitterStats {
    fn fractions(&self) -> impl Iterator<Item = f64> + '_ {
        self.phases.iter().map(|(_, fraction)| *fraction)
    }
    /// Mean share.
    #[must_use]
    pub fn mean(&self) -> f64 {
        self.fractions().sum::<f64>() / self.phases.len() as f64
    }
    /// Smallest share.
    #[must_use]
    pub fn min(&self) -> f64 {
        self.fractions().fold(f64::INFINITY, f64::min)
    }
    /// Largest share.
    #[must_use]
    pub fn max(&self) -> f64 {
        self.fractions().fold(0.0, f64::max)
    }
    /// Standard deviation over the phases.
    #[must_use]
    pub fn standard_deviation(&self) -> f64 {
        let mean = self.mean();
        (self.fractions().map(|fraction| (fraction - mean).powi(2)).sum::<f64>() / self.phases.len() as f64).sqrt()
    }
}

/// The phase parameters of techniques with a texel grid.
const PHASES: [&str; 2] = ["phase_u_texels", "phase_v_texels"];
/// Powers of the plastic number's inverse: a two-dimensional low-discrepancy sequence (M. Roberts, "The Unreasonable
/// Effectiveness of Quasirandom Sequences", 2018).
const STEPS: [f64; 2] = [0.754_877_666_246_693, 0.569_840_290_998_053_3];

/// Evaluates `count` texel phases, the first of them 0; `None` for a technique without a texel grid, for zero phases,
/// and where nothing is asked.
///
/// # Errors
/// Those of [`evaluate`].
pub fn jittered(
    view: &View<'_>,
    question: &Question<'_>,
    spec: &Spec,
    count: u32,
    watch: &dyn Watch,
) -> Result<Option<JitterStats>, EvaluateError> {
    let has_grid = PHASES.iter().all(|name| spec.technique().params().iter().any(|param| param.name == *name));
    let mut phases = Vec::new();
    for index in 0..if has_grid { count } else { 0 } {
        // A phase within (-1, 1) of a declared parameter is always legal.
        let Ok(shifted) = phase(spec, index) else { break };
        let evaluation = evaluate(view, question, &shifted, Effort::VERDICT, watch)?;
        phases.extend(evaluation.verdict.error.wrong_fraction.map(|fraction| (shifted, fraction)));
    }
    Ok((!phases.is_empty()).then_some(JitterStats { phases }))
}

fn phase(spec: &Spec, index: u32) -> Result<Spec, SpecError> {
    let [u, v] = STEPS.map(|step| (step * f64::from(index)).fract());
    spec.with(PHASES[0], &u.to_string())?.with(PHASES[1], &v.to_string())
}
