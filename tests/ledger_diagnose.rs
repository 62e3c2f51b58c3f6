//! What `diagnose` says is measured: the fix that it tried does what it says, side effects included, and where no bias
//! clears both of what bias trades, it says so. And what looks like acne but is none has a statistic of its own.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout, reason = "tests")]

mod support;

use gnomon::cause::Cause;
use gnomon::evaluate::{Evaluation, Outcome, Trials, diagnose, search_bias};
use gnomon::receiver::PixelClass;
use gnomon::scene::Shading;
use gnomon::shade::terminator;
use gnomon::watch::Unwatched;
use support::scenes::shipped;
use support::shot::{Shot, named, parsed};

const SIZE: [u32; 2] = [200, 150];

fn diagnoses(shot: &Shot<'_>, typed: &str, evaluation: &Evaluation<'_>) -> Vec<gnomon::evaluate::Diagnosis> {
    diagnose(&mut Trials::new(&shot.view, &shot.question), &parsed(typed), evaluation, &Unwatched)
        .expect("nobody stops it")
}

#[test]
fn acne_is_diagnosed_with_the_bias_that_clears_it_and_what_that_costs() {
    let scene = shipped("torus", SIZE);
    let shot = Shot::new(&scene, "lamp");
    let typed = "map:size=512,bias=none";
    let evaluation = shot.evaluate(typed);
    let diagnoses = diagnoses(&shot, typed, &evaluation);

    let acne = &diagnoses[0];
    let acne_pixels = named(&evaluation, &[Cause::Acne]);
    assert_eq!((acne.cause, acne.pixels), (Cause::Acne, acne_pixels.len() as u64), "the most frequent comes first");
    assert!(!acne.worst.is_empty() && acne.worst.iter().all(|pixel| acne_pixels.contains(pixel)));
    let (fix, outcome) = &acne.trials[0];
    let after = outcome.as_ref().expect("a closed form always runs");
    assert_eq!(fix.short(), "map:size=512");
    assert!(after.of_cause(Cause::Acne) * 100 < acne.pixels, "{after:?}");
    // What is said of a trial is what the fix really does.
    let fixed = Outcome::of(&shot.evaluate_spec(fix));
    assert_eq!((&fixed.wrong_by_cause, fixed.wrong), (&after.wrong_by_cause, after.wrong));
    // Aliasing is still there: a side that the fix leaves alone.
    let aliasing =
        |outcome: &Outcome| outcome.of_cause(Cause::PerspectiveAliasing) + outcome.of_cause(Cause::EdgeAliasing);
    assert!(aliasing(after) > 0);

    let shares: f64 = diagnoses.iter().map(|diagnosis| diagnosis.share).sum();
    assert!((shares - 1.0).abs() < 1e-12, "{shares}");
    assert!(diagnoses.is_sorted_by(|a, b| a.pixels >= b.pixels));
}

#[test]
fn a_fix_is_reported_with_its_side_effects() {
    let scene = shipped("contact", SIZE);
    let shot = Shot::new(&scene, "sun");
    let typed = "map:size=1024,bias=closed-form,bias_depth_m=0.1";
    let evaluation = shot.evaluate(typed);
    let detached = &diagnoses(&shot, typed, &evaluation)[0];
    assert_eq!(detached.cause, Cause::PeterPanning);
    let outcome_of = |short: &str| {
        let (_, outcome) = detached.trials.iter().find(|(fix, _)| fix.short() == short).expect("a trial");
        outcome.as_ref().expect("it runs")
    };
    assert_eq!(outcome_of("map").of_cause(Cause::PeterPanning), 0, "no metres on top");
    let (finer, before) = (outcome_of("map:size=2048,bias_depth_m=0.1"), Outcome::of(&evaluation));
    assert!(finer.of_cause(Cause::PeterPanning) > 0, "a finer map does not help against metres");
    assert!(finer.cost.bytes > 3 * before.cost.bytes, "and is not free");
}

#[test]
fn at_a_contact_a_coarse_map_needs_a_bias_that_follows_the_plane() {
    let scene = shipped("contact", SIZE);
    let shot = Shot::new(&scene, "sun");
    let searched = |typed: &str| {
        let verdict = search_bias(&mut Trials::new(&shot.view, &shot.question), &parsed(typed), &Unwatched);
        verdict.expect("nobody stops it").expect("maps have a bias")
    };
    let coarse = searched("map:size=32");
    let free = coarse.free_of_both.expect("one that follows the plane, or none at all where there is no second surface");
    assert!(["midpoint", "receiver-plane"].contains(&free.choice("bias").0), "{}", free.short());
    for (spec, own, detached) in &coarse.tried {
        println!("{}: self-shadowing {own}, detached {detached}", spec.short());
        let is_along_the_light = ["none", "slope", "closed-form"].contains(&spec.choice("bias").0);
        assert!(!is_along_the_light || own + detached > 0, "{}", spec.short());
        let measured = Outcome::of(&shot.evaluate_spec(spec));
        assert_eq!(measured.of_cause(Cause::Acne) + measured.of_cause(Cause::Curvature), *own);
        assert_eq!(measured.of_cause(Cause::PeterPanning), *detached);
    }
    assert_eq!(coarse.tried.len(), 9);
    // Control: with finer texels the slope suffices, and whatever bias was typed is not on top of it.
    let fine = searched("map:size=4096,bias=none,bias_depth_m=0.1,bias_normal_texels=3,bias_depth_texels=9");
    let free = fine.free_of_both.expect("a bias");
    let outcome = Outcome::of(&shot.evaluate_spec(&free));
    assert_eq!(outcome.of_cause(Cause::Acne) + outcome.of_cause(Cause::PeterPanning), 0, "{}", free.short());
}

/// The smooth-shading terminator: facets turned away from the light that the interpolated normals would still light. No
/// technique is asked about them, so none is blamed.
#[test]
fn the_terminator_is_counted_apart_from_acne() {
    let mut scene = shipped("torus", SIZE);
    let shot = Shot::new(&scene, "lamp");
    let band = terminator(&scene, &shot.view.receivers, shot.question.light);
    let pixels: Vec<usize> = (0..band.len()).filter(|pixel| band[*pixel]).collect();
    assert!(pixels.len() > 20, "{}", pixels.len());
    assert!(pixels.iter().all(|pixel| shot.question.classes[*pixel] == PixelClass::FacingAway));
    let unbiased = shot.evaluate("map:bias=none");
    assert!(pixels.iter().all(|pixel| unbiased.ledger.cause_of(*pixel as u32).is_none()));
    // Flat shading has none: what one sees there really is the facet's own darkness.
    let receivers = shot.view.receivers.clone();
    let light = shot.question.light.clone();
    drop(unbiased);
    drop(shot);
    scene.shading = Shading::Flat;
    assert!(!terminator(&scene, &receivers, &light).contains(&true));
}

#[test]
fn explain_names_the_terminator() {
    let scene = shipped("torus", SIZE);
    let shot = Shot::new(&scene, "lamp");
    let band = terminator(&scene, &shot.view.receivers, shot.question.light);
    let said_of = |pixel: usize| {
        let at = format!("{},{}", pixel as u32 % SIZE[0], pixel as u32 / SIZE[0]);
        let size = format!("{}x{}", SIZE[0], SIZE[1]);
        let call = std::process::Command::new(assert_cmd::cargo::cargo_bin!("gnomon"))
            .current_dir(env!("CARGO_MANIFEST_DIR"))
            .args(["explain", "scenes/torus", "-t", "map", "--light", "lamp", "--size", &size, "--pixel", &at])
            .output()
            .expect("the program runs");
        assert!(call.status.success(), "{}", String::from_utf8_lossy(&call.stderr));
        String::from_utf8(call.stdout).expect("text")
    };
    let on_it = band.iter().position(|is| *is).expect("a band");
    assert!(said_of(on_it).contains("terminator"));
    let turned_away = |pixel: &usize| shot.question.classes[*pixel] == PixelClass::FacingAway && !band[*pixel];
    let beside_it = (0..band.len()).find(turned_away).expect("a pixel dark for good");
    assert!(!said_of(beside_it).contains("terminator"));
}
