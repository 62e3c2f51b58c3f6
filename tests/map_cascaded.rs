//! Cascades: one is a single map, several are finer near the eye, a stable fit stays put while the camera moves.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout, reason = "tests")]

mod support;

use glam::{DVec2, DVec3, Vec3};
use gnomon::cause::Cause;
use gnomon::scene::Scene;
use gnomon::technique::map::projection::View;
use gnomon::technique::map::{Lookup, Settings};
use support::scenes::shipped;
use support::shot::{Shot, named, parsed};

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

/// How far along the camera's axis the first and the second share change.
fn along_axis(scene: &Scene, typed: &str, distance_m: f64) -> (usize, f64) {
    let lookup = Lookup::new(views(scene, typed, &[]), &Settings::of(&parsed(typed)), scene.light("sun").unwrap());
    let along = (scene.camera.target - scene.camera.eye).as_dvec3().normalize();
    let shares = lookup.select(scene.camera.eye.as_dvec3() + along * distance_m);
    (shares.first, shares.second_weight)
}

#[test]
fn typed_splits_are_where_cascades_end() {
    let scene = shipped("posts", [160, 120]);
    let typed = "map:projection=cascaded,splits_m=10/20/50,max_distance_m=100,lambda=1,first_far_m=3";
    for (distance_m, expected) in [(4.0, 0), (9.9, 0), (10.1, 1), (19.9, 1), (20.1, 2), (49.9, 2), (50.1, 3), (99.0, 3)]
    {
        assert_eq!(along_axis(&scene, typed, distance_m), (expected, 0.0), "{distance_m}");
    }
    let three = Settings::of(&parsed("map:projection=cascaded,splits_m=10/20"));
    let refused = three.projection.supports(&scene, scene.light("sun").unwrap(), &three).unwrap_err().to_string();
    assert!(refused.contains("splits_m=10/20 makes 3 cascades") && refused.contains("cascades=4"), "{refused}");
    let shot = Shot::new(&scene, "sun");
    let by_formula = shot.evaluate("map:projection=cascaded,cascades=2,size=300,min_distance_m=1,max_distance_m=64");
    let typed = "map:projection=cascaded,cascades=2,size=300,min_distance_m=1,max_distance_m=64,splits_m=20.25";
    assert!(by_formula.mask == shot.evaluate(typed).mask, "(8 + 32.5) / 2");
}

/// The weight grows over a share of the split's distance, and the view that is blended in holds all of that band.
#[test]
fn cascades_overlap_by_a_share_of_the_splits_distance() {
    let scene = shipped("posts", [160, 120]);
    let splits =
        "map:size=512,projection=cascaded,splits_m=10/20/50,max_distance_m=100,min_distance_m=0.1,fit_margin_texels=0";
    let overlapping = format!("{splits},overlap_ratio=0.2");
    for (distance_m, first, weight) in
        [(7.9, 0, 0.0), (8.5, 0, 0.25), (9.5, 0, 0.75), (10.5, 1, 0.0), (18.0, 1, 0.5), (45.0, 2, 0.5), (90.0, 3, 0.0)]
    {
        let found = along_axis(&scene, &overlapping, distance_m);
        assert!(found.0 == first && (found.1 - weight).abs() < 1e-5, "{distance_m}: {found:?}");
    }
    // The wider band counts: here 64 texels.
    assert!(along_axis(&scene, &format!("{splits},overlap_ratio=0.01,blend_texels=64"), 45.0).1 > 0.1);
    // Seen: the view's corners at some distances, among them where bands start.
    let size = scene.image_size;
    let corners = [DVec2::ZERO, DVec2::new(size.x.into(), 0.0), DVec2::new(0.0, size.y.into()), size.as_dvec2()];
    let seen_at = |distance_m: f64| {
        corners.map(|corner| scene.camera.eye.as_dvec3() + distance_m * scene.camera.ray_through(size, corner))
    };
    let bands = [(1, 8.001), (2, 16.001), (3, 40.001)];
    let visible: Vec<DVec3> =
        [1.0, 8.001, 10.0, 16.001, 20.0, 40.001, 50.0, 99.0].into_iter().flat_map(seen_at).collect();
    let held = |typed: &str| {
        let views = views(&scene, &format!("{typed},cascade_fit=box"), &visible);
        let of_band =
            bands.iter().flat_map(|(view, distance_m)| seen_at(*distance_m).map(|point| views[*view].project(point)));
        of_band.filter(|at| at.uv.min_element() >= 0.0 && at.uv.max_element() < 1.0).count()
    };
    assert_eq!(held(&overlapping), 12);
    assert!(held(splits) < 12, "without it a cascade starts at its split");
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

/// Typed planes are measured from where a single map's light would stand, not from the middle of the world, which casters
/// between it and the light would be before.
#[test]
fn a_typed_near_plane_lies_before_the_scene() {
    let scene = shipped("torus", [160, 120]);
    let shot = Shot::new(&scene, "sun");
    for fit in ["sphere", "box"] {
        let clipped = |near_m: f64| {
            let typed = format!("map:projection=cascaded,cascade_fit={fit},near_m={near_m}");
            named(&shot.evaluate(&typed), &[Cause::ClippingNear]).len()
        };
        assert_eq!(clipped(4.0), 0, "{fit}: before the torus");
        assert!(clipped(6.0) > 100, "{fit}: through it");
    }
}
