//! What `judge` counts, what it refuses, and that it sees the faults planted here.

use super::*;
use crate::mask::{Mask, Truth, TruthMask, Visibility};
use crate::receiver::PixelClass::{self, Asked, Background, FacingAway, NotLit};
use glam::UVec2;
use proptest::prelude::*;

/// Sums of a few dozen f64 terms of size 1.
const ROUNDING: f64 = 1e-12;

fn visibility(value: f32) -> Visibility {
    Visibility::new(value).unwrap()
}

fn mask(size: UVec2, value: impl Fn(u32, u32) -> f32) -> Mask {
    let pixels = (0..size.x * size.y).map(|i| Some(visibility(value(i % size.x, i / size.x)))).collect();
    Mask { size, pixels }
}

fn truth(size: UVec2, value: impl Fn(u32, u32) -> f32) -> TruthMask {
    let pixels = mask(size, value).pixels.into_iter().map(|v| v.map(Truth::Known)).collect();
    TruthMask { size, pixels }
}

/// A shadow with a slanted edge, so that neither a shift nor an exchange of the axes maps it to itself.
fn slanted(x: u32, y: u32) -> f32 {
    if 2 * x + 5 * y < 40 { 0.0 } else { 1.0 }
}

fn judge_hard(truth: &TruthMask, mask: &Mask) -> Verdict {
    judge(&vec![Asked; truth.pixels.len()], truth, mask, WRONG_ABOVE_HARD).unwrap()
}

#[test]
fn every_kind_of_pixel_is_counted_once() {
    let size = UVec2::new(4, 2);
    let classes = [Background, FacingAway, NotLit, Asked, Asked, Asked, Asked, Asked];
    let known = |v| Some(Truth::Known(visibility(v)));
    let truth = TruthMask {
        size,
        pixels: vec![None, None, None, Some(Truth::Undecided), known(1.0), known(0.0), known(0.5), known(1.0)],
    };
    let mask = Mask {
        size,
        pixels: [None, None, Some(0.3), None, Some(0.0), Some(0.75), Some(0.5), Some(0.75)]
            .map(|v| v.map(visibility))
            .to_vec(),
    };
    let verdict = judge(&classes, &truth, &mask, WRONG_ABOVE_HARD).unwrap();
    let expected = PixelCounts {
        total: 8,
        background: 1,
        facing_away: 1,
        not_lit: 1,
        undecided: 1,
        asked: 4,
        wrong: 2,
        differing: 3,
        false_shadow: 1,
        false_light: 1,
    };
    assert_eq!(verdict.pixels, expected);
    assert_eq!(verdict.signed_error[3..], [None, Some(-1.0), Some(0.75), Some(0.0), Some(-0.25)]);
    assert_eq!(verdict.error.mean_abs, Some(2.0 / 4.0));
    assert_eq!(verdict.error.signed, Some(-0.5 / 4.0));
    assert_eq!(verdict.error.wrong_fraction, Some(2.0 / 4.0));
    assert_eq!(verdict.worst_case, WorstCase { wrong_fraction: Some(3.0 / 5.0), mean_abs: Some(3.0 / 5.0) });
    // Wrong pixels 4 and 5 are neighbours, and each other's nearest pixel across the edge.
    assert_eq!(verdict.error.largest_blob_px, 2);
    assert_eq!(verdict.error.edge_distance_px, Some(EdgeDistance { p50: 0.5, p99: 0.5, max: 0.5 }));
    assert!(verdict.is_wrong(4) && !verdict.is_wrong(7) && verdict.is_differing(7) && !verdict.is_wrong(3));
}

#[test]
fn thresholds_are_exceeded_not_reached() {
    let size = UVec2::new(2, 1);
    let verdict = judge_hard(&truth(size, |_, _| 0.0), &mask(size, |x, _| if x == 0 { 0.5 } else { 0.500_001 }));
    assert_eq!(verdict.pixels.wrong, 1);
    let step = DIFFERING_ABOVE as f32;
    let verdict = judge_hard(&truth(size, |_, _| 0.0), &mask(size, |x, _| if x == 0 { step } else { 1.001 * step }));
    assert_eq!(verdict.pixels.differing, 1);
    let soft = judge(&[Asked; 2], &truth(size, |_, _| 0.0), &mask(size, |_, _| 0.2), WRONG_ABOVE_SOFT).unwrap();
    assert_eq!(soft.pixels.wrong, 2);
}

#[test]
fn ratios_over_nothing_are_none() {
    let size = UVec2::new(2, 2);
    let nothing = TruthMask { size, pixels: vec![None; 4] };
    let verdict = judge(&[Background; 4], &nothing, &mask(size, |_, _| 1.0), WRONG_ABOVE_HARD).unwrap();
    assert_eq!(verdict.error, ErrorStats::default());
    assert_eq!(verdict.worst_case, WorstCase::default());

    let undecided = TruthMask { size, pixels: vec![Some(Truth::Undecided); 4] };
    let verdict = judge(&[Asked; 4], &undecided, &mask(size, |_, _| 1.0), WRONG_ABOVE_HARD).unwrap();
    assert_eq!(verdict.error.wrong_fraction, None);
    assert_eq!(verdict.worst_case.wrong_fraction, Some(1.0));

    let empty = TruthMask { size: UVec2::ZERO, pixels: Vec::new() };
    let verdict = judge(&[], &empty, &mask(UVec2::ZERO, |_, _| 1.0), WRONG_ABOVE_HARD).unwrap();
    assert_eq!(verdict.pixels, PixelCounts::default());
}

#[test]
fn planted_faults_are_seen() {
    let size = UVec2::new(16, 16);
    let truth = truth(size, slanted);
    let faultless = judge_hard(&truth, &mask(size, slanted));
    assert_eq!((faultless.pixels.differing, faultless.error.mean_abs), (0, Some(0.0)));
    assert_eq!(faultless.error.edge_distance_px, None);

    let shifted = judge_hard(&truth, &mask(size, |x, y| slanted(x.saturating_sub(1), y)));
    assert!(shifted.pixels.false_shadow > 0 && shifted.pixels.false_light == 0);
    assert_eq!(shifted.error.edge_distance_px.unwrap().max, 0.5, "a shift by one pixel stays at the edge");

    let swapped = judge_hard(&truth, &mask(size, |x, y| slanted(y, x)));
    assert!(swapped.pixels.false_shadow > 0 && swapped.pixels.false_light > 0);

    let inverted = judge_hard(&truth, &mask(size, |x, y| 1.0 - slanted(x, y)));
    assert_eq!(inverted.pixels.wrong, 256);
    assert_eq!(inverted.error.largest_blob_px, 256);

    let mut one_flipped = mask(size, slanted);
    one_flipped.pixels[0] = Some(Visibility::LIT);
    assert_eq!(judge_hard(&truth, &one_flipped).pixels.false_light, 1);
}

#[test]
fn inputs_of_different_pictures_are_refused() {
    let size = UVec2::new(3, 2);
    let truth = truth(size, slanted);
    let transposed = mask(UVec2::new(2, 3), slanted);
    let of_transposed = judge(&[Asked; 6], &truth, &transposed, WRONG_ABOVE_HARD);
    assert_eq!(of_transposed, Err(VerdictError::Shape { mask: UVec2::new(2, 3), truth: size }));

    let too_few = judge(&[Asked; 5], &truth, &mask(size, slanted), WRONG_ABOVE_HARD);
    assert_eq!(too_few, Err(VerdictError::Size { what: "class list", found: 5, expected: size }));
    let mut short = mask(size, slanted);
    short.pixels.pop();
    let of_short = judge(&[Asked; 6], &truth, &short, WRONG_ABOVE_HARD);
    assert_eq!(of_short, Err(VerdictError::Size { what: "mask", found: 5, expected: size }));
    for threshold in [f64::NAN, -0.1, 0.0, 1.1, f64::INFINITY] {
        let refused = judge(&[Asked; 6], &truth, &mask(size, slanted), threshold);
        assert!(matches!(refused, Err(VerdictError::Threshold(_))), "{threshold}");
    }
}

#[test]
fn unanswered_pixels_are_refused_with_count_and_place() {
    let size = UVec2::new(3, 2);
    let (known, mut sparse) = (truth(size, slanted), mask(size, slanted));
    sparse.pixels[4] = None;
    sparse.pixels[5] = None;
    let first = UVec2::new(1, 1);
    let refused = judge(&[Asked; 6], &known, &sparse, WRONG_ABOVE_HARD);
    assert_eq!(refused, Err(VerdictError::Unanswered { what: "mask", count: 2, first }));
    assert_eq!(refused.unwrap_err().to_string(), "the mask leaves 2 asked pixels unanswered, the first at (1, 1)");
    let mut classes = [Asked; 6];
    classes[4] = Background;
    classes[5] = FacingAway;
    assert!(judge(&classes, &known, &sparse, WRONG_ABOVE_HARD).is_ok(), "nobody asked about those two");

    let mut gap = known;
    gap.pixels[4] = None;
    let refused = judge(&[Asked; 6], &gap, &mask(size, slanted), WRONG_ABOVE_HARD);
    assert_eq!(refused, Err(VerdictError::Unanswered { what: "truth", count: 1, first }));
}

fn class(kind: u8) -> PixelClass {
    [Background, FacingAway, NotLit, Asked, Asked, Asked, Asked, Asked][usize::from(kind) % 8]
}

proptest! {
    /// Against the definitions, spelled out slowly.
    #[test]
    fn counts_and_sums_follow_their_definitions(
        pixels in prop::collection::vec((any::<u8>(), 0_u8..=8, 0_u8..=8, 0_u8..10), 1..60),
    ) {
        let size = UVec2::new(pixels.len() as u32, 1);
        let eighth = |n: u8| visibility(f32::from(n) / 8.0);
        let classes: Vec<PixelClass> = pixels.iter().map(|p| class(p.0)).collect();
        let known = |p: &(u8, u8, u8, u8)| if p.3 == 0 { Truth::Undecided } else { Truth::Known(eighth(p.1)) };
        let truth = TruthMask { size, pixels: pixels.iter().map(|p| Some(known(p))).collect() };
        let mask = Mask { size, pixels: pixels.iter().map(|p| Some(eighth(p.2))).collect() };
        let verdict = judge(&classes, &truth, &mask, WRONG_ABOVE_HARD).unwrap();

        let n = verdict.pixels;
        prop_assert_eq!(n.total, n.background + n.facing_away + n.not_lit + n.undecided + n.asked);
        prop_assert_eq!(n.wrong, n.false_shadow + n.false_light);
        let errors: Vec<f64> = verdict.signed_error.iter().flatten().copied().collect();
        prop_assert_eq!(errors.len() as u64, n.asked);
        prop_assert_eq!(errors.iter().filter(|e| e.abs() > 0.5).count() as u64, n.wrong);
        prop_assert_eq!(errors.iter().filter(|e| e.abs() > DIFFERING_ABOVE).count() as u64, n.differing);
        let asked = n.asked as f64;
        let signed: f64 = errors.iter().sum();
        prop_assert!((verdict.error.signed.unwrap_or(0.0) * asked - signed).abs() < ROUNDING);
        prop_assert!(verdict.error.mean_abs >= verdict.error.signed.map(f64::abs));
        prop_assert!(verdict.worst_case.wrong_fraction >= verdict.error.wrong_fraction);
    }
}
