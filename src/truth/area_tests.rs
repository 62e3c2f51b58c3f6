//! The truth of area lights over the edge of a half plane, against the share of the light's area worked out on paper.

use super::{cross_check, exact};
use crate::cast::Casters;
use crate::cast::testing::{Shape, scene_of};
use crate::mask::{Truth, TruthMask, Visibility};
use crate::receiver::{PixelClass, Receiver, Receivers};
use crate::scene::{Light, LightKind, Scene};
use crate::watch::Unwatched;
use glam::{DVec2, DVec3, UVec2, Vec3};
use std::f64::consts::PI;

const SIDE: f64 = 1.0;
const LAMP_HEIGHT: f64 = 4.0;
const EDGE_HEIGHT: f64 = 1.0;
const RECEIVERS: u32 = 101;
/// Points and corners are rounded to f32.
const ROUNDING: f64 = 1e-5;

/// A floor, and above it the half plane beyond the line through (0, 0) across the direction at `tilt` in x and z.
fn scene_with_edge(tilt: f64, kind: LightKind) -> Scene {
    let (across, along) = (DVec2::from_angle(tilt), DVec2::from_angle(tilt).perp());
    let far = 50.0;
    let place = |at: DVec2| DVec3::new(at.x, EDGE_HEIGHT, at.y).as_vec3();
    let [a, b] = [-far * along, far * along].map(place);
    let [c, d] = [far * (across + along), far * (across - along)].map(place);
    let floor = Shape::grid(1, 1, |i, j| Vec3::new(20.0 * i as f32 - 10.0, 0.0, 20.0 * j as f32 - 10.0));
    let mut scene = scene_of(&[floor, Shape::soup(&[[a, b, c], [a, c, d]])], Vec3::Y * LAMP_HEIGHT as f32);
    scene.camera.eye = Vec3::new(0.0, 9.0, 0.0);
    scene.lights[0].kind = kind;
    scene
}

fn rectangle(samples: u32) -> LightKind {
    let half = 0.5 * SIDE as f32;
    LightKind::Rectangle {
        position: Vec3::Y * LAMP_HEIGHT as f32,
        aim: Vec3::ZERO,
        half_width: Vec3::X * half,
        half_height: Vec3::NEG_Z * half,
        samples,
    }
}

fn sphere(samples: u32) -> LightKind {
    LightKind::Sphere { position: Vec3::Y * LAMP_HEIGHT as f32, aim: Vec3::ZERO, radius_m: 0.5 * SIDE as f32, samples }
}

/// As wide as the lamps seen from below.
fn sun(samples: u32) -> LightKind {
    let angular_radius_rad = (0.5 * SIDE / LAMP_HEIGHT).atan();
    LightKind::Sun { towards_light: Vec3::Y, angular_radius_rad, samples }
}

/// A row of receivers across the penumbra.
fn receivers(tilt: f64) -> Receivers {
    let at = |i: u32| 0.5 * (2.0 * f64::from(i) / f64::from(RECEIVERS - 1) - 1.0) + 1e-4;
    let receiver = |i: u32| {
        let point = at(i) * DVec2::from_angle(tilt);
        // The floor's diagonal runs from −x, +z to +x, −z.
        let triangle = u32::from(point.x + point.y > 0.0);
        Some(Receiver { triangle, point_in_world: DVec3::new(point.x, 0.0, point.y), normal_in_world: DVec3::Y })
    };
    Receivers { size: UVec2::new(RECEIVERS, 1), pixels: (0..RECEIVERS).map(receiver).collect() }
}

fn truth(scene: &Scene, light: &Light, receivers: &Receivers) -> TruthMask {
    let classes = vec![PixelClass::Asked; receivers.pixels.len()];
    exact(scene, &Casters::new(scene), light, receivers, &classes, &Unwatched).unwrap().mask
}

/// The visible share of the square, for a receiver at `x` along the direction of `tilt`: the edge, seen from there, cuts
/// the square along a line.
fn square_share(tilt: f64, x: f64) -> f64 {
    let line = x - x * LAMP_HEIGHT / EDGE_HEIGHT;
    let (c, s) = (tilt.cos().abs(), tilt.sin().abs());
    let offset = line / SIDE + 0.5 * (c + s);
    if c.min(s) < 1e-12 {
        return offset.clamp(0.0, 1.0);
    }
    let triangle = |t: f64| 0.5 * t.max(0.0).powi(2);
    (triangle(offset) - triangle(offset - c) - triangle(offset - s) + triangle(offset - c - s)) / (c * s)
}

/// The visible share of the sphere's facing disc: what the plane through receiver and edge leaves of it.
fn disc_share(tilt: f64, x: f64) -> f64 {
    let across = DVec3::new(tilt.cos(), 0.0, tilt.sin());
    let to_centre = DVec3::Y * LAMP_HEIGHT - x * across;
    // Normal of that plane, towards the blocked side.
    let normal = (across + DVec3::Y * (x / EDGE_HEIGHT)).normalize();
    let in_disc = normal.reject_from(to_centre).length();
    let t = (-normal.dot(to_centre) / (in_disc * 0.5 * SIDE)).clamp(-1.0, 1.0);
    ((-t).acos() + t * (1.0 - t * t).sqrt()) / PI
}

/// The visible share of the sun's disc of tangents: the edge is seen at −x over its height.
fn sun_share(_tilt: f64, x: f64) -> f64 {
    let t = (-x / EDGE_HEIGHT / (0.5 * SIDE / LAMP_HEIGHT)).clamp(-1.0, 1.0);
    ((-t).acos() + t * (1.0 - t * t).sqrt()) / PI
}

/// The largest error of the truth over a penumbra.
fn worst(tilt: f64, kind: LightKind, share: fn(f64, f64) -> f64) -> f64 {
    let (scene, row) = (scene_with_edge(tilt, kind), receivers(tilt));
    let truth = truth(&scene, &scene.lights[0], &row);
    let errors = row.pixels.iter().flatten().zip(&truth.pixels).map(|(receiver, truth)| {
        let Some(Truth::Known(visibility)) = truth else { panic!("{truth:?} at {receiver:?}") };
        let point = receiver.point_in_world;
        let x = DVec2::new(point.x, point.z).dot(DVec2::from_angle(tilt));
        (f64::from(visibility.get()) - share(tilt, x)).abs()
    });
    errors.fold(0.0, f64::max)
}

#[test]
fn an_edge_along_a_side_hides_its_share_of_the_rectangle_within_one_sample() {
    for samples in [1, 4, 9, 16, 64, 100, 256] {
        for tilt in [0.0, 0.5 * PI] {
            let error = worst(tilt, rectangle(samples), square_share);
            assert!(error <= 1.0 / f64::from(samples) + ROUNDING, "{samples} samples: {error}");
        }
    }
}

#[test]
fn any_other_edge_hides_its_share_within_half_a_row_of_samples() {
    for samples in [64, 144, 256] {
        let bound = 0.5 / f64::from(samples).sqrt() + ROUNDING;
        for tilt_deg in [0.0_f64, 10.0, 26.57, 45.0, 70.0] {
            let tilt = tilt_deg.to_radians();
            let errors = [
                worst(tilt, rectangle(samples), square_share),
                worst(tilt, sphere(samples), disc_share),
                worst(tilt, sun(samples), sun_share),
            ];
            assert!(errors.iter().all(|error| *error <= bound), "{samples} samples, {tilt_deg}: {errors:?}");
        }
    }
}

#[test]
fn the_error_falls_with_the_samples_at_the_predicted_rate() {
    let mean = |samples| {
        let tilts = [10.0_f64, 26.57, 45.0, 70.0].map(f64::to_radians);
        tilts.map(|tilt| worst(tilt, sphere(samples), disc_share) + worst(tilt, rectangle(samples), square_share))
    };
    // 1/√N halves the error where N is four times as large, and this set is no worse.
    let [few, many] = [16, 256].map(|samples| mean(samples).into_iter().sum::<f64>());
    assert!(many <= few / 4.0, "{few} with 16, {many} with 256");
}

#[test]
fn a_light_moved_by_a_centimetre_is_noticed() {
    let LightKind::Rectangle { position, aim, half_width, half_height, samples } = rectangle(256) else { panic!() };
    let moved = LightKind::Rectangle { position: position + Vec3::X * 0.01, aim, half_width, half_height, samples };
    assert!(worst(0.0, moved, square_share) > 1.0 / 256.0 + ROUNDING);
}

#[test]
fn a_sun_turned_by_half_its_radius_is_noticed() {
    let LightKind::Sun { angular_radius_rad, samples, .. } = sun(256) else { panic!() };
    let towards_light = Vec3::new(0.5 * angular_radius_rad as f32, 1.0, 0.0).normalize();
    let turned = LightKind::Sun { towards_light, angular_radius_rad, samples };
    assert!(worst(0.0, turned, sun_share) > 4.0 * (0.5 / 256.0_f64.sqrt()));
}

#[test]
fn brute_force_counts_the_same_and_notices_one_sample_too_many() {
    let scene = scene_with_edge(0.3, sphere(16));
    let (light, row) = (&scene.lights[0], receivers(0.3));
    let classes = vec![PixelClass::Asked; row.pixels.len()];
    let mut known = truth(&scene, light, &row);
    let disagreements =
        |known: &TruthMask| cross_check(&scene, light, &row, &classes, &Unwatched, known, u32::MAX).unwrap().len();
    assert_eq!(disagreements(&known), 0);
    let Some(Truth::Known(visibility)) = &mut known.pixels[50] else { panic!() };
    *visibility = Visibility::new(visibility.get() + 1.0 / 16.0).unwrap();
    assert_eq!(disagreements(&known), 1);
}

#[test]
fn points_behind_the_surface_are_not_seen() {
    // A square that the floor cuts in half.
    let kind = LightKind::Rectangle {
        position: Vec3::new(3.0, 0.125, 0.0),
        aim: Vec3::ZERO,
        half_width: Vec3::NEG_Z,
        half_height: Vec3::Y,
        samples: 64,
    };
    let mut scene = scene_with_edge(0.0, kind);
    scene.meshes.iter_mut().for_each(|mesh| mesh.casts = false);
    let truth = truth(&scene, &scene.lights[0], &receivers(0.0));
    let above = Visibility::new((64.0 * 1.125_f32 / 2.0) / 64.0);
    assert!(truth.pixels.iter().all(|pixel| *pixel == above.map(Truth::Known)), "{:?}", truth.pixels);
}
