//! Hand-made chains whose accounts are known, random chains whose sums must be exact, and replays that must be refused.

use super::*;
use crate::cause::{Cause, Replay, Stage};
use crate::mask::{Mask, Truth, TruthMask, Visibility};
use crate::receiver::PixelClass;
use glam::UVec2;
use proptest::prelude::*;

const NAMES: [&str; 4] = ["coverage", "bias", "sampling", "filter"];
const CAUSES: [Cause; 4] = [Cause::ClippingNear, Cause::PeterPanning, Cause::EdgeAliasing, Cause::FilterWidth];

/// Everything a ledger is made from, for one row of pixels.
struct Case {
    truth: TruthMask,
    mask: Mask,
    verdict: Verdict,
    replay: Replay,
}

impl Case {
    /// One chain per pixel: the truth, then the value after each of the four stages, which own one cause each.
    fn of(chains: &[[f64; 5]]) -> Self {
        let size = UVec2::new(chains.len() as u32, 1);
        let visibility = |value: f64| Visibility::new(value as f32).unwrap();
        let truth = TruthMask { size, pixels: chains.iter().map(|c| Some(Truth::Known(visibility(c[0])))).collect() };
        let mask = Mask { size, pixels: chains.iter().map(|c| Some(visibility(c[4]))).collect() };
        let verdict = judge(&vec![PixelClass::Asked; chains.len()], &truth, &mask, WRONG_ABOVE_HARD).unwrap();
        let stage = |i: usize| Stage {
            name: NAMES[i],
            values: chains.iter().map(|c| c[i + 1]).collect(),
            causes: vec![CAUSES[i]; chains.len()],
        };
        let replay = Replay {
            pixels: (0..size.x).collect(),
            exact: chains.iter().map(|c| c[0]).collect(),
            stages: (0..4).map(stage).collect(),
        };
        Self { truth, mask, verdict, replay }
    }

    fn ledger(&self) -> Result<Ledger, LedgerError> {
        ledger(&self.verdict, &self.truth, &self.mask, &self.replay)
    }
}

fn share(pixels: u64, merely_differing: u64, sum: f64) -> CauseShare {
    CauseShare { pixels, merely_differing, sum }
}

#[test]
fn a_pixel_that_leaves_comes_back_and_leaves_again_is_named_after_the_last_departure() {
    let case = Case::of(&[[1.0, 0.0, 1.0, 0.0, 0.0]]);
    let ledger = case.ledger().unwrap();
    assert_eq!(ledger.wrong, [(0, Cause::EdgeAliasing)]);
    // Every stage that moved the value is booked, the one that did not is absent.
    let expected = [
        (Cause::ClippingNear, share(0, 0, -1.0)),
        (Cause::PeterPanning, share(0, 0, 1.0)),
        (Cause::EdgeAliasing, share(1, 0, -1.0)),
    ];
    let booked: Vec<_> = ledger.causes.iter().map(|(cause, share)| (*cause, *share)).collect();
    assert_eq!(booked.len(), 3);
    assert!(expected.iter().all(|entry| booked.contains(entry)), "{booked:?}");
}

#[test]
fn a_pixel_that_comes_back_for_good_is_named_after_nothing() {
    let ledger = Case::of(&[[1.0, 0.0, 0.0, 1.0, 1.0]]).ledger().unwrap();
    assert!(ledger.wrong.is_empty() && ledger.merely_differing.is_empty());
    assert_eq!(ledger.causes[&Cause::ClippingNear].sum, -1.0);
    assert_eq!(ledger.causes[&Cause::EdgeAliasing].sum, 1.0);
    assert_eq!(ledger.cause_of(0), None);
}

#[test]
fn two_faults_in_two_places_are_both_named() {
    let case = Case::of(&[
        [0.0, 1.0, 1.0, 1.0, 1.0],
        [0.0, 0.0, 0.0, 0.0, 0.0],
        [0.0, 0.0, 1.0, 1.0, 1.0],
        [1.0, 1.0, 1.0, 1.0, 0.0],
    ]);
    let ledger = case.ledger().unwrap();
    assert_eq!(ledger.wrong, [(0, Cause::ClippingNear), (2, Cause::PeterPanning), (3, Cause::FilterWidth)]);
    assert_eq!(ledger.cause_of(2), Some(Cause::PeterPanning));
    assert_eq!(ledger.cause_of(1), None);
}

#[test]
fn a_small_step_beyond_the_threshold_counts_not_the_largest_one() {
    // Coverage moves by 0.5, which is not beyond 0.5; the filter's last 0.125 is what makes the pixel wrong.
    let ledger = Case::of(&[[0.0, 0.5, 0.5, 0.5, 0.625]]).ledger().unwrap();
    assert_eq!(ledger.wrong, [(0, Cause::FilterWidth)]);
}

#[test]
fn a_differing_pixel_is_named_by_the_finer_threshold() {
    let ledger = Case::of(&[[1.0, 1.0, 0.875, 0.75, 0.875]]).ledger().unwrap();
    assert_eq!(ledger.merely_differing, [(0, Cause::PeterPanning)]);
    assert_eq!(ledger.cause_of(0), Some(Cause::PeterPanning));
    assert_eq!(ledger.causes[&Cause::PeterPanning], share(0, 1, -0.125));
    assert_eq!(ledger.causes[&Cause::FilterWidth], share(0, 0, 0.125));
}

#[test]
fn a_pixels_account_lists_every_stage() {
    let case = Case::of(&[[1.0; 5], [1.0, 1.0, 0.25, 0.25, 0.5]]);
    let entries = entries_of_pixel(&case.replay, 1).unwrap();
    let lines: Vec<_> = entries.iter().map(|e| (e.stage, e.value, e.contribution, e.cause)).collect();
    assert_eq!(
        lines,
        [
            ("coverage", 1.0, 0.0, Cause::ClippingNear),
            ("bias", 0.25, -0.75, Cause::PeterPanning),
            ("sampling", 0.25, 0.0, Cause::EdgeAliasing),
            ("filter", 0.5, 0.25, Cause::FilterWidth),
        ]
    );
    assert_eq!(entries_of_pixel(&case.replay, 2), None);
}

#[test]
fn a_replay_may_leave_out_faultless_pixels_only() {
    let mut case = Case::of(&[[1.0; 5], [1.0, 1.0, 0.0, 0.0, 0.0]]);
    let keep = |case: &mut Case, slot: usize| {
        case.replay.pixels = vec![case.replay.pixels[slot]];
        case.replay.exact = vec![case.replay.exact[slot]];
        for stage in &mut case.replay.stages {
            stage.values = vec![stage.values[slot]];
            stage.causes.truncate(1);
        }
    };
    keep(&mut case, 1);
    assert_eq!(case.ledger().unwrap().wrong, [(1, Cause::PeterPanning)]);

    let mut case = Case::of(&[[1.0; 5], [1.0, 1.0, 0.0, 0.0, 0.0]]);
    keep(&mut case, 0);
    assert_eq!(case.ledger(), Err(LedgerError::Missing { pixel: 1, error: -1.0 }));
    case.replay = Replay::default();
    assert_eq!(case.ledger(), Err(LedgerError::Missing { pixel: 1, error: -1.0 }));
}

#[test]
fn chains_that_miss_either_end_are_refused_by_pixel_and_stage() {
    let whole = || Case::of(&[[1.0; 5], [1.0, 1.0, 0.0, 0.0, 0.0]]);
    let mut ends_elsewhere = whole();
    ends_elsewhere.replay.stages[3].values[1] = 2.0 * RESIDUE_ABOVE;
    let refused = ends_elsewhere.ledger().unwrap_err().to_string();
    assert!(refused.contains("pixel 1") && refused.contains("bias 0") && refused.contains("filter 0.000000002"));

    let mut starts_elsewhere = whole();
    starts_elsewhere.replay.exact[1] = 0.0;
    assert!(matches!(starts_elsewhere.ledger(), Err(LedgerError::Residue { pixel: 1, .. })));

    let mut stageless = whole();
    stageless.replay.stages.clear();
    assert!(matches!(stageless.ledger(), Err(LedgerError::Residue { pixel: 1, .. })));

    let mut rounded = whole();
    rounded.replay.stages[3].values[1] = 0.5 * RESIDUE_ABOVE;
    assert!(rounded.ledger().is_ok());
}

#[test]
fn malformed_replays_are_refused() {
    let whole = || Case::of(&[[1.0; 5], [1.0, 1.0, 0.0, 0.0, 0.0]]);
    let faults: [fn(&mut Replay); 6] = [
        |r| r.pixels.swap(0, 1),
        |r| r.pixels[1] = 0,
        |r| r.stages[0].values.truncate(1),
        |r| r.stages[3].causes.truncate(1),
        |r| r.stages[1].values[0] = f64::NAN,
        |r| r.stages[1].values[0] = 1.5,
    ];
    for (i, plant) in faults.iter().enumerate() {
        let mut case = whole();
        plant(&mut case.replay);
        assert!(matches!(case.ledger(), Err(LedgerError::Malformed(_))), "fault {i}");
    }
}

#[test]
fn pixels_without_a_verdict_and_foreign_masks_are_refused() {
    let mut beyond = Case::of(&[[1.0; 5], [1.0; 5]]);
    beyond.replay.pixels[1] = 7;
    assert_eq!(beyond.ledger(), Err(LedgerError::NotCompared { pixel: 7 }));

    let mut foreign = Case::of(&[[1.0; 5]]);
    foreign.mask.pixels[0] = Some(Visibility::SHADOW);
    assert_eq!(foreign.ledger(), Err(LedgerError::Foreign));
    foreign.mask.pixels.push(None);
    assert_eq!(foreign.ledger(), Err(LedgerError::Foreign));
}

/// Visibilities as techniques make them: 0, 1, and averages of taps that f32 holds exactly.
fn value() -> impl Strategy<Value = f64> {
    prop_oneof![Just(0.0), Just(1.0), (0_u32..=64).prop_map(|n| f64::from(n) / 64.0)]
}

proptest! {
    #[test]
    fn sums_are_exact_whatever_the_chains(chains in prop::collection::vec([value(), value(), value(), value(), value()], 1..40)) {
        let case = Case::of(&chains);
        let ledger = case.ledger().unwrap();
        let asked = case.verdict.pixels.asked as f64;
        let booked: f64 = ledger.causes.values().map(|share| share.sum).sum();
        prop_assert!((booked - case.verdict.error.signed.unwrap() * asked).abs() <= RESIDUE_ABOVE * asked);
        for (pixel, error) in (0_u32..).zip(&case.verdict.signed_error) {
            let account: f64 = entries_of_pixel(&case.replay, pixel).unwrap().iter().map(|e| e.contribution).sum();
            prop_assert!((account - error.unwrap()).abs() <= RESIDUE_ABOVE);
        }

        // Every wrong and every differing pixel has exactly one name.
        let named: u64 = ledger.causes.values().map(|share| share.pixels).sum();
        prop_assert_eq!(named, case.verdict.pixels.wrong);
        prop_assert_eq!(ledger.wrong.len() as u64, case.verdict.pixels.wrong);
        let fine: u64 = ledger.causes.values().map(|share| share.merely_differing).sum();
        prop_assert_eq!(fine + named, case.verdict.pixels.differing);
    }
}
