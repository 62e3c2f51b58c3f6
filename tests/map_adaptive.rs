//! Adaptive maps: tiles that are refined where shadow edges pass, against one map as fine, and against their budget.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout, reason = "tests")]

mod support;

use gnomon::mask::Visibility;
use gnomon::scene::Placement;
use support::scenes::{placed, shipped};
use support::shot::Shot;

/// AD-1: with every tile of the last level an adaptive map is one map as fine, whatever the filter does at tiles' sides.
#[test]
fn refined_everywhere_it_is_one_fine_map() {
    /// Matrices of tiles are rounded otherwise than that of the map, so pixels on a texel's side may change texels.
    const TIED: usize = 12;
    /// Weights of bilinear lookups are as exact as places in the map.
    const VISIBLE: f32 = 1e-3;
    /// A tap in another tile is biased for as far as its texel is, not for the whole kernel.
    const OTHERWISE_BIASED: usize = 100;
    let scene = shipped("torus", [200, 150]);
    for light in ["sun", "lamp"] {
        let shot = Shot::new(&scene, light);
        for rest in ["filter=nearest", "filter=pcf-box5", "depth_convention=forward,filter=pcf-bilinear2"] {
            let tiles = "projection=adaptive,tile_texels=64,max_level=3,m_target=0.25,edges_only=off";
            let adaptive = shot.evaluate(&format!("map:{tiles},{rest}"));
            let one = shot.evaluate(&format!("map:size=512,{rest}"));
            let pairs = adaptive.mask.pixels.iter().zip(&one.mask.pixels);
            let value = |answer: &Option<Visibility>| answer.map_or(0.0, Visibility::get);
            let differing = pairs.filter(|(a, b)| (value(a) - value(b)).abs() > VISIBLE).count();
            println!(
                "{light} {rest}: {differing} differ, {} and {} wrong",
                adaptive.verdict.pixels.wrong, one.verdict.pixels.wrong
            );
            assert!(
                differing <= if rest == "filter=nearest" { TIED } else { OTHERWISE_BIASED },
                "{light} {rest}: {differing}"
            );
            assert!(one.verdict.pixels.wrong > 5 * differing as u64 || rest != "filter=nearest");
        }
    }
}

/// One tile is one map, bit for bit, for filters that reckon with depths, too.
#[test]
fn one_tile_is_one_map_for_every_filter_of_depths() {
    let (torus, area) = (shipped("torus", [120, 90]), shipped("area", [120, 90]));
    let shots =
        [Shot::new(&torus, "sun"), Shot::new(&torus, "lamp"), Shot::new(&area, "panel"), Shot::new(&area, "bulb")];
    for shot in &shots {
        for filter in ["pcss", "vsm3", "esm4", "evsm3", "msm5", "depth-mean2"] {
            let mask = |typed: &str| shot.evaluate(&format!("map:{typed},filter={filter},seam=clamp")).mask;
            let tile = mask("projection=adaptive,tile_texels=300,max_level=0");
            assert!(tile == mask("size=300"), "{} {filter}", shot.question.light.name);
            assert!(tile != mask("size=301"), "{} {filter}", shot.question.light.name);
        }
    }
}

/// AD-2: more tiles, fewer wrong pixels, and with as many texels as a plain map has far fewer. Where casters are thinner
/// than texels that holds only once these are fine enough: on posts, chance decides at first.
#[test]
fn wrong_pixels_fall_with_the_budget() {
    for (name, fine_from, at_least) in [("torus", 0, 1), ("posts", 2, 3)] {
        let scene = shipped(name, [256, 192]);
        let shot = Shot::new(&scene, "sun");
        let wrong = |typed: &str| shot.evaluate(typed).verdict.pixels.wrong;
        let counts = [1, 4, 16, 64, 256].map(|tiles| wrong(&format!("map:projection=adaptive,max_tiles={tiles}")));
        let plain = wrong("map:size=1024");
        println!("{name}: wrong with 1, 4, 16, 64 and 256 tiles of 64²: {counts:?}; one map of 1024²: {plain}");
        assert!(counts[fine_from..].is_sorted_by(|a, b| a >= b), "{counts:?}");
        assert!(at_least * counts[4] < plain, "{counts:?} {plain}");
    }
}

/// AD-3: every receiver's texel is fine enough, or counted with the reason.
#[test]
fn receivers_are_content_or_counted() {
    let scene = shipped("posts", [128, 96]);
    let shot = Shot::new(&scene, "sun");
    for typed in ["max_level=12,edges_only=off,m_target=2", "max_tiles=40", "max_level=2,m_target=4", "edges_only=off"]
    {
        let evaluation = shot.evaluate(&format!("map:projection=adaptive,{typed}"));
        let target = typed.split("m_target=").nth(1).map_or(1.0, |target| target.parse().unwrap());
        let coarse = |pixel: &u32| evaluation.prepared.footprint(*pixel).is_some_and(|footprint| footprint.m > target);
        let found = shot.asked().iter().filter(|pixel| coarse(pixel)).count();
        let facts = evaluation.prepared.facts();
        let (_, told) = facts.iter().find(|(label, _)| label.starts_with("pixels with m >")).unwrap();
        let counted: usize = told.split(' ').filter_map(|word| word.parse::<usize>().ok()).sum();
        println!("{typed}: {found} pixels with m > {target}; {told}; {}", facts[1].1);
        // The f32 rows of tiles move m by a hair, and undecided pixels are receivers, too.
        assert!(found.abs_diff(counted) <= 4, "{typed}: {found} {counted}");
    }
}

/// Twelve levels on a scene of ten kilometres, one tile alone, and a picture of one pixel.
#[test]
fn extremes_answer() {
    let scene = placed("torus", [96, 72], Placement { scale: 1e3, ..Placement::default() });
    let shot = Shot::new(&scene, "sun");
    let wrong = |typed: &str| shot.evaluate(typed).verdict.pixels.wrong;
    let deep = wrong("map:projection=adaptive,max_level=12,tile_texels=16,size=16384");
    let plain = wrong("map:size=1024");
    println!("deep {deep}, plain {plain}");
    // A pixel or two at the limit of what either resolves.
    assert!(deep <= plain + 2, "{deep} {plain}");
    let scene = shipped("torus", [1, 1]);
    let shot = Shot::new(&scene, "sun");
    assert!(shot.evaluate("map:projection=adaptive").verdict.pixels.asked <= 1);
    let one_tile = shot.evaluate("map:projection=adaptive,max_tiles=1");
    assert_eq!(one_tile.prepared.view_names(), ["tile 0, 0 of level 0"]);
}
