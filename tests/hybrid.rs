//! The hybrid of a map and volumes: it is the volumes' answer at silhouettes and the map's elsewhere, and better than a map of
//! four times the texels.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "tests")]

mod support;

use gnomon::cause::Cause;
use gnomon::mask::Visibility;
use gnomon::technique::Unsupported;
use support::scenes::shipped;
use support::shot::{Shot, parsed};

const SIZE: [u32; 2] = [256, 192];
const SHOTS: [(&str, &str); 5] =
    [("torus", "lamp"), ("torus", "sun"), ("fence", "sun"), ("polygons-69", "lamp"), ("room", "spot")];

/// Pixels of the hybrid's mask that are neither the volumes' at silhouettes nor the map's elsewhere.
fn differing(shot: &Shot<'_>, hybrid: &str, map: &str) -> (usize, usize) {
    let masks = [hybrid, map, "volume"].map(|typed| shot.evaluate(typed).mask.pixels);
    let [hybrid, map, volume] = &masks;
    let is_silhouette = |answer: &Visibility| answer.get() > 0.0 && answer.get() < 1.0;
    let expected = map.iter().zip(volume).map(|(map, volume)| match map {
        Some(answer) if is_silhouette(answer) => volume,
        _ => map,
    });
    let silhouettes = map.iter().flatten().filter(|answer| is_silhouette(answer)).count();
    (hybrid.iter().zip(expected).filter(|(found, expected)| *found != *expected).count(), silhouettes)
}

/// HY-1, bit for bit.
#[test]
fn it_is_the_volumes_answer_at_silhouettes_and_the_maps_elsewhere() {
    for (name, light) in SHOTS {
        let scene = shipped(name, SIZE);
        let shot = Shot::new(&scene, light);
        let (others, silhouettes) = differing(&shot, "hybrid", "map:size=256,filter=pcf-box2");
        assert_eq!(others, 0, "{name} {light}");
        assert!(silhouettes > 100, "{name} {light}: {silhouettes}");
        let (widened, more) = differing(&shot, "hybrid:widen_texels=2", "map:size=256,filter=pcf-box6");
        assert!(widened == 0 && more > silhouettes, "{name} {light}: {widened} {more}");
        // Control: another map's answers are others.
        assert!(differing(&shot, "hybrid", "map:size=256,filter=pcf-box2,bias=none").0 > 0, "{name} {light}");
    }
}

/// HY-2, HY-3 and HY-5: what is wrong lies off the silhouettes, of which a finer map has fewer pixels.
#[test]
fn it_errs_where_no_texel_tells_of_a_silhouette() {
    for (name, light) in SHOTS {
        let scene = shipped(name, SIZE);
        let shot = Shot::new(&scene, light);
        let wrong = |typed: &str| shot.evaluate(typed).verdict.pixels.wrong;
        let (hybrid, map) = (wrong("hybrid"), wrong("map:size=512"));
        println!("{name} {light}: hybrid of 256² {hybrid}, map of 512² {map}");
        // The fence's bars are thinner than a texel of 256²: what no texel holds, no silhouette tells of.
        assert_eq!(hybrid < map, name != "fence", "{name} {light}");
        if name == "fence" {
            continue;
        }
        let silhouettes = [64, 256, 1024].map(|size| {
            differing(&shot, &format!("hybrid:size={size}"), &format!("map:size={size},filter=pcf-box2")).1
        });
        assert!(silhouettes.is_sorted_by(|a, b| a > b), "{name} {light}: {silhouettes:?}");
    }
}

/// Bars thinner than a texel that no texel centre meets are missed, and named after the texels.
#[test]
fn a_missed_silhouette_is_named_after_the_texels() {
    let scene = shipped("fence", SIZE);
    let shot = Shot::new(&scene, "sun");
    let coarse = shot.evaluate("hybrid:size=40");
    let aliased = [Cause::EdgeAliasing, Cause::PerspectiveAliasing, Cause::ProjectiveAliasing];
    let by_texels: u64 = aliased.iter().filter_map(|cause| coarse.ledger.causes.get(cause)).map(|s| s.pixels).sum();
    println!("{:?}", coarse.ledger.causes);
    assert!(by_texels > 50 && 10 * by_texels > 5 * coarse.verdict.pixels.wrong, "{:?}", coarse.ledger.causes);
    let facts = coarse.prepared.facts();
    let told = facts.iter().find(|(label, _)| label == "wrong off silhouettes").unwrap();
    assert_eq!(told.1, format!("{} pixels, which the map answers", coarse.verdict.pixels.wrong));
}

#[test]
fn what_does_not_fit_is_refused() {
    let scene = shipped("torus", SIZE);
    let shot = Shot::new(&scene, "sun");
    let filters = "the texels around a receiver are compared, not filtered: map=(...) takes no filter";
    let flags = "the stencil's highest bit marks silhouettes: volume=(...) takes no range_mask=on and no \
                 stencil_ops=clamp";
    for (typed, why) in [
        ("hybrid:map=(volume)", "map=(volume) is no map"),
        ("hybrid:volume=(map)", "volume=(map) is no volume"),
        ("hybrid:map=(map:filter=pcf-box3)", filters),
        ("hybrid:volume=(volume:range_mask=on)", flags),
        ("hybrid:volume=(volume:stencil_ops=clamp)", flags),
    ] {
        let refusal = shot.refusal(&parsed(typed));
        assert_eq!(refusal, Some(Unsupported::Combination { why: why.to_owned() }), "{typed}");
    }
    // Control: other values of the same keys are answered.
    for typed in ["hybrid:map=(map:bias=slope)", "hybrid:volume=(volume:count=mixed,range_mask=off,stencil_ops=wrap)"] {
        assert_eq!(shot.refusal(&parsed(typed)), None, "{typed}");
    }
}
