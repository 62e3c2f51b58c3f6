//! Sampled soft shadows against the penumbra of a half plane worked out on paper, against the truth, and what their
//! ledger says.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests fail by panicking")]

mod support;

use gnomon::cause::Cause;
use support::penumbra::{EDGE_HEIGHT, LAMP_HEIGHT, SIDE, SNAP_M, across_edge, half_plane, half_plane_under_sun};
use support::scenes::shipped;
use support::shot::{Shot, parsed};

/// The visible share of the square lamp for a floor point `x` across the edge.
fn share(tilt_deg: f64, x: f64) -> f64 {
    let line = x - x * LAMP_HEIGHT / EDGE_HEIGHT;
    let tilt = tilt_deg.to_radians();
    let (c, s) = (tilt.cos(), tilt.sin());
    let offset = line / SIDE + 0.5 * (c + s);
    if s < 1e-12 {
        return offset.clamp(0.0, 1.0);
    }
    let triangle = |t: f64| 0.5 * t.max(0.0).powi(2);
    (triangle(offset) - triangle(offset - c) - triangle(offset - s) + triangle(offset - c - s)) / (c * s)
}

/// The largest difference from the paper's share, over all places within the snap of each point.
fn worst(points: &[(f64, f64)], tilt_deg: f64) -> f64 {
    let error = |&(x, visibility): &(f64, f64)| {
        let near = [x - SNAP_M, x, x + SNAP_M].map(|x| (visibility - share(tilt_deg, x)).abs());
        near.into_iter().fold(f64::INFINITY, f64::min)
    };
    points.iter().map(error).fold(0.0, f64::max)
}

#[test]
fn n_by_n_midpoints_miss_the_penumbra_by_half_a_row_at_most() {
    for tilt_deg in [0.0, 10.0, 26.57, 45.0] {
        let scene = half_plane(tilt_deg, SIDE, EDGE_HEIGHT);
        let shot = Shot::new(&scene, "lamp");
        for n in [1_u32, 2, 4, 8] {
            let spec = format!("soft:pattern=grid-midpoint,samples={},inner=(volume)", n * n);
            let points = across_edge(&shot, &shot.evaluate(&spec).mask, tilt_deg);
            let error = worst(&points, tilt_deg);
            let bound = 0.5 / f64::from(n);
            assert!(error <= bound + 1e-9, "{tilt_deg} degrees, {n} x {n}: {error}");
            if tilt_deg == 0.0 {
                assert!(error > 0.8 * bound, "{n} x {n}: {error}: too good to be n x n");
                let mut levels: Vec<u64> = points.iter().map(|(_, v)| v.to_bits()).collect();
                levels.sort_unstable();
                levels.dedup();
                assert_eq!(levels.len(), n as usize + 1, "levels of {n} x {n}");
            }
        }
    }
}

#[test]
fn a_penumbra_is_monotone_as_wide_as_predicted_and_ends_in_light_and_umbra() {
    for gap in [0.05_f64, 0.5, 1.0] {
        let scene = half_plane(0.0, SIDE, gap);
        let shot = Shot::new(&scene, "lamp");
        let mut points = across_edge(&shot, &shot.evaluate("soft:samples=64,inner=(volume)").mask, 0.0);
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        assert!(points.windows(2).all(|pair| pair[1].1 <= pair[0].1 || pair[1].0 - pair[0].0 < SNAP_M), "{gap}");
        assert_eq!((points.first().unwrap().1, points.last().unwrap().1), (1.0, 0.0));
        let width = points.iter().rfind(|p| p.1 > 0.0).unwrap().0 - points.iter().find(|p| p.1 < 1.0).unwrap().0;
        let predicted = SIDE * gap / (LAMP_HEIGHT - gap);
        // The outer sixty-fourths are dark or lit already, and the picture has pixels.
        assert!((width - predicted * 63.0 / 64.0).abs() < 0.03 + SNAP_M, "gap {gap}: {width}, not {predicted}");
    }
}

/// The places across an edge where a penumbra begins and ends.
fn ends(points: &mut [(f64, f64)]) -> [f64; 2] {
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    [points.iter().find(|p| p.1 < 1.0).unwrap().0, points.iter().rfind(|p| p.1 > 0.0).unwrap().0]
}

/// A sun's rays differ by its angular diameter: at an elevation e the shadow of an edge ends between gap · cot(e + r) and
/// gap · cot(e − r).
#[test]
fn a_suns_penumbra_lies_between_the_rays_to_its_rim() {
    for (elevation_deg, diameter_deg, gap) in [(90.0, 20.0, 0.6), (50.0, 12.0, 0.6), (25.0, 8.0, 0.4)] {
        let scene = half_plane_under_sun(elevation_deg, diameter_deg, gap);
        let shot = Shot::new(&scene, "sun");
        let cot = |degrees: f64| gap / degrees.to_radians().tan();
        let expected = [cot(elevation_deg + 0.5 * diameter_deg), cot(elevation_deg - 0.5 * diameter_deg)];
        // The rim's outermost points are 1/√512 of the radius inside it, and the picture has pixels.
        let tolerance = 0.05 * (expected[1] - expected[0]) + 0.03;
        for spec in ["soft:samples=64,inner=(volume)", "soft:samples=256,inner=(map:size=2048)"] {
            let found = ends(&mut across_edge(&shot, &shot.evaluate(spec).mask, 0.0));
            let off = [found[0] - expected[0], found[1] - expected[1]].map(f64::abs);
            assert!(off.iter().all(|off| *off < tolerance), "{elevation_deg}, {spec}: {found:?}, not {expected:?}");
        }
        // Control: a light without the extent has no such penumbra.
        let hard = ends(&mut across_edge(&shot, &shot.evaluate("volume").mask, 0.0));
        assert!(hard[1] - hard[0] < 0.2 * (expected[1] - expected[0]), "{hard:?}");
    }
}

#[test]
fn a_light_without_size_leaves_the_inner_hard_shadow() {
    let scene = half_plane(10.0, 1e-6, EDGE_HEIGHT);
    let shot = Shot::new(&scene, "lamp");
    for inner in ["volume", "map:size=256,filter=pcf-box2,fov_deg=60"] {
        let soft = shot.evaluate(&format!("soft:samples=9,inner=({inner})")).mask;
        let hard = shot.evaluate(inner).mask;
        let differing = soft.pixels.iter().zip(&hard.pixels).filter(|(a, b)| a != b).count();
        // The light is moved by up to half a micrometre: a point on the very edge may change sides.
        assert!(differing <= 2, "{inner}: {differing} pixels");
    }
    let other = shot.evaluate("soft:samples=9,inner=(map:size=16,fov_deg=60)").mask;
    assert_ne!(other, shot.evaluate("volume").mask, "the comparison sees another technique");
}

#[test]
fn the_truths_own_points_leave_nothing_but_inner_errors() {
    let scene = shipped("area", [160, 120]);
    let shot = Shot::new(&scene, "panel");
    let evaluation = shot.evaluate("soft:samples=36,inner=(volume)");
    assert!(evaluation.verdict.pixels.differing <= 2, "{:?}", evaluation.verdict.pixels);
    let other_points = shot.evaluate("soft:samples=36,pattern=hammersley,inner=(volume)");
    assert!(other_points.verdict.pixels.differing > 100, "{:?}", other_points.verdict.pixels);
    assert!(other_points.verdict.error.mean_abs < shot.evaluate("volume").verdict.error.mean_abs);
}

#[test]
fn the_cost_is_that_of_the_inner_runs() {
    let scene = shipped("area", [64, 48]);
    let shot = Shot::new(&scene, "panel");
    let vertices = |samples: u32| {
        shot.evaluate(&format!("soft:samples={samples},inner=(map:size=64)")).cost.vertices.expect("counted")
    };
    assert_eq!(vertices(5), 5 * vertices(1));
}

#[test]
fn errors_are_booked_to_the_points_or_to_the_inner_technique() {
    let scene = shipped("area", [160, 120]);
    let most = |light: &str, spec: &str| {
        let shot = Shot::new(&scene, light);
        let evaluation = shot.evaluate(spec);
        let (cause, share) = evaluation.ledger.causes.iter().max_by_key(|(_, share)| share.pixels).expect("errors");
        assert!(share.pixels > 10, "{spec}: {:?}", evaluation.ledger.causes);
        *cause
    };
    assert_eq!(most("panel", "soft:samples=1,inner=(volume)"), Cause::FilterWidth);
    assert_eq!(most("bulb", "soft:samples=4,inner=(volume)"), Cause::TechniqueModel);
    assert_eq!(most("panel", "soft:samples=36,inner=(map:size=256,bias=none)"), Cause::Acne);
    assert_eq!(most("panel", "soft:samples=36,inner=(map:size=256,bias_depth_m=0.5)"), Cause::PeterPanning);
    // A hard technique takes the light for its centre.
    assert_eq!(most("panel", "volume"), Cause::TechniqueModel);
}

#[test]
fn nested_specifications_are_spelled_in_parentheses() {
    let spec = parsed("soft:inner=(map:filter=pcf-box3,size=512),samples=4");
    assert_eq!(spec.short(), "soft:inner=(map:size=512,filter=pcf-box3),samples=4");
    assert_eq!(parsed(&spec.to_string()), spec);
    assert_eq!(spec.nested("inner"), parsed("map:size=512,filter=pcf-box3"));
    let refused = gnomon::technique::Spec::parse("soft:inner=(mpa)").unwrap_err().to_string();
    assert!(refused.contains("did you mean 'map'"), "{refused}");
}
