//! Running a technique and measuring what it cost: warm-up until times are stable, then the median of the timed runs.

use super::EvaluateError;
use crate::gpu::{PassRecord, WorkCounts};
use crate::mask::Mask;
use crate::technique::{Cost, GpuTime, PassTime, Prepared, TechniqueError};
use crate::watch::{Interrupted, Watch};
use std::time::Instant;

/// A run is warm once it takes as long as the one before, within this share: drivers compile pipelines and fault pages in
/// during the first runs.
const STABLE: f64 = 0.1;
/// Where times never settle, measuring begins after so many runs.
const MOST_WARM_UPS: u32 = 6;

/// A run's answer and cost.
pub(super) struct Measured {
    pub(super) mask: Mask,
    pub(super) cost: Cost,
}

/// A technique made ready, and the milliseconds that took on the CPU.
pub(super) fn prepared<'v>(
    prepare: impl FnOnce() -> Result<Box<dyn Prepared + 'v>, TechniqueError>,
) -> Result<(Box<dyn Prepared + 'v>, f64), TechniqueError> {
    let start = Instant::now();
    let prepared = prepare()?;
    Ok((prepared, start.elapsed().as_secs_f64() * 1e3))
}

/// Runs once, and with `timed_runs` > 0 until it is warm and then that often again, timing those.
pub(super) fn measure(prepared: &dyn Prepared, timed_runs: u32, watch: &dyn Watch) -> Result<Measured, EvaluateError> {
    let mut answer = prepared.run()?;
    let mut timed: Vec<Vec<PassRecord>> = Vec::new();
    if timed_runs > 0 {
        warm_up(prepared, &answer.passes, watch)?;
    }
    for _ in 0..timed_runs {
        proceed(watch)?;
        answer = prepared.run()?;
        timed.push(answer.passes.clone());
    }
    let cost = cost(&answer.passes, &timed, prepared.bytes());
    Ok(Measured { mask: answer.mask, cost })
}

/// Times several techniques in turn, round by round, so that an adapter that slows down or speeds up meanwhile does so
/// for all of them: the ratios of their times hold. Every technique has run before.
///
/// # Errors
/// What the device reported, and an interrupt.
pub fn time_in_turn(
    prepared: &[&dyn Prepared],
    rounds: u32,
    watch: &dyn Watch,
) -> Result<Vec<Option<GpuTime>>, EvaluateError> {
    let mut totals: Vec<Vec<Option<f64>>> = vec![Vec::new(); prepared.len()];
    for _ in 0..rounds {
        for (prepared, totals) in prepared.iter().zip(&mut totals) {
            proceed(watch)?;
            totals.push(total_ms(&prepared.run()?.passes));
        }
    }
    Ok(totals.into_iter().map(|totals| spread(totals.into_iter().collect())).collect())
}

fn proceed(watch: &dyn Watch) -> Result<(), Interrupted> {
    if watch.interrupted() { Err(Interrupted) } else { Ok(()) }
}

fn warm_up(prepared: &dyn Prepared, first: &[PassRecord], watch: &dyn Watch) -> Result<(), EvaluateError> {
    let mut before = total_ms(first);
    for _ in 0..MOST_WARM_UPS {
        proceed(watch)?;
        let ms = total_ms(&prepared.run()?.passes);
        if is_stable(before, ms) {
            break;
        }
        before = ms;
    }
    Ok(())
}

/// Without timestamps there is nothing to wait for.
fn is_stable(before_ms: Option<f64>, ms: Option<f64>) -> bool {
    match (before_ms, ms) {
        (Some(before), Some(ms)) => (ms - before).abs() <= STABLE * before,
        _ => true,
    }
}

fn total_ms(passes: &[PassRecord]) -> Option<f64> {
    passes.iter().map(|pass| pass.ms).sum()
}

fn spread(ms: Option<Vec<f64>>) -> Option<GpuTime> {
    let ms = ms.filter(|ms| !ms.is_empty())?;
    Some(GpuTime { median: median(ms.clone()), min: least(&ms), max: most(&ms), runs: ms.len() as u32 })
}

fn least(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::INFINITY, f64::min)
}

fn most(values: &[f64]) -> f64 {
    values.iter().copied().fold(0.0, f64::max)
}

fn cost(counted: &[PassRecord], timed: &[Vec<PassRecord>], bytes: u64) -> Cost {
    let work: Option<Vec<WorkCounts>> = counted.iter().map(|pass| pass.work).collect();
    let total = |of: fn(&WorkCounts) -> u64| work.as_ref().map(|counts| counts.iter().map(of).sum());
    let pass = |index: usize| {
        let ms: Option<Vec<f64>> = timed.iter().map(|passes| passes[index].ms).collect();
        let GpuTime { median, min, max, .. } = spread(ms)?;
        Some(PassTime { name: counted[index].name.to_owned(), ms: median, ms_min: min, ms_max: max })
    };
    Cost {
        gpu_ms: spread(timed.iter().map(|passes| total_ms(passes)).collect()),
        passes: (0..counted.len()).filter_map(pass).collect(),
        prepare_ms: None,
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
        assert_eq!(cost.passes[0], PassTime { name: "a".to_owned(), ms: 2.0, ms_min: 1.0, ms_max: 9.0 });
        assert_eq!(cost.passes.len(), 2);
    }

    #[test]
    fn no_timestamps_leave_no_time() {
        let timed = [pass(None)];
        assert_eq!(cost(&timed[0], &timed, 0).gpu_ms, None);
        assert_eq!(cost(&pass(Some(1.0)), &[], 0).gpu_ms, None);
    }

    #[test]
    fn a_run_is_warm_once_it_takes_as_long_as_the_one_before() {
        assert!(is_stable(Some(10.0), Some(10.9)) && is_stable(Some(10.0), Some(9.1)));
        assert!(!is_stable(Some(60.0), Some(10.0)) && !is_stable(Some(10.0), Some(12.0)));
        assert!(is_stable(None, None));
    }
}
