//! Every projection with every filter and every bias: it either answers, with a ledger that adds up, or says why not.

#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout, reason = "tests")]

mod support;

use gnomon::cause::Cause;
use gnomon::evaluate::{Effort, EvaluateError, Evaluation, evaluate};
use gnomon::technique::map::{bias, filter, projection};
use gnomon::technique::{TechniqueError, Unsupported};
use gnomon::watch::Unwatched;
use std::collections::BTreeMap;
use support::ledger::assert_adds_up;
use support::scenes::shipped;
use support::shot::{Shot, parsed};

const SIZE: [u32; 2] = [48, 36];

/// Wrong pixels of a picture this small that may be left to rounding: the rasteriser's own slope bias, which moments then
/// take to the power of 40, is known to a few units only; measured, 2.
const MOST_ROUNDED: u64 = 3;

/// Combinations that do not go together, of all 672: 84 that reckon with distances where a warped map stores none, 7 that see
/// the light's shape where it is warped, and 73 of a filter with a bias that works otherwise.
const REFUSED: u32 = 164;

/// The answer to a combination, or why there is none.
fn answered<'s>(shot: &'s Shot<'_>, typed: &str) -> Result<Evaluation<'s>, String> {
    match evaluate(&shot.view, &shot.question, &parsed(typed), Effort::CAUSES, &Unwatched) {
        Ok(evaluation) => Ok(evaluation),
        Err(EvaluateError::Technique(TechniqueError::Unsupported(Unsupported::Combination { why }))) => Err(why),
        Err(error) => panic!("{typed}: {error}"),
    }
}

#[test]
fn every_combination_answers_with_a_ledger_that_adds_up_or_says_why_not() {
    let (torus, room) = (shipped("torus", SIZE), shipped("room", SIZE));
    let shots = [Shot::new(&torus, "sun"), Shot::new(&torus, "lamp"), Shot::new(&room, "spot")];
    let mut answers: BTreeMap<&str, u32> = BTreeMap::new();
    let mut refusals: BTreeMap<String, u32> = BTreeMap::new();
    for projection in projection::registry() {
        let plain = format!("map:size=64,projection={}", projection.name());
        let handled: Vec<&Shot<'_>> =
            shots.iter().filter(|shot| shot.evaluate_if_supported(&parsed(&plain)).is_some()).collect();
        for (f, filter) in filter::registry().iter().enumerate() {
            for (b, bias) in bias::registry().iter().enumerate() {
                // Means are not taken across a view's sides.
                let seam = if filter.moments().is_some() { "clamp" } else { "per-tap" };
                let parts = [projection.name(), filter.choice().name, bias.name()];
                let typed = format!("{plain},seam={seam},filter={},bias={}", parts[1], parts[2]);
                // The lights in turn: each is asked of every projection, filter and bias that handles it.
                match answered(handled[(f + b) % handled.len()], &typed) {
                    Ok(evaluation) => {
                        assert_adds_up(&typed, &evaluation);
                        let rounded = evaluation.ledger.causes.get(&Cause::Precision).map_or(0, |share| share.pixels);
                        assert!(rounded <= MOST_ROUNDED, "{typed}: {rounded} wrong pixels are left to rounding");
                        for part in parts {
                            *answers.entry(part).or_default() += 1;
                        }
                    }
                    Err(why) => {
                        assert!(parts.iter().any(|part| why.contains(&format!("={part}"))), "{typed}: {why}");
                        *refusals.entry(why).or_default() += 1;
                    }
                }
            }
        }
    }
    println!("answers: {answers:?}\nrefusals: {refusals:#?}");
    let parts = projection::registry().len() + filter::registry().len() + bias::registry().len();
    assert_eq!(answers.len(), parts, "every part suits some others");
    let refused: u32 = refusals.values().sum();
    assert_eq!(refused, REFUSED, "{refusals:#?}");
}
