//! One view is one sample of the texel phase. Jitter shifts the light's texel grid by sub-texel steps; the spread over
//! the phases is what a measurement that decides anything reports.

use super::{Effort, EvaluateError, Question, View, evaluate};
use crate::technique::{Spec, SpecError};
use crate::watch::Watch;

/// The phase parameters of techniques with a texel grid.
const PHASES: [&str; 2] = ["phase_u_texels", "phase_v_texels"];
/// Powers of the plastic number's inverse: a two-dimensional low-discrepancy sequence (M. Roberts, "The Unreasonable
/// Effectiveness of Quasirandom Sequences", 2018).
const STEPS: [f64; 2] = [0.754_877_666_246_693, 0.569_840_290_998_053_3];

/// The share of wrong pixels for each of `count` texel phases, the first of them 0, with the specification that repeats
/// it. Empty for a technique without a texel grid and where nothing is asked.
///
/// # Errors
/// Those of [`evaluate`].
pub fn jittered(
    view: &View<'_>,
    question: &Question<'_>,
    spec: &Spec,
    count: u32,
    watch: &dyn Watch,
) -> Result<Vec<(Spec, f64)>, EvaluateError> {
    let has_grid = PHASES.iter().all(|name| spec.technique().params().iter().any(|param| param.name == *name));
    watch.start("shifting the texel grid", count.into());
    let mut phases = Vec::new();
    for index in 0..if has_grid { count } else { 0 } {
        // A phase within [0, 1) of a declared parameter is always legal.
        let Ok(shifted) = phase(spec, index) else { break };
        let evaluation = evaluate(view, question, &shifted, Effort::VERDICT, watch)?;
        phases.extend(evaluation.verdict.error.wrong_fraction.map(|fraction| (shifted, fraction)));
        watch.advance(1);
    }
    Ok(phases)
}

fn phase(spec: &Spec, index: u32) -> Result<Spec, SpecError> {
    let [u, v] = STEPS.map(|step| (step * f64::from(index)).fract());
    spec.with(PHASES[0], &u.to_string())?.with(PHASES[1], &v.to_string())
}
