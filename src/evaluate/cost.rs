//! Running a technique and measuring what it cost: warm-up first, then the median of the timed runs.

use super::EvaluateError;
use crate::gpu::{PassRecord, WorkCounts};
use crate::mask::Mask;
use crate::technique::{Cost, GpuTime, PassTime, Prepared};
use crate::watch::{Interrupted, Watch};

/// A run's answer and cost.
pub(super) struct Measured {
    pub(super) mask: Mask,
    pub(super) cost: Cost,
}

/// Runs once, and with `timed_runs` > 0 that often again, timing those.
pub(super) fn measure(prepared: &dyn Prepared, timed_runs: u32, watch: &dyn Watch) -> Result<Measured, EvaluateError> {
    let mut answer = prepared.run()?;
    let mut timed: Vec<Vec<PassRecord>> = Vec::new();
    for _ in 0..timed_runs {
        if watch.interrupted() {
            return Err(Interrupted.into());
        }
        answer = prepared.run()?;
        timed.push(answer.passes.clone());
    }
    let cost = cost(&answer.passes, &timed, prepared.bytes());
    Ok(Measured { mask: answer.mask, cost })
}

fn cost(counted: &[PassRecord], timed: &[Vec<PassRecord>], bytes: u64) -> Cost {
    let work: Option<Vec<WorkCounts>> = counted.iter().map(|pass| pass.work).collect();
    let total = |of: fn(&WorkCounts) -> u64| work.as_ref().map(|counts| counts.iter().map(of).sum());
    let totals: Option<Vec<f64>> =
        timed.iter().map(|passes| passes.iter().map(|pass| pass.ms).sum::<Option<f64>>()).collect();
    Cost {
        gpu_ms: totals.filter(|totals| !totals.is_empty()).map(|totals| GpuTime {
            median: median(totals.clone()),
            min: totals.iter().copied().fold(f64::INFINITY, f64::min),
            max: totals.iter().copied().fold(0.0, f64::max),
            runs: totals.len() as u32,
        }),
        passes: (0..counted.len())
            .filter_map(|index| {
                let ms: Vec<f64> = timed.iter().filter_map(|passes| passes[index].ms).collect();
                (!ms.is_empty()).then(|| PassTime { name: counted[index].name.to_owned(), ms: median(ms) })
            })
            .collect(),
        bytes,
        vertices: total(|work| work.vertices),
        primitives: total(|work| work.primitives),
        fragments: total(|work| work.fragments),
    }
}

/// The middle value (the lower of two); 0 of nothing.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get((values.len().max(1) - 1) / 2).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pass(ms: Option<f64>) -> Vec<PassRecord> {
        let work = Some(WorkCounts { vertices: 3, primitives: 1, fragments: 7 });
        vec![PassRecord { name: "a", ms, work }, PassRecord { name: "b", ms, work: Some(WorkCounts::default()) }]
    }

    #[test]
    fn times_are_medians_and_work_is_summed_over_passes() {
        let timed = [pass(Some(1.0)), pass(Some(9.0)), pass(Some(2.0))];
        let cost = cost(&timed[0], &timed, 64);
        assert_eq!(cost.gpu_ms, Some(GpuTime { median: 4.0, min: 2.0, max: 18.0, runs: 3 }));
        assert_eq!((cost.vertices, cost.primitives, cost.fragments), (Some(3), Some(1), Some(7)));
        assert_eq!(cost.passes.len(), 2);
    }

    #[test]
    fn no_timestamps_leave_no_time() {
        let timed = [pass(None)];
        assert_eq!(cost(&timed[0], &timed, 0).gpu_ms, None);
        assert_eq!(cost(&pass(Some(1.0)), &[], 0).gpu_ms, None);
    }
}
