//! The irregular z-buffer: right wherever its edge functions are beyond rounding, whatever the grid, on every scene, for
//! every kind of light and at every scale.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout, reason = "tests")]

mod support;

use glam::{DVec3, IVec2, UVec2, Vec3};
use gnomon::evaluate::{Effort, View, evaluate};
use gnomon::mask::{Mask, TruthMask};
use gnomon::receiver::Receiver;
use gnomon::scene::{Placement, Scene};
use gnomon::technique::irregular::PreparedIrregular;
use gnomon::watch::Unwatched;
use support::scenes::{ask, gpu, placed, shadowed, shipped, with_triangles};
use support::shot::{Shot, parsed, shipped_scenes};

/// Share of asked pixels that f32 may flip: measured, a handful in a million lie within rounding of an edge.
const FLIPPED: f64 = 2e-5;

/// Wrong pixels of a shot, all of which must lie within the f32 error bound of an edge function.
fn wrong_and_in_doubt(shot: &Shot<'_>, what: &str) -> (u64, u64) {
    let evaluation = shot.evaluate("irregular");
    let job = shot.view.job(shot.question.light, &shot.question.classes);
    let twin = PreparedIrregular::new(512, job).unwrap();
    for (pixel, _) in &evaluation.ledger.wrong {
        assert!(twin.is_in_doubt(*pixel), "{what}: pixel {pixel} is wrong beyond rounding");
    }
    (evaluation.verdict.pixels.wrong, evaluation.verdict.pixels.asked)
}

#[test]
fn every_wrong_pixel_lies_within_the_error_bound_on_every_shipped_scene() {
    let (mut wrong, mut asked) = (0, 0);
    for scene in shipped_scenes(UVec2::new(160, 120)) {
        for light in scene.lights.iter().filter(|light| !light.is_area()) {
            let shot = Shot::new(&scene, &light.name);
            let found = wrong_and_in_doubt(&shot, &format!("{} {}", scene.name, light.name));
            (wrong, asked) = (wrong + found.0, asked + found.1);
        }
    }
    println!("{wrong} wrong of {asked} asked");
    assert!(asked > 100_000);
    assert!(wrong as f64 <= FLIPPED * asked as f64, "{wrong} of {asked}");
}

#[test]
fn no_scale_and_no_distance_from_the_origin_matters() {
    for scale in [1e-3, 1.0, 1e3] {
        for translate in [DVec3::ZERO, DVec3::new(1e6, -1e6, 1e6)] {
            for (name, light) in [("torus", "lamp"), ("torus", "sun"), ("room", "spot")] {
                let scene = placed(name, [160, 120], Placement { scale, translate });
                let shot = Shot::new(&scene, light);
                let (wrong, asked) = wrong_and_in_doubt(&shot, &format!("{name} {light} at {scale}"));
                assert!(wrong <= 1, "{name} {light} at {scale}: {wrong} of {asked}");
            }
        }
    }
}

#[test]
fn the_grid_changes_nothing() {
    let gpu = gpu();
    for (name, light) in [("room", "lamp"), ("polygons-69", "lamp"), ("triangle", "sun"), ("pipe", "lamp")] {
        let scene = shipped(name, [101, 67]);
        let view = View::new(&gpu, &scene).unwrap();
        let question = ask(&view, light);
        assert!(shadowed(&question.truth.mask) > 100, "{name}: nothing is in shadow");
        let mask = |grid: u32| -> Mask {
            let spec = parsed(&format!("irregular:grid={grid}"));
            evaluate(&view, &question, &spec, Effort::VERDICT, &Unwatched).unwrap().mask
        };
        let usual = mask(512);
        for grid in [1, 3, 64, 2000] {
            assert!(mask(grid) == usual, "{name}: a grid of {grid} cells answers otherwise");
        }
    }
}

/// How far off the rim of its triangle f64 puts a receiver that was moved onto it, relative to its coordinates.
const ON_RIM: f64 = 1e-14;

/// Whether a receiver lies on the rim of its own triangle, and so in the plane of the next one too.
fn is_on_rim(scene: &Scene, receiver: &Receiver) -> bool {
    let point = receiver.point_in_world;
    let [a, b, c] = scene.triangle_in_world(receiver.triangle);
    [(a, b), (b, c), (c, a)].iter().any(|&(from, to)| {
        let off_line_m = (to - from).normalize().cross(point - from).length();
        off_line_m < ON_RIM * (point.length() + from.length())
    })
}

/// Whether truth differs between a pixel and one of the eight around it.
fn is_beside_an_edge(truth: &TruthMask, pixel: u32) -> bool {
    let size = truth.size.as_ivec2();
    let at = |place: IVec2| truth.pixels[(place.y * size.x + place.x) as usize];
    let place = IVec2::new(pixel as i32 % size.x, pixel as i32 / size.x);
    let steps = (-1..=1).flat_map(|y| (-1..=1).map(move |x| IVec2::new(x, y)));
    let around = steps.map(|step| (place + step).clamp(IVec2::ZERO, size - 1));
    around.into_iter().any(|other| at(other) != at(place))
}

/// Far from every shadow's edge, rounding can only decide at a fold of the receiver's own surface.
#[test]
fn away_from_true_edges_only_receivers_on_a_rim_are_wrong() {
    for (name, light) in [("posts", "sun"), ("torus", "lamp"), ("room", "lamp")] {
        let scene = shipped(name, [512, 384]);
        let shot = Shot::new(&scene, light);
        wrong_and_in_doubt(&shot, name);
        let truth = &shot.question.truth.mask;
        for (pixel, _) in shot.evaluate("irregular").ledger.wrong {
            let receiver = shot.view.receivers.pixels[pixel as usize].unwrap();
            let is_explained = is_beside_an_edge(truth, pixel) || is_on_rim(&scene, &receiver);
            assert!(is_explained, "{name}: pixel {pixel} is wrong amid its like");
        }
        // Control: hardly any other pixel would be excused.
        let asked = shot.view.receivers.pixels.iter().enumerate().filter_map(|(pixel, r)| Some((pixel as u32, (*r)?)));
        let (mut excused, mut all) = (0, 0);
        for (pixel, receiver) in asked {
            all += 1;
            excused += u32::from(!is_beside_an_edge(truth, pixel) && is_on_rim(&scene, &receiver));
        }
        println!("{name}: {excused} of {all} receivers lie on a rim away from shadow edges");
        assert!(excused * 1000 < all, "{name}: {excused} of {all}");
    }
}

/// What every cell test relies on: shifting the samples by a pixel's worth is seen.
#[test]
fn a_shifted_mask_is_wrong_beyond_rounding() {
    let scene = shipped("torus", [160, 120]);
    let shot = Shot::new(&scene, "lamp");
    let evaluation = shot.evaluate("irregular");
    let job = shot.view.job(shot.question.light, &shot.question.classes);
    let twin = PreparedIrregular::new(512, job).unwrap();
    let mut shifted = evaluation.mask.clone();
    shifted.pixels.rotate_right(1);
    let moved = |pixel: &usize| {
        let (was, is) = (evaluation.mask.pixels[*pixel], shifted.pixels[*pixel]);
        was.is_some() && is.is_some() && was != is
    };
    let changed: Vec<usize> = (0..shifted.pixels.len()).filter(moved).collect();
    assert!(changed.len() > 50);
    let in_doubt = changed.iter().filter(|pixel| twin.is_in_doubt(**pixel as u32)).count();
    assert!(in_doubt * 20 < changed.len(), "{in_doubt} of {}", changed.len());
}

/// A closed box of twelve triangles around the lamp, whose walls cross every face of the grids.
#[test]
fn a_light_inside_a_box_reaches_nothing_outside() {
    let scene = shipped("torus", [160, 120]);
    let lamp = scene.light("lamp").unwrap().homogeneous().truncate().as_vec3();
    for half in [1e-5_f32, 1e-2, 0.3] {
        let corner = |i: u32| lamp + half * Vec3::from([1, 2, 4].map(|bit| if i & bit == 0 { -1.0 } else { 1.3 }));
        let sides = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
        let triangles: Vec<[Vec3; 3]> =
            sides.iter().flat_map(|s| [[s[0], s[1], s[2]], [s[0], s[2], s[3]]]).map(|t| t.map(corner)).collect();
        let boxed = with_triangles(&scene, &triangles);
        let shot = Shot::new(&boxed, "lamp");
        let evaluation = shot.evaluate("irregular");
        assert!(evaluation.verdict.pixels.asked > 1000);
        assert_eq!(evaluation.verdict.pixels.wrong, 0, "{half}");
    }
}
