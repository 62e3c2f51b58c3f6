//! That a ledger adds up: what the causes are booked with makes exactly the error that was measured.

#![allow(clippy::expect_used, clippy::panic, reason = "tests fail by panicking")]

use gnomon::evaluate::Evaluation;
use gnomon::verdict::{RESIDUE_ABOVE, entries_of_pixel};

/// Each pixel's residue may be as large as [`RESIDUE_ABOVE`], and no picture here has more than 10⁴ pixels.
const SUM_ROUNDING: f64 = 1e-6;

/// In the sums over all pixels, in the counts, and pixel by pixel.
pub(crate) fn assert_adds_up(what: &str, evaluation: &Evaluation<'_>) {
    let (verdict, ledger) = (&evaluation.verdict, &evaluation.ledger);
    let measured = verdict.error.signed.unwrap_or(0.0) * verdict.pixels.asked as f64;
    let booked: f64 = ledger.causes.values().map(|share| share.sum).sum();
    assert!((booked - measured).abs() <= SUM_ROUNDING, "{what}: booked {booked}, measured {measured}");
    let named: u64 = ledger.causes.values().map(|share| share.pixels).sum();
    assert_eq!((named, ledger.wrong.len() as u64), (verdict.pixels.wrong, verdict.pixels.wrong), "{what}");
    let differing: u64 = ledger.causes.values().map(|share| share.pixels + share.merely_differing).sum();
    assert_eq!(differing, verdict.pixels.differing, "{what}");
    for &pixel in &evaluation.replay.pixels {
        let entries = entries_of_pixel(&evaluation.replay, pixel).expect("replayed");
        let error = verdict.signed_error[pixel as usize].expect("compared");
        let residue = entries.iter().map(|entry| entry.contribution).sum::<f64>() - error;
        assert!(residue.abs() <= RESIDUE_ABOVE, "{what}: pixel {pixel} leaves {residue}");
    }
}
