//! Cascades: one is a single map, several are finer near the eye, a stable fit stays put while the camera moves.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout, reason = "tests")]

mod support;

use glam::{DVec2, DVec3, Vec3};
use gnomon::scene::Scene;
use gnomon::technique::map::projection::View;
use gnomon::technique::map::{Lookup, Settings};
use support::scenes::shipped;
use support::shot::{Shot, parsed};

fn views(scene: &Scene, typed: &str, visible: &[DVec3]) -> Vec<View> {
    let settings = Settings::of(&parsed(typed));
    settings.projection.fit(scene, scene.light("sun").unwrap(), &settings, visible).expect("supported")
}

#[test]
fn one_tight_cascade_is_a_single_map_around_what_is_seen() {
    let scene = shipped("posts", [160, 120]);
    let shot = Shot::new(&scene, "sun");
    for filter in ["nearest", "pcf-box3"] {
        let cascade =
            shot.evaluate(&format!("map:size=500,projection=cascaded,cascades=1,cascade_fit=box,filter={filter}"));
        let single = shot.evaluate(&format!("map:size=500,fit=receivers,filter={filter}"));
        assert!(cascade.mask == single.mask, "{filter}");
    }
    // Control: two are not.
    let two = shot.evaluate("map:size=500,projection=cascaded,cascades=2,cascade_fit=box");
    assert!(two.mask != shot.evaluate("map:size=500,fit=receivers").mask);
}

/// CA-1: four cascades have the texels of one map of twice the size, and less error.
#[test]
fn cascades_are_finer_than_one_map_of_as_many_texels() {
    let scene = shipped("posts", [256, 192]);
    let shot = Shot::new(&scene, "sun");
    let wrong = |typed: &str| shot.evaluate(typed).verdict.pixels.wrong;
    let single = wrong("map:size=1024");
    let around_seen = wrong("map:size=1024,fit=receivers");
    let stable = wrong("map:size=512,projection=cascaded");
    let tight = wrong("map:size=512,projection=cascaded,cascade_fit=box");
    println!(
        "wrong: one map {single}, around what is seen {around_seen}, stable cascades {stable}, tight ones {tight}"
    );
    assert!(2 * stable < single && 3 * tight < 2 * around_seen);
}

/// CA-2: across a split the resolution steps; a blended band has values between.
#[test]
fn blending_leaves_no_step_at_a_split() {
    let scene = shipped("posts", [256, 192]);
    let shot = Shot::new(&scene, "sun");
    let typed = |blend: u32| format!("map:size=48,projection=cascaded,blend_texels={blend}");
    let [sharp, blended] = [0, 16].map(|blend| shot.evaluate(&typed(blend)).mask);
    let between = |mask: &gnomon::mask::Mask| {
        mask.pixels.iter().flatten().filter(|answer| answer.get() > 0.01 && answer.get() < 0.99).count()
    };
    assert_eq!(between(&sharp), 0, "nearest answers 0 or 1");
    assert!(between(&blended) > 20, "{}", between(&blended));
    // Weights run from 0 to 1 as the split is approached, and the next cascade takes over at 1.
    let settings = Settings::of(&parsed(&typed(16)));
    let lookup = Lookup::new(views(&scene, &typed(16), &[]), &settings, shot.question.light);
    let camera = &scene.camera;
    let along = (camera.target - camera.eye).as_dvec3().normalize();
    let mut last = (0, 0.0);
    for step in 0..20_000 {
        let shares = lookup.select(camera.eye.as_dvec3() + along * 0.01 * f64::from(step));
        let now = (shares.first, shares.second_weight);
        let is_next = now.0 == last.0 + 1 && last.1 > 0.99;
        assert!(now.0 == last.0 && now.1 >= last.1 || is_next, "{last:?} {now:?}");
        last = now;
    }
    assert_eq!(last.0, 3, "all cascades were passed");
}

/// CA-3 and CA-5: a point of the world keeps its place within its texel however the camera moves and turns.
#[test]
fn a_stable_fit_keeps_the_texel_grid_and_a_tight_one_does_not() {
    /// Positions in a map of 10³ texels in f32 rows.
    const ROUNDING_TEXELS: f64 = 2e-3;
    let point = DVec3::new(1.0, 0.3, -9.0);
    let phases = |typed: &str, turns: bool| -> Vec<(DVec2, f64)> {
        (0..24)
            .map(|step| {
                let mut scene = shipped("posts", [160, 120]);
                let moved = Vec3::new(0.013, 0.004, -0.017) * step as f32;
                scene.camera.eye += moved;
                scene.camera.target += if turns { moved + Vec3::X * 0.2 * step as f32 } else { moved };
                let view = &views(&scene, typed, &[])[1];
                let site = view.site(point);
                (site.position_in_texels().fract(), site.texel_m().x)
            })
            .collect()
    };
    let spread = |phases: &[(DVec2, f64)]| {
        let (first, width) = phases[0];
        // A phase of 0.999 is next to one of 0.001.
        let apart = |(phase, _): &(DVec2, f64)| (*phase - first - (*phase - first).round()).abs().max_element();
        assert!(phases.iter().all(|(_, w)| (w / width - 1.0).abs() < 1e-6 || phases.len() == 1));
        phases.iter().map(apart).fold(0.0, f64::max)
    };
    let stable = "map:size=1024,projection=cascaded,min_distance_m=0.1,max_distance_m=60";
    assert!(spread(&phases(stable, false)) < ROUNDING_TEXELS, "{:?}", spread(&phases(stable, false)));
    assert!(spread(&phases(stable, true)) < ROUNDING_TEXELS, "turning too");
    let far = "map:size=1024,projection=cascaded,min_distance_m=0.1,max_distance_m=1000";
    assert!(spread(&phases(far, false)) < ROUNDING_TEXELS, "far away too");
}
