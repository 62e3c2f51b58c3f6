//! Biases that follow the receiver's plane: none leaves acne on a plane, whatever its tilt, the light and the filter; each
//! is the least of its kind; and at contacts each costs what its formula says.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "tests")]

mod support;

use glam::DVec3;
use gnomon::cause::Cause;
use gnomon::mask::{Truth, Visibility};
use gnomon::scene::Scene;
use gnomon::technique::map::{Lookup, Settings};
use support::scenes::{scene_of_texts, shipped};
use support::shot::{Shot, parsed};

const DERIVED: [&str; 4] = ["closed-form", "normal", "receiver-plane", "midpoint"];
const FILTERS: [&str; 5] = ["nearest", "pcf-box4", "pcf-box5", "pcf-bilinear3", "pcf-poisson16"];

/// A plane that leans along no axis, under a sun and a lamp straight above; the light's tilt to it is `tilt_deg`.
fn leaning(tilt_deg: f64) -> Scene {
    const HALF_M: f64 = 3.0;
    let slope = tilt_deg.to_radians().tan();
    let scene = "about = \"a leaning plane\"\nsize = [120, 90]\n\
         [camera]\neye = [0.1, 9, 0.2]\ntarget = [0, 0, 0]\nup = [0.3, 0, -1]\nfov_y_deg = 25\n\
         [[mesh]]\nfile = \"model.obj\"\n\
         [[light]]\nname = \"sun\"\nkind = \"directional\"\ndirection = [0, -1, 0]\n\
         [[light]]\nname = \"lamp\"\nkind = \"point\"\nposition = [0, 40, 0]\n";
    // Within the lamp's reach even where it is steepest.
    let corner = |x: f64, z: f64| format!("v {x} {} {z}\n", (slope * (0.8 * x + 0.6 * z)).clamp(-35.0, 35.0));
    let reach = HALF_M.min(35.0 / (1.4 * slope));
    let corners: String =
        [(-reach, -reach), (-reach, reach), (reach, reach), (reach, -reach)].map(|(x, z)| corner(x, z)).concat();
    scene_of_texts(scene, &format!("o Plane\n{corners}f 1 2 3 4\n"))
}

/// A plane's own samples never darken it.
#[test]
fn no_plane_shadows_itself_at_any_tilt_under_any_filter() {
    for tilt_deg in [5.0, 45.0, 80.0, 87.0] {
        let scene = leaning(tilt_deg);
        for (light, projection) in [
            ("sun", "single"),
            ("lamp", "single"),
            ("lamp", "cube"),
            ("sun", "cascaded"),
            ("sun", "perspective"),
            ("sun", "light-space-perspective"),
            ("lamp", "light-space-perspective"),
            ("sun", "trapezoidal"),
            ("lamp", "trapezoidal"),
            ("sun", "adaptive"),
            ("lamp", "dual-paraboloid"),
        ] {
            let shot = Shot::new(&scene, light);
            // An offset along the normal clears a plane to first order only, where depth bends over it.
            let suits = |bias: &&&str| !(projection == "trapezoidal" && **bias == "normal");
            let biases = DERIVED.iter().filter(suits);
            let is_plain = ["single", "cube", "cascaded"].contains(&projection);
            let filters = if is_plain { &FILTERS[..] } else { &["nearest", "pcf-box5"] };
            for (bias, filter) in biases.flat_map(|bias| filters.iter().map(move |filter| (bias, filter))) {
                let axes = format!("projection={projection},filter={filter},bias={bias},bias_cap_texels=1000");
                let pixels = shot.evaluate(&format!("map:size=200,{axes}")).verdict.pixels;
                assert_eq!(pixels.differing, 0, "tilt {tilt_deg}, {light}, {axes}, of {}", pixels.asked);
            }
            let unbiased = shot.evaluate(&format!("map:size=200,projection={projection},bias=none")).verdict.pixels;
            assert!(unbiased.differing > unbiased.asked / 4, "control: {tilt_deg} {light} {projection}");
        }
    }
}

fn lookup(shot: &Shot<'_>, typed: &str) -> Lookup {
    let settings = Settings::of(&parsed(typed));
    let (scene, light) = (shot.view.scene, shot.question.light);
    Lookup::new(settings.projection.fit(scene, light, &settings, &[]).unwrap(), &settings, light)
}

/// Half a texel's width times the sine of the tilt times |cos a| + |sin a|, a being its azimuth: what 95 % of does not
/// suffice.
#[test]
fn the_normal_offset_is_the_least_without_acne() {
    for tilt_deg in [20.0, 60.0, 85.0] {
        let scene = leaning(tilt_deg);
        let shot = Shot::new(&scene, "sun");
        let lookup = lookup(&shot, "map:size=200,bias=normal");
        let receiver = shot.view.receivers.pixels[shot.asked()[0] as usize].unwrap();
        let (point, normal) = (receiver.point_in_world, receiver.normal_in_world);
        let texel_m = lookup.project(point).unwrap().texel_m().max_element();
        let predicted_m = 0.5 * texel_m * (normal.x.abs() + normal.z.abs());
        let offset_m = lookup.normal_offset_m(0, point, normal);
        assert!((offset_m / predicted_m - 1.0).abs() < 1e-5, "{tilt_deg}: {offset_m} m, not {predicted_m} m");
        let sine = normal.with_y(0.0).length();
        let acne = |share: f64| {
            let texels = share * offset_m / (texel_m * sine);
            shot.evaluate(&format!("map:size=200,bias=none,bias_normal_texels={texels}")).verdict.pixels.differing
        };
        let (more, less) = (acne(1.005), acne(0.95));
        println!("tilt {tilt_deg}: {offset_m:.4} m leaves {more} px, 95 % of it {less}");
        assert!(more == 0 && less > 0, "{tilt_deg}: {more} {less}");
    }
}

/// How far along the light the floor of `scenes/contact` is lit behind the upright fin, metres, and how deep a pixel is.
fn lit_strip_m(shot: &Shot<'_>, typed: &str) -> (f64, f64) {
    let scene = shot.view.scene;
    let fin = scene.bounds_of(|mesh| mesh.name == "Fin");
    let travel = -shot.question.light.homogeneous().truncate();
    let evaluation = shot.evaluate(typed);
    let (mut farthest_lit, mut pixel_m) = (0.0_f64, 0.0_f64);
    for pixel in shot.asked() {
        let receiver = shot.view.receivers.pixels[pixel as usize].unwrap();
        let is_shadow = shot.question.truth.mask.pixels[pixel as usize] == Some(Truth::Known(Visibility::SHADOW));
        let behind_m = receiver.point_in_world.z - fin.min.z;
        // The middle of the shadow, where the fin's ends and top play no part.
        let foot_x = receiver.point_in_world.x - travel.x / travel.z * behind_m;
        if scene.mesh_of(receiver.triangle).name != "Floor" || !is_shadow || foot_x.abs() > 0.5 || behind_m > 0.5 {
            continue;
        }
        let along = travel.with_y(0.0).length() / travel.z;
        let row_m = {
            let clip = |point: DVec3| scene.camera.clip_from_world(scene.image_size).project_point3(point);
            let step = 1e-4 * DVec3::Z;
            let (here, there) = (clip(receiver.point_in_world), clip(receiver.point_in_world + step));
            1e-4 / (0.5 * f64::from(scene.image_size.y) * (there - here).y.abs())
        };
        pixel_m = pixel_m.max(along * row_m);
        if evaluation.mask.pixels[pixel as usize] == Some(Visibility::LIT) {
            farthest_lit = farthest_lit.max(along * behind_m);
        }
    }
    (farthest_lit, pixel_m)
}

/// A bias of b along the light costs a strip of b · cos(elevation) behind a thin upright blocker; an offset along the
/// floor's normal and the plane's own depth cost none.
#[test]
fn a_contact_comes_undone_by_what_moves_the_comparison_along_the_light() {
    let scene = shipped("contact", [256, 192]);
    let shot = Shot::new(&scene, "sun");
    let travel = -shot.question.light.homogeneous().truncate();
    let cosine = travel.with_y(0.0).length();
    let typed = "map:size=1024,bias=none";
    let texel_m = {
        let receiver = shot.view.receivers.pixels[shot.asked()[0] as usize].unwrap();
        lookup(&shot, typed).project(receiver.point_in_world).unwrap().texel_m().max_element()
    };
    for texels in [8.0, 16.0] {
        let (lit_m, pixel_m) = lit_strip_m(&shot, &format!("{typed},bias_depth_texels={texels}"));
        let predicted_m = texels * texel_m * cosine;
        println!("{texels} texels: lit up to {lit_m:.4} m, predicted {predicted_m:.4} m, a pixel is {pixel_m:.4} m");
        // Within a pixel, and within the texel that the fin's edge falls in.
        assert!((lit_m - predicted_m).abs() <= pixel_m + texel_m, "{texels}: {lit_m} {predicted_m}");
    }
    for unmoved in ["map:size=1024,bias=receiver-plane", "map:size=1024,bias=normal,bias_normal_texels=8"] {
        let (lit_m, pixel_m) = lit_strip_m(&shot, unmoved);
        println!("{unmoved}: lit up to {lit_m:.4} m");
        assert!(lit_m <= pixel_m + 2.0 * texel_m, "{unmoved}: {lit_m}");
    }
}

/// A plate over a floor, which casts or does not.
fn plate_over_floor(floor_casts: bool) -> Scene {
    let scene = format!(
        "about = \"a plate over a floor\"\nsize = [192, 144]\n\
         [camera]\neye = [0, 7, 4]\ntarget = [0, 0, 0]\n\
         [[mesh]]\nfile = \"model.obj\"\nobjects = [\"Floor\"]\ncasts = {floor_casts}\n\
         [[mesh]]\nfile = \"model.obj\"\nobjects = [\"Plate\"]\n\
         [[light]]\nname = \"sun\"\nkind = \"directional\"\ndirection = [0.2, -1, -0.3]\n"
    );
    let model = "o Floor\nv -4 0 -4\nv -4 0 4\nv 4 0 4\nv 4 0 -4\nf 1 2 3 4\n\
                 o Plate\nv -1 1 -1\nv -1 1 1\nv 1 1 1\nv 1 1 -1\nf 5 6 7 8\n";
    scene_of_texts(&scene, model)
}

/// The middle lies between the plate and the floor; without a floor in the map there is no middle, and no shadow.
#[test]
fn a_midpoint_needs_a_second_surface() {
    const SIZED: &str = "map:size=256,bias=midpoint";
    let (with, without) = (plate_over_floor(true), plate_over_floor(false));
    let (with, without) = (Shot::new(&with, "sun"), Shot::new(&without, "sun"));
    let of_both = [with.evaluate(SIZED), without.evaluate(SIZED), without.evaluate("map:size=256")];
    let [by_both, lost, closed_form] = of_both.each_ref().map(|evaluation| &evaluation.ledger.causes);
    assert!(!by_both.contains_key(&Cause::Acne) && !by_both.contains_key(&Cause::PeterPanning), "{by_both:?}");
    let shadowed = without.question.truth.mask.pixels.iter().filter(|t| **t == Some(Truth::Known(Visibility::SHADOW)));
    let (shadowed, wrong) = (shadowed.count() as u64, of_both[1].verdict.pixels.wrong);
    assert_eq!(wrong, shadowed, "all of the shadow is lost");
    // Texels at the shadow's edge are coarse either way.
    assert!(wrong > 100 && lost[&Cause::PeterPanning].pixels * 5 > wrong * 4, "{lost:?}");
    assert!(!closed_form.contains_key(&Cause::PeterPanning), "{closed_form:?}");
    let refused = with.evaluate_if_supported(&parsed("map:bias=midpoint,caster_sides=away-facing"));
    assert!(refused.is_none());
}
