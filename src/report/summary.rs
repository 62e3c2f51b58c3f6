//! The figures of a run that tables show, spelled for people.

use super::format::{NOTHING, grouped, or_nothing, percent, significant};
use super::model::{Adapter, BudgetOutcome, Report, Run, Status};
use crate::cause::Cause;

/// Beside times that were measured on a software adapter.
pub(super) const SOFTWARE_MARK: &str = "*";

/// What the mark of a doubtful budget means.
pub(super) const BUDGET_NOTE: &str = "? only if enough of the undecided pixels are right";

/// How many causes a summary names.
const MAIN_CAUSES: usize = 2;

/// One run in words.
#[derive(Debug)]
pub(super) struct Summary {
    pub(super) wrong: String,
    pub(super) wrong_share: String,
    pub(super) false_shadow: String,
    pub(super) false_light: String,
    pub(super) mean_abs: String,
    pub(super) edge_p99: String,
    /// The main causes with their shares of the wrong pixels, largest first.
    pub(super) causes: Vec<String>,
    pub(super) gpu_ms: String,
    pub(super) budget: String,
}

impl Summary {
    pub(super) fn of(run: &Run, adapter: &Adapter) -> Self {
        let mark = if adapter.software { SOFTWARE_MARK } else { "" };
        let gpu_ms = run.cost.as_ref().and_then(|cost| cost.gpu_ms);
        Self {
            wrong: or_nothing(run.pixels.map(|pixels| grouped(pixels.wrong))),
            wrong_share: or_nothing(run.error.and_then(|error| error.wrong_fraction).map(percent)),
            false_shadow: or_nothing(run.pixels.map(|pixels| grouped(pixels.false_shadow))),
            false_light: or_nothing(run.pixels.map(|pixels| grouped(pixels.false_light))),
            mean_abs: or_nothing(run.error.and_then(|error| error.mean_abs).map(significant)),
            edge_p99: or_nothing(run.error.and_then(|error| error.edge_distance_px).map(|d| significant(d.p99))),
            causes: main_causes(run),
            gpu_ms: or_nothing(gpu_ms.map(|time| format!("{}{mark}", significant(time.median)))),
            budget: if run.is_unchecked() { UNCHECKED } else { run.budget.map_or(NOTHING, budget) }.to_owned(),
        }
    }

    /// What to call a run without a verdict.
    pub(super) fn verdictless(run: &Run) -> &'static str {
        if run.status == Status::Failed { "failed" } else { "not applicable" }
    }

    /// Whether some budget's mark needs [`BUDGET_NOTE`].
    pub(super) fn any_doubtful_budget(report: &Report) -> bool {
        report.runs.iter().filter_map(|run| run.budget).any(|budget| budget.met && !budget.met_worst_case)
    }
}

/// What the mark of a software adapter's times means; `None` for a real adapter.
pub(super) fn software_note(adapter: &Adapter) -> Option<String> {
    let name = super::format::printable(&adapter.name);
    adapter.software.then(|| {
        format!("{SOFTWARE_MARK} on {name}, a software adapter: not representative, compare the counted work instead")
    })
}

/// What a budget is where no pixel was asked.
const UNCHECKED: &str = "unchecked";

fn budget(budget: BudgetOutcome) -> &'static str {
    match (budget.met, budget.met_worst_case) {
        (true, true) => "met",
        (true, false) => "met?",
        (false, _) => "EXCEEDED",
    }
}

fn main_causes(run: &Run) -> Vec<String> {
    let (Some(causes), Some(pixels)) = (&run.causes, run.pixels) else { return Vec::new() };
    let mut shares: Vec<(Cause, u64)> = causes.iter().map(|(&cause, entry)| (cause, entry.pixels)).collect();
    shares.retain(|&(_, pixels)| pixels > 0);
    shares.sort_by_key(|&(_, pixels)| std::cmp::Reverse(pixels));
    let named = shares.iter().take(MAIN_CAUSES);
    named.map(|(cause, of)| format!("{} {:.0} %", cause.name(), 100.0 * *of as f64 / pixels.wrong as f64)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::model::CauseEntry;
    use crate::report::model::tests::{full_run, report};

    #[test]
    fn a_run_is_summed_up_by_its_two_largest_causes() {
        let mut run = full_run("kitchen");
        let third = CauseEntry { pixels: 0, sum: 0.5 };
        run.causes.as_mut().unwrap().insert(Cause::Precision, third);
        let summary = Summary::of(&run, &report().adapter);
        assert_eq!(summary.causes, ["acne 67 %", "edge-aliasing 33 %"]);
        assert_eq!((summary.gpu_ms.as_str(), summary.budget.as_str()), ("1.25*", "EXCEEDED"));
    }

    #[test]
    fn a_budget_without_an_asked_pixel_is_unchecked() {
        let mut run = full_run("kitchen");
        run.pixels.as_mut().unwrap().asked = 0;
        assert_eq!(Summary::of(&run, &Adapter::default()).budget, "unchecked");
        run.budget = None;
        assert_eq!(Summary::of(&run, &Adapter::default()).budget, NOTHING);
    }

    #[test]
    fn a_real_adapter_has_no_mark_and_a_doubtful_budget_has_one() {
        let mut run = full_run("kitchen");
        run.budget = run.budget.map(|budget| BudgetOutcome { met: true, ..budget });
        let summary = Summary::of(&run, &Adapter::default());
        assert_eq!((summary.gpu_ms.as_str(), summary.budget.as_str()), ("1.25", "met?"));
        let mut report = report();
        assert!(!Summary::any_doubtful_budget(&report));
        report.runs.push(run);
        assert!(Summary::any_doubtful_budget(&report));
    }
}
