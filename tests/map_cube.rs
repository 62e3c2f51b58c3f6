//! Cube maps against exact rays: whatever surrounds a light, in all six directions and across every seam.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout, reason = "tests")]

mod support;

use glam::DVec3;
use gnomon::evaluate::Evaluation;
use gnomon::receiver::Receiver;
use gnomon::technique::map::{Lookup, Settings};
use support::models::{boxes_on_diagonals, closed_room, inside_a_sphere};
use support::shot::{Shot, lit_at_texel_centre, lit_over_kernel, parsed};

fn lookup(shot: &Shot<'_>, typed: &str) -> Lookup {
    let settings = Settings::of(&parsed(typed));
    let (scene, light) = (shot.view.scene, shot.question.light);
    Lookup::new(settings.projection.fit(scene, light, &settings, &[]).expect("supported"), &settings, light)
}

fn receiver(shot: &Shot<'_>, pixel: u32) -> Receiver {
    shot.view.receivers.pixels[pixel as usize].expect("asked")
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
    let scene = inside_a_sphere();
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
    let scene = boxes_on_diagonals();
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
