//! The rows of the page's tables.

use crate::report::details::{self, Detail};
use crate::report::format::{grouped, or_nothing, significant};
use crate::report::model::{Report, Run, Status};
use crate::report::summary::{BUDGET_NOTE, Summary, software_note};
use serde::Serialize;

/// A run in the summary.
#[derive(Debug, Serialize)]
pub(super) struct SummaryRow {
    index: usize,
    scene: String,
    light: String,
    technique: String,
    /// What the row looks like: `over`, `met`, `judged`, `failed` or `unsupported`.
    state: &'static str,
    has_pictures: bool,
    why: Option<String>,
    verdictless: &'static str,
    wrong: String,
    wrong_share: String,
    false_shadow: String,
    false_light: String,
    mean_abs: String,
    edge_p99: String,
    causes: String,
    gpu_ms: String,
    budget: String,
}

/// A judged run in the table of costs.
#[derive(Debug, Serialize)]
pub(super) struct CostRow {
    scene: String,
    light: String,
    technique: String,
    median: String,
    min: String,
    max: String,
    gbuffers: String,
    runs: String,
    passes: String,
    prepare: String,
    vertices: String,
    primitives: String,
    fragments: String,
    texel_reads: String,
    bytes: String,
}

/// What deserves attention first: budgets exceeded, by how many times; then failures, then the share of wrong pixels.
pub(super) fn summary_rows(report: &Report, has_pictures: impl Fn(usize) -> bool) -> Vec<SummaryRow> {
    let mut order: Vec<usize> = (0..report.runs.len()).collect();
    let key = |index: &usize| attention(&report.runs[*index]);
    order.sort_by(|a, b| {
        let ((a_rank, a_size), (b_rank, b_size)) = (key(a), key(b));
        a_rank.cmp(&b_rank).then(b_size.total_cmp(&a_size))
    });
    order.into_iter().map(|index| summary_row(report, index, has_pictures(index))).collect()
}

/// Rank (less comes first) and how bad it is within the rank.
fn attention(run: &Run) -> (u8, f64) {
    let wrong = run.error.and_then(|error| error.wrong_fraction).unwrap_or(0.0);
    match (run.status, run.budget) {
        (Status::Ok, Some(budget)) if !budget.met => {
            let times = |figure: Option<f64>, limit: Option<f64>| figure.zip(limit).map_or(0.0, |(is, may)| is / may);
            let mean = run.error.and_then(|error| error.mean_abs);
            (0, times(Some(wrong), budget.wrong_fraction).max(times(mean, budget.mean_abs)))
        }
        (Status::Failed, _) => (1, 0.0),
        (Status::Ok, _) => (2, wrong),
        (Status::Unsupported, _) => (3, 0.0),
    }
}

fn summary_row(report: &Report, index: usize, has_pictures: bool) -> SummaryRow {
    let run = &report.runs[index];
    let summary = Summary::of(run, &report.adapter);
    SummaryRow {
        index,
        scene: run.scene.clone(),
        light: run.light.clone(),
        technique: run.typed.clone(),
        state: match (run.status, run.budget) {
            (Status::Failed, _) => "failed",
            (Status::Unsupported, _) => "unsupported",
            (Status::Ok, Some(budget)) if budget.met => "met",
            (Status::Ok, Some(_)) => "over",
            (Status::Ok, None) => "judged",
        },
        has_pictures,
        why: run.why.clone(),
        verdictless: Summary::verdictless(run),
        wrong: summary.wrong,
        wrong_share: summary.wrong_share,
        false_shadow: summary.false_shadow,
        false_light: summary.false_light,
        mean_abs: summary.mean_abs,
        edge_p99: summary.edge_p99,
        causes: summary.causes.join(", "),
        gpu_ms: summary.gpu_ms,
        budget: summary.budget,
    }
}

/// The costs of the runs that have any, in the report's order.
pub(super) fn cost_rows(report: &Report) -> Vec<CostRow> {
    let row = |run: &Run| {
        let cost = run.cost.as_ref()?;
        let ms =
            |of: fn(&crate::technique::GpuTime) -> f64| or_nothing(cost.gpu_ms.as_ref().map(|t| significant(of(t))));
        let count = |count: Option<u64>| or_nothing(count.map(grouped));
        let passes = cost.passes.iter().map(|pass| format!("{} {}", pass.name, significant(pass.ms)));
        Some(CostRow {
            scene: run.scene.clone(),
            light: run.light.clone(),
            technique: run.typed.clone(),
            median: ms(|time| time.median),
            min: ms(|time| time.min),
            max: ms(|time| time.max),
            gbuffers: or_nothing(cost.gbuffers().map(significant)),
            runs: or_nothing(cost.gpu_ms.map(|time| time.runs.to_string())),
            passes: passes.collect::<Vec<_>>().join(", "),
            prepare: or_nothing(cost.prepare_ms.map(significant)),
            vertices: count(cost.vertices),
            primitives: count(cost.primitives),
            fragments: count(cost.fragments),
            texel_reads: count(cost.texel_reads),
            bytes: grouped(cost.bytes),
        })
    };
    report.runs.iter().filter_map(row).collect()
}

/// What is known of the runs besides their rows.
pub(super) fn details(report: &Report) -> Vec<String> {
    let lines = |run: &Run| {
        let of = format!("{} / {}: {}", run.scene, run.light, run.typed);
        let line = move |detail: Detail| format!("{of}  {}: {}", detail.label, detail.text);
        details::details(run).into_iter().map(line)
    };
    report.runs.iter().flat_map(lines).collect()
}

/// What the summary's marks mean.
pub(super) fn notes(report: &Report) -> Vec<String> {
    let doubtful = Summary::any_doubtful_budget(report).then(|| BUDGET_NOTE.to_owned());
    software_note(&report.adapter).into_iter().chain(doubtful).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::model::BudgetOutcome;
    use crate::report::model::tests::{full_run, report, verdict_with};

    #[test]
    fn what_exceeds_its_budget_most_comes_first() {
        let mut report = report();
        let with_limit = |limit: f64| {
            let mut run = full_run("other");
            run.budget = Some(BudgetOutcome::of(&verdict_with(3, 4, 1), Some(limit), None));
            run
        };
        report.runs.extend([with_limit(0.1), with_limit(0.9), with_limit(0.0001)]);
        let rows = summary_rows(&report, |index| index == 4);
        let order: Vec<(usize, &str)> = rows.iter().map(|row| (row.index, row.state)).collect();
        assert_eq!(order, [(5, "over"), (0, "over"), (3, "over"), (2, "failed"), (4, "met"), (1, "unsupported")]);
        assert!(rows.iter().all(|row| row.has_pictures == (row.index == 4)));
        assert_eq!(cost_rows(&report).len(), 4);
        assert!(details(&report)[0].starts_with("kitchen / lamp: map:size=512  "));
    }
}
