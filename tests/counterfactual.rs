//! A cause is a counterfactual: without that approximation the pixel would be right. So it is taken away on the GPU, and
//! it alone, and at least 95 % of the pixels that the ledger gave to it come right.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout, reason = "tests")]

mod support;

use glam::UVec2;
use gnomon::cause::Cause;
use support::models::{corrugated_sheet, plate};
use support::scenes::shipped;
use support::shot::{Shot, named, shipped_if_fetched};

const SIZE: [u32; 2] = [256, 192];

/// Share of a cause's pixels that must come right without it.
const REMOVED: f64 = 0.95;
/// Fewer pixels than this prove little at 95 %.
const FEWEST: usize = 40;

/// Share of the pixels named after a cause in one evaluation that are right in another.
fn removed(shot: &Shot<'_>, with: &str, without: &str, cause: Cause) -> f64 {
    let (with_it, without_it) = (shot.evaluate(with), shot.evaluate(without));
    let named = named(&with_it, &[cause]);
    assert!(named.len() >= FEWEST, "{with}: {} pixels of {cause:?}", named.len());
    let right = named.iter().filter(|pixel| !without_it.verdict.is_wrong(**pixel as usize)).count();
    let share = right as f64 / named.len() as f64;
    println!("{with} → {without}: {right} of {} {cause:?} pixels come right", named.len());
    share
}

fn assert_removed(shot: &Shot<'_>, with: &str, without: &str, cause: Cause) {
    let share = removed(shot, with, without, cause);
    assert!(share >= REMOVED, "{with} → {without}: {share} of the {cause:?} pixels come right");
}

/// A map 32 times the size: nothing else changes.
#[test]
fn a_finer_map_removes_aliasing_and_curvature() {
    // In a picture so small that no pixel is smaller than a texel.
    let fence = shipped("fence", [64, 48]);
    assert_removed(&Shot::new(&fence, "sun"), "map:size=256", "map:size=8192", Cause::EdgeAliasing);
    let polygons = shipped("polygons-69", SIZE);
    assert_removed(&Shot::new(&polygons, "lamp"), "map:size=256", "map:size=8192", Cause::PerspectiveAliasing);
    let grazing = plate(7.0, 30.0);
    assert_removed(&Shot::new(&grazing, "sun"), "map:size=128", "map:size=4096", Cause::ProjectiveAliasing);
    let sheet = corrugated_sheet();
    assert_removed(&Shot::new(&sheet, "sun"), "map:size=53", "map:size=1696", Cause::Curvature);
}

/// Where light grazes a bent surface, a texel may be hundreds of pixels long, and even in a map 32 times the size it is
/// longer than a pixel. Wherever it is not, the finer map removes what was named after it. A bias along the light leaves
/// some of that to peter-panning; compared with its own plane a receiver loses nothing, but has acne where it bends.
#[test]
fn a_finer_map_removes_projective_aliasing_where_its_texels_are_small_enough() {
    let scenes = ["bunny", "room"].map(|name| shipped_if_fetched(name, UVec2::from_array(SIZE)));
    let lights = [("lamp", "cube"), ("sun", "single"), ("spot", "single")];
    for bias in ["closed-form", "receiver-plane"] {
        let (mut all, mut reached, mut left, mut panned) = (0, 0, 0, 0);
        for (scene, (light, projection)) in scenes.iter().flatten().flat_map(|scene| lights.map(|light| (scene, light)))
        {
            if scene.light(light).is_none() {
                continue;
            }
            let shot = Shot::new(scene, light);
            let sized = |size: u32| format!("map:projection={projection},size={size},bias={bias}");
            let [coarse, fine] = [256, 8192].map(|size| shot.evaluate(&sized(size)));
            let named = named(&coarse, &[Cause::ProjectiveAliasing]);
            let is_fine = |pixel: &u32| fine.prepared.footprint(*pixel).is_some_and(|texel| texel.m <= 1.0);
            let fine_enough: Vec<u32> = named.iter().copied().filter(is_fine).collect();
            let is_left = |pixel: &&u32| fine.ledger.cause_of(**pixel).is_some_and(|cause| cause != Cause::Acne);
            (all, reached) = (all + named.len(), reached + fine_enough.len());
            left += fine_enough.iter().filter(is_left).count();
            panned += fine.ledger.causes.get(&Cause::PeterPanning).map_or(0, |share| share.pixels);
        }
        println!("{bias}: of {all} pixels, of which {reached} are fine enough, {left} stay; {panned} panned");
        assert!(reached >= FEWEST || scenes[0].is_none(), "{bias}: {reached}");
        assert!(left as f64 <= (1.0 - REMOVED) * reached as f64, "{bias}: {left} of {reached} stay");
        assert_eq!(panned > 0, bias == "closed-form", "{bias}: {panned}");
    }
}

#[test]
fn a_sufficient_bias_removes_acne() {
    let (torus, posts) = (shipped("torus", SIZE), shipped("posts", SIZE));
    assert_removed(&Shot::new(&torus, "lamp"), "map:bias=none", "map", Cause::Acne);
    assert_removed(&Shot::new(&posts, "sun"), "map:bias=slope", "map", Cause::Acne);
    let filtered = "map:filter=pcf-box5";
    assert_removed(&Shot::new(&torus, "sun"), &format!("{filtered},bias=none"), filtered, Cause::Acne);
}

#[test]
fn no_bias_removes_peter_panning() {
    let (contact, fence) = (shipped("contact", SIZE), shipped("fence", SIZE));
    let contact = Shot::new(&contact, "sun");
    assert_removed(&contact, "map:bias=none,bias_depth_m=0.1", "map:bias=none", Cause::PeterPanning);
    assert_removed(&contact, "map:bias=none,bias_normal_texels=40", "map:bias=none", Cause::PeterPanning);
    assert_removed(&contact, "map:bias_constant_ulps=1e6", "map", Cause::PeterPanning);
    assert_removed(&Shot::new(&fence, "sun"), "map:size=256", "map:size=256,bias=none", Cause::PeterPanning);
}

#[test]
fn a_frustum_that_holds_everything_removes_clipping() {
    let torus = shipped("torus", SIZE);
    let (lamp, sun) = (Shot::new(&torus, "lamp"), Shot::new(&torus, "sun"));
    assert_removed(&lamp, "map:near_m=4.2", "map", Cause::ClippingNear);
    assert_removed(&lamp, "map:far_m=5.2", "map", Cause::ClippingFar);
    assert_removed(&lamp, "map:fov_deg=25", "map", Cause::ClippingFrustum);
    assert_removed(&sun, "map:width_m=2", "map", Cause::ClippingFrustum);
}

#[test]
fn a_single_tap_removes_the_filters_width() {
    let posts = shipped("posts", SIZE);
    let shot = Shot::new(&posts, "sun");
    // A margin in place of the kernel's radius keeps the texels where they are.
    assert_removed(&shot, "map:filter=pcf-box5", "map:filter=nearest,fit_margin_texels=3", Cause::FilterWidth);
    assert_removed(&shot, "map:filter=pcf-box5", "map:filter=pcf-box5,size=8192", Cause::FilterWidth);
}

#[test]
fn a_float_format_removes_precision() {
    let triangle = shipped("triangle", SIZE);
    let deep = "map:bias=none,near_m=5e-6";
    let shot = Shot::new(&triangle, "lamp");
    assert_removed(&shot, &format!("{deep},format=depth16unorm"), deep, Cause::Precision);
}

/// Taking away what is not the cause removes next to nothing.
#[test]
fn another_approximation_removes_nothing() {
    let torus = shipped("torus", SIZE);
    let lamp = Shot::new(&torus, "lamp");
    for (with, without, cause) in [
        ("map:bias=none", "map:bias=none,size=4096", Cause::Acne),
        ("map:near_m=4.2", "map:near_m=4.2,size=4096", Cause::ClippingNear),
        ("map:fov_deg=25", "map:fov_deg=25,bias=slope", Cause::ClippingFrustum),
        ("map:size=64", "map:size=64,bias=slope,bias_slope=4", Cause::PerspectiveAliasing),
    ] {
        let share = removed(&lamp, with, without, cause);
        assert!(share < REMOVED, "{with} → {without}: {share} of the {cause:?} pixels come right");
    }
}
