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
        let plain = format!("map:size=64,seam=clamp,projection={}", projection.name());
        let handled: Vec<&Shot<'_>> =
            shots.iter().filter(|shot| shot.evaluate_if_supported(&parsed(&plain)).is_some()).collect();
        for (f, filter) in filter::registry().iter().enumerate() {
            for (b, bias) in bias::registry().iter().enumerate() {
                let typed = format!("{plain},filter={},bias={}", filter.choice().name, bias.name());
                // The lights in turn: each is asked of every projection, filter and bias that handles it.
                match answered(handled[(f + b) % handled.len()], &typed) {
                    Ok(evaluation) => {
                        assert_adds_up(&typed, &evaluation);
                        let rounded = evaluation.ledger.causes.get(&Cause::Precision).map_or(0, |share| share.pixels);
                        assert!(rounded <= MOST_ROUNDED, "{typed}: {rounded} wrong pixels are left to rounding");
                        for part in [projection.name(), filter.choice().name, bias.name()] {
                            *answers.entry(part).or_default() += 1;
                        }
                    }
                    Err(why) => *refusals.entry(why).or_default() += 1,
                }
            }
        }
    }
    println!("answers: {answers:?}\nrefusals: {refusals:#?}");
    let parts = projection::registry().len() + filter::registry().len() + bias::registry().len();
    assert_eq!(answers.len(), parts, "every part suits some others");
    assert!(refusals.keys().all(|why| why.contains('=')), "a refusal names what does not fit: {refusals:#?}");
}
