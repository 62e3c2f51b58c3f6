//! Where shadow volumes fail, and that the ledger says why: each cause where theory puts it and nowhere else.

mod volume_stage;

use glam::Vec3;
use gnomon::cause::Cause;
use gnomon::evaluate::View;
use gnomon::scene::{Mesh, Scene};
use gnomon::technique::Prepared;
use gnomon::watch::Unwatched;
use volume_stage::testing::{Random, Shape};
use volume_stage::*;

/// Pixels at edges that a rasteriser may flip in pictures of this size.
const FLIPPED: u64 = 1;

/// A ball over a floor under a lamp, seen from inside its shadow or beside it.
fn ball_scene(eye: Vec3, target: Vec3) -> Scene {
    over_floor(&[ball(Vec3::new(0.0, 1.5, 0.0), 0.5)], lamp(Vec3::new(0.0, 4.0, 0.0)), eye, target)
}

#[test]
fn a_near_plane_inside_volumes_breaks_only_the_count_before_the_surface() {
    let gpu = gpu();
    // From under the ball, out of its shadow; with a growing near distance the plane leaves the volume.
    let mut scene = ball_scene(Vec3::new(0.3, 0.4, 0.0), Vec3::new(3.0, 0.0, 0.4));
    let mut masks = Vec::new();
    let mut started_inside = 0;
    for near_m in [0.01, 0.1, 0.25, 0.35] {
        scene.camera.near_m = near_m;
        let view = View::new(&gpu, &scene).unwrap();
        let question = view.ask(&scene.lights[0], &Unwatched).unwrap();
        let behind = run(&view, &question, "volume");
        behind.assert_exact("z-fail");
        let before = run(&view, &question, "volume:count=z-pass");
        before.assert_exact("z-pass");
        for (pixel, counts) in before.counts.iter().enumerate().filter_map(|(pixel, counts)| Some((pixel, (*counts)?)))
        {
            let at_near = counts.reached - counts.from_near;
            let theory = (counts.from_near == 0) != (counts.reached == 0);
            let wrong = before.verdict.signed_error[pixel].is_some_and(|error| error != 0.0);
            let tolerated = behind.verdict.signed_error[pixel] != Some(0.0);
            assert!(wrong == theory || tolerated || before.verdict.signed_error[pixel].is_none());
            started_inside += u64::from(at_near != 0);
        }
        assert!(before.wrong() - before.wrong_by(Cause::ClippingNear) <= FLIPPED);
        masks.push(behind.mask);
        for count in ["mixed", "zp-plus"] {
            let fixed = run(&view, &question, &format!("volume:count={count}"));
            assert!(fixed.wrong() <= FLIPPED, "{count} at {near_m}: {}", fixed.wrong());
        }
    }
    assert!(started_inside > 1000, "{started_inside}");
    assert!(masks.windows(2).all(|pair| pair[0] == pair[1]), "z-fail does not know the near plane");
}

#[test]
fn an_eye_inside_wraps_to_shadow_and_stops_at_light() {
    let gpu = gpu();
    let scene = ball_scene(Vec3::new(0.1, 0.4, 0.0), Vec3::new(3.0, 0.0, 0.4));
    let wraps = run_first(&gpu, &scene, "volume:count=z-pass");
    assert!(wraps.verdict.pixels.false_shadow > 100 && wraps.verdict.pixels.false_light > 100);
    let stops = run_first(&gpu, &scene, "volume:count=z-pass,stencil_ops=clamp");
    assert!(stops.verdict.pixels.false_shadow <= FLIPPED && stops.verdict.pixels.false_light > 100);
}

#[test]
fn mixed_is_z_fail_bit_for_bit_from_everywhere() {
    const POSES: u32 = 200;
    let gpu = gpu();
    let casters = [ball(Vec3::new(-1.2, 1.2, 0.0), 0.5), without_last(ball(Vec3::new(0.8, 0.9, 0.4), 0.5), 60)];
    let mut scene = over_floor(&casters, lamp(Vec3::new(0.3, 4.0, 0.5)), Vec3::Y, Vec3::ZERO);
    scene.image_size /= 4;
    let mut random = Random(7);
    let (mut before, mut behind) = (0, 0);
    for pose in 0..POSES {
        let at = random.in_cube().as_vec3();
        scene.camera.eye = Vec3::new(2.0 * at.x, 1.1 + at.y, 2.0 * at.z);
        scene.camera.target = random.in_cube().as_vec3() * 0.7;
        let view = View::new(&gpu, &scene).unwrap();
        let classes = view.receivers.classify(&scene, &scene.lights[0]);
        let mask = |typed: &str| {
            let prepared = prepare(&view, &scene.lights[0], &classes, typed);
            (prepared.run().unwrap().mask, prepared.objects_before_and_behind())
        };
        let (mixed, chosen) = mask("volume:count=mixed");
        assert_eq!(mixed, mask("volume").0, "pose {pose}");
        (before, behind) = (before + chosen.0, behind + chosen.1);
    }
    assert!(before > 100 && behind > 20, "{before} before, {behind} behind");
}

#[test]
fn sparkles_of_zp_plus_are_few_and_precision() {
    let gpu = gpu();
    for eye in [Vec3::new(0.3, 0.4, 0.0), Vec3::new(0.0, 2.5, 0.9), Vec3::new(2.0, 2.0, 2.0)] {
        let scene = ball_scene(eye, Vec3::ZERO);
        let run = run_first(&gpu, &scene, "volume:count=zp-plus,caster_sides=all");
        assert!(run.wrong() <= FLIPPED && run.wrong() == run.wrong_by(Cause::Precision));
    }
}

#[test]
fn an_open_caster_with_half_its_triangles_is_named() {
    let gpu = gpu();
    let open = without_last(ball(Vec3::Y, 0.6), 90);
    let scene = over_floor(&[open], lamp(Vec3::new(-1.0, 4.0, 1.5)), Vec3::new(0.0, 2.5, 4.0), Vec3::ZERO);
    let forced = run_first(&gpu, &scene, "volume:caster_sides=light-facing");
    forced.assert_exact("the count of the triangles in use is right");
    assert!(forced.wrong_by(Cause::OpenMesh) > 50 && forced.wrong() - forced.wrong_by(Cause::OpenMesh) <= FLIPPED);
    assert!(run_first(&gpu, &scene, "volume").wrong() <= FLIPPED);
}

#[test]
fn the_edges_of_an_open_base_are_named() {
    let gpu = gpu();
    // A bell that lies on its side: half a ball, its open base towards the lamp.
    let mut bell = ball(Vec3::Y, 0.6);
    let positions = bell.positions.clone();
    bell.triangles.retain(|corners| corners.iter().any(|v| positions[*v as usize].z < 0.0));
    let scene = over_floor(&[bell], lamp(Vec3::new(0.3, 3.0, 4.0)), Vec3::new(0.0, 2.5, 5.0), Vec3::Y * 0.5);
    let view = View::new(&gpu, &scene).unwrap();
    let question = view.ask(&scene.lights[0], &Unwatched).unwrap();
    let typed = "volume:caster_sides=light-facing";
    let forced = run(&view, &question, typed);
    assert!(forced.wrong_by(Cause::OpenMesh) > 50, "{}", forced.wrong());
    assert!(forced.wrong() - forced.wrong_by(Cause::OpenMesh) <= FLIPPED);

    let prepared = prepare(&view, question.light, &question.classes, typed);
    prepared.run().unwrap();
    let facts = prepared.facts();
    let (_, named) = facts.iter().find(|(label, _)| label == "open object cast one-sided").unwrap();
    assert!(named.contains("open edges: edge ") && named.matches(" from (").count() == 8, "{named}");
    let is_lit_wrongly = |pixel: &u32| forced.verdict.signed_error[*pixel as usize].is_some_and(|error| error > 0.5);
    let wrong = (0..forced.stencil.len() as u32).find(is_lit_wrongly).unwrap();
    let facts = prepared.lookup_facts(wrong).unwrap();
    let (_, blamed) = facts.iter().find(|(label, _)| label == "open mesh").unwrap();
    assert!(blamed.contains("nearest open edge ") && blamed.contains(" to ("), "{blamed}");
    let closed = prepare(&view, question.light, &question.classes, "volume");
    closed.run().unwrap();
    assert!(closed.facts().iter().all(|(label, _)| label != "open object cast one-sided"));
    assert!(closed.lookup_facts(wrong).unwrap().iter().all(|(label, _)| label != "open mesh"));
}

#[test]
fn a_light_inside_needs_the_right_back_cap_and_both_sides() {
    let gpu = gpu();
    let scene = over_floor(&[ball(Vec3::Y, 0.6)], lamp(Vec3::Y), Vec3::new(0.0, 2.5, 4.0), Vec3::ZERO);
    let auto = run_first(&gpu, &scene, "volume");
    assert!(auto.wrong() <= FLIPPED && auto.wrong_by(Cause::Precision) <= FLIPPED);
    let one_sided = run_first(&gpu, &scene, "volume:caster_sides=light-facing");
    assert!(one_sided.wrong_by(Cause::OpenMesh) > 1000, "a convex mesh has no facing triangle then");
    let away = run_first(&gpu, &scene, "volume:caster_sides=light-facing,back_cap=away-facing");
    let off_by_one = |run: &Run| run.stencil.iter().filter(|count| **count == 1).count();
    assert_eq!((off_by_one(&one_sided), off_by_one(&away)), (0, away.stencil.len()));
}

#[test]
fn a_finite_volume_ends_at_its_length() {
    let gpu = gpu();
    let blocker = quad(Vec3::new(0.0, 2.0, 0.0), Vec3::X * 0.5, Vec3::NEG_Z * 0.5);
    let scene = over_floor(&[blocker], sun(Vec3::Y), Vec3::new(0.0, 3.0, 4.0), Vec3::ZERO);
    for count in ["z-fail", "z-pass", "mixed"] {
        let length =
            |length: &str| run_first(&gpu, &scene, &format!("volume:count={count},extrusion=finite,length_m={length}"));
        assert!(length("2.01").wrong() <= FLIPPED, "{count}");
        let short = length("1.99");
        assert!(short.wrong() > 100 && short.wrong() == short.wrong_by(Cause::ClippingFar), "{count}");
        assert_eq!(short.verdict.pixels.false_shadow, 0);
    }
    // Half as wide as high above: at 45 degrees the corners reach only cos 45° of the length down.
    let wide = quad(Vec3::new(0.0, 2.0, 0.0), Vec3::X * 2.0, Vec3::NEG_Z * 2.0);
    let scene = over_floor(&[wide], lamp(Vec3::new(0.0, 4.0, 0.0)), Vec3::new(0.0, 3.0, 9.0), Vec3::ZERO);
    let falls_short = run_first(&gpu, &scene, "volume:extrusion=finite,length_m=2.5");
    falls_short.assert_exact("finite");
    assert!(falls_short.wrong_by(Cause::ClippingFar) > 100, "{}", falls_short.wrong());
}

#[test]
fn a_finite_far_plane_leaks_unless_volumes_are_clamped_to_it() {
    let gpu = gpu();
    // Towards the light's far side the volume outlasts the far plane.
    let scene = over_floor(
        &[ball(Vec3::Y, 0.5)],
        lamp(Vec3::new(0.0, 2.0, 3.0)),
        Vec3::new(0.0, 2.2, 5.0),
        Vec3::new(0.0, 0.5, 0.0),
    );
    for depth in ["reversed", "forward"] {
        let far = |far: &str| run_first(&gpu, &scene, &format!("volume:far={far},depth_convention={depth}"));
        let leaks = far("finite,far_m=9");
        assert!(leaks.wrong_by(Cause::ClippingFar) > 100);
        assert!(leaks.wrong() - leaks.wrong_by(Cause::ClippingFar) <= FLIPPED);
        assert!(far("infinite").wrong() <= FLIPPED && far("clamp").wrong() <= FLIPPED);
    }
    let beyond = run_first(&gpu, &scene, "volume:far=finite,far_m=4");
    assert!(beyond.wrong() - beyond.wrong_by(Cause::ClippingFar) <= FLIPPED);
}

/// A wall seen from the front under a parallel light; `here` quads over its middle, `behind` quads over what it hides.
fn nested(here: u32, behind: u32) -> Scene {
    let stack = |count: u32, z: f32| -> Vec<Shape> {
        (0..count).map(|i| quad(Vec3::new(0.0, 3.0 + 0.01 * i as f32, z), Vec3::X * 0.5, Vec3::NEG_Z * 0.5)).collect()
    };
    let casters = [stack(here, 0.0), stack(behind, -2.0)].concat();
    let mut scene =
        over_floor(&casters, sun(Vec3::new(0.0, 1.0, 0.1)), Vec3::new(0.0, 1.0, 4.0), Vec3::new(0.0, 1.0, 0.0));
    let wall =
        over_floor(&[quad(Vec3::new(0.0, 1.0, 0.0), Vec3::X * 0.4, Vec3::Y * 0.4)], sun(Vec3::Y), Vec3::Y, Vec3::ZERO);
    let (first_vertex, first_triangle) = (scene.positions.len() as u32, scene.triangles.len() as u32);
    scene.positions.extend(&wall.positions[..4]);
    scene.triangles.extend(wall.triangles[..2].iter().map(|corners| corners.map(|v| v + first_vertex)));
    scene.corner_normals.extend([[Vec3::Z; 3]; 2]);
    scene.triangle_material.extend([0; 2]);
    let mesh =
        Mesh { name: "wall".into(), triangles: first_triangle..first_triangle + 2, casts: false, receives: true };
    scene.meshes.push(mesh);
    scene.camera.fov_y_rad = 0.2;
    scene.image_size /= 4;
    scene
}

#[test]
fn the_stencil_wraps_at_256_and_loses_what_it_clamps() {
    let gpu = gpu();
    // Volumes over the wall, volumes behind it; value wrapped, value clamped.
    for (here, behind, wrapped, clamped) in
        [(255, 0, 255, 255), (256, 0, 0, 255), (257, 0, 1, 255), (1, 299, 1, 0), (45, 255, 45, 0), (10, 290, 10, 0)]
    {
        let scene = nested(here, behind);
        let centre = (scene.image_size.y / 2 * scene.image_size.x + scene.image_size.x / 2) as usize;
        for (ops, value) in [("wrap", wrapped), ("clamp", clamped)] {
            let run = run_first(&gpu, &scene, &format!("volume:faces=two-pass,stencil_ops={ops}"));
            assert_eq!(run.stencil[centre], value, "{here} + {behind} {ops}");
            let overflown = run.wrong_by(Cause::StencilOverflow);
            assert_eq!(overflown > 100, value == 0, "{here} + {behind} {ops}: {overflown}");
            assert!(run.wrong() - overflown <= FLIPPED);
        }
    }
}

#[test]
fn a_range_mask_leaves_seven_bits_to_count_with() {
    let gpu = gpu();
    for (here, counted) in [(127, 127), (128, 0), (130, 2)] {
        let scene = nested(here, 0);
        let centre = (scene.image_size.y / 2 * scene.image_size.x + scene.image_size.x / 2) as usize;
        let run = run_first(&gpu, &scene, "volume:range_mask=on");
        assert_eq!(run.stencil[centre], counted, "{here}");
        run.assert_exact("modulo 128");
        assert_eq!(run.wrong_by(Cause::StencilOverflow) > 100, counted == 0, "{here}");
    }
    // Three volumes left and none entered, because the near plane is inside all three.
    let balls = [0.5, 0.4, 0.3].map(|radius| ball(Vec3::new(0.0, 1.5, 0.0), radius));
    let scene = over_floor(&balls, lamp(Vec3::Y * 4.0), Vec3::new(0.05, 0.4, 0.0), Vec3::new(3.0, 0.0, 0.4));
    let run = run_first(&gpu, &scene, "volume:count=z-pass,range_mask=on");
    run.assert_exact("below zero");
    assert!(run.stencil.iter().filter(|count| **count == 125).count() > 100);
}

#[test]
fn starting_with_the_volumes_around_the_eye_mends_z_pass_where_they_are_the_same_all_over_the_near_plane() {
    let gpu = gpu();
    let mut scene = ball_scene(Vec3::new(0.1, 0.4, 0.0), Vec3::new(3.0, 0.0, 0.4));
    let wrong = |scene: &Scene, typed: &str| {
        let run = run_first(&gpu, scene, typed);
        run.assert_exact(typed);
        assert!(run.wrong() - run.wrong_by(Cause::ClippingNear) <= FLIPPED);
        run.wrong()
    };
    let (zero, eye) = ("volume:count=z-pass", "volume:count=z-pass,stencil_init=eye-count");
    assert!(wrong(&scene, zero) > 100 && wrong(&scene, eye) <= FLIPPED);
    // Outside every volume there is nothing to start from.
    let outside = ball_scene(Vec3::new(2.0, 2.0, 2.0), Vec3::ZERO);
    assert!(wrong(&outside, eye) <= FLIPPED);
    // A near plane that the volume's side cuts has no count of its own.
    (scene.camera.near_m, scene.camera.eye) = (0.3, Vec3::new(0.42, 0.4, 0.0));
    assert!(wrong(&scene, eye) > 100);
}

#[test]
fn the_scissor_changes_no_answer() {
    let gpu = gpu();
    let mut scene = ball_scene(Vec3::new(0.5, 3.0, 5.0), Vec3::ZERO);
    scene.lights[0].range_m = 4.5;
    let view = View::new(&gpu, &scene).unwrap();
    let question = view.ask(&scene.lights[0], &Unwatched).unwrap();
    let whole = run(&view, &question, "volume");
    let cut = run(&view, &question, "volume:scissor=on");
    assert_eq!(whole.mask, cut.mask);
    cut.assert_exact("scissor");
    for count in ["z-fail", "z-pass", "mixed", "zp-plus"] {
        let masked = run(&view, &question, &format!("volume:range_mask=on,count={count}"));
        assert_eq!(whole.mask, masked.mask, "{count}");
        masked.assert_exact("range mask");
    }
    assert!(whole.asked() < whole.stencil.len() / 2, "the range matters in this view");
}
