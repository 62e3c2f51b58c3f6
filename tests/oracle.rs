//! The exact truth against Mitsuba, which nobody here wrote: every shadow ray of every shipped scene, at every scale;
//! area lights point by point and against an independent estimate. `make oracle` installs it.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout, reason = "tests")]

mod support;

use glam::{DVec3, UVec2, Vec3};
use gnomon::cast::Casters;
use gnomon::evaluate::{Question, View};
use gnomon::gpu::Gpu;
use gnomon::mask::TruthMask;
use gnomon::scene::{Emitter, Light, LightKind, LoadOptions, Placement, Scene, load};
use gnomon::truth::mitsuba::{Mitsuba, MitsubaCheck, MitsubaError, Reason};
use gnomon::watch::Unwatched;
use std::path::Path;
use support::scenes::shipped;
use support::shot::shipped_scenes;

/// One ray in a million.
const RAYS_PER_DISAGREEMENT: u64 = 1_000_000;
/// Contacts are as long as edges between surfaces in the picture; of a thousand rays one lies in one.
const RAYS_PER_CONTACT: u64 = 1000;

fn mitsuba(view: &View<'_>) -> Mitsuba {
    Mitsuba::new(view.scene, &view.casters).expect("`make oracle` installs Mitsuba")
}

fn check(mitsuba: &mut Mitsuba, view: &View<'_>, light: &Light) -> MitsubaCheck {
    let classes = view.receivers.classify(view.scene, light);
    mitsuba.check(view.scene, &view.casters, light, &view.receivers, &classes, &Unwatched).unwrap()
}

/// At most one ray in a million differs; each lies within f32 error of an edge, and exact arithmetic confirms the truth.
fn assert_agrees(what: &str, check: &MitsubaCheck) {
    let disagreements: Vec<_> = check.disagreements().collect();
    println!("{what}: {} of {} rays, {} contacts", disagreements.len(), check.rays, check.contacts());
    assert!(disagreements.len() as u64 <= check.rays.div_ceil(RAYS_PER_DISAGREEMENT), "{what}: {disagreements:?}");
    assert!(disagreements.iter().all(|ray| matches!(ray.reason, Reason::Edge { .. })), "{what}: {disagreements:?}");
    assert!(disagreements.iter().all(|ray| ray.confirmed), "{what}: {disagreements:?}");
    assert!(check.contacts() as u64 <= check.rays.div_ceil(RAYS_PER_CONTACT), "{what}: {} contacts", check.contacts());
}

#[test]
fn every_ray_of_every_shipped_scene_is_answered_alike() {
    let gpu = Gpu::open().unwrap();
    let (mut lights, mut rays) = (0, 0);
    for scene in shipped_scenes(UVec2::splat(1024)) {
        let view = View::new(&gpu, &scene).unwrap();
        let mut mitsuba = mitsuba(&view);
        for light in scene.lights.iter().filter(|light| !light.is_area()) {
            let check = check(&mut mitsuba, &view, light);
            assert_agrees(&format!("{} / {}", scene.name, light.name), &check);
            (lights, rays) = (lights + 1, rays + check.rays);
        }
    }
    println!("{rays} rays of {lights} lights");
    assert!(lights >= 14 && rays > 5_000_000, "{rays} rays of {lights} lights");
}

#[test]
fn area_lights_are_answered_alike_point_by_point_and_by_an_independent_estimate() {
    let gpu = Gpu::open().unwrap();
    for name in ["area", "sundial"] {
        let scene = shipped(name, [256, 192]);
        let view = View::new(&gpu, &scene).unwrap();
        let mut mitsuba = mitsuba(&view);
        for light in &scene.lights {
            let what = format!("{name} / {}", light.name);
            let question = view.ask(light, &Unwatched).unwrap();
            let check = check(&mut mitsuba, &view, light);
            assert_agrees(&what, &check);
            let settled = check.listed.iter().map(|ray| ray.pixel).collect::<Vec<_>>();
            let differing = differing(&question.truth.mask, &check.mask);
            assert!(differing.iter().all(|pixel| settled.contains(pixel)), "{what}: counts differ where no ray does");
            assert_eq!(rejected(&mut mitsuba, &view, light, &question.truth.mask), [0_u32; 0], "{what}");
        }
    }
}

/// The estimate may miss the count by what the discrepancy of 36 points allows, 1/12, and by its noise among 10⁵ pixels: of
/// a light half a metre wide a centimetre is a fiftieth, and no test can see it. These are about a centimetre wide.
#[test]
fn an_estimate_of_a_light_moved_by_a_centimetre_is_rejected() {
    const SHRUNK: f32 = 1.0 / 64.0;
    let gpu = Gpu::open().unwrap();
    let scene = shipped("area", [512, 384]);
    let view = View::new(&gpu, &scene).unwrap();
    let mut mitsuba = mitsuba(&view);
    for light in &scene.lights {
        let small = shrunk(light, SHRUNK);
        let question = view.ask(&small, &Unwatched).unwrap();
        let truth = &question.truth.mask;
        assert_eq!(rejected(&mut mitsuba, &view, &small, truth), [0_u32; 0], "area / {}", light.name);
        let of_moved = rejected(&mut mitsuba, &view, &moved(&small, 0.01), truth).len();
        println!("area / {}: {of_moved} pixels", light.name);
        assert!(of_moved > 10, "area / {}: rejected at {of_moved} pixels only", light.name);
    }
}

#[test]
fn an_estimate_of_a_sun_turned_by_its_own_radius_is_rejected() {
    let gpu = Gpu::open().unwrap();
    let scene = shipped("sundial", [256, 192]);
    let view = View::new(&gpu, &scene).unwrap();
    let mut mitsuba = mitsuba(&view);
    let (sun, question) = (&scene.lights[0], view.ask(&scene.lights[0], &Unwatched).unwrap());
    let mut turned = sun.clone();
    let LightKind::Sun { towards_light, angular_radius_rad, .. } = &mut turned.kind else { panic!("a sun") };
    let aside = towards_light.any_orthonormal_vector();
    *towards_light = (*towards_light + aside * *angular_radius_rad as f32).normalize();
    let of_turned = rejected(&mut mitsuba, &view, &turned, &question.truth.mask).len();
    assert!(of_turned > 10, "rejected at {of_turned} pixels only");
}

/// Pixels at which the counted shares and an estimate of a light cannot both be right.
fn rejected(mitsuba: &mut Mitsuba, view: &View<'_>, light: &Light, truth: &TruthMask) -> Vec<u32> {
    let estimate = mitsuba.estimate(view.scene, &view.casters, light, &view.receivers, truth).unwrap();
    estimate.expect("an area light").rejected
}

/// The area light, with sides or radius times a factor.
fn shrunk(light: &Light, factor: f32) -> Light {
    let mut shrunk = light.clone();
    match &mut shrunk.kind {
        LightKind::Rectangle { half_width, half_height, .. } => {
            *half_width *= factor;
            *half_height *= factor;
        }
        LightKind::Sphere { radius_m, .. } => *radius_m *= factor,
        LightKind::Sun { angular_radius_rad, .. } => *angular_radius_rad *= f64::from(factor),
        LightKind::Point { .. } | LightKind::Directional { .. } | LightKind::Spot { .. } => {}
    }
    shrunk
}

/// Pixels that two masks answer differently.
fn differing(a: &TruthMask, b: &TruthMask) -> Vec<u32> {
    (0..).zip(a.pixels.iter().zip(&b.pixels)).filter(|(_, (a, b))| a != b).map(|(pixel, _)| pixel).collect()
}

/// The light, moved along x.
fn moved(light: &Light, step_m: f32) -> Light {
    let mut moved = light.clone();
    match &mut moved.kind {
        LightKind::Point { position, .. }
        | LightKind::Spot { position, .. }
        | LightKind::Rectangle { position, .. }
        | LightKind::Sphere { position, .. } => *position += Vec3::X * step_m,
        LightKind::Directional { towards_light } | LightKind::Sun { towards_light, .. } => {
            *towards_light = (*towards_light + Vec3::X * step_m).normalize();
        }
    }
    moved
}

#[test]
fn scale_and_place_change_no_answer() {
    let gpu = Gpu::open().unwrap();
    let placements = [1e-6, 1e-3, 1.0, 1e3, 1e6].map(|scale| Placement { scale, translate: DVec3::ZERO });
    let far = Placement { scale: 1.0, translate: DVec3::new(1e6, -1e6, 1e6) };
    for placement in placements.into_iter().chain([far]) {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/triangle");
        let scene = load(&folder, &LoadOptions { size: Some(UVec2::new(512, 384)), placement }).unwrap();
        let view = View::new(&gpu, &scene).unwrap();
        let mut mitsuba = mitsuba(&view);
        for light in &scene.lights {
            assert_agrees(&format!("{placement:?} / {}", light.name), &check(&mut mitsuba, &view, light));
        }
    }
}

fn question<'s>(view: &View<'s>, light: &str) -> Question<'s> {
    view.ask(view.scene.light(light).unwrap(), &Unwatched).unwrap()
}

#[test]
fn a_light_moved_by_a_centimetre_and_points_in_another_order_are_noticed() {
    let gpu = Gpu::open().unwrap();
    let scene = shipped("triangle", [512, 384]);
    let view = View::new(&gpu, &scene).unwrap();
    let question = question(&view, "lamp");
    let of_moved = check(&mut mitsuba(&view), &view, &moved(question.light, 0.01));
    let differing_pixels = differing(&question.truth.mask, &of_moved.mask).len();
    assert!(differing_pixels > 100, "{differing_pixels}");
    let undecided = |q: &Question<'_>| q.truth.mask.pixels.iter().filter(|p| format!("{p:?}").contains("Und")).count();
    let before = undecided(&question);
    assert_eq!(undecided(&question.answered_by(of_moved)), before + differing_pixels, "nobody knows them then");

    let scene = shipped("area", [96, 72]);
    let view = View::new(&gpu, &scene).unwrap();
    let light = scene.light("panel").unwrap();
    let truth = view.ask(light, &Unwatched).unwrap().truth.mask;
    let mut mirrored = light.clone();
    let LightKind::Rectangle { half_width, half_height, .. } = &mut mirrored.kind else { panic!("a rectangle") };
    (*half_width, *half_height) = (*half_height, -*half_width);
    assert_ne!(Emitter::new(&mirrored), Emitter::new(light));
    let of_mirrored = check(&mut mitsuba(&view), &view, &mirrored);
    assert!(differing(&truth, &of_mirrored.mask).len() > 20);
}

#[test]
fn another_mesh_makes_its_answers_void() {
    let scene = shipped("triangle", [8, 6]);
    let mut other: Scene = scene.clone();
    other.positions[0].x += 1e-3;
    let mut fewer = scene.clone();
    fewer.meshes[1].casts = false;
    for wrong in [other, fewer] {
        assert!(matches!(Mitsuba::new(&wrong, &Casters::new(&scene)), Err(MitsubaError::Void { .. })));
    }
}
