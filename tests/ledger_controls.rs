//! Controls: a fault is planted that produces one cause, and the ledger must find it. Of the pixels that the fault
//! breaks at least 99 % bear its cause (recall), and of the pixels that bear the cause at least 99 % are the fault's
//! (precision).

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout, reason = "tests")]

mod support;

use gnomon::cause::Cause;
use gnomon::evaluate::Evaluation;
use gnomon::technique::map::Settings;
use support::models::{corrugated_sheet, plate};
use support::scenes::shipped;
use support::shot::{Shot, named, parsed, shipped_if_fetched};

const SIZE: [u32; 2] = [256, 192];

/// Precision and recall that every control must reach.
const FOUND: f64 = 0.99;
/// Fewer broken pixels than this prove nothing at a precision of 99 %.
const FEWEST: usize = 100;

const ALIASING: [Cause; 3] = [Cause::EdgeAliasing, Cause::PerspectiveAliasing, Cause::ProjectiveAliasing];

/// How well a set of pixels names another.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Score {
    /// Pixels that the fault broke: wrong with it, right without it.
    broken: usize,
    /// Share of the named pixels that are broken.
    precision: f64,
    /// Share of the broken pixels that are named.
    recall: f64,
}

impl Score {
    fn of(broken: &[u32], named: &[u32]) -> Self {
        let both = broken.iter().filter(|pixel| named.contains(pixel)).count() as f64;
        Self { broken: broken.len(), precision: both / named.len() as f64, recall: both / broken.len() as f64 }
    }

    fn is_found(&self) -> bool {
        self.broken >= FEWEST && self.precision >= FOUND && self.recall >= FOUND
    }
}

/// Pixels wrong with a fault and right without it.
fn broken(clean: &Evaluation<'_>, faulty: &Evaluation<'_>) -> Vec<u32> {
    let wrong = faulty.ledger.wrong.iter().map(|(pixel, _)| *pixel);
    wrong.filter(|pixel| !clean.verdict.is_wrong(*pixel as usize)).collect()
}

/// Plants a fault and asserts that it is found under its name.
fn assert_found(shot: &Shot<'_>, clean: &str, faulty: &str, causes: &[Cause]) {
    let (clean, fault) = (shot.evaluate(clean), shot.evaluate(faulty));
    let score = Score::of(&broken(&clean, &fault), &named(&fault, causes));
    println!("{faulty}: {score:?}");
    assert!(score.is_found(), "{faulty}: {causes:?} {score:?}, named {:?}", fault.ledger.causes);
}

#[test]
fn bias_off_is_acne() {
    let (triangle, torus) = (shipped("triangle", SIZE), shipped("torus", SIZE));
    for shot in [Shot::new(&triangle, "lamp"), Shot::new(&triangle, "sun"), Shot::new(&torus, "lamp")] {
        assert_found(&shot, "map", "map:bias=none", &[Cause::Acne]);
        assert_found(&shot, "map:filter=pcf-box3", "map:filter=pcf-box3,bias=none", &[Cause::Acne]);
    }
    // A mesh so fine that a texel holds many of its triangles.
    if let Some(bunny) = shipped_if_fetched("bunny", SIZE.into()) {
        assert_found(&Shot::new(&bunny, "sun"), "map", "map:bias=none", &[Cause::Acne]);
    }
}

#[test]
fn a_bias_of_fifty_texels_is_peter_panning() {
    let scene = shipped("contact", SIZE);
    let shot = Shot::new(&scene, "sun");
    let spec = parsed("map");
    let settings = Settings::of(&spec);
    let views = settings.projection.fit(&scene, shot.question.light, &settings, &[]).expect("a fit");
    // The same everywhere in a sun's map.
    let texel_m = views[0].site(scene.bounds().centre()).texel_m().max_element();
    assert_found(&shot, "map", &format!("map:bias_depth_m={}", 50.0 * texel_m), &[Cause::PeterPanning]);
}

#[test]
fn a_map_of_64_texels_is_edge_aliasing() {
    let (triangle, torus) = (shipped("triangle", SIZE), shipped("torus", SIZE));
    for shot in [Shot::new(&triangle, "lamp"), Shot::new(&triangle, "sun"), Shot::new(&torus, "sun")] {
        assert_found(&shot, "map:size=8192", "map:size=64", &ALIASING);
    }
}

#[test]
fn planes_that_cut_are_clipping() {
    let scene = shipped("torus", SIZE);
    let lamp = Shot::new(&scene, "lamp");
    assert_found(&lamp, "map:size=4096", "map:size=4096,near_m=4.2", &[Cause::ClippingNear]);
    assert_found(&lamp, "map:size=4096", "map:size=4096,far_m=5.2", &[Cause::ClippingFar]);
    assert_found(&lamp, "map:size=4096", "map:size=4096,fov_deg=25", &[Cause::ClippingFrustum]);
    let sun = Shot::new(&scene, "sun");
    assert_found(&sun, "map:size=4096", "map:size=4096,width_m=2", &[Cause::ClippingFrustum]);
}

/// The lamp is 5 m away, and the near plane a millionth of that: fixed-point depth has no step left for the scene.
#[test]
fn sixteen_bits_over_a_range_of_a_million_are_precision() {
    let scene = shipped("triangle", SIZE);
    let shot = Shot::new(&scene, "lamp");
    let deep = "map:size=4096,bias=none,near_m=5e-6";
    assert_found(&shot, deep, &format!("{deep},format=depth16unorm"), &[Cause::Precision]);
}

/// Texels as small as a map makes them: what is wrong with it is too little to spoil a percent.
const FINEST: &str = "map:size=8192,fit=receivers";

/// The same small map is called by the tilt where light grazes the floor, and by the distances where it does not.
#[test]
fn grazing_light_is_projective_aliasing() {
    let (grazing, steep) = (plate(7.0, 30.0), plate(60.0, 30.0));
    assert_found(&Shot::new(&grazing, "sun"), FINEST, "map:size=128", &[Cause::ProjectiveAliasing]);
    assert_found(&Shot::new(&steep, "sun"), FINEST, "map:size=128", &[Cause::PerspectiveAliasing]);
}

/// The same map under the same light: fine enough for a wide view, too coarse for a narrow one.
#[test]
fn a_zoomed_camera_is_perspective_aliasing() {
    let (narrow, wide) = (plate(60.0, 8.0), plate(60.0, 100.0));
    assert_found(&Shot::new(&narrow, "sun"), FINEST, "map:size=256", &[Cause::PerspectiveAliasing]);
    let shot = Shot::new(&wide, "sun");
    let coarse = shot.evaluate("map:size=256");
    let found = coarse.ledger.wrong.iter().map(|(_, cause)| *cause).collect::<Vec<_>>();
    assert!(!found.is_empty() && found.iter().all(|cause| *cause == Cause::EdgeAliasing), "{found:?}");
}

/// A map whose texels are as wide as half a wave: each holds a part of the wave that the bias elsewhere on it does not
/// reach over.
#[test]
fn a_surface_finer_than_the_texels_is_curvature() {
    let scene = corrugated_sheet();
    assert_found(&Shot::new(&scene, "sun"), "map:size=4096", "map:size=53", &[Cause::Curvature]);
}

/// Bias off, and a frustum too narrow for the scene: acne inside it, clipping outside. Width and size shrink together,
/// so that the texels stay where they are; each fault's pixels are those that come right when it alone is repaired.
#[test]
fn two_faults_at_once_are_both_named_where_they_are() {
    let scene = shipped("torus", SIZE);
    let shot = Shot::new(&scene, "sun");
    let faulty = shot.evaluate("map:width_m=2,size=516,bias=none");
    let bias_repaired = shot.evaluate("map:width_m=2,size=516");
    let width_repaired = shot.evaluate("map:width_m=8,size=2052,bias=none");
    for (repaired, cause) in [(bias_repaired, Cause::Acne), (width_repaired, Cause::ClippingFrustum)] {
        let score = Score::of(&broken(&repaired, &faulty), &named(&faulty, &[cause]));
        println!("{cause:?}: {score:?}");
        assert!(score.is_found(), "{cause:?}: {score:?}");
    }
}

/// The names are not interchangeable: what bias off breaks is not what too much bias breaks, nor the other way round.
#[test]
fn a_swapped_name_is_not_found() {
    let scene = shipped("contact", SIZE);
    let shot = Shot::new(&scene, "sun");
    let clean = shot.evaluate("map");
    for (fault, cause, other) in [
        ("map:bias=none", Cause::Acne, Cause::PeterPanning),
        ("map:bias_depth_m=0.1", Cause::PeterPanning, Cause::Acne),
    ] {
        let faulty = shot.evaluate(fault);
        let broken = broken(&clean, &faulty);
        assert!(Score::of(&broken, &named(&faulty, &[cause])).is_found(), "{fault}");
        let swapped = Score::of(&broken, &named(&faulty, &[other]));
        assert!(
            swapped.broken >= FEWEST && !swapped.is_found() && swapped.recall < 1.0 - FOUND,
            "{fault}: {swapped:?}"
        );
    }
}

#[test]
fn the_score_falls_with_every_pixel_named_amiss_or_left_out() {
    let broken: Vec<u32> = (0..1000).collect();
    let with = |named: Vec<u32>| Score::of(&broken, &named);
    assert_eq!(with(broken.clone()), Score { broken: 1000, precision: 1.0, recall: 1.0 });
    assert!(with((0..990).collect()).is_found() && with((0..1010).collect()).is_found());
    assert!(!with((0..989).collect()).is_found(), "recall");
    assert!(!with((0..1011).collect()).is_found(), "precision");
    assert!(!with((1000..2000).collect()).is_found() && !with(Vec::new()).is_found());
    assert!(!Score::of(&broken[..FEWEST - 1], &broken[..FEWEST - 1]).is_found(), "too few to tell");
}
