//! Checks that cannot fail prove nothing: each fault planted here must turn a check that passes into one that fails.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

mod support;

use glam::{DVec2, Vec3};
use gnomon::cast::Casters;
use gnomon::evaluate::{Question, View};
use gnomon::mask::{Mask, TruthMask, Visibility};
use gnomon::receiver::Receiver;
use gnomon::scene::{LightKind, Scene};
use gnomon::technique::map::{Lookup, Placed};
use gnomon::truth;
use gnomon::verdict::{WRONG_ABOVE_HARD, judge};
use gnomon::watch::Unwatched;
use support::outline::{MappedOutline, band_texels, mesh};
use support::scenes::{as_mask, ask, explained, gpu, judged, shadowed, shipped, verdict_on};

/// Square, so that its axes can be swapped.
const SIZE: [u32; 2] = [320, 320];
const SPEC: &str = "map:size=4096";

/// The check: the scene's own budget on the share of wrong pixels.
fn passes(scene: &Scene, question: &Question<'_>, mask: &Mask) -> bool {
    within_budget(scene, question, &question.truth.mask, mask)
}

fn within_budget(scene: &Scene, question: &Question<'_>, truth: &TruthMask, mask: &Mask) -> bool {
    let verdict = judge(&question.classes, truth, mask, WRONG_ABOVE_HARD).unwrap();
    verdict.error.wrong_fraction <= scene.budgets[0].wrong_fraction
}

/// The mask with every pixel taken from where `from` says; where that was not asked the pixel keeps its own answer.
fn rearranged(mask: &Mask, from: impl Fn(u32, u32) -> (u32, u32)) -> Mask {
    let answer = |x: u32, y: u32| mask.pixels[(y * mask.size.x + x) as usize];
    let places = (0..mask.size.y).flat_map(|y| (0..mask.size.x).map(move |x| (x, y)));
    let pixels = places.map(|(x, y)| {
        let (from_x, from_y) = from(x, y);
        answer(x, y).and(answer(from_x.min(mask.size.x - 1), from_y.min(mask.size.y - 1)).or(answer(x, y)))
    });
    Mask { size: mask.size, pixels: pixels.collect() }
}

/// Where a pixel's answer is taken from.
type Source = fn(u32, u32) -> (u32, u32);

#[test]
fn a_mask_in_the_wrong_place_fails() {
    let gpu = gpu();
    let scene = shipped("triangle", SIZE);
    let view = View::new(&gpu, &scene).unwrap();
    for light in ["lamp", "sun"] {
        let question = ask(&view, light);
        let mask = judged(&view, &question, SPEC).mask;
        assert!(passes(&scene, &question, &mask), "{light}");
        assert!(passes(&scene, &question, &rearranged(&mask, |x, y| (x, y))), "{light}");
        let shifts: [Source; 4] =
            [|x, y| (x + 1, y), |x, y| (x.saturating_sub(1), y), |x, y| (x, y + 1), |x, y| (x, y.saturating_sub(1))];
        for shift in shifts {
            assert!(!passes(&scene, &question, &rearranged(&mask, shift)), "{light}: shifted");
        }
        assert!(!passes(&scene, &question, &rearranged(&mask, |x, y| (y, x))), "{light}: axes swapped");
        assert!(!passes(&scene, &question, &rearranged(&mask, |x, y| (x, SIZE[1] - 1 - y))), "{light}: upside down");
    }
}

#[test]
fn the_other_lights_mask_fails() {
    let gpu = gpu();
    let scene = shipped("triangle", SIZE);
    let view = View::new(&gpu, &scene).unwrap();
    let (lamp, sun) = (ask(&view, "lamp"), ask(&view, "sun"));
    // What only one light asks about is answered correctly, so that just the mix-up is left to be seen.
    let mixed_up = |own: &Question<'_>, other: &Question<'_>| {
        let (mask, correct) = (judged(&view, other, SPEC).mask, as_mask(&own.truth.mask));
        let pixels = mask.pixels.iter().zip(&correct.pixels).map(|(mask, own)| own.and(mask.or(*own)));
        Mask { size: mask.size, pixels: pixels.collect() }
    };
    assert!(passes(&scene, &lamp, &mixed_up(&lamp, &lamp)));
    assert!(!passes(&scene, &lamp, &mixed_up(&lamp, &sun)));
    assert!(!passes(&scene, &sun, &mixed_up(&sun, &lamp)));
}

#[test]
fn no_bias_fails() {
    let gpu = gpu();
    let scene = shipped("triangle", SIZE);
    let view = View::new(&gpu, &scene).unwrap();
    for light in ["lamp", "sun"] {
        let question = ask(&view, light);
        let mask = |bias: &str| judged(&view, &question, &format!("{SPEC},bias={bias}")).mask;
        assert!(passes(&scene, &question, &mask("closed-form")), "{light}");
        assert!(!passes(&scene, &question, &mask("none")), "{light}");
    }
}

/// The scene with both of its lights moved: the lamp by `step_m`, the sun as if it stood at the lamp's distance.
fn with_lights_moved(scene: &Scene, step_m: f32) -> Scene {
    let mut moved = scene.clone();
    for light in &mut moved.lights {
        match &mut light.kind {
            LightKind::Point { position, .. }
            | LightKind::Spot { position, .. }
            | LightKind::Rectangle { position, .. }
            | LightKind::Sphere { position, .. } => position.x += step_m,
            LightKind::Directional { towards_light } | LightKind::Sun { towards_light, .. } => {
                *towards_light = (*towards_light + Vec3::X * step_m / 4.0).normalize();
            }
        }
    }
    moved
}

/// The truth of another scene's casters and light for the pixels of a question.
fn truth_of_other(view: &View<'_>, question: &Question<'_>, other: &Scene) -> TruthMask {
    let light = other.light(&question.light.name).unwrap();
    let (receivers, classes) = (&view.receivers, &question.classes);
    truth::exact(other, &Casters::new(other), light, receivers, classes, &Unwatched).unwrap().mask
}

/// The finer check of a map's errors: each wrong pixel lies within half a texel's diagonal of the edge.
fn errs_at_the_edge_only(view: &View<'_>, question: &Question<'_>, truth: &TruthMask, mask: &Mask) -> bool {
    let verdict = judge(&question.classes, truth, mask, WRONG_ABOVE_HARD).unwrap();
    let mapped = MappedOutline::new(view.scene, question.light, SPEC);
    let wrong = (0..mask.pixels.len()).filter(|pixel| verdict.is_wrong(*pixel));
    let mut wrong = wrong.filter_map(|pixel| view.receivers.pixels[pixel]);
    wrong.all(|receiver| mapped.texels_from_edge(receiver.point_in_world) <= band_texels(1.0))
}

#[test]
fn a_light_moved_by_a_centimetre_fails() {
    let gpu = gpu();
    let scene = shipped("triangle", SIZE);
    let view = View::new(&gpu, &scene).unwrap();
    for light in ["lamp", "sun"] {
        let question = ask(&view, light);
        let mask = judged(&view, &question, SPEC).mask;
        let passes = |step_m: f32| {
            let truth = truth_of_other(&view, &question, &with_lights_moved(&scene, step_m));
            errs_at_the_edge_only(&view, &question, &truth, &mask)
        };
        assert!(passes(0.0), "{light}");
        assert!(!passes(0.01), "{light}");
    }
}

#[test]
fn the_truth_of_another_mesh_fails() {
    let gpu = gpu();
    let scene = shipped("triangle", SIZE);
    let view = View::new(&gpu, &scene).unwrap();
    let mut without_blocker = scene.clone();
    without_blocker.meshes.iter_mut().for_each(|mesh| mesh.casts &= mesh.name != "Triangle");
    let mut bent = scene.clone();
    let corner = scene.triangles[mesh(&scene, "Triangle").triangles.start as usize][0];
    bent.positions[corner as usize].y += 0.2;
    for light in ["lamp", "sun"] {
        let question = ask(&view, light);
        let mask = judged(&view, &question, SPEC).mask;
        let judged_by =
            |other: &Scene| within_budget(&scene, &question, &truth_of_other(&view, &question, other), &mask);
        assert!(judged_by(&scene), "{light}");
        assert!(!judged_by(&without_blocker), "{light}: a triangle is missing");
        assert!(!judged_by(&bent), "{light}: a corner is elsewhere");
        // The casters can be told apart, so a report can prove that the truth was given the right ones.
        let hashes = [&scene, &without_blocker, &bent].map(|scene| Casters::new(scene).content_hash());
        assert!(hashes[0] != hashes[1] && hashes[0] != hashes[2] && hashes[1] != hashes[2]);
    }
}

#[test]
fn a_perfect_mask_has_no_wrong_pixel_and_one_flipped_pixel_is_seen() {
    let gpu = gpu();
    let scene = shipped("triangle", SIZE);
    let view = View::new(&gpu, &scene).unwrap();
    let question = ask(&view, "lamp");
    let mut mask = as_mask(&question.truth.mask);
    let perfect = verdict_on(&mask, &question);
    assert_eq!((perfect.pixels.wrong, perfect.pixels.differing, perfect.error.mean_abs), (0, 0, Some(0.0)));
    assert!(shadowed(&question.truth.mask) > 1_000, "a truth without shadow could not be missed");

    let flipped = mask.pixels.iter().position(|answer| *answer == Some(Visibility::SHADOW)).unwrap();
    mask.pixels[flipped] = Some(Visibility::LIT);
    let verdict = verdict_on(&mask, &question);
    assert_eq!((verdict.pixels.wrong, verdict.pixels.false_light, verdict.error.largest_blob_px), (1, 1, 1));
    assert!(verdict.is_wrong(flipped) && verdict.error.edge_distance_px.is_some());
}

/// The map technique once more, from its f64 twin and rays through the texels' centres, with room for a fault: `texel`
/// may read another place of the map, `is_lit` may compare otherwise.
fn twin(
    view: &View<'_>,
    question: &Question<'_>,
    texel: impl Fn(DVec2) -> DVec2,
    is_lit: impl Fn(&Lookup, f64, f64) -> bool,
) -> Mask {
    let lookup = MappedOutline::new(view.scene, question.light, "map:size=512").lookup;
    let cleared = lookup.views[0].cleared();
    let bounds = view.scene.bounds();
    let visibility = |receiver: &Receiver| {
        let Ok(Placed { position_in_texels, reference, .. }) =
            lookup.place(0, receiver.point_in_world, receiver.normal_in_world)
        else {
            return Visibility::LIT;
        };
        let stored = lookup.ray_through(0, texel(position_in_texels).floor() + 0.5, &bounds).map_or(cleared, |ray| {
            let hit = view.casters.nearest_hit(&ray, None);
            hit.map_or(cleared, |hit| lookup.views[0].project(ray.from.lerp(ray.to, hit.t)).depth)
        });
        if is_lit(&lookup, reference, stored) { Visibility::LIT } else { Visibility::SHADOW }
    };
    let pixels = view.receivers.pixels.iter().zip(&question.truth.mask.pixels);
    let pixels = pixels.map(|(receiver, truth)| truth.and(receiver.as_ref()).map(&visibility)).collect();
    Mask { size: view.receivers.size, pixels }
}

fn differences(a: &Mask, b: &Mask) -> usize {
    a.pixels.iter().zip(&b.pixels).filter(|(a, b)| a != b).count()
}

#[test]
fn a_mutated_lookup_is_not_the_shaders() {
    /// Pixels of 102 400 that rounding in f32 and the rasteriser's snapping may decide otherwise.
    const PRECISION_PX: usize = 10;
    let gpu = gpu();
    let scene = shipped("triangle", SIZE);
    let view = View::new(&gpu, &scene).unwrap();
    for light in ["lamp", "sun"] {
        let question = ask(&view, light);
        let by_shader = judged(&view, &question, "map:size=512").mask;
        let off_by = |twin: &Mask| differences(twin, &by_shader);
        let right = |lookup: &Lookup, reference, stored| lookup.is_lit(0, reference, stored);
        let off = off_by(&twin(&view, &question, |at| at, right));
        assert!(off <= PRECISION_PX, "{light}: {off}");
        let other_convention =
            |lookup: &Lookup, reference, stored| !lookup.is_lit(0, reference, stored) || reference == stored;
        let faults = [
            ("depth compared the other way round", twin(&view, &question, |at| at, other_convention)),
            ("half a texel aside", twin(&view, &question, |at| at + 0.5, right)),
            ("v not flipped", twin(&view, &question, |at| DVec2::new(at.x, 512.0 - at.y), right)),
            ("u and v swapped", twin(&view, &question, |at| DVec2::new(at.y, at.x), right)),
        ];
        for (fault, mask) in &faults {
            assert!(off_by(mask) > 5 * PRECISION_PX, "{light}, {fault}: {}", off_by(mask));
        }
    }
}

#[test]
fn a_replay_of_something_else_explains_nothing() {
    let gpu = gpu();
    let scene = shipped("triangle", SIZE);
    let view = View::new(&gpu, &scene).unwrap();
    let question = ask(&view, "sun");
    let evaluation = explained(&view, &question, "map:size=128");
    let book = |truth: &TruthMask, mask: &Mask| {
        let verdict = judge(&question.classes, truth, mask, WRONG_ABOVE_HARD).unwrap();
        gnomon::verdict::ledger(&verdict, truth, mask, &evaluation.replay)
    };
    assert_eq!(book(&question.truth.mask, &evaluation.mask), Ok(evaluation.ledger.clone()));
    let other_mask = judged(&view, &question, "map:size=64").mask;
    assert!(book(&question.truth.mask, &other_mask).is_err());
    assert!(book(&truth_of_other(&view, &question, &with_lights_moved(&scene, 0.3)), &evaluation.mask).is_err());
}
