//! Maps whose texels are warped towards the eye: their texels' sizes by closed form, by gradients and as measured in
//! the picture; and what happens to casters behind the eye.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout, reason = "tests")]

mod support;

use glam::{DVec3, Vec3};
use gnomon::cause::Cause;
use gnomon::scene::Scene;
use gnomon::technique::map::Settings;
use gnomon::technique::map::projection::View;
use support::scenes::{scene_of_texts, shadowed, shipped};
use support::shot::{Shot, named, parsed};
use support::texels::diagonals_over_predicted;

const NEAR_M: f64 = 1.0;
const FAR_M: f64 = 100.0;
const SIZE: f64 = 4096.0;

/// A floor under a camera that looks along it, with the sun straight above: light across the view, floor across the
/// light.
fn floor() -> Scene {
    let scene = "about = \"a floor\"\nsize = [100, 100]\n\
         [camera]\neye = [0, 0.5, 0]\ntarget = [0, 0.5, -1]\nfov_y_deg = 90\nnear = 1.0\n\
         [[mesh]]\nfile = \"model.obj\"\n\
         [[light]]\nname = \"sun\"\nkind = \"directional\"\ndirection = [0, -1, 0]\n";
    scene_of_texts(scene, "o Floor\nv -99 0 -100\nv -99 0 99\nv 99 0 99\nv 99 0 -100\nf 1 2 3 4\n")
}

/// The part of that floor between near and far which the camera sees.
fn seen() -> Vec<DVec3> {
    let row = |i: u32| {
        let d = NEAR_M * (FAR_M / NEAR_M).powf(f64::from(i) / 60.0);
        [-1.0, 0.0, 1.0].map(|x| DVec3::new(x * d, 0.0, -d))
    };
    (0..=60).flat_map(row).collect()
}

fn view(typed: &str) -> View {
    let scene = floor();
    let settings = Settings::of(&parsed(&format!("map:size={SIZE},fit_margin_texels=0,{typed}")));
    settings.projection.fit(&scene, scene.light("sun").unwrap(), &settings, &seen()).expect("supported").remove(0)
}

/// N times the texel's extent along the view over its distance, and across the view over the picture's width there.
fn widths(view: &View, d: f64) -> (f64, f64) {
    let steps = view.site(DVec3::new(0.0, 0.0, -d)).texel_steps_m(DVec3::Y);
    let along = steps.map(|step| step.z.abs()).into_iter().fold(0.0, f64::max);
    let across = steps.map(|step| step.x.abs()).into_iter().fold(0.0, f64::max);
    (SIZE * along / d, SIZE * across / (2.0 * d))
}

fn largest(view: &View) -> (f64, f64) {
    let all = (0..=200).map(|i| widths(view, NEAR_M * (FAR_M / NEAR_M).powf(f64::from(i) / 200.0)));
    all.fold((0.0, 0.0), |most, (along, across)| (most.0.max(along), most.1.max(across)))
}

/// LS-1, PS-1: the largest texel along the view is the closed form's.
#[test]
fn the_largest_texel_along_the_view_is_as_predicted() {
    /// The rim of one texel, and the slack around what the map holds.
    const WITHIN: f64 = 0.02;
    let range = FAR_M - NEAR_M;
    for (typed, expected) in [
        ("fit=receivers", range / NEAR_M),
        ("projection=perspective", range / NEAR_M),
        ("projection=light-space-perspective", range / (NEAR_M * FAR_M).sqrt()),
    ] {
        let (along, across) = largest(&view(typed));
        println!("{typed}: {along:.3} along (predicted {expected:.3}), {across:.3} across");
        assert!((along / expected - 1.0).abs() < WITHIN, "{typed}: {along} {expected}");
    }
    // PS-1: across the view a perspective map's texels are as wide as the picture's, near and far.
    let perspective = view("projection=perspective");
    for d in [1.5, 10.0, 30.0, 90.0] {
        let (_, across) = widths(&perspective, d);
        assert!((across - 1.0).abs() < WITHIN, "{d}: {across}");
    }
}

/// B. Lloyd et al., 2006: from PSM's warp to the optimal one the product of the largest errors along both axes is the
/// same, so that range of warps only moves error from one axis to the other; weaker warps are worse.
#[test]
fn a_range_of_warps_shares_one_maximum_of_error() {
    const WITHIN: f64 = 0.03;
    // n' of the optimal warp is 11; 1 is PSM's.
    let product = |n: f64| {
        let (along, across) = largest(&view(&format!("projection=light-space-perspective,n_opt_scale={}", n / 11.0)));
        println!("n' = {n}: {along:.2} along, {across:.2} across, product {:.2}", along * across);
        along * across
    };
    let products = [1.11, 2.0, 4.0, 8.0, 11.0].map(product);
    let expected = (FAR_M - NEAR_M) / NEAR_M;
    assert!(products.iter().all(|found| (found / expected - 1.0).abs() < WITHIN), "{products:?}");
    assert!(product(44.0) > 1.5 * expected && product(1e5) > 50.0 * expected, "weaker warps have more");
}

/// LS-2: without an angle to warp along, or with a warp from far away, the map is a uniform one.
#[test]
fn light_along_the_view_gives_the_uniform_map() {
    let mut scene = shipped("posts", [128, 96]);
    let along = (scene.camera.target - scene.camera.eye).normalize();
    let gnomon::scene::LightKind::Directional { towards_light } = &mut scene.lights[0].kind else { panic!() };
    *towards_light = (Vec3::new(0.002, 0.001, 0.0) - along).normalize();
    let shot = Shot::new(&scene, "sun");
    let uniform = shot.evaluate("map:fit=receivers");
    let warped = shot.evaluate("map:projection=light-space-perspective");
    assert!(uniform.mask == warped.mask, "a tenth of a degree is not warped");
    assert!(shot.evaluate("map:projection=light-space-perspective,min_angle_deg=0.01").mask != uniform.mask);
    // PS-2: nothing is gained, and little is lost.
    let perspective = shot.evaluate("map:projection=perspective").verdict.pixels.wrong as f64;
    let plain = uniform.verdict.pixels.wrong as f64;
    println!("light along the view: {perspective} wrong, uniform {plain}");
    assert!((perspective - plain).abs() <= 0.2 * plain.max(50.0), "{perspective} {plain}");
    // From far away the warp is an orthographic projection: equal texels everywhere.
    let (along, across) = largest(&view("projection=light-space-perspective,n_opt_scale=1e6"));
    let (uniform_along, uniform_across) = largest(&view("fit=receivers"));
    assert!((along / uniform_along - 1.0).abs() < 1e-3 && (across / uniform_across - 1.0).abs() < 1e-3);
}

/// The measured size of texels against the predicted one, over a sweep of poses.
#[test]
fn texels_are_as_large_in_the_picture_as_predicted() {
    const WITHIN: f64 = 0.10;
    for pose in [Vec3::ZERO, Vec3::new(4.0, 3.0, 2.0), Vec3::new(-6.0, 1.5, -4.0), Vec3::new(2.0, 9.0, 5.0)] {
        let mut scene = shipped("posts", [400, 300]);
        scene.camera.eye += pose;
        let shot = Shot::new(&scene, "sun");
        for typed in [
            "map:size=200,fit=receivers",
            "map:size=64,projection=perspective",
            "map:size=64,projection=trapezoidal",
            "map:size=64,projection=light-space-perspective",
        ] {
            let evaluation = shot.evaluate(typed);
            let ratios = diagonals_over_predicted(&shot, &evaluation, typed);
            let median = ratios[ratios.len() / 2];
            let m = shot.asked().into_iter().filter_map(|pixel| Some(evaluation.prepared.footprint(pixel)?.m));
            let largest_m = m.fold(0.0, f64::max);
            let error = evaluation.verdict.error.mean_abs.unwrap();
            println!(
                "{pose} {typed}: {} texels, measured / predicted {median:.3}, largest m {largest_m:.1}, error {error:.5}",
                ratios.len()
            );
            assert!(ratios.len() >= 10, "{typed}: {}", ratios.len());
            assert!((median - 1.0).abs() < WITHIN, "{pose} {typed}: {median}");
        }
    }
}

/// TS-2, TS-3: warped maps are finer where the camera is, and need no more bias for it.
#[test]
fn warped_maps_err_less_and_show_no_acne() {
    let scene = shipped("posts", [256, 192]);
    let shot = Shot::new(&scene, "sun");
    let uniform = shot.evaluate("map:fit=receivers").verdict.pixels.wrong;
    for projection in ["perspective", "trapezoidal", "light-space-perspective"] {
        for extra in ["", ",filter=pcf-box3", ",depth_convention=forward"] {
            let evaluation = shot.evaluate(&format!("map:projection={projection}{extra}"));
            let acne = named(&evaluation, &[Cause::Acne, Cause::Precision]).len();
            let wrong = evaluation.verdict.pixels.wrong;
            println!("{projection}{extra}: {wrong} wrong (uniform {uniform}), {acne} of acne");
            assert!(2 * wrong < uniform && acne <= 2, "{projection}{extra}: {wrong} {acne}");
        }
    }
}

/// PS-3: a wall behind the eye throws its shadow into the view.
#[test]
fn a_caster_behind_the_eye_needs_the_virtual_camera() {
    let scene = "about = \"a wall behind the eye\"\nsize = [160, 120]\n\
         [camera]\neye = [0, 2, 0]\ntarget = [0, 0, -6]\nfov_y_deg = 50\n\
         [[mesh]]\nfile = \"model.obj\"\n\
         [[light]]\nname = \"sun\"\nkind = \"directional\"\ndirection = [0.1, -0.5, -1]\n";
    let model = "o Floor\nv -30 0 -30\nv -30 0 9\nv 30 0 9\nv 30 0 -30\nf 1 2 3 4\n\
                 o Wall\nv -1.5 2.2 4\nv 1.2 2.2 4\nv 1.2 4.1 4\nv -1.5 4.1 4\nf 5 6 7 8\n";
    let scene = scene_of_texts(scene, model);
    let shot = Shot::new(&scene, "sun");
    let in_shadow = shadowed(&shot.question.truth.mask);
    assert!(in_shadow > 500, "{in_shadow}");
    for typed in ["perspective", "trapezoidal", "light-space-perspective", "cascaded"] {
        let wrong = shot.evaluate(&format!("map:projection={typed}")).verdict.pixels.wrong as usize;
        assert!(wrong * 10 < in_shadow, "{typed}: {wrong} of {in_shadow}");
    }
    let lost = shot.evaluate("map:projection=perspective,virtual_back_m=0");
    assert!(lost.verdict.pixels.wrong as usize * 10 > 9 * in_shadow, "{}", lost.verdict.pixels.wrong);
    assert!(named(&lost, &[Cause::ClippingNear]).len() * 10 > 9 * in_shadow);
}
