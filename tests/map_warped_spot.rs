//! Warps across lights that are somewhere: for them the light's post-perspective space is the world of a parallel light.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout, reason = "tests")]

mod support;

use glam::{DVec2, DVec3, Vec3};
use gnomon::cause::Cause;
use gnomon::scene::{Falloff, LightKind, Scene};
use gnomon::technique::map::Settings;
use gnomon::technique::map::projection::View;
use support::scenes::{scene_of_texts, shadowed, shipped};
use support::shot::{Shot, named, parsed};
use support::testing::Random;
use support::texels::diagonals_over_predicted;

const WARPED: &str = "map:projection=light-space-perspective";

/// A floor with a block on it under a spot.
fn floor() -> Scene {
    let scene = "about = \"a floor\"\nsize = [160, 120]\n\
         [camera]\neye = [0, 2, 6]\ntarget = [0, 0, 0]\n\
         [[mesh]]\nfile = \"model.obj\"\n\
         [[light]]\nname = \"spot\"\nkind = \"spot\"\nposition = [3, 5, 0]\ntarget = [0, 0, 0]\ncone_deg = 70\n";
    let model = "o Floor\nv -20 0 -20\nv -20 0 20\nv 20 0 20\nv 20 0 -20\nf 1 2 3 4\n\
                 o Sail\nv -1 0.2 -1\nv 1 0.2 -1\nv 0 1.5 -1\nf 5 6 7\n";
    scene_of_texts(scene, model)
}

fn spot(position: DVec3, target: DVec3, outer_rad: f64) -> LightKind {
    let (position, axis) = (position.as_vec3(), (target - position).normalize().as_vec3());
    LightKind::Spot { position, axis, outer_rad, falloff: Falloff::Hard, attenuation: [1.0, 0.0, 0.0] }
}

fn fitted(scene: &Scene, typed: &str, visible: &[DVec3]) -> View {
    let settings = Settings::of(&parsed(typed));
    settings.projection.fit(scene, &scene.lights[0], &settings, visible).expect("supported").remove(0)
}

/// A camera and a spot anywhere, and what both see of the floor.
fn any_set_up(scene: &mut Scene, random: &mut Random) -> Vec<DVec3> {
    let light = 4.0 * random.in_cube() + 5.0 * DVec3::Y;
    let target = 3.0 * random.in_cube() * DVec3::new(1.0, 0.1, 1.0);
    let outer_rad = 0.1 + 1.1 * random.unit();
    let eye = 9.0 * random.in_cube() + 9.2 * DVec3::Y;
    let looks_at = 4.0 * random.in_cube() * DVec3::new(1.0, 0.2, 1.0);
    scene.lights[0].kind = spot(light, target, outer_rad);
    (scene.camera.eye, scene.camera.target) = (eye.as_vec3(), looks_at.as_vec3());
    let on_floor = |_| 8.0 * random.in_cube() * DVec3::new(1.0, 0.0, 1.0);
    let is_seen = |point: &DVec3| {
        (target - light).angle_between(*point - light) < outer_rad && (looks_at - eye).dot(*point - eye) > 0.1
    };
    (0..400).map(on_floor).filter(is_seen).collect()
}

/// As in light space: all of the body inside, light along depth alone and in its order, nothing mirrored.
#[test]
fn any_set_up_keeps_rays_in_their_texels_and_depths_in_their_order() {
    /// Rows of f32, at up to 11 (tan 85 degrees) times the distance along the axis.
    const WITHIN: f64 = 1e-4;
    let (mut scene, mut random) = (floor(), Random(7));
    let (mut warped, mut eye_behind, mut farthest) = (0, 0, 0.0_f64);
    for i in 0..1000 {
        let visible = any_set_up(&mut scene, &mut random);
        if visible.len() < 3 {
            continue;
        }
        let convention = if i % 2 == 0 { "" } else { ",depth_convention=forward" };
        let view = fitted(&scene, &format!("{WARPED}{convention}"), &visible);
        let LightKind::Spot { position, axis, .. } = scene.lights[0].kind else { panic!() };
        let light = position.as_dvec3();
        warped += u32::from(view.window.starts_with("warped"));
        eye_behind += u32::from(axis.dot(scene.camera.eye - position) <= 0.0);
        for point in visible {
            let at = view.project(point);
            assert!(at.uv.min_element() >= 0.0 && at.uv.max_element() < 1.0 && at.q > 0.0, "{i}: {at:?}");
            assert!((0.0..=1.0).contains(&at.depth), "{i}: {at:?}");
            let mut behind = at;
            for share in [0.1, 0.5, 0.9] {
                let nearer = view.project(point.lerp(light, share));
                farthest = farthest.max((nearer.uv - at.uv).length());
                assert!(view.is_nearer(nearer.depth, behind.depth), "{i}: {nearer:?} {behind:?}");
                behind = nearer;
            }
            // Counter-clockwise as the light sees it.
            let towards = (light - point).normalize();
            let side = towards.any_orthonormal_vector();
            let [a, b, c] = [DVec3::ZERO, side, towards.cross(side)].map(|step| view.project(point + 1e-3 * step).uv);
            let area = ((b - a) * DVec2::new(1.0, -1.0)).perp_dot((c - a) * DVec2::new(1.0, -1.0));
            assert_eq!(area.signum(), view.winding(scene.lights[0].homogeneous()), "{i}");
        }
    }
    println!("{warped} warped, {eye_behind} with the eye behind the light, rays leave by {farthest:e}");
    assert!(farthest < WITHIN && warped > 300 && eye_behind > 50, "{farthest} {warped} {eye_behind}");
}

#[test]
fn along_the_spots_axis_the_map_is_the_uniform_one() {
    let mut scene = floor();
    scene.lights[0].kind = spot(DVec3::new(0.5, 5.0, 4.0), DVec3::new(0.5, 0.0, -1.0), 0.5);
    (scene.camera.eye, scene.camera.target) = (Vec3::new(0.0, 5.0, 4.0), Vec3::new(0.01, 0.0, -1.0));
    let shot = Shot::new(&scene, "spot");
    let uniform = shot.evaluate("map:size=200,fit=receivers").mask;
    assert!(uniform == shot.evaluate(&format!("{WARPED},size=200")).mask, "a tenth of a degree is not warped");
    assert!(uniform != shot.evaluate(&format!("{WARPED},size=200,min_angle_deg=0.01")).mask);
}

/// With the rim of the cone in view: nothing to gain, and from far away the warp is no warp.
#[test]
fn a_warp_from_far_away_is_single() {
    const WITHIN: f64 = 2e-3;
    let (light, outer_rad) = (DVec3::new(0.3, 5.0, 0.2), 0.6_f64);
    let mut scene = floor();
    scene.lights[0].kind = spot(light, light - DVec3::Y, outer_rad);
    let on_rim = |i: u32| {
        let angle = f64::from(i) * std::f64::consts::TAU / 720.0;
        light + 5.0 * DVec3::new(outer_rad.tan() * angle.cos(), -1.0, outer_rad.tan() * angle.sin())
    };
    let rim: Vec<DVec3> = (0..720).map(on_rim).map(|point| light.lerp(point, 1.0 - 1e-6)).collect();
    let of_texel = |typed: &str| {
        let view = fitted(&scene, typed, &rim);
        let sizes = rim.iter().map(|point| view.site(*point).texel_m());
        let all: Vec<f64> = sizes.flat_map(|size| size.to_array()).collect();
        [f64::min, f64::max].map(|most| all.iter().copied().reduce(most).unwrap())
    };
    let single = of_texel("map");
    let far = of_texel(&format!("{WARPED},n_opt_scale=1e6"));
    let warped = of_texel(WARPED);
    println!("single {single:?}, warped from far away {far:?}, warped {warped:?}");
    assert!(single.iter().zip(far).all(|(a, b)| (a / b - 1.0).abs() < WITHIN));
    assert!(warped[1] / warped[0] > 1.5 * single[1] / single[0]);
}

/// High above a floor and across the view, a spot's space is the floor, and the warp is that of a sun: the largest texel
/// along the view is the published one.
#[test]
fn across_the_view_the_largest_texel_is_the_suns() {
    const WITHIN: f64 = 0.02;
    const SIZE: f64 = 4096.0;
    let (near_m, far_m) = (1.0_f64, 100.0_f64);
    let mut scene = scene_of_texts(
        "about = \"a floor\"\nsize = [100, 100]\n\
         [camera]\neye = [0, 0.5, 0]\ntarget = [0, 0.5, -1]\nfov_y_deg = 90\nnear = 1.0\n\
         [[mesh]]\nfile = \"model.obj\"\n\
         [[light]]\nname = \"spot\"\nkind = \"spot\"\nposition = [0, 60, -50]\ntarget = [0, 0, -50]\ncone_deg = 140\n",
        "o Floor\nv -99 0 -100\nv -99 0 99\nv 99 0 99\nv 99 0 -100\nf 1 2 3 4\n",
    );
    let at = |i: u32| near_m * (far_m / near_m).powf(f64::from(i) / 60.0);
    let seen: Vec<DVec3> =
        (0..=60).map(at).flat_map(|d| [-1.0, 0.0, 1.0].map(|x| DVec3::new(x * d, 0.0, -d))).collect();
    for (height_m, side_m) in [(60.0, 0.0), (90.0, 0.0), (60.0, 20.0)] {
        let light = DVec3::new(side_m, height_m, -50.0);
        scene.lights[0].kind = spot(light, light - DVec3::Y, 1.2);
        let view = fitted(&scene, &format!("{WARPED},size={SIZE},fit_margin_texels=0"), &seen);
        let along = |d: f64| {
            let steps = view.site(DVec3::new(0.0, 0.0, -d)).texel_steps_m(DVec3::Y);
            SIZE * steps.map(|step| step.z.abs()).into_iter().fold(0.0, f64::max) / d
        };
        let largest = (0..=60).map(at).map(along).fold(0.0, f64::max);
        let expected = (far_m - near_m) / (near_m * far_m).sqrt();
        println!("{light}: {largest:.3} along (predicted {expected:.3})");
        assert!((largest / expected - 1.0).abs() < WITHIN, "{largest} {expected}");
    }
}

#[test]
fn a_spots_texels_are_as_large_in_the_picture_as_predicted() {
    const WITHIN: f64 = 0.10;
    for [x, y, z] in [[-9.0, 12.0, -6.0], [8.0, 9.0, 4.0], [0.0, 14.0, -16.0]] {
        let mut scene = shipped("posts", [400, 300]);
        scene.lights[0].kind = spot(DVec3::new(x, y, z), DVec3::new(0.6, 0.0, -7.0), 0.7);
        let shot = Shot::new(&scene, "sun");
        let typed = format!("{WARPED},size=64");
        let evaluation = shot.evaluate(&typed);
        let ratios = diagonals_over_predicted(&shot, &evaluation, &typed);
        let median = ratios[ratios.len() / 2];
        println!("{} texels, measured / predicted {median:.3}", ratios.len());
        assert!(ratios.len() >= 10 && (median - 1.0).abs() < WITHIN, "{median} of {}", ratios.len());
    }
}

/// The camera's axis runs level with the lamp, and through it: none of the axis has a place in the lamp's picture.
#[test]
fn a_lamp_on_the_cameras_axis_has_a_trapezoid() {
    let scene = "about = \"a plate under a lamp ahead\"\nsize = [160, 120]\n\
         [camera]\neye = [0, 2, 6]\ntarget = [0, 2, 0]\nfov_y_deg = 60\n\
         [[mesh]]\nfile = \"model.obj\"\n\
         [[light]]\nname = \"spot\"\nkind = \"spot\"\nposition = [0, 2, 0]\ntarget = [0, 0, 0]\ncone_deg = 90\n";
    let model = "o Floor\nv -9 0 -9\nv -9 0 9\nv 9 0 9\nv 9 0 -9\nf 1 2 3 4\n\
                 o Plate\nv -0.5 1 -0.5\nv -0.5 1 0.5\nv 0.5 1 0.5\nv 0.5 1 -0.5\nf 5 6 7 8\n";
    let scene = scene_of_texts(scene, model);
    let shot = Shot::new(&scene, "spot");
    let in_shadow = shadowed(&shot.question.truth.mask);
    let wrong = shot.evaluate("map:projection=trapezoidal").verdict.pixels.wrong as usize;
    assert!(in_shadow > 100 && 10 * wrong < in_shadow, "{wrong} wrong of {in_shadow} in shadow");
}

/// A wall behind the eye, below the spot that stands behind it.
#[test]
fn a_caster_behind_the_eye_casts() {
    let scene = "about = \"a wall behind the eye\"\nsize = [160, 120]\n\
         [camera]\neye = [0, 2, 0]\ntarget = [0, 0, -6]\nfov_y_deg = 50\n\
         [[mesh]]\nfile = \"model.obj\"\n\
         [[light]]\nname = \"spot\"\nkind = \"spot\"\nposition = [-1, 6, 8]\ntarget = [0, 0, -6]\ncone_deg = 70\n";
    let model = "o Floor\nv -30 0 -30\nv -30 0 9\nv 30 0 9\nv 30 0 -30\nf 1 2 3 4\n\
                 o Wall\nv -1.5 2.2 4\nv 1.2 2.2 4\nv 1.2 4.1 4\nv -1.5 4.1 4\nf 5 6 7 8\n";
    let scene = scene_of_texts(scene, model);
    let shot = Shot::new(&scene, "spot");
    let in_shadow = shadowed(&shot.question.truth.mask);
    let wrong = shot.evaluate(WARPED).verdict.pixels.wrong as usize;
    println!("{wrong} wrong of {in_shadow} in shadow");
    assert!(in_shadow > 500 && wrong * 20 < in_shadow, "{wrong} of {in_shadow}");
    let cut = shot.evaluate(&format!("{WARPED},near_m=7"));
    assert!(named(&cut, &[Cause::ClippingNear]).len() * 10 > 9 * in_shadow, "a near plane behind the wall loses it");
}

/// Casters all around the light: rays end at it, where its space has no end.
#[test]
fn a_light_within_its_shade_casts_like_any_other() {
    let scene = "about = \"a lamp in a shade\"\nsize = [160, 120]\n\
         [camera]\neye = [0, 3, 7]\ntarget = [0, 1, 0]\n\
         [[mesh]]\nfile = \"model.obj\"\n\
         [[light]]\nname = \"spot\"\nkind = \"spot\"\nposition = [0.1, 3, 0.05]\ntarget = [0, 0, 0]\ncone_deg = 120\n";
    // A pyramid without a bottom around the light, and a sail below.
    let model = "o Floor\nv -9 0 -9\nv -9 0 9\nv 9 0 9\nv 9 0 -9\nf 1 2 3 4\n\
                 o Shade\nv -0.6 2.5 -0.6\nv -0.6 2.5 0.6\nv 0.6 2.5 0.6\nv 0.6 2.5 -0.6\nv 0 3.5 0\nf 5 6 9\nf 6 7 9\nf 7 8 9\nf 8 5 9\n\
                 o Sail\nv -1 0.2 -1\nv 1 0.2 -1\nv 0 1.5 -1\nf 10 11 12\n";
    let scene = scene_of_texts(scene, model);
    let shot = Shot::new(&scene, "spot");
    let in_shadow = shadowed(&shot.question.truth.mask);
    let wrong = shot.evaluate(WARPED).verdict.pixels.wrong as usize;
    println!("{wrong} wrong of {in_shadow} in shadow");
    assert!(in_shadow > 500 && wrong * 50 < in_shadow, "{wrong} of {in_shadow}");
}

#[test]
fn warped_maps_of_spots_err_less_and_show_no_acne() {
    for (name, light) in [("bleeding", "lamp"), ("room", "spot")] {
        let scene = shipped(name, [320, 240]);
        let shot = Shot::new(&scene, light);
        let uniform = shot.evaluate("map:size=512,fit=receivers").verdict.pixels.wrong;
        let warped = shot.evaluate(&format!("{WARPED},size=512"));
        let acne = named(&warped, &[Cause::Acne, Cause::Precision]).len();
        println!("{name}: {} wrong (uniform {uniform}), {acne} of acne", warped.verdict.pixels.wrong);
        assert!(warped.verdict.pixels.wrong < uniform && acne <= 2, "{name}: {acne}");
    }
}
