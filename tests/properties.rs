//! What must hold of any scene, and the scenes that are most likely to break it: more blockers never light anything,
//! turning or scaling a scene changes nothing, and every legal scene, however odd, is answered and explained.

#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail by panicking")]
#![allow(clippy::print_stderr, reason = "a skipped scene must be seen")]

mod support;

use glam::{DMat3, DVec3, UVec2, Vec3};
use gnomon::cast::Casters;
use gnomon::evaluate::{Effort, EvaluateError, Question, View, evaluate};
use gnomon::gpu::Gpu;
use gnomon::mask::{Mask, Truth, TruthMask, Visibility};
use gnomon::receiver::PixelClass;
use gnomon::scene::{LightKind, LoadOptions, Placement, Scene, load};
use gnomon::technique::{Spec, TechniqueError};
use gnomon::truth;
use gnomon::watch::Unwatched;
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};
use std::cell::Cell;
use std::collections::BTreeMap;
use std::fs;
use support::outline::{all_edges, pixels_near};
use support::scenes::{
    ask, explained, folder_of, gpu, judged, placed, scene_of_texts, shadowed, shipped, with_triangles,
};

const SMALL: [u32; 2] = [64, 48];
const LIGHTS: [&str; 2] = ["lamp", "sun"];

/// The truth of another scene's casters for the pixels of a question.
fn truth_among(view: &View<'_>, question: &Question<'_>, other: &Scene) -> TruthMask {
    let (receivers, classes) = (&view.receivers, &question.classes);
    truth::exact(other, &Casters::new(other), question.light, receivers, classes, &Unwatched).unwrap().mask
}

fn is_lit_by(truth: &TruthMask, pixel: usize) -> bool {
    truth.pixels[pixel] == Some(Truth::Known(Visibility::LIT))
}

fn is_shadowed_by(truth: &TruthMask, pixel: usize) -> bool {
    truth.pixels[pixel] == Some(Truth::Known(Visibility::SHADOW))
}

/// Some triangle inside the scene's box, which the fit of a map then holds too.
fn occluder(scene: &Scene) -> impl Strategy<Value = [Vec3; 3]> + use<> {
    let bounds = scene.bounds();
    let corner = prop::array::uniform3(0.0..1.0_f64)
        .prop_map(move |share| (bounds.min + DVec3::from(share) * (bounds.max - bounds.min)).as_vec3());
    prop::array::uniform3(corner)
}

#[test]
fn an_occluder_more_never_lights_a_pixel() {
    /// A frustum that no occluder moves: the nearest depth in a texel can then only come closer to the light.
    const FIXED: &str = "map:size=128,fit=manual,width_m=14,pull_back_m=8,near_m=0.5,far_m=20,fov_deg=120,bias=none";
    let gpu = gpu();
    let scene = shipped("triangle", SMALL);
    let view = View::new(&gpu, &scene).unwrap();
    for light in LIGHTS {
        let question = ask(&view, light);
        let before = &question.truth.mask;
        let map_before = judged(&view, &question, FIXED).mask;
        let darkened = Cell::new(0);
        let mut runner = TestRunner::new(Config { cases: 24, failure_persistence: None, ..Config::default() });
        let outcome = runner.run(&occluder(&scene), |corners| {
            let more = with_triangles(&scene, &[corners]);
            let after = truth_among(&view, &question, &more);
            let lighter = (0..before.pixels.len()).filter(|p| is_shadowed_by(before, *p) && is_lit_by(&after, *p));
            prop_assert_eq!(lighter.count(), 0);
            // The same pixels, asked of a map that the occluder was drawn into.
            let with_more = View::new(&gpu, &more).unwrap();
            let job = gnomon::technique::Job {
                receivers: &view.receivers,
                ..with_more.job(question.light, &question.classes)
            };
            let spec = Spec::parse(FIXED).unwrap();
            let map_after = spec.technique().prepare(&spec, job).unwrap().run().unwrap().mask;
            prop_assert!(map_before.pixels.iter().zip(&map_after.pixels).all(|(before, after)| after <= before));
            let newly_dark = |p: &usize| is_lit_by(before, *p) && is_shadowed_by(&after, *p);
            darkened.set(darkened.get() + (0..before.pixels.len()).filter(newly_dark).count());
            Ok(())
        });
        outcome.unwrap();
        assert!(darkened.get() > 100, "{light}: the occluders darkened {} pixels", darkened.get());
        // Control: without its blocker the scene is lighter.
        let mut fewer = scene.clone();
        fewer.meshes.iter_mut().for_each(|mesh| mesh.casts = false);
        let after = truth_among(&view, &question, &fewer);
        assert!((0..before.pixels.len()).any(|p| is_shadowed_by(before, p) && is_lit_by(&after, p)));
    }
}

/// What every pixel came to.
fn kinds(gpu: &Gpu, scene: &Scene, light: &str) -> Vec<(PixelClass, Option<Truth>)> {
    let view = View::new(gpu, scene).unwrap();
    let question = ask(&view, light);
    question.classes.into_iter().zip(question.truth.mask.pixels).collect()
}

fn counts(kinds: &[(PixelClass, Option<Truth>)]) -> BTreeMap<String, usize> {
    let mut counts = BTreeMap::new();
    for kind in kinds {
        *counts.entry(format!("{kind:?}")).or_default() += 1;
    }
    counts
}

#[test]
fn scaling_by_a_power_of_two_changes_no_bit() {
    let gpu = gpu();
    for light in LIGHTS {
        let answers = |exponent: i32| {
            let placement = Placement { scale: 2.0_f64.powi(exponent), translate: DVec3::ZERO };
            let scene = placed("torus", SMALL, placement);
            let view = View::new(&gpu, &scene).unwrap();
            let question = ask(&view, light);
            let mask = judged(&view, &question, "map:size=256,filter=pcf-box2").mask;
            (question.classes.clone(), question.truth.mask.clone(), mask)
        };
        let as_filed = answers(0);
        for exponent in [-20, -3, 1, 10] {
            assert!(answers(exponent) == as_filed, "{light} 2^{exponent}");
        }
    }
}

/// The whole scene turned about Y, rounded once.
fn turned(scene: &Scene, degrees: f64) -> Scene {
    let rotation = DMat3::from_rotation_y(degrees.to_radians());
    let turn = |v: &mut Vec3| *v = (rotation * v.as_dvec3()).as_vec3();
    let mut scene = scene.clone();
    scene.positions.iter_mut().for_each(turn);
    turn(&mut scene.camera.eye);
    turn(&mut scene.camera.target);
    for light in &mut scene.lights {
        match &mut light.kind {
            LightKind::Point { position, aim, .. } => [position, aim].into_iter().for_each(turn),
            LightKind::Directional { towards_light } | LightKind::Sun { towards_light, .. } => turn(towards_light),
            LightKind::Spot { position, axis, .. } => [position, axis].into_iter().for_each(turn),
            LightKind::Rectangle { position, aim, half_width, half_height, .. } => {
                [position, aim, half_width, half_height].into_iter().for_each(turn);
            }
            LightKind::Sphere { position, aim, .. } => [position, aim].into_iter().for_each(turn),
        }
    }
    scene
}

#[test]
fn turning_the_scene_changes_pixels_at_edges_only() {
    /// Corners snapped to 1/256 pixel, and the rounding of turned coordinates, which is less.
    const EDGE_PX: f64 = 1.0 / 128.0;
    /// Pixels at the edge of a shadow, which no list of edges holds here: of 3072.
    const AT_SHADOW_EDGES: usize = 2;
    let gpu = gpu();
    let scene = shipped("torus", SMALL);
    let near_edge = pixels_near(&scene, &all_edges(&scene), EDGE_PX);
    for light in LIGHTS {
        let as_filed = kinds(&gpu, &scene, light);
        let changed = |other: &Scene| {
            let turned = kinds(&gpu, other, light);
            let pixels = turned.iter().zip(&as_filed).zip(&near_edge);
            pixels.filter(|((turned, before), near)| turned != before && !**near).count()
        };
        for degrees in [37.0, 90.0, 180.0, 211.5] {
            let changed = changed(&turned(&scene, degrees));
            assert!(changed <= AT_SHADOW_EDGES, "{light} {degrees}: {changed}");
        }
        // Control: a camera that stays behind sees something else.
        let left_behind = Scene { camera: scene.camera, ..turned(&scene, 37.0) };
        assert!(changed(&left_behind) > 100);
    }
}

#[test]
fn empty_scenes_single_triangles_and_both_windings_are_answered() {
    let gpu = gpu();
    let scene = shipped("triangle", SMALL);
    let mut empty = scene.clone();
    empty.triangles.clear();
    empty.corner_normals.clear();
    empty.triangle_material.clear();
    empty.meshes.clear();
    let view = View::new(&gpu, &empty).unwrap();
    for light in LIGHTS {
        let question = ask(&view, light);
        let verdict = judged(&view, &question, "map:size=64").verdict;
        assert_eq!((verdict.pixels.background, verdict.pixels.total), (64 * 48, 64 * 48), "{light}");
    }

    let [a, b, c] = [Vec3::new(-2.0, 0.0, -2.0), Vec3::new(0.0, 0.0, 2.0), Vec3::new(2.0, 0.0, -2.0)];
    let alone = with_triangles(&empty, &[[a, b, c]]);
    let view = View::new(&gpu, &alone).unwrap();
    for light in LIGHTS {
        let question = ask(&view, light);
        let verdict = explained(&view, &question, "map:size=64").verdict;
        assert!(verdict.pixels.asked > 100, "{light}: {:?}", verdict.pixels);
        assert_eq!((shadowed(&question.truth.mask), verdict.pixels.wrong), (0, 0), "{light}: it cannot shadow itself");
    }

    let mut reversed = scene.clone();
    reversed.triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
    for light in LIGHTS {
        let as_filed = kinds(&gpu, &scene, light);
        assert!(kinds(&gpu, &reversed, light) == as_filed, "{light}");
        assert!(counts(&as_filed).len() >= 3, "{light}: background, lit and shadow are there to differ");
    }
}

#[test]
fn duplicated_triangles_change_nothing() {
    let gpu = gpu();
    let scene = shipped("triangle", SMALL);
    let corners: Vec<[Vec3; 3]> =
        (0..scene.triangles.len() as u32).map(|t| scene.triangle_in_world(t).map(|corner| corner.as_vec3())).collect();
    let turned_round = corners.iter().map(|[a, b, c]| [*c, *b, *a]);
    let doubled = with_triangles(&scene, &corners.iter().copied().chain(turned_round).collect::<Vec<_>>());
    let answers = |scene: &Scene, light: &str| -> (TruthMask, Mask) {
        let view = View::new(&gpu, scene).unwrap();
        let question = ask(&view, light);
        let mask = explained(&view, &question, "map:size=256,filter=pcf-box3").mask;
        (question.truth.mask, mask)
    };
    for light in LIGHTS {
        assert!(answers(&doubled, light) == answers(&scene, light), "{light}");
    }
}

const HEAD: &str = r#"about = "an extreme"
size = [64, 48]
[camera]
eye = [0, 4, 6]
target = [0, 0, 0]
[[mesh]]
file = "model.obj"
"#;
const FLOOR: &str = "o Floor\nv -4 0 -4\nv -4 0 4\nv 4 0 4\nv 4 0 -4\nf 1 2 3 4\n";
const LAMP: &str = "[[light]]\nname = \"lamp\"\nkind = \"point\"\nposition = [0.5, 5, 1]\n";
/// Above the floor, level.
const TRIANGLE: &str = "o Triangle\nv -1 1 -1\nv 0 1 1\nv 1 1 -1\nf 5 6 7\n";

#[test]
fn a_hundred_thousand_identical_triangles_are_one() {
    let gpu = gpu();
    let one = FLOOR.to_owned() + TRIANGLE;
    let many = FLOOR.to_owned() + TRIANGLE + &"f 5 6 7\n".repeat(99_999);
    let answers = |model: &str| {
        let scene = scene_of_texts(&format!("{HEAD}{LAMP}"), model);
        let view = View::new(&gpu, &scene).unwrap();
        let question = ask(&view, "lamp");
        let evaluation = explained(&view, &question, "map:size=128");
        (scene.triangles.len(), question.classes.clone(), question.truth.mask.clone(), evaluation.mask)
    };
    let (few, many) = (answers(&one), answers(&many));
    assert_eq!((few.0, many.0), (3, 100_002));
    assert!((few.1, few.2, few.3) == (many.1, many.2, many.3));
}

/// Puts every light of a scene to a map, causes included: how many pixels were asked about each, `None` where a single
/// map does not apply.
fn answered(gpu: &Gpu, scene: &Scene, typed: &str) -> Vec<Option<u64>> {
    let view = View::new(gpu, scene).unwrap();
    let answer = |name: &str| {
        let question = ask(&view, name);
        assert!(question.brute_disagreements.is_empty(), "{:?}", question.brute_disagreements);
        match evaluate(&view, &question, &Spec::parse(typed).unwrap(), Effort::CAUSES, &Unwatched) {
            Ok(evaluation) => Some(evaluation.verdict.pixels.asked),
            Err(EvaluateError::Technique(TechniqueError::Unsupported(_))) => None,
            Err(error) => panic!("{} {name}: {error}", scene.name),
        }
    };
    scene.lights.iter().map(|light| answer(&light.name)).collect()
}

#[test]
fn lights_and_cameras_in_the_worst_places_are_answered() {
    /// As wide as it takes: from beside a level blocker its corners are at right angles to the way down.
    const WIDE: &str = "map:size=64,fov_deg=150";
    let gpu = gpu();
    let model = FLOOR.to_owned() + TRIANGLE;
    let lamp_at =
        |position: &str| format!("{HEAD}[[light]]\nname = \"lamp\"\nkind = \"point\"\nposition = {position}\n");
    // On a corner of the blocker, on its edge, in its plane beside it, inside it; and high above.
    for position in ["[0, 1, 1]", "[0, 1, -1]", "[3, 1, 0]", "[0, 1, 0]", "[0, 5, 0]"] {
        let asked = answered(&gpu, &scene_of_texts(&lamp_at(position), &model), WIDE);
        assert!(asked[0] > Some(100), "{position}: {asked:?}");
    }
    // In the floor's plane everything there faces away.
    let on_floor = scene_of_texts(&lamp_at("[1, 0, 1]"), FLOOR);
    assert_eq!(answered(&gpu, &on_floor, WIDE), [Some(0)]);
    // At the eye no shadow can be seen.
    let at_eye = scene_of_texts(&lamp_at("[0, 4, 6]"), &model);
    let view = View::new(&gpu, &at_eye).unwrap();
    assert_eq!(shadowed(&ask(&view, "lamp").truth.mask), 0);
    // The camera on the blocker, on its corner, and on the floor.
    for eye in ["[0, 1, 0]", "[0, 1, 1]", "[2, 0, 2]"] {
        let head = HEAD.replace("eye = [0, 4, 6]", &format!("eye = {eye}"));
        let scene = format!("{head}{LAMP}").replace("target = [0, 0, 0]", "target = [0.1, -3, 0.1]");
        assert!(answered(&gpu, &scene_of_texts(&scene, &model), WIDE)[0].is_some(), "{eye}");
    }
}

#[test]
fn where_nothing_is_asked_ratios_are_null() {
    let gpu = gpu();
    let nothing_receives = HEAD.replace("file = \"model.obj\"", "file = \"model.obj\"\nreceives = false");
    let from_below = format!("{HEAD}[[light]]\nname = \"lamp\"\nkind = \"point\"\nposition = [0, -5, 0]\n");
    for text in [format!("{nothing_receives}{LAMP}"), from_below] {
        let scene = scene_of_texts(&text, FLOOR);
        let view = View::new(&gpu, &scene).unwrap();
        let question = ask(&view, "lamp");
        let verdict = explained(&view, &question, "map:size=64").verdict;
        assert_eq!((verdict.pixels.asked, verdict.pixels.wrong), (0, 0));
        assert_eq!((verdict.error.mean_abs, verdict.error.signed, verdict.error.wrong_fraction), (None, None, None));
    }
    // Control: with something asked they are numbers.
    let scene = scene_of_texts(&format!("{HEAD}{LAMP}"), FLOOR);
    let view = View::new(&gpu, &scene).unwrap();
    let question = ask(&view, "lamp");
    assert_eq!(judged(&view, &question, "map:size=64").verdict.error.wrong_fraction, Some(0.0));
}

#[test]
fn every_shipped_scene_is_answered_and_explained() {
    let gpu = gpu();
    let names = fs::read_dir(folder_of("")).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut run = 0;
    for name in names.filter(|name| folder_of(name).join("scene.toml").exists()) {
        let fetched = format!("{name}.obj");
        if ["kitchen", "bunny"].contains(&name.as_str()) && !folder_of(&name).join(&fetched).exists() {
            eprintln!("skipped: scenes/{name} lacks {fetched}; `make setup` fetches it");
            continue;
        }
        let options = LoadOptions { size: Some(UVec2::from_array(SMALL)), ..LoadOptions::default() };
        let scene = load(&folder_of(&name), &options).unwrap_or_else(|error| panic!("{error}"));
        for budget in &scene.budgets {
            assert!(Spec::parse(&budget.technique).is_ok(), "{name}: {}", budget.technique);
        }
        for (light, asked) in scene.lights.iter().zip(answered(&gpu, &scene, "map:size=64")) {
            match asked {
                Some(asked) => assert!(asked > 100, "{name} {}: {asked} pixels", light.name),
                // Receivers all around a lamp fit in no single map.
                None => assert!(matches!(light.kind, LightKind::Point { .. }), "{name} {}", light.name),
            }
            run += u32::from(asked.is_some());
        }
    }
    assert!(run >= 12, "{run} lights were answered");
}
