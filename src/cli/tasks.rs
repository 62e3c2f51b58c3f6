//! What `gnomon check` has to run for a scene: the techniques typed, or those of the scene's budgets, or a default set,
//! each for every light it concerns, with the limits that bind it.

use super::args::CheckArgs;
use super::context::lights;
use crate::report::model::{BudgetOutcome, Jitter};
use crate::scene::{Budget, Light, Scene};
use crate::technique::map::{Settings, projection};
use crate::technique::{Spec, Unsupported};
use crate::verdict::Verdict;
use anyhow::Context;
use std::path::Path;

/// What is checked when neither the command line nor the scene says: the default map, a finer, filtered one (both as a
/// cube where receivers lie all around the light), and stencil volumes.
const DEFAULT_SPECS: [&str; 3] = ["map", "map:size=2048,filter=pcf-box3", "volume"];

/// One technique to run for one light, and the limits on it.
#[derive(Debug)]
pub(super) struct Task<'s> {
    pub(super) light: &'s Light,
    pub(super) spec: Spec,
    pub(super) limits: Limits,
}

/// Limits on a run's error; `None` does not bind.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Limits {
    wrong_fraction: Option<f64>,
    mean_abs: Option<f64>,
}

/// The tasks of the scene at `path`, light by light. `typed` are the techniques of the command line.
pub(super) fn tasks<'s>(
    path: &Path,
    scene: &'s Scene,
    typed: &[Spec],
    args: &CheckArgs,
) -> anyhow::Result<Vec<Task<'s>>> {
    let budgets = budgets(path, scene)?;
    let defaults = DEFAULT_SPECS.iter().map(|typed| Spec::parse(typed)).collect::<Result<Vec<_>, _>>()?;
    let mut tasks = Vec::new();
    for light in lights(scene, args.light.as_deref())? {
        let binding: Vec<_> = budgets.iter().filter(|(_, budget)| binds(budget, light)).collect();
        let specs = match (typed, binding.as_slice()) {
            ([], []) => defaults.iter().map(|spec| all_around(spec, scene, light)).collect::<Result<_, _>>()?,
            ([], binding) => distinct(binding.iter().map(|(spec, _)| spec)),
            (typed, _) => typed.to_vec(),
        };
        tasks.extend(specs.into_iter().map(|spec| {
            let own = binding.iter().filter(|(budgeted, _)| *budgeted == spec).map(|(_, budget)| *budget);
            Task { light, limits: Limits::tightest(own), spec }
        }));
    }
    Ok(tasks)
}

/// The default map as a cube, where the receivers lie so far around the light that one frustum cannot hold them.
fn all_around(spec: &Spec, scene: &Scene, light: &Light) -> anyhow::Result<Spec> {
    if spec.technique().id() != "map" {
        return Ok(spec.clone());
    }
    let settings = Settings::of(spec);
    match projection::by_name("single").supports(scene, light, &settings) {
        Err(Unsupported::FieldOfView { .. }) => Ok(spec.with("projection", "cube")?),
        _ => Ok(spec.clone()),
    }
}

fn budgets<'s>(path: &Path, scene: &'s Scene) -> anyhow::Result<Vec<(Spec, &'s Budget)>> {
    let file = if path.is_dir() { path.join("scene.toml") } else { path.to_owned() };
    let parsed = scene.budgets.iter().map(|budget| {
        let spec = Spec::parse(&budget.technique)
            .with_context(|| format!("{}: [[budget]] technique = {:?}", file.display(), budget.technique))?;
        Ok((spec, budget))
    });
    parsed.collect()
}

fn binds(budget: &Budget, light: &Light) -> bool {
    budget.light.as_ref().is_none_or(|name| *name == light.name)
}

/// Two budgets on one technique are one run.
fn distinct<'a>(specs: impl Iterator<Item = &'a Spec>) -> Vec<Spec> {
    let mut distinct: Vec<Spec> = Vec::new();
    for spec in specs {
        if !distinct.contains(spec) {
            distinct.push(spec.clone());
        }
    }
    distinct
}

impl Limits {
    /// All budgets at once.
    fn tightest<'a>(budgets: impl Iterator<Item = &'a Budget>) -> Self {
        let lesser = |a: Option<f64>, b: Option<f64>| [a, b].into_iter().flatten().reduce(f64::min);
        budgets.fold(Self::default(), |limits, budget| Self {
            wrong_fraction: lesser(limits.wrong_fraction, budget.wrong_fraction),
            mean_abs: lesser(limits.mean_abs, budget.mean_abs),
        })
    }

    /// Whether a verdict keeps to them; `None` without a limit. With jitter, the share of wrong pixels is the mean over
    /// the phases.
    pub(super) fn outcome(self, verdict: &Verdict, jitter: Option<Jitter>) -> Option<BudgetOutcome> {
        if self == Self::default() {
            return None;
        }
        let mut judged = verdict.clone();
        if let (Some(jitter), Some(own)) = (jitter, verdict.error.wrong_fraction) {
            let mean = jitter.wrong_fraction.mean;
            judged.error.wrong_fraction = Some(mean);
            judged.worst_case.wrong_fraction = verdict.worst_case.wrong_fraction.map(|worst| worst + mean - own);
        }
        Some(BudgetOutcome::of(&judged, self.wrong_fraction, self.mean_abs))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::model::tests::verdict_with;

    fn budget(wrong_fraction: Option<f64>, mean_abs: Option<f64>) -> Budget {
        Budget { technique: "map".to_owned(), light: None, wrong_fraction, mean_abs }
    }

    #[test]
    fn every_budget_on_a_technique_binds() {
        let budgets = [budget(Some(0.5), None), budget(Some(0.25), None), budget(None, Some(0.1))];
        let limits = Limits::tightest(budgets.iter());
        assert_eq!(limits, Limits { wrong_fraction: Some(0.25), mean_abs: Some(0.1) });
        assert_eq!(Limits::tightest([].iter()), Limits::default());
    }

    #[test]
    fn jitter_moves_the_verdict_to_its_mean_and_the_worst_case_along() {
        // 1 of 8 decided pixels is wrong, 2 more are undecided: 0.125, at worst 0.3.
        let verdict = verdict_with(1, 7, 2);
        let met = |limit, jitter| {
            let limits = Limits { wrong_fraction: Some(limit), mean_abs: None };
            let outcome = limits.outcome(&verdict, jitter).unwrap();
            (outcome.met, outcome.met_worst_case)
        };
        assert_eq!(met(0.31, None), (true, true));
        assert_eq!(met(0.31, Jitter::of(&[0.2, 0.3])), (true, false));
        assert_eq!(met(0.2, Jitter::of(&[0.2, 0.3])), (false, false));
        assert_eq!(Limits::default().outcome(&verdict, None), None);
    }
}
