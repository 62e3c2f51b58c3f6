//! What is predicted before anything is drawn, against what is measured afterwards: how large a texel is in the picture,
//! how much bias a plane needs, how wide a strip of shadow a bias costs at a contact.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout, reason = "tests")]

mod support;

use glam::{DVec2, DVec3};
use gnomon::mask::{Truth, Visibility};
use gnomon::receiver::Receiver;
use gnomon::scene::Scene;
use gnomon::technique::map::{Lookup, Settings};
use support::scenes::{scene_of_texts, shipped};
use support::shot::{Shot, parsed};

/// The lookup of a map whose fit does not depend on the camera.
fn lookup(shot: &Shot<'_>, typed: &str) -> Lookup {
    let settings = Settings::of(&parsed(typed));
    let (scene, light) = (shot.view.scene, shot.question.light);
    Lookup::new(settings.projection.fit(scene, light, &settings, &[]).expect("supported"), &settings, light)
}

fn receiver(shot: &Shot<'_>, pixel: u32) -> Receiver {
    shot.view.receivers.pixels[pixel as usize].expect("asked")
}

/// Where a point appears in the picture, pixels.
fn in_picture(scene: &Scene, point: DVec3) -> DVec2 {
    let clip = scene.camera.clip_from_world(scene.image_size) * point.extend(1.0);
    let ndc = clip.truncate().truncate() / clip.w;
    (DVec2::new(ndc.x, -ndc.y) + 1.0) * 0.5 * scene.image_size.as_dvec2()
}

/// The point of a receiver's plane that a place in the map looks at.
fn on_plane(scene: &Scene, lookup: &Lookup, receiver: &Receiver, position_in_texels: DVec2) -> DVec3 {
    let ray = lookup.ray_through(0, position_in_texels, &scene.bounds()).expect("meets the scene");
    let (near, far) = (ray.from, ray.to);
    let normal = receiver.normal_in_world;
    near + (far - near) * (normal.dot(receiver.point_in_world - near) / normal.dot(far - near))
}

/// Lloyd's m by its meaning: the steps of one side of a texel, made in the map and followed into the picture.
#[test]
fn the_texels_size_in_the_picture_is_what_finite_differences_say() {
    const STEP_TEXELS: f64 = 1e-3;
    /// The steps' own curvature, and the rounding of places in a map of 10³ texels over steps of 10⁻³.
    const ERROR: f64 = 1e-4;
    let scenes = [("room", "spot"), ("torus", "lamp"), ("fence", "sun"), ("posts", "sun")];
    let mut compared = 0;
    for (name, light) in scenes {
        let scene = shipped(name, [128, 96]);
        let shot = Shot::new(&scene, light);
        let (evaluation, lookup) = (shot.evaluate("map"), lookup(&shot, "map"));
        for pixel in shot.asked().into_iter().step_by(37) {
            let receiver = receiver(&shot, pixel);
            let Ok(site) = lookup.project(receiver.point_in_world) else { continue };
            let at = site.position_in_texels();
            let footprint = evaluation.prepared.footprint(pixel).expect("inside the map");
            // Seen nearly edge-on by light or eye, a step of any size leaves the neighbourhood in which it is straight.
            if footprint.projective_factor > 50.0 || footprint.m > 50.0 {
                continue;
            }
            let side = |axis: DVec2| {
                let end = |sign: f64| {
                    in_picture(&scene, on_plane(&scene, &lookup, &receiver, at + sign * STEP_TEXELS * axis))
                };
                (end(1.0) - end(-1.0)) / (2.0 * STEP_TEXELS)
            };
            let (u, v) = (side(DVec2::X), side(DVec2::Y));
            let m = u.length().max(v.length());
            let diagonal = (u + v).length().max((u - v).length());
            assert!((footprint.m - m).abs() <= ERROR * m, "{name}: {} {m}", footprint.m);
            assert!((footprint.m_diagonal - diagonal).abs() <= ERROR * diagonal, "{name}");
            assert!((footprint.position_in_texels - at).length() <= ERROR, "{name}");
            compared += 1;
        }
    }
    assert!(compared > 400, "{compared}");
}

/// A floor seen from straight above, shaded up to an edge that leans a fifth against the map's axis, by a sun in the
/// plane of x and y that is `tilt_deg` from the vertical.
fn straight_edge(tilt_deg: f64) -> Scene {
    let tilt = tilt_deg.to_radians();
    let scene = format!(
        "about = \"a straight edge\"\nsize = [512, 384]\n\
         [camera]\neye = [0.5, 12, 0]\ntarget = [0.5, 0, 0]\nup = [0, 0, -1]\nfov_y_deg = 30\n\
         [[mesh]]\nfile = \"model.obj\"\n\
         [[light]]\nname = \"sun\"\nkind = \"directional\"\ndirection = [{}, {}, 0]\n",
        tilt.sin(),
        -tilt.cos()
    );
    let model = "o Floor\nv -9 0 -9\nv -9 0 9\nv 9 0 9\nv 9 0 -9\nf 1 2 3 4\n\
                 o Screen\nv -9 1.5 -9\nv -9 1.5 9\nv 1.3 1.5 9\nv -2.3 1.5 -9\nf 5 6 7 8\n";
    scene_of_texts(&scene, model)
}

/// Mean size of the steps of a shadow's right edge, pixels, from the first jump between rows to the last.
fn step_px(shot: &Shot<'_>, mask: &[Option<Visibility>]) -> f64 {
    let [width, height] = shot.view.scene.image_size.to_array().map(|side| side as usize);
    let edge_of = |row: &[Option<Visibility>]| row.iter().rposition(|answer| *answer == Some(Visibility::SHADOW));
    let edges: Vec<f64> = (0..height)
        .map(|y| edge_of(&mask[y * width..(y + 1) * width]).expect("a shadow in every row") as f64)
        .collect();
    let jumps: Vec<usize> = (1..height).filter(|y| (edges[*y] - edges[*y - 1]).abs() > 0.5).collect();
    let (first, last) = (jumps[0], jumps[jumps.len() - 1]);
    (edges[last] - edges[first]).abs() / (jumps.len() - 1) as f64
}

#[test]
fn a_staircase_has_steps_as_wide_as_predicted() {
    const WITHIN: f64 = 0.10;
    for (tilt_deg, typed) in [
        (20.0, "map:width_m=20,size=192"),
        (20.0, "map:width_m=20,size=96"),
        (45.0, "map:width_m=20,size=160"),
        (65.0, "map:width_m=20,size=256"),
    ] {
        let scene = straight_edge(tilt_deg);
        let shot = Shot::new(&scene, "sun");
        let evaluation = shot.evaluate(typed);
        let measured = step_px(&shot, &evaluation.mask.pixels);
        let middle = 192 * 512 + 300;
        assert_eq!(receiver(&shot, middle).point_in_world.y, 0.0, "the floor");
        let predicted = evaluation.prepared.footprint(middle).expect("in the map").m;
        println!("tilt {tilt_deg}, {typed}: steps of {measured:.2} px, m = {predicted:.2}");
        assert!((measured / predicted - 1.0).abs() < WITHIN, "{tilt_deg} {typed}: {measured} {predicted}");
    }
}

/// A floor under a sun `tilt_deg` from the vertical, along no axis of the map.
fn tilted(tilt_deg: f64) -> Scene {
    let tilt = tilt_deg.to_radians();
    let scene = format!(
        "about = \"a floor\"\nsize = [200, 150]\n\
         [camera]\neye = [0, 9, 0]\ntarget = [0, 0, 0]\nup = [0.3, 0, -1]\nfov_y_deg = 40\n\
         [[mesh]]\nfile = \"model.obj\"\n\
         [[light]]\nname = \"sun\"\nkind = \"directional\"\ndirection = [{}, {}, {}]\n",
        0.8 * tilt.sin(),
        -tilt.cos(),
        0.6 * tilt.sin()
    );
    scene_of_texts(&scene, "o Floor\nv -9 0 -9\nv -9 0 9\nv 9 0 9\nv 9 0 -9\nf 1 2 3 4\n")
}

/// The closed-form bias of a lone plane in metres: the same everywhere but for rounding, so the largest.
fn closed_form_m(shot: &Shot<'_>, lookup: &Lookup, kernel: f64) -> f64 {
    let biases = shot.asked().into_iter().map(|pixel| {
        let Receiver { point_in_world, normal_in_world, .. } = receiver(shot, pixel);
        let site = lookup.project(point_in_world).expect("in the map");
        lookup.closed_form(&site, normal_in_world, DVec2::splat(kernel)) * site.metres_per_depth()
    });
    biases.fold(0.0, f64::max)
}

/// Differing pixels with a bias of that many metres for all receivers.
fn acne(shot: &Shot<'_>, typed: &str, bias_m: f64) -> u64 {
    shot.evaluate(&format!("{typed},bias=none,bias_depth_m={bias_m}")).verdict.pixels.differing
}

/// Just enough: the whole closed form leaves nothing, 95 % of it leaves some.
#[test]
fn the_closed_form_is_the_least_bias_without_acne() {
    for tilt_deg in [10.0, 25.0, 40.0, 55.0, 70.0, 80.0, 85.0] {
        let scene = tilted(tilt_deg);
        let shot = Shot::new(&scene, "sun");
        let typed = "map:size=500,bias_cap_texels=100";
        assert_eq!(shot.evaluate(typed).verdict.pixels.differing, 0, "{tilt_deg}");
        let bias_m = closed_form_m(&shot, &lookup(&shot, typed), 0.5);
        let (whole, most) = (acne(&shot, typed, bias_m), acne(&shot, typed, 0.95 * bias_m));
        println!("tilt {tilt_deg}: {bias_m:.4} m leaves {whole} px, 95 % of it {most}");
        assert!(whole == 0 && most > 0, "{tilt_deg}: {whole} {most}");
        // Without any, half of the plane is in its own shadow, at every tilt.
        let unbiased = shot.evaluate("map:size=500,bias=none").verdict.pixels;
        let share = unbiased.wrong as f64 / unbiased.asked as f64;
        assert!((share - 0.5).abs() < 0.02, "{tilt_deg}: {share}");
    }
}

#[test]
fn a_box_of_n_taps_needs_n_halves_of_a_texel() {
    let scene = tilted(50.0);
    let shot = Shot::new(&scene, "sun");
    for n in [1, 2, 3, 4, 5, 8] {
        let typed = format!("map:size=300,filter=pcf-box{n}");
        let kernel = 0.5 * f64::from(n);
        let bias_m = closed_form_m(&shot, &lookup(&shot, &typed), kernel);
        let (whole, most) = (acne(&shot, &typed, bias_m), acne(&shot, &typed, 0.95 * bias_m));
        println!("pcf-box{n}: {bias_m:.4} m leaves {whole} px, 95 % of it {most}");
        assert!(whole == 0 && most > 0, "{n}: {whole} {most}");
        assert_eq!(shot.evaluate(&typed).verdict.pixels.differing, 0, "pcf-box{n}");
    }
}

/// Of the fin's shadow a strip of b · cos(elevation) comes undone, measured along the light from the side of the fin
/// that the map holds.
#[test]
fn a_contact_comes_undone_by_the_bias_times_the_cosine_of_the_elevation() {
    let scene = shipped("contact", [512, 384]);
    let shot = Shot::new(&scene, "sun");
    let travel = -shot.question.light.homogeneous().truncate();
    let elevation = (-travel.y).asin();
    let fin = scene.bounds_of(|mesh| mesh.name == "Fin");
    for bias_m in [0.05, 0.1, 0.2] {
        let evaluation = shot.evaluate(&format!("map:size=4096,bias=none,bias_depth_m={bias_m}"));
        let (mut farthest_lit, mut nearest_dark) = (0.0_f64, f64::INFINITY);
        let mut pixel_m = 0.0_f64;
        for pixel in shot.asked() {
            let receiver = receiver(&shot, pixel);
            let is_shadow = shot.question.truth.mask.pixels[pixel as usize] == Some(Truth::Known(Visibility::SHADOW));
            let behind_m = receiver.point_in_world.z - fin.min.z;
            // The middle of the shadow, where the fin's ends and top play no part.
            let foot_x = receiver.point_in_world.x - travel.x / travel.z * behind_m;
            if scene.mesh_of(receiver.triangle).name != "Floor" || !is_shadow || foot_x.abs() > 0.5 || behind_m > 0.5 {
                continue;
            }
            let along_m = behind_m * travel.with_y(0.0).length() / travel.z;
            match evaluation.mask.pixels[pixel as usize] {
                Some(Visibility::LIT) => farthest_lit = farthest_lit.max(along_m),
                _ => nearest_dark = nearest_dark.min(along_m),
            }
            pixel_m = pixel_m.max(pixel_depth_m(&scene, receiver.point_in_world));
        }
        let predicted = bias_m * elevation.cos();
        println!("bias {bias_m}: lit up to {farthest_lit:.4} m, dark from {nearest_dark:.4}, predicted {predicted:.4}");
        for measured in [farthest_lit, nearest_dark] {
            assert!((measured - predicted).abs() <= pixel_m, "{bias_m}: {measured} {predicted}, a pixel is {pixel_m}");
        }
    }
}

/// How deep one pixel is on the floor, metres.
fn pixel_depth_m(scene: &Scene, point: DVec3) -> f64 {
    let step = 1e-4;
    step / (in_picture(scene, point + step * DVec3::Z) - in_picture(scene, point)).length()
}

/// Control: the comparison of prediction and measurement is no tautology. Another map's prediction does not fit.
#[test]
fn the_prediction_of_another_map_does_not_fit() {
    let scene = straight_edge(45.0);
    let shot = Shot::new(&scene, "sun");
    let measured = step_px(&shot, &shot.evaluate("map:width_m=20,size=160").mask.pixels);
    let other = shot.evaluate("map:width_m=20,size=200").prepared.footprint(192 * 512 + 300).expect("in the map").m;
    assert!((measured / other - 1.0).abs() > 0.10, "{measured} {other}");
}
