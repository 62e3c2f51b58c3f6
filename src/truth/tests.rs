//! The truth of a floor under one triangle against the shadow worked out on paper, and what must stay undecided.

use super::exact::rounding_radius_m;
use super::*;
use crate::cast::Casters;
use crate::cast::testing::{Shape, scene_of};
use crate::mask::{Truth, TruthMask, Visibility};
use crate::scene::{Light, LightKind, Scene};
use crate::watch::{Interrupted, Unwatched, Watch};
use glam::{DVec2, DVec3, UVec2, Vec3};
use std::sync::atomic::{AtomicU64, Ordering};

const LIT: Option<Truth> = Some(Truth::Known(Visibility::LIT));
const SHADOW: Option<Truth> = Some(Truth::Known(Visibility::SHADOW));
const UNDECIDED: Option<Truth> = Some(Truth::Undecided);

/// Receivers along each side of the floor; odd, so that some lie on its middle lines.
const SIDE: u32 = 65;
/// Closer than this to the analytic edge, relative to the floor, rounding of the analytic answer itself decides.
const EDGE: f64 = 1e-9;

const LAMP: Vec3 = Vec3::new(0.3, 4.0, -0.2);
const BLOCKER: [Vec3; 3] = [Vec3::new(-0.7, 1.0, -0.6), Vec3::new(0.8, 1.5, -0.3), Vec3::new(0.1, 0.5, 0.9)];

/// A floor from −2 to 2 (triangles 0 and 1), some triangles from id 2 on, all times `scale`.
fn floor_and(others: &[[Vec3; 3]], scale: f32) -> Scene {
    let floor = Shape::grid(1, 1, |i, j| scale * Vec3::new(4.0 * i as f32 - 2.0, 0.0, 4.0 * j as f32 - 2.0));
    let others: Vec<_> = others.iter().map(|corners| corners.map(|corner| scale * corner)).collect();
    scene_of(&[floor, Shape::soup(&others)], scale * LAMP)
}

fn receiver_at(x: f64, z: f64) -> Receiver {
    let triangle = u32::from(x + z > 0.0);
    Receiver { triangle, point_in_world: DVec3::new(x, 0.0, z), normal_in_world: DVec3::Y }
}

/// A square grid of receivers on the floor.
fn grid(scale: f64) -> Receivers {
    let at = |i: u32| scale * (4.0 * f64::from(i) / f64::from(SIDE - 1) - 2.0);
    let pixels = (0..SIDE * SIDE).map(|i| Some(receiver_at(at(i % SIDE), at(i / SIDE)))).collect();
    Receivers { size: UVec2::splat(SIDE), pixels }
}

fn row(points: &[(f64, f64)]) -> Receivers {
    let pixels = points.iter().map(|&(x, z)| Some(receiver_at(x, z))).collect();
    Receivers { size: UVec2::new(points.len() as u32, 1), pixels }
}

fn truth_of(scene: &Scene, receivers: &Receivers) -> ExactTruth {
    let classes = vec![PixelClass::Asked; receivers.pixels.len()];
    exact(scene, &Casters::new(scene), &scene.lights[0], receivers, &classes, &Unwatched).unwrap()
}

/// Signed distance of a floor point from the edge of the blocker's shadow, positive in shadow.
fn depth_in_shadow(scene: &Scene, light: &Light, point: DVec3) -> f64 {
    let light = light.homogeneous();
    let corners = scene.triangle_in_world(2).map(|corner| {
        // Along the way light travels through the corner, down to y = 0.
        let travel = corner * light.w - light.truncate();
        let foot = corner - travel * (corner.y / travel.y);
        DVec2::new(foot.x, foot.z)
    });
    let point = DVec2::new(point.x, point.z);
    let left_of = |a: DVec2, b: DVec2| (b - a).perp_dot(point - a) / (b - a).length();
    let sides = [0, 1, 2].map(|i| left_of(corners[i], corners[(i + 1) % 3]));
    let turn = (corners[1] - corners[0]).perp_dot(corners[2] - corners[0]).signum();
    sides.map(|side| turn * side).into_iter().fold(f64::INFINITY, f64::min)
}

/// How many receivers are clearly on the wrong side of the analytic edge, and how many are in shadow.
fn wrong_and_shadowed(scene: &Scene, light: &Light, receivers: &Receivers, truth: &TruthMask) -> (usize, usize) {
    let pixels = receivers.pixels.iter().flatten().zip(&truth.pixels);
    let clear = pixels.filter_map(|(receiver, &truth)| {
        let depth = depth_in_shadow(scene, light, receiver.point_in_world);
        (depth.abs() > EDGE * scene.extent_m()).then_some((if depth > 0.0 { SHADOW } else { LIT }, truth))
    });
    let clear: Vec<_> = clear.collect();
    let wrong = clear.iter().filter(|(expected, truth)| expected != truth).count();
    (wrong, clear.iter().filter(|(expected, _)| *expected == SHADOW).count())
}

#[test]
fn the_shadow_of_a_triangle_is_the_projected_triangle_at_every_scale() {
    for scale in [1e-6, 1e-3, 1.0, 1e3, 1e6] {
        let mut scene = floor_and(&[BLOCKER], scale);
        let towards_light = Vec3::new(0.3, 0.9, -0.2).normalize();
        for kind in [scene.lights[0].kind, LightKind::Directional { towards_light }] {
            scene.lights[0].kind = kind;
            let (light, receivers) = (&scene.lights[0], grid(f64::from(scale)));
            let truth = truth_of(&scene, &receivers);
            let (wrong, shadowed) = wrong_and_shadowed(&scene, light, &receivers, &truth.mask);
            assert_eq!(wrong, 0, "{} at {scale}", light.kind_name());
            assert!(shadowed > 100);
            assert_eq!(truth.rays, u64::from(SIDE * SIDE));

            // The check has teeth: a light moved by a hundredth of the floor is noticed.
            let mut moved = scene.clone();
            moved.lights[0].kind = match kind {
                LightKind::Point { position, aim, attenuation } => {
                    LightKind::Point { position: position + Vec3::X * 0.04 * scale, aim, attenuation }
                }
                _ => LightKind::Directional { towards_light: (towards_light + Vec3::X * 0.04).normalize() },
            };
            assert!(wrong_and_shadowed(&moved, &moved.lights[0], &receivers, &truth.mask).0 > 0);
        }
    }
}

#[test]
fn a_wall_that_stands_on_the_floor_shadows_right_up_to_the_contact() {
    let scene = floor_and(&[[Vec3::new(-0.5, 0.0, 0.0), Vec3::new(0.5, 0.0, 0.0), Vec3::new(0.0, 2.0, 0.0)]], 1.0);
    let truth = truth_of(&scene, &row(&[(0.1, 1e-12), (0.1, -1e-12), (0.1, 0.0), (0.6, 0.0)]));
    assert_eq!(truth.mask.pixels, [SHADOW, LIT, UNDECIDED, LIT]);
}

#[test]
fn a_second_surface_in_the_floor_leaves_its_receivers_undecided() {
    let carpet = [Vec3::new(0.2, 0.0, 0.1), Vec3::new(1.0, 0.0, 0.3), Vec3::new(0.5, 0.0, 1.0)];
    let inside = [(0.5, 0.4), (0.6, 0.5)];
    let truth = truth_of(&floor_and(&[carpet], 1.0), &row(&[inside[0], inside[1], (-0.5, 0.4)]));
    assert_eq!(truth.mask.pixels, [UNDECIDED, UNDECIDED, LIT]);
    let above = carpet.map(|corner| corner + Vec3::Y * 1e-9);
    assert_eq!(truth_of(&floor_and(&[above], 1.0), &row(&inside)).mask.pixels, [SHADOW, SHADOW]);
}

#[test]
fn only_asked_receivers_are_decided() {
    let scene = floor_and(&[BLOCKER], 1.0);
    let mut receivers = row(&[(0.0, 0.0); 5]);
    receivers.pixels[4] = None;
    let classes =
        [PixelClass::Asked, PixelClass::FacingAway, PixelClass::NotLit, PixelClass::Background, PixelClass::Asked];
    let truth = exact(&scene, &Casters::new(&scene), &scene.lights[0], &receivers, &classes, &Unwatched).unwrap();
    assert_eq!(truth.mask.pixels, [SHADOW, None, None, None, None]);
    assert_eq!(truth.rays, 1);
}

#[test]
fn the_cross_check_is_silent_on_the_truth_and_finds_a_planted_error() {
    let (scene, receivers) = (floor_and(&[BLOCKER], 1.0), grid(1.0));
    let classes = vec![PixelClass::Asked; receivers.pixels.len()];
    let mut mask = truth_of(&scene, &receivers).mask;
    let check = |mask: &TruthMask, samples: u32| {
        cross_check(&scene, &scene.lights[0], &receivers, &classes, &Unwatched, mask, samples).unwrap()
    };
    assert_eq!(check(&mask, u32::MAX), []);
    let planted = mask.pixels.iter().position(|&truth| truth == SHADOW).unwrap();
    mask.pixels[planted] = LIT;
    let found = check(&mask, u32::MAX);
    assert_eq!(found.iter().map(|d| d.pixel as usize).collect::<Vec<_>>(), [planted]);
    assert_eq!((found[0].exact, found[0].brute), (Visibility::LIT, Visibility::SHADOW));
    mask.pixels.fill(LIT);
    assert!(!check(&mask, 200).is_empty());
}

#[test]
fn a_receiver_is_less_certain_the_farther_and_the_flatter_it_is_seen() {
    let radius = |eye: DVec3| rounding_radius_m(&receiver_at(0.0, 0.0), eye);
    assert!(radius(DVec3::Y) < 1e-14);
    assert!(radius(DVec3::Y * 100.0) > 50.0 * radius(DVec3::Y));
    assert!(radius(DVec3::new(1.0, 0.01, 0.0)) > 10.0 * radius(DVec3::Y));
    assert!(radius(DVec3::X).is_finite());
}

/// Stops the work after some rows.
struct Impatient {
    rows_left: AtomicU64,
}

impl Watch for Impatient {
    fn start(&self, _what: &str, _total: u64) {}
    fn advance(&self, units: u64) {
        // Below zero the number wraps, and the work has long been told to stop.
        self.rows_left.fetch_sub(units, Ordering::Relaxed);
    }
    fn interrupted(&self) -> bool {
        self.rows_left.load(Ordering::Relaxed) == 0
    }
}

#[test]
fn work_stops_when_the_user_asks() {
    let (scene, receivers) = (floor_and(&[BLOCKER], 1.0), grid(1.0));
    let classes = vec![PixelClass::Asked; receivers.pixels.len()];
    let stop_now = Impatient { rows_left: AtomicU64::new(0) };
    let casters = Casters::new(&scene);
    assert_eq!(exact(&scene, &casters, &scene.lights[0], &receivers, &classes, &stop_now), Err(Interrupted));
    let mask = truth_of(&scene, &receivers).mask;
    let checked = cross_check(&scene, &scene.lights[0], &receivers, &classes, &stop_now, &mask, 10);
    assert_eq!(checked, Err(Interrupted));
}
