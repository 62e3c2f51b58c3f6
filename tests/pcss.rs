//! Percentage-closer soft shadows against penumbras worked out on paper, and what their ledger says where their one
//! blocker is two.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests fail by panicking")]

mod support;

use gnomon::cause::Cause;
use gnomon::scene::Scene;
use gnomon::technique::Unsupported;
use support::penumbra::{LAMP_HEIGHT, SIDE, across_edge, half_plane, half_plane_of_size, half_plane_under_sun};
use support::scenes::{scene_of_texts, shipped};
use support::shot::Shot;

/// A frustum that holds the floor around the penumbra, with texels of 4.5 mm there, and kernels as wide as they need be.
const MAP: &str = "fov_deg=60,size=1024,max_texels=4096,min_texels=0,search_taps=64";
/// The same for projections that have frusta of their own.
const SEARCH: &str = "max_texels=4096,min_texels=0,search_taps=64";
const TEXEL_M: f64 = 4.6 / 1024.0;
/// Rows of this picture lie up to 7 mm apart where the penumbra is.
const SIZE: [u32; 2] = [160, 384];
const ROW_M: f64 = 0.007;
/// Inside that frustum along the floor, metres from its middle.
const HELD_M: f64 = 1.8;

/// Where the light falls from 98 % to 2 % on the floor, stretched to the whole of a linear penumbra, metres.
fn width_m(scene: &Scene, spec: &str) -> f64 {
    let shot = Shot::new(scene, &scene.lights[0].name);
    let points = across_edge(&shot, &shot.evaluate(spec).mask, 0.0);
    let points: Vec<_> = points.into_iter().filter(|p| p.0.abs() < HELD_M).collect();
    let first_dimmed = points.iter().filter(|p| p.1 < 0.98).map(|p| p.0).fold(f64::INFINITY, f64::min);
    let last_lit = points.iter().filter(|p| p.1 > 0.02).map(|p| p.0).fold(f64::NEG_INFINITY, f64::max);
    (last_lit - first_dimmed) / 0.96
}

/// Of a sun the width follows from its angular diameter and the distance to the blocker alone; the disc dims slowly at both
/// ends: from 98 % to 2 % are 0.85 of its width.
#[test]
fn a_suns_penumbra_is_as_wide_as_its_angle_makes_it() {
    let falls_to = |diameter_deg: f64, gap: f64, projection: &str| {
        let scene = half_plane_under_sun(90.0, diameter_deg, gap);
        let spec = format!("map:filter=pcss128,{SEARCH},size=4096,fit=receivers,projection={projection}");
        0.96 * width_m(&scene, &spec)
    };
    for projection in ["single", "cascaded,cascades=2", "adaptive"] {
        for (diameter_deg, gap) in [(4.0, 0.6), (8.0, 0.6), (8.0, 1.2)] {
            let (width, disc) =
                (falls_to(diameter_deg, gap, projection), 2.0 * gap * (0.5 * diameter_deg.to_radians()).tan());
            let within = 0.1 * disc + 2.0 * (TEXEL_M + ROW_M);
            assert!(
                (width - 0.85 * disc).abs() < within,
                "{projection}, {diameter_deg} degrees at {gap}: {width}, not {disc}"
            );
        }
    }
    let hard = falls_to(0.01, 0.6, "single");
    assert!(hard < 2.0 * (TEXEL_M + ROW_M), "a small sun's edge is hard: {hard}");
}

/// PC-2, PC-3, PC-5.
#[test]
fn penumbras_are_as_wide_as_distances_and_light_make_them() {
    for gap in [0.02_f64, 0.1, 0.5, 1.0, 1.3] {
        let of_side =
            |side: f64| width_m(&half_plane_of_size(0.0, side, gap, SIZE), &format!("map:filter=pcss128,{MAP}"));
        let predicted = |side: f64| side * gap / (LAMP_HEIGHT - gap);
        for side in [0.5 * SIDE, SIDE] {
            let (width, predicted) = (of_side(side), predicted(side));
            // A texel and a row of pixels at either end.
            let within = 0.1 * predicted + 2.0 * (TEXEL_M + ROW_M);
            assert!((width - predicted).abs() < within, "gap {gap}, side {side}: {width}, not {predicted}");
        }
    }
    // On a disc around the light, in tiles, and on a cube's face it is the same.
    for (projection, texel_m) in [
        ("dual-paraboloid,size=2048", 4.0 * LAMP_HEIGHT / 2048.0),
        ("adaptive,fov_deg=60,tile_texels=128,max_level=3", TEXEL_M),
        ("cube", 2.0 * LAMP_HEIGHT / 1024.0),
    ] {
        for gap in [0.1, 1.0] {
            let spec = format!("map:filter=pcss128,{SEARCH},projection={projection}");
            let (width, predicted) =
                (width_m(&half_plane_of_size(0.0, SIDE, gap, SIZE), &spec), SIDE * gap / (LAMP_HEIGHT - gap));
            let within = 0.1 * predicted + 2.0 * (texel_m + ROW_M);
            assert!((width - predicted).abs() < within, "{projection}, gap {gap}: {width}, not {predicted}");
        }
    }
    // Control: a kernel of constant width knows nothing of the gap.
    let of_gap = |gap: f64| width_m(&half_plane_of_size(0.0, SIDE, gap, SIZE), "map:filter=pcf-box16,fov_deg=60");
    assert!(of_gap(1.0) < 2.0 * of_gap(0.5) - 4.0 * TEXEL_M);
}

/// PC-1: without extent, or with kernels of no width, it is the nearest texel's answer, bit for bit.
#[test]
fn a_light_without_extent_leaves_the_nearest_texel() {
    let torus = shipped("torus", [160, 120]);
    let half_plane = half_plane(10.0, 1e-7, 1.0);
    let shots = [Shot::new(&torus, "lamp"), Shot::new(&torus, "sun"), Shot::new(&half_plane, "lamp")];
    // The plane that a paraboloid fits nearer to the casters for a search is typed.
    for projection in ["single", "cube", "cascaded", "adaptive", "dual-paraboloid,near_m=0.1"] {
        for shot in &shots {
            let mask = |filter: &str| {
                let spec = shot.supported(&format!("map:size=300,projection={projection},filter={filter}"));
                Some(shot.evaluate_if_supported(&spec)?.mask)
            };
            let (what, pcss) = (format!("{projection}, {}", shot.question.light.name), mask("pcss"));
            assert!(pcss == mask("nearest,depth_metric=linear"), "{what}");
            assert!(pcss.is_none() || pcss != mask("pcf-box2,depth_metric=linear"), "{what}");
        }
    }
    let wide = Shot::new(&shipped("area", [160, 120]), "panel").evaluate("map:filter=pcss").mask;
    assert!(wide.pixels.iter().flatten().any(|v| v.get() > 0.1 && v.get() < 0.9), "the panel has an extent");
}

/// PC-4: behind two plates the mean distance is neither's, and the penumbra that comes of it is the kernel's fault.
#[test]
fn two_blockers_at_different_distances_are_one_too_few() {
    let plates = |upper: &str| {
        let scene = "about = \"two plates\"\nsize = [128, 96]\n\
             [camera]\neye = [-1.5, 0.6, 0.02]\ntarget = [0, 0, 0.01]\nfov_y_deg = 40\n\
             [[mesh]]\nfile = \"model.obj\"\n\
             [[light]]\nname = \"lamp\"\nkind = \"rectangle\"\nposition = [0, 4, 0]\ntarget = [0, 0, 0]\n\
             width = 1\nheight = 1\nsamples = 64\n";
        let model = "o Floor\nv -9 0 -9\nv -9 0 9\nv 9 0 9\nv 9 0 -9\nf 1 2 3 4\n\
             o Lower\nv 0 1 -9\nv 0 1 9\nv 9 1 9\nv 9 1 -9\nf 5 6 7 8\n";
        scene_of_texts(scene, &format!("{model}{upper}"))
    };
    let errors = |scene: &Scene| {
        let shot = Shot::new(scene, "lamp");
        let evaluation = shot.evaluate("map:filter=pcss128,fov_deg=150,size=2048,search_taps=64");
        let share = evaluation.ledger.causes.get(&Cause::FilterWidth).copied().unwrap_or_default();
        assert!(share.pixels * 100 >= 95 * evaluation.verdict.pixels.wrong, "{:?}", evaluation.ledger.causes);
        evaluation.verdict.pixels.wrong
    };
    // The upper plate leaves a slit of light between the two.
    let two = errors(&plates("o Upper\nv -9 2.9 -9\nv -9 2.9 9\nv -0.12 2.9 9\nv -0.12 2.9 -9\nf 9 10 11 12\n"));
    let one = errors(&plates(""));
    assert!(two > 4 * one && two > 100, "{two} with two plates, {one} with one");
}

/// What the limits of the widths cost is the kernel's fault, too.
#[test]
fn limits_of_the_kernel_are_booked_as_its_width() {
    let scene = shipped("area", [160, 120]);
    for light in ["panel", "bulb"] {
        let shot = Shot::new(&scene, light);
        let free = shot.evaluate("map:filter=pcss");
        let tight = shot.evaluate("map:filter=pcss,max_texels=4");
        assert!(tight.verdict.pixels.wrong > 2 * free.verdict.pixels.wrong, "{light}");
        let (cause, _) = tight.ledger.causes.iter().max_by_key(|(_, share)| share.pixels).unwrap();
        assert_eq!(*cause, Cause::FilterWidth, "{light}");
        let hard = shot.evaluate("map");
        assert!(10 * free.verdict.pixels.wrong < 4 * hard.verdict.pixels.wrong, "{light}");
    }
}

/// FI-8 for patterns that are turned: the same seed, the same bits.
#[test]
fn turned_patterns_repeat_with_their_seed() {
    let scene = shipped("area", [160, 120]);
    for light in ["panel", "bulb"] {
        let shot = Shot::new(&scene, light);
        let mask = |seed: &str| shot.evaluate(&format!("map:filter=pcss16,turn=per-pixel,seed={seed}")).mask;
        assert!(mask("7") == mask("7") && mask("7") != mask("8"), "{light}");
    }
}

#[test]
fn what_does_not_go_together_is_refused_with_the_reason() {
    let scene = shipped("area", [64, 48]);
    let shot = Shot::new(&scene, "panel");
    let refusal = |typed: &str| {
        let spec = support::shot::parsed(typed);
        spec.technique().supports(&spec, &scene, shot.question.light, &support::scenes::gpu()).unwrap_err()
    };
    for (typed, reason) in [
        ("map:filter=pcss,depth_metric=projected", "depth_metric=linear"),
        ("map:filter=pcss,projection=trapezoidal", "warps"),
        ("map:projection=perspective,depth_metric=linear", "is no distance"),
    ] {
        let refused = refusal(typed);
        assert!(
            matches!(refused, Unsupported::Combination { .. }) && refused.to_string().contains(reason),
            "{refused}"
        );
    }
}

/// Where views measure depth alike, blockers are found beyond their sides; in tiles that is most of them.
#[test]
fn the_search_goes_on_across_tiles() {
    let scene = shipped("area", [160, 120]);
    for light in ["panel", "bulb"] {
        let shot = Shot::new(&scene, light);
        let wrong = |typed: &str| shot.evaluate(&format!("map:filter=pcss,{typed}")).verdict.pixels.wrong;
        let (across, within, one) =
            (wrong("projection=adaptive"), wrong("projection=adaptive,seam=clamp"), wrong("size=1024"));
        assert!(3 * across < within && across < 2 * one, "{light}: {across} {within} {one}");
        // No seam nearby, and depth along the rays.
        let (halves, cube) = (wrong("projection=dual-paraboloid,size=1024"), wrong("projection=cube,size=512"));
        assert!(halves < cube, "{light}: {halves} {cube}");
    }
}
