//! Times of techniques that hold beside one another: all are warmed up, then run in turn, round by round, with the view's
//! G-buffer among them. An adapter that slows down or speeds up meanwhile does so for all of them, and what was timed at
//! another time compares by its multiple of the G-buffer.

use super::{EvaluateError, Evaluation, View};
use crate::gpu::PassRecord;
use crate::technique::{GpuTime, PassTime, Prepared, TechniqueError};
use crate::watch::{Interrupted, Watch};

/// Rounds in which techniques that are compared are timed.
pub const TIMED_ROUNDS: u32 = 3;
/// A run is warm once it takes as long as the one before, within this share: drivers compile pipelines and fault pages in
/// during the first runs.
const STABLE: f64 = 0.1;
/// Where times never settle, measuring begins after so many runs.
const MOST_WARM_UPS: u32 = 6;

/// GPU times of one technique; all `None` or empty where the adapter has no timestamps.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Times {
    /// All passes together.
    pub gpu_ms: Option<GpuTime>,
    /// Each pass.
    pub passes: Vec<PassTime>,
    /// The G-buffer, in the same rounds; the middle one, milliseconds.
    pub gbuffer_ms: Option<f64>,
}

/// Times several techniques of one view in turn.
///
/// # Errors
/// What the device reported, and an interrupt.
pub fn time_in_turn(
    view: &View<'_>,
    prepared: &[&dyn Prepared],
    rounds: u32,
    watch: &dyn Watch,
) -> Result<Vec<Times>, EvaluateError> {
    // The G-buffer first, then each technique.
    let run = |turn: usize| -> Result<Vec<PassRecord>, TechniqueError> {
        match turn.checked_sub(1) {
            None => Ok(view.gbuffer.run(view.gpu, &view.geometry)?),
            Some(index) => Ok(prepared[index].run()?.passes),
        }
    };
    let turns = prepared.len() + 1;
    watch.start("timing", turns as u64 * u64::from(rounds + 1));
    for turn in 0..turns {
        warm_up(|| run(turn), watch)?;
        watch.advance(1);
    }
    let mut timed: Vec<Vec<Vec<PassRecord>>> = vec![Vec::new(); turns];
    for _ in 0..rounds {
        for (turn, timed) in timed.iter_mut().enumerate() {
            proceed(watch)?;
            timed.push(run(turn)?);
            watch.advance(1);
        }
    }
    let gbuffer_ms = timed.first().and_then(|runs| total(runs)).map(|time| time.median);
    let times = |runs: &Vec<Vec<PassRecord>>| Times { gpu_ms: total(runs), passes: passes(runs), gbuffer_ms };
    Ok(timed.iter().skip(1).map(times).collect())
}

/// Times evaluations of one view in turn, and notes the times in their costs.
///
/// # Errors
/// As [`time_in_turn`]; no cost has changed then.
pub fn time_evaluations(
    view: &View<'_>,
    evaluations: &mut [&mut Evaluation<'_>],
    watch: &dyn Watch,
) -> Result<(), EvaluateError> {
    if evaluations.is_empty() {
        return Ok(());
    }
    let prepared: Vec<&dyn Prepared> = evaluations.iter().map(|evaluation| evaluation.prepared.as_ref()).collect();
    let times = time_in_turn(view, &prepared, TIMED_ROUNDS, watch)?;
    for (evaluation, Times { gpu_ms, passes, gbuffer_ms }) in evaluations.iter_mut().zip(times) {
        let cost = &mut evaluation.cost;
        (cost.gpu_ms, cost.passes, cost.gbuffer_ms) = (gpu_ms, passes, gbuffer_ms);
    }
    Ok(())
}

fn proceed(watch: &dyn Watch) -> Result<(), Interrupted> {
    if watch.interrupted() { Err(Interrupted) } else { Ok(()) }
}

fn warm_up(run: impl Fn() -> Result<Vec<PassRecord>, TechniqueError>, watch: &dyn Watch) -> Result<(), EvaluateError> {
    let mut before = total_ms(&run()?);
    for _ in 0..MOST_WARM_UPS {
        proceed(watch)?;
        let ms = total_ms(&run()?);
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

fn total(runs: &[Vec<PassRecord>]) -> Option<GpuTime> {
    spread(runs.iter().map(|passes| total_ms(passes)).collect())
}

fn passes(runs: &[Vec<PassRecord>]) -> Vec<PassTime> {
    let pass = |(index, pass): (usize, &PassRecord)| {
        let GpuTime { median, min, max, .. } = spread(runs.iter().map(|passes| passes[index].ms).collect())?;
        Some(PassTime { name: pass.name.to_owned(), ms: median, ms_min: min, ms_max: max })
    };
    runs.first().into_iter().flatten().enumerate().filter_map(pass).collect()
}

fn spread(ms: Option<Vec<f64>>) -> Option<GpuTime> {
    let mut ms = ms.filter(|ms| !ms.is_empty())?;
    ms.sort_by(f64::total_cmp);
    // The lower of two middle ones.
    Some(GpuTime { median: ms[(ms.len() - 1) / 2], min: ms[0], max: ms[ms.len() - 1], runs: ms.len() as u32 })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(ms: Option<f64>) -> Vec<PassRecord> {
        ["a", "b"].map(|name| PassRecord { name, ms, work: None }).into()
    }

    #[test]
    fn times_are_medians() {
        let runs = [run(Some(1.0)), run(Some(9.0)), run(Some(2.0))];
        assert_eq!(total(&runs), Some(GpuTime { median: 4.0, min: 2.0, max: 18.0, runs: 3 }));
        assert_eq!(passes(&runs)[0], PassTime { name: "a".to_owned(), ms: 2.0, ms_min: 1.0, ms_max: 9.0 });
        assert_eq!(passes(&runs).len(), 2);
    }

    #[test]
    fn no_timestamps_leave_no_time() {
        assert_eq!((total(&[run(None)]), passes(&[run(None)])), (None, Vec::new()));
        assert_eq!((total(&[]), passes(&[])), (None, Vec::new()));
    }

    #[test]
    fn a_run_is_warm_once_it_takes_as_long_as_the_one_before() {
        assert!(is_stable(Some(10.0), Some(10.9)) && is_stable(Some(10.0), Some(9.1)));
        assert!(!is_stable(Some(60.0), Some(10.0)) && !is_stable(Some(10.0), Some(12.0)));
        assert!(is_stable(None, None));
    }
}
