//! Cube maps against exact rays: whatever surrounds a light, in all six directions and across every seam.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout, reason = "tests")]

mod support;

use glam::{DVec2, DVec3, Vec3};
use gnomon::evaluate::Evaluation;
use gnomon::receiver::Receiver;
use gnomon::scene::Scene;
use gnomon::technique::map::{Lookup, Settings};
use std::fmt::Write;
use support::scenes::scene_of_texts;
use support::shot::{Shot, parsed};

/// A box's eight corners and six sides, wound outwards.
fn cuboid(model: &mut String, name: &str, centre: Vec3, half: Vec3, first: &mut u32) {
    writeln!(model, "o {name}").unwrap();
    for corner in 0..8 {
        let sign = |bit: u32| if corner >> bit & 1 == 0 { -1.0 } else { 1.0 };
        let at = centre + half * Vec3::new(sign(0), sign(1), sign(2));
        writeln!(model, "v {} {} {}", at.x, at.y, at.z).unwrap();
    }
    for side in [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]] {
        let [a, b, c, d] = side.map(|corner| corner + *first);
        writeln!(model, "f {a} {b} {c} {d}").unwrap();
    }
    *first += 8;
}

/// A lamp in a closed room with a small box in each of the six directions; the camera is in a corner.
fn closed_room(corner: f32) -> Scene {
    let (mut model, mut first) = (String::new(), 1);
    cuboid(&mut model, "Room", Vec3::new(0.1, 0.2, -0.1), Vec3::splat(3.0), &mut first);
    for (i, axis) in [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z].into_iter().enumerate() {
        cuboid(&mut model, &format!("Box{i}"), 1.2 * axis + Vec3::splat(0.13), Vec3::splat(0.21), &mut first);
    }
    let scene = format!(
        "about = \"a closed room\"\nsize = [160, 120]\n\
         [camera]\neye = [{0}, {0}, {0}]\ntarget = [0, 0, 0]\nfov_y_deg = 110\n\
         [[mesh]]\nfile = \"model.obj\"\n\
         [[light]]\nname = \"lamp\"\nkind = \"point\"\nposition = [0, 0, 0]\nintensity = [9, 9, 9]\n",
        2.6 * corner
    );
    scene_of_texts(&scene, &model)
}

/// A sphere of facets around the light, which lights all of it; the camera inside looks at a corner of the cube.
fn sphere() -> Scene {
    const AROUND: usize = 48;
    let mut model = String::from("o Sphere\n");
    for ring in 0..=AROUND / 2 {
        let height = std::f64::consts::TAU * ring as f64 / AROUND as f64;
        for i in 0..AROUND {
            let turn = std::f64::consts::TAU * i as f64 / AROUND as f64;
            let at = 2.0 * DVec3::new(height.sin() * turn.cos(), height.cos(), height.sin() * turn.sin());
            writeln!(model, "v {} {} {}", at.x, at.y, at.z).unwrap();
        }
    }
    for ring in 0..AROUND / 2 {
        for i in 0..AROUND {
            let [a, b] = [i, (i + 1) % AROUND].map(|i| ring * AROUND + i + 1);
            writeln!(model, "f {a} {b} {} {}", b + AROUND, a + AROUND).unwrap();
        }
    }
    let scene = "about = \"a sphere around a lamp\"\nsize = [160, 120]\n\
         [camera]\neye = [-0.9, -0.9, -0.9]\ntarget = [0, 0, 0]\nfov_y_deg = 120\n\
         [[mesh]]\nfile = \"model.obj\"\n\
         [[light]]\nname = \"lamp\"\nkind = \"point\"\nposition = [0, 0, 0]\nintensity = [9, 9, 9]\n";
    scene_of_texts(scene, &model)
}

fn lookup(shot: &Shot<'_>, typed: &str) -> Lookup {
    let settings = Settings::of(&parsed(typed));
    let (scene, light) = (shot.view.scene, shot.question.light);
    Lookup::new(settings.projection.fit(scene, light, &settings, &[]).expect("supported"), &settings, light)
}

fn receiver(shot: &Shot<'_>, pixel: u32) -> Receiver {
    shot.view.receivers.pixels[pixel as usize].expect("asked")
}

/// The truth at the place where a lookup's texel has its centre, on the receiver's plane.
fn lit_at_texel_centre(shot: &Shot<'_>, lookup: &Lookup, receiver: &Receiver) -> bool {
    let site = lookup.project(receiver.point_in_world).expect("inside a face");
    let at = site.position_in_texels();
    let [along_u, along_v] = site.texel_steps_m(receiver.normal_in_world);
    let aside = at.floor() + 0.5 - at;
    let point = receiver.point_in_world + aside.x * along_u + aside.y * along_v;
    let segment = shot.question.light.segment_from(point, shot.view.scene.bounds().radius());
    shot.view.casters.any_hit(&segment, Some(receiver.triangle)).is_none()
}

/// CU-3: every answer is the truth at the texel's centre, whichever of the six faces holds it.
#[test]
fn in_a_closed_room_each_answer_is_the_truth_at_its_texels_centre() {
    /// A step of a texel on a plane is straight in the map to first order, and what it moves by may cross an edge; a
    /// step that leaves the receiver's surface asks about a point in the air.
    const OFF_SHARE: f64 = 2e-3;
    let typed = "map:projection=cube,size=300";
    let mut seen = std::collections::BTreeSet::new();
    for corner in [-1.0, 1.0] {
        let scene = closed_room(corner);
        let shot = Shot::new(&scene, "lamp");
        let evaluation = shot.evaluate(typed);
        let lookup = lookup(&shot, typed);
        assert_eq!(lookup.views.len(), 6);
        let (mut off, mut asked, mut differs_from_truth) = (0, 0, 0);
        for pixel in shot.asked() {
            let receiver = receiver(&shot, pixel);
            seen.insert(lookup.select(receiver.point_in_world).first);
            let lit = evaluation.mask.pixels[pixel as usize].unwrap().get() > 0.5;
            off += u32::from(lit != lit_at_texel_centre(&shot, &lookup, &receiver));
            differs_from_truth += u32::from(evaluation.verdict.is_wrong(pixel as usize));
            asked += 1;
        }
        println!("{off} off, {differs_from_truth} wrong of {asked}");
        assert!(f64::from(off) <= OFF_SHARE * f64::from(asked), "{off} of {asked}");
        assert!(differs_from_truth > 3 * off, "texels are coarse enough to see");
    }
    assert_eq!(seen.len(), 6, "all six directions are seen");
}

/// CU-2: nothing shadows the inside of a sphere, on no seam and at no corner.
#[test]
fn inside_a_sphere_no_seam_darkens_anything() {
    let scene = sphere();
    let shot = Shot::new(&scene, "lamp");
    let differing = |typed: &str| shot.evaluate(typed).verdict.pixels.differing;
    for typed in
        ["size=16", "size=101", "size=64,filter=pcf-box5", "size=70,filter=pcf-box8", "size=256,filter=pcf-box3"]
    {
        // The metres clear the sphere's curvature within a kernel.
        assert_eq!(differing(&format!("map:projection=cube,bias_depth_m=0.08,{typed}")), 0, "{typed}");
    }
    // Controls: without a bias, and with a border for a seam.
    assert!(differing("map:projection=cube,size=64,bias=none") > 1000);
    let lookup = lookup(&shot, "map:projection=cube,size=64");
    let placed = |point: DVec3| lookup.place(lookup.select(point).first, point, -point.normalize()).unwrap();
    // Both faces name the same world texel where they meet.
    for (a, b) in
        [(DVec3::new(1.0, 0.999, 0.3), DVec3::new(0.999, 1.0, 0.3)), (DVec3::ONE, DVec3::new(1.0, 1.001, 1.0))]
    {
        let (a, b) = (placed(1.15 * a), placed(1.15 * b));
        assert_ne!(a.view, b.view);
        let normal = -a.point_in_world.normalize();
        let beyond = (a.position_in_texels + 64.0 * (a.position_in_texels - 32.0).signum() * 0.02).floor().as_ivec2();
        let across = lookup.tap(&a, normal, beyond).unwrap();
        let off = (across.texel.as_dvec2() + 0.5 - b.position_in_texels).abs().max_element();
        assert!(off <= 3.0, "{off} texels apart");
    }
}

/// The mean truth at the places on the receiver's plane where the texels of a kernel around it have their centres, as
/// if its face had no sides; `None` in a corner of the room, where the plane ends.
fn lit_over_kernel(shot: &Shot<'_>, lookup: &Lookup, receiver: &Receiver, taps: i32) -> Option<f64> {
    let view = lookup.select(receiver.point_in_world).first;
    let own = lookup.project(receiver.point_in_world).expect("inside a face").position_in_texels().floor();
    let bounds = shot.view.scene.bounds();
    let normal = receiver.normal_in_world;
    let mut lit = 0.0;
    for (row, column) in (0..taps).flat_map(|row| (0..taps).map(move |column| (row, column))) {
        let aside = DVec2::new(column.into(), row.into()) - f64::from(taps / 2) + 0.5;
        let ray = lookup.ray_through(view, own + aside, &bounds).expect("through the room");
        let along = ray.to - ray.from;
        let point = ray.from + along * (normal.dot(receiver.point_in_world - ray.from) / normal.dot(along));
        if point.clamp(bounds.min, bounds.max).distance(point) > 1e-6 {
            return None;
        }
        let segment = shot.question.light.segment_from(point, bounds.radius());
        lit += f64::from(u8::from(shot.view.casters.any_hit(&segment, Some(receiver.triangle)).is_none()));
    }
    Some(lit / f64::from(taps * taps))
}

/// Mean distance from what the kernel should give, over pixels whose kernel reaches over a seam, and over others.
fn mean_error_at_seams(shot: &Shot<'_>, lookup: &Lookup, evaluation: &Evaluation<'_>, taps: i32) -> [f64; 2] {
    let mut sums = [(0.0, 0.0); 2];
    for pixel in shot.asked().into_iter().step_by(3) {
        let receiver = receiver(shot, pixel);
        let at = lookup.project(receiver.point_in_world).unwrap().position_in_texels();
        let from_seam = at.min(lookup.texels().as_dvec2() - at).min_element();
        let Some(expected) = lit_over_kernel(shot, lookup, &receiver, taps) else { continue };
        // Only where the kernel meets an edge is there anything to compare.
        if expected > 0.0 && expected < 1.0 {
            let (sum, count) = &mut sums[usize::from(from_seam > 0.5 * f64::from(taps))];
            *sum += (f64::from(evaluation.mask.pixels[pixel as usize].unwrap().get()) - expected).abs();
            *count += 1.0;
        }
    }
    sums.map(|(sum, count)| sum / count)
}

/// CU-4: with taps that choose their own face a kernel at a seam is as good as elsewhere.
#[test]
fn a_kernel_across_a_seam_is_as_good_as_elsewhere() {
    // Boxes on the diagonals, so that their shadows cross the seams.
    let (mut model, mut first) = (String::new(), 1);
    cuboid(&mut model, "Room", Vec3::new(0.8, -0.5, -0.6), Vec3::splat(3.0), &mut first);
    let mut i = 0;
    for a in [-1.0, 0.0, 1.0_f32] {
        for b in [-1.0, 1.0_f32] {
            for at in [Vec3::new(a, b, 1.0), Vec3::new(b, -1.0, a), Vec3::new(-1.0, a, b)] {
                cuboid(&mut model, &format!("Box{i}"), at, Vec3::new(0.11, 0.13, 0.12), &mut first);
                i += 1;
            }
        }
    }
    let scene = "about = \"boxes across seams\"\nsize = [240, 180]\n\
         [camera]\neye = [2.7, -1.4, -2.6]\ntarget = [-2, 0.5, 1.5]\nfov_y_deg = 100\n\
         [[mesh]]\nfile = \"model.obj\"\n\
         [[light]]\nname = \"lamp\"\nkind = \"point\"\nposition = [0, 0, 0]\nintensity = [9, 9, 9]\n";
    let scene = scene_of_texts(scene, &model);
    let shot = Shot::new(&scene, "lamp");
    let typed = |seam: &str| format!("map:projection=cube,size=48,filter=pcf-box7,{seam}");
    let lookup = lookup(&shot, &typed("seam=per-tap"));
    let errors = |seam: &str| mean_error_at_seams(&shot, &lookup, &shot.evaluate(&typed(seam)), 7);
    let (chosen, clamped) = (errors("seam=per-tap"), errors("seam=clamp"));
    println!("seam and elsewhere: per tap {chosen:.4?}, clamped {clamped:.4?}");
    assert_eq!(chosen[1], clamped[1], "away from seams both are the same");
    assert!(chosen[0] < 0.7 * clamped[0], "{chosen:?} {clamped:?}");
    assert!(chosen[0] < 2.0 * chosen[1], "{chosen:?}");
}
