//! The figures of a run that no other module owns: causes, truth, budget, jitter and motion.

use crate::evaluate::{Flips, Followed};
use crate::verdict::{CauseShare, Verdict};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// What one cause is answerable for.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CauseEntry {
    /// Wrong pixels named after it.
    pub pixels: u64,
    /// Sum of its signed contributions, in units of one pixel's full visibility; negative is too dark.
    pub sum: f64,
}

impl From<&CauseShare> for CauseEntry {
    fn from(share: &CauseShare) -> Self {
        Self { pixels: share.pixels, sum: share.sum }
    }
}

/// Where the truth came from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TruthSource {
    /// The oracle's name.
    pub oracle: String,
    /// Shadow rays it cast.
    pub rays: u64,
    /// How long that took, milliseconds.
    pub ms: f64,
    /// Pixels on which other oracles disagree with it.
    pub disagreements: Disagreements,
    /// What Mitsuba said, ray by ray where it differs; null if it was not asked.
    pub mitsuba: Option<MitsubaFigures>,
}

/// What came of asking Mitsuba.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MitsubaFigures {
    /// Version and variant.
    pub version: String,
    /// Shadow rays that it answered.
    pub rays: u64,
    /// Rays on which it disagrees with the exact truth.
    pub disagreements: u64,
    /// Rays whose first surface lies too close to the receiver for f32 to tell; it calls them lit.
    pub contacts: u64,
    /// Wall-clock time, milliseconds.
    pub ms: f64,
    /// Every disagreement and every contact.
    pub listed: Vec<RayRow>,
    /// The test of an area light's counted shares against an independent estimate; null for other lights.
    pub estimate: Option<EstimateFigures>,
}

/// A test of counted shares of an area light against an estimate by other points.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EstimateFigures {
    /// Points drawn for each pixel.
    pub draws: u32,
    /// The chance of any false rejection.
    pub alpha: f64,
    /// What the counted points are granted.
    pub discrepancy: f64,
    /// Pixels whose share and estimate can both be right.
    pub accepted: u64,
    /// Pixels at which they cannot, as column and row.
    pub rejected: Vec<[u32; 2]>,
}

/// A ray on which two oracles disagree, or that one of them cannot decide.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RayRow {
    /// Column and row.
    pub pixel: [u32; 2],
    /// Which point of the light.
    pub point: u32,
    /// The receiver, rebased world, metres.
    pub from: [f64; 3],
    /// The light.
    pub to: [f64; 3],
    /// What the exact truth says: blocked or not.
    pub blocked: bool,
    /// What Mitsuba says: blocked, lit or contact.
    pub mitsuba: Cow<'static, str>,
    /// Whether exact arithmetic on every triangle says so, too.
    pub confirmed: bool,
    /// Why they differ.
    pub reason: Cow<'static, str>,
    /// How far the ray would have to move for the other verdict to be right, metres.
    pub distance_m: f64,
}

/// Pixels on which other oracles disagree; `None` for one that was not asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Disagreements {
    /// Mitsuba 3.
    pub mitsuba: Option<u64>,
    /// Our own brute force.
    pub brute: Option<u64>,
}

/// A limit on a run's error, and whether it was met.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct BudgetOutcome {
    /// Largest allowed share of wrong pixels among the asked, 0..=1.
    pub wrong_fraction: Option<f64>,
    /// Largest allowed mean absolute error, 0..=1.
    pub mean_abs: Option<f64>,
    /// Whether the verdict stays within both.
    pub met: bool,
    /// Whether it would with every undecided pixel as wrong as can be.
    pub met_worst_case: bool,
}

impl BudgetOutcome {
    /// Holds the limits against a verdict. A run in which nothing was asked meets every budget.
    #[must_use]
    pub fn of(verdict: &Verdict, wrong_fraction: Option<f64>, mean_abs: Option<f64>) -> Self {
        let within = |figure: Option<f64>, limit: Option<f64>| match (figure, limit) {
            (Some(figure), Some(limit)) => figure <= limit,
            _ => true,
        };
        let (error, worst) = (&verdict.error, &verdict.worst_case);
        Self {
            wrong_fraction,
            mean_abs,
            met: within(error.wrong_fraction, wrong_fraction) && within(error.mean_abs, mean_abs),
            met_worst_case: within(worst.wrong_fraction, wrong_fraction) && within(worst.mean_abs, mean_abs),
        }
    }
}

/// The spread of a run's error over sub-texel shifts of its map: one view alone is one sample of the texel phase.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Jitter {
    /// How many shifts were rendered.
    pub phases: u32,
    /// Of the share of wrong pixels.
    pub wrong_fraction: Spread,
}

/// Mean and spread of some samples.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// Arithmetic mean.
    pub mean: f64,
    /// Smallest sample.
    pub min: f64,
    /// Largest sample.
    pub max: f64,
    /// Standard deviation of the samples themselves (divided by n).
    pub stddev: f64,
}

impl Jitter {
    /// The spread of the share of wrong pixels, one sample per phase; `None` without samples.
    #[must_use]
    pub fn of(wrong_fractions: &[f64]) -> Option<Self> {
        Some(Self { phases: wrong_fractions.len() as u32, wrong_fraction: Spread::of(wrong_fractions)? })
    }
}

impl Spread {
    /// Of some samples; `None` without any.
    #[must_use]
    pub fn of(samples: &[f64]) -> Option<Self> {
        let n = samples.len() as f64;
        let mean = samples.iter().sum::<f64>() / n;
        let variance = samples.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n;
        Some(Self {
            mean,
            min: samples.iter().copied().reduce(f64::min)?,
            max: samples.iter().copied().reduce(f64::max)?,
            stddev: variance.sqrt(),
        })
    }
}

/// Shimmering: pixels that flip from one frame to the next although the truth does not, or the other way round.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Motion {
    /// How many steps were taken of each kind.
    pub steps: u32,
    /// What was compared from frame to frame while the camera moved.
    pub followed: Followed,
    /// Flips per step while the camera moves sideways.
    pub camera_flips: Spread,
    /// Flips per step while the light turns about the scene.
    pub light_flips: Spread,
}

impl Motion {
    /// The flips of each step; `None` without steps.
    #[must_use]
    pub fn of(flips: &Flips) -> Option<Self> {
        let spread = |counts: &[u64]| Spread::of(&counts.iter().map(|count| *count as f64).collect::<Vec<f64>>());
        Some(Self {
            steps: flips.of_camera.len() as u32,
            followed: flips.followed,
            camera_flips: spread(&flips.of_camera)?,
            light_flips: spread(&flips.of_light)?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::model::tests::verdict_with;

    #[test]
    fn budgets_are_met_up_to_their_limit() {
        // 1 of 8 decided pixels is wrong by 1, 2 more are undecided.
        let verdict = verdict_with(1, 7, 2);
        let outcome = |wrong, mean| {
            let outcome = BudgetOutcome::of(&verdict, wrong, mean);
            (outcome.met, outcome.met_worst_case)
        };
        assert_eq!(outcome(Some(0.125), None), (true, false));
        assert_eq!(outcome(Some(0.124), None), (false, false));
        assert_eq!(outcome(Some(0.3), None), (true, true));
        assert_eq!(outcome(Some(0.3), Some(0.1)), (false, false));
        assert_eq!(outcome(None, Some(0.125)), (true, false));
        assert_eq!(outcome(None, None), (true, true));
    }

    #[test]
    fn nothing_asked_meets_a_budget_unless_all_of_it_is_undecided() {
        let nothing = BudgetOutcome::of(&verdict_with(0, 0, 0), Some(0.0), None);
        assert!(nothing.met && nothing.met_worst_case);
        let undecided = BudgetOutcome::of(&verdict_with(0, 0, 3), Some(0.0), None);
        assert!(undecided.met && !undecided.met_worst_case);
    }

    #[test]
    fn the_spread_of_a_jittered_run() {
        let jitter = Jitter::of(&[0.25, 0.5, 0.75]).unwrap();
        assert_eq!((jitter.phases, jitter.wrong_fraction.mean), (3, 0.5));
        assert_eq!((jitter.wrong_fraction.min, jitter.wrong_fraction.max), (0.25, 0.75));
        assert!((jitter.wrong_fraction.stddev - (1.0_f64 / 24.0).sqrt()).abs() < f64::EPSILON);
        assert_eq!(Jitter::of(&[]), None);
    }
}
