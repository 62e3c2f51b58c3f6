//! Error by view and by distance to the seam: what goes wrong at seams shows in the bins next to them, and nowhere else.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout, reason = "tests")]

mod support;

use gnomon::evaluate::Evaluation;
use gnomon::mask::Visibility;
use gnomon::technique::InView;
use gnomon::verdict::{Seams, WRONG_ABOVE_HARD, seams};
use support::models::boxes_on_diagonals;
use support::scenes::{shipped, verdict_on};
use support::shot::Shot;

fn seams_of(evaluation: &Evaluation<'_>) -> Seams {
    let seams = evaluation.seams(WRONG_ABOVE_HARD).expect("several views");
    let asked: u64 = seams.views.iter().map(|view| view.error.asked).sum();
    assert_eq!(asked, evaluation.verdict.pixels.asked, "every pixel belongs to a view");
    let wrong: u64 = seams.distances.iter().map(|bin| bin.error.wrong).sum();
    assert_eq!(wrong, evaluation.verdict.pixels.wrong, "and to a distance");
    seams
}

/// CU-4: what a kernel's taps beyond their view read makes a difference up to the kernel's radius from the seam, and
/// nowhere else. (That it makes it worse is tests/map_cube.rs.)
#[test]
fn taps_that_are_clamped_to_their_view_show_next_to_its_sides() {
    /// Bins end at 1, 2 and 4 texels; the kernel's radius is 3½.
    const REACHED: usize = 3;
    let scene = boxes_on_diagonals();
    let shot = Shot::new(&scene, "lamp");
    for projection in ["cube", "dual-paraboloid"] {
        let typed = |seam: &str| format!("map:projection={projection},size=64,filter=pcf-box7,seam={seam}");
        let [chosen, clamped] = ["per-tap", "clamp"].map(|seam| seams_of(&shot.evaluate(&typed(seam))));
        for (bin, (a, b)) in chosen.distances.iter().zip(&clamped.distances).enumerate() {
            println!("{projection} from {} texels: {:?} {:?}", a.from_texels, a.error, b.error);
            assert!(bin < REACHED || a.error == b.error);
        }
        assert!((0..REACHED).all(|bin| chosen.distances[bin].error != clamped.distances[bin].error), "{projection}");
    }
}

/// CA-2: an error that is planted at the splits shows in the bin next to them and in the views that it was planted in.
#[test]
fn an_error_planted_at_a_split_shows_there_and_nowhere_else() {
    let scene = shipped("posts", [256, 192]);
    let shot = Shot::new(&scene, "sun");
    let room = boxes_on_diagonals();
    let lamp = Shot::new(&room, "lamp");
    for (shot, typed) in [
        (&shot, "map:projection=cascaded,size=512"),
        (&shot, "map:projection=cascaded,size=512,selection=by-projection"),
        (&lamp, "map:projection=cube,size=100"),
    ] {
        let evaluation = shot.evaluate(typed);
        let found = seams_of(&evaluation);
        let (mut mask, mut planted) = (evaluation.mask.clone(), 0);
        let mut places: Vec<Option<InView>> = vec![None; mask.pixels.len()];
        for pixel in shot.asked() {
            let place = evaluation.prepared.in_view(pixel).unwrap();
            places[pixel as usize] = Some(place);
            let is_right = !evaluation.verdict.is_wrong(pixel as usize);
            if place.view == 1 && place.seam_texels.unwrap() < 1.0 && is_right {
                let answer = mask.pixels[pixel as usize].as_mut().unwrap();
                *answer = if answer.get() > 0.5 { Visibility::SHADOW } else { Visibility::LIT };
                planted += 1;
            }
        }
        assert!(planted > 10, "{typed}: {planted}");
        let verdict = verdict_on(&mask, &shot.question);
        let names = evaluation.prepared.view_names();
        let spoilt = seams(&names, &places, &verdict.signed_error, WRONG_ABOVE_HARD);
        for (bin, (before, after)) in found.distances.iter().zip(&spoilt.distances).enumerate() {
            println!("{typed} from {} texels: {:?} {:?}", before.from_texels, before.error, after.error);
            assert_eq!(after.error.wrong - before.error.wrong, if bin == 0 { planted } else { 0 });
        }
        for (view, (before, after)) in found.views.iter().zip(&spoilt.views).enumerate() {
            assert_eq!(after.error.wrong - before.error.wrong, if view == 1 { planted } else { 0 });
        }
    }
}

#[test]
fn one_view_has_no_seam() {
    let scene = shipped("triangle", [64, 48]);
    let shot = Shot::new(&scene, "lamp");
    assert_eq!(shot.evaluate("map").seams(WRONG_ABOVE_HARD), None);
    assert_eq!(shot.evaluate("volume").seams(WRONG_ABOVE_HARD), None);
}
