//! What changed between two reports: wrong pixels by cause, counted work, GPU time; and which changes are regressions.
//!
//! Runs are matched by scene, light, technique (every parameter) and picture size. Milliseconds only decide where somebody
//! sets a limit for them, and never on a software adapter; counted work does not depend on the machine and always does.

use super::format::{grouped, percent, printable, significant};
use super::model::{Report, Run, Status};
use crate::cause::Cause;
use std::collections::BTreeMap;

/// What is still tolerated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerance {
    /// Largest growth of the share of wrong pixels among the asked, 0..=1.
    pub wrong_fraction: f64,
    /// Largest ratio of each figure of counted work, after / before.
    pub work_ratio: f64,
    /// Largest ratio of median GPU milliseconds; `None` does not bind.
    pub ms_ratio: Option<f64>,
}

/// One run in both reports, or in one of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Change {
    /// Scene, light, technique as typed, width and height.
    pub run: String,
    /// Share of wrong pixels before and after; `None` without a verdict.
    pub wrong: [Option<f64>; 2],
    /// Wrong pixels before and after.
    pub wrong_px: [Option<u64>; 2],
    /// Growth in wrong pixels per cause, only where there is any.
    pub causes: BTreeMap<Cause, i64>,
    /// Growth of each figure of cost, after / before, where both are known.
    pub cost: Vec<(&'static str, f64)>,
    /// What makes it a regression; empty for none.
    pub regressions: Vec<String>,
}

impl Change {
    /// Whether anything but times changed.
    #[must_use]
    pub fn is_change(&self) -> bool {
        let work = self.cost.iter().filter(|(name, _)| *name != MS);
        !self.regressions.is_empty()
            || self.wrong_px[0] != self.wrong_px[1]
            || !self.causes.is_empty()
            || work.clone().any(|(_, ratio)| (ratio - 1.0).abs() > 0.0)
    }
}

/// The name of GPU time among the costs.
const MS: &str = "GPU ms";

/// Everything in either report, in the order of the second and then of what is only in the first.
#[must_use]
pub fn compare(before: &Report, after: &Report, tolerance: &Tolerance) -> Vec<Change> {
    let same_adapter = before.adapter == after.adapter && !after.adapter.software;
    let old = |run: &Run| before.runs.iter().find(|old| identity(old) == identity(run));
    let new = |run: &Run| after.runs.iter().any(|new| identity(new) == identity(run));
    let changed = after.runs.iter().map(|run| change(old(run), run, tolerance, same_adapter));
    let gone = before.runs.iter().filter(|run| !new(run)).map(vanished);
    changed.chain(gone).collect()
}

fn identity(run: &Run) -> (&str, &str, &str, [u32; 2]) {
    (&run.scene, &run.light, &run.technique, run.image)
}

fn label(run: &Run) -> String {
    format!("{} / {}  {}  {}x{}", run.scene, run.light, run.typed, run.image[0], run.image[1])
}

fn change(before: Option<&Run>, after: &Run, tolerance: &Tolerance, same_adapter: bool) -> Change {
    let share = |run: &Run| run.error.and_then(|error| error.wrong_fraction);
    let pixels = |run: &Run| run.pixels.map(|pixels| pixels.wrong);
    let mut change = Change {
        run: label(after),
        wrong: [before.and_then(share), share(after)],
        wrong_px: [before.and_then(pixels), pixels(after)],
        causes: before.map_or_else(BTreeMap::new, |before| grown_causes(before, after)),
        cost: before.map_or_else(Vec::new, |before| cost_ratios(before, after, same_adapter)),
        regressions: Vec::new(),
    };
    let Some(before) = before else { return change };
    if before.status == Status::Ok && after.status != Status::Ok {
        change.regressions.push(format!("no longer answers: {}", after.why.as_deref().unwrap_or("")));
    }
    if let [Some(was), Some(is)] = change.wrong
        && is - was > tolerance.wrong_fraction
    {
        change.regressions.push(format!("{} more of the asked pixels are wrong", percent(is - was)));
    }
    for (name, ratio) in &change.cost {
        let limit = if *name == MS { tolerance.ms_ratio } else { Some(tolerance.work_ratio) };
        if limit.is_some_and(|limit| *ratio > limit) {
            change.regressions.push(format!("{name} × {}", significant(*ratio)));
        }
    }
    change
}

fn vanished(run: &Run) -> Change {
    Change {
        run: label(run),
        wrong: [run.error.and_then(|error| error.wrong_fraction), None],
        wrong_px: [run.pixels.map(|pixels| pixels.wrong), None],
        causes: BTreeMap::new(),
        cost: Vec::new(),
        regressions: vec!["is missing".to_owned()],
    }
}

fn grown_causes(before: &Run, after: &Run) -> BTreeMap<Cause, i64> {
    let pixels = |run: &Run, cause: &Cause| {
        run.causes.as_ref().and_then(|causes| causes.get(cause)).map_or(0, |entry| entry.pixels as i64)
    };
    let growth = Cause::ALL.into_iter().map(|cause| (cause, pixels(after, &cause) - pixels(before, &cause)));
    growth.filter(|(_, growth)| *growth != 0).collect()
}

fn cost_ratios(before: &Run, after: &Run, same_adapter: bool) -> Vec<(&'static str, f64)> {
    let (Some(before), Some(after)) = (&before.cost, &after.cost) else { return Vec::new() };
    // Whatever slowed one of the two reports down slowed its G-buffers down, too.
    let ms = |cost: &crate::technique::Cost| cost.gbuffers().filter(|_| same_adapter);
    let figures = [
        ("vertices", before.vertices.map(|n| n as f64), after.vertices.map(|n| n as f64)),
        ("primitives", before.primitives.map(|n| n as f64), after.primitives.map(|n| n as f64)),
        ("fragments", before.fragments.map(|n| n as f64), after.fragments.map(|n| n as f64)),
        ("texel reads", before.texel_reads.map(|n| n as f64), after.texel_reads.map(|n| n as f64)),
        ("bytes", Some(before.bytes as f64), Some(after.bytes as f64)),
        (MS, ms(before), ms(after)),
    ];
    figures.into_iter().filter_map(|(name, was, is)| Some((name, ratio(was?, is?)))).collect()
}

fn ratio(was: f64, is: f64) -> f64 {
    if was == is { 1.0 } else { is / was }
}

/// The changes as text, regressions first; nothing but times having changed is one line.
#[must_use]
pub fn changes_as_text(changes: &[Change]) -> String {
    let mut shown: Vec<&Change> = changes.iter().filter(|change| change.is_change()).collect();
    shown.sort_by_key(|change| change.regressions.is_empty());
    let same = changes.len() - shown.len();
    let lines = shown.into_iter().flat_map(lines).chain([format!("{} runs, {same} of them unchanged", changes.len())]);
    lines.collect::<Vec<_>>().join("\n")
}

fn lines(change: &Change) -> Vec<String> {
    let known = |figure: Option<String>| figure.unwrap_or_else(|| "no verdict".to_owned());
    let wrong = |i: usize| {
        known(change.wrong_px[i].zip(change.wrong[i]).map(|(n, share)| format!("{} ({})", grouped(n), percent(share))))
    };
    let mark = if change.regressions.is_empty() { "changed   " } else { "REGRESSION" };
    let mut lines =
        vec![format!("{mark} {}", printable(&change.run)), format!("    wrong px {} → {}", wrong(0), wrong(1))];
    let causes: Vec<String> =
        change.causes.iter().map(|(cause, growth)| format!("{} {growth:+}", cause.name())).collect();
    if !causes.is_empty() {
        lines.push(format!("    by cause {}", causes.join(", ")));
    }
    let cost = change.cost.iter().filter(|(_, ratio)| (ratio - 1.0).abs() > 0.0);
    let cost: Vec<String> = cost.map(|(name, ratio)| format!("{name} × {}", significant(*ratio))).collect();
    if !cost.is_empty() {
        lines.push(format!("    cost {}", cost.join(", ")));
    }
    lines.extend(change.regressions.iter().map(|why| format!("    ✗ {}", printable(why))));
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::model::tests::report;

    const STRICT: Tolerance = Tolerance { wrong_fraction: 0.0, work_ratio: 1.0, ms_ratio: None };

    fn regressions(after: &Report, tolerance: &Tolerance) -> Vec<String> {
        compare(&report(), after, tolerance).into_iter().flat_map(|change| change.regressions).collect()
    }

    #[test]
    fn a_report_has_not_changed_against_itself() {
        let changes = compare(&report(), &report(), &STRICT);
        assert_eq!(changes.len(), 3);
        assert!(changes.iter().all(|change| !change.is_change()));
        assert_eq!(changes_as_text(&changes), "3 runs, 3 of them unchanged");
    }

    #[test]
    fn more_wrong_pixels_are_a_regression_beyond_the_tolerance() {
        let mut worse = report();
        let run = &mut worse.runs[0];
        let share = run.error.and_then(|error| error.wrong_fraction).unwrap();
        run.error.as_mut().unwrap().wrong_fraction = Some(share + 0.125);
        run.causes.as_mut().unwrap().get_mut(&Cause::Acne).unwrap().pixels += 7;
        assert_eq!(regressions(&worse, &STRICT), ["12.5 % more of the asked pixels are wrong"]);
        assert_eq!(regressions(&worse, &Tolerance { wrong_fraction: 0.2, ..STRICT }), [""; 0]);
        let changes = compare(&report(), &worse, &STRICT);
        assert_eq!(changes[0].causes, BTreeMap::from([(Cause::Acne, 7)]));
        assert!(changes_as_text(&changes).contains("by cause acne +7"));
        // The other way round it is an improvement.
        assert!(compare(&worse, &report(), &STRICT).iter().all(|change| change.regressions.is_empty()));
    }

    #[test]
    fn more_work_is_a_regression_and_more_milliseconds_only_where_they_mean_something() {
        let mut dearer = report();
        let cost = dearer.runs[0].cost.as_mut().unwrap();
        cost.fragments = cost.fragments.map(|n| 2 * n);
        cost.gpu_ms.as_mut().unwrap().median *= 10.0;
        assert_eq!(regressions(&dearer, &STRICT), ["fragments × 2"]);
        let bound = Tolerance { ms_ratio: Some(2.0), work_ratio: 3.0, ..STRICT };
        assert_eq!(regressions(&dearer, &bound), [""; 0], "a software adapter");
        let (mut before, mut after) = (report(), dearer);
        before.adapter.software = false;
        after.adapter.software = false;
        assert_eq!(compare(&before, &after, &bound)[0].regressions, ["GPU ms × 10"]);
    }

    #[test]
    fn what_failed_or_is_gone_is_a_regression_and_what_is_new_is_none() {
        let mut less = report();
        let gone = less.runs.remove(1);
        less.runs[0].status = Status::Failed;
        let found = regressions(&less, &STRICT);
        assert_eq!(found, ["no longer answers: ", "is missing"]);
        assert!(
            compare(&less, &report(), &STRICT)
                .iter()
                .any(|change| change.run == label(&gone) && change.regressions.is_empty())
        );
    }
}
