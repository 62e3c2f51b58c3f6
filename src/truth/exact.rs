//! The exact truth: one shadow ray per asked pixel, decided without an epsilon, and undecided only where the receiver's
//! own rounding error decides.

use super::asked;
use crate::cast::{Casters, Occlusion};
use crate::mask::{Truth, TruthMask, Visibility};
use crate::receiver::{PixelClass, Receiver, Receivers};
use crate::scene::{Emitter, Light, Scene, Segment};
use crate::watch::{Interrupted, Watch};
use glam::DVec3;
use rayon::prelude::*;
use std::time::Instant;

/// The truth, and what it took to find it.
#[derive(Debug, Clone, PartialEq)]
pub struct ExactTruth {
    /// One entry per pixel; `None` unless the pixel is asked.
    pub mask: TruthMask,
    /// How many shadow rays were asked about.
    pub rays: u64,
    /// Wall-clock time, milliseconds.
    pub ms: f64,
}

/// Decides for every pixel of class [`PixelClass::Asked`] whether it sees `light`, or how many of the points of an area
/// light. `classes` has one entry per pixel of
/// `receivers`; `casters` were made from `scene`.
///
/// # Errors
/// [`Interrupted`] once `watch` says so.
pub fn exact(
    scene: &Scene,
    casters: &Casters,
    light: &Light,
    receivers: &Receivers,
    classes: &[PixelClass],
    watch: &dyn Watch,
) -> Result<ExactTruth, Interrupted> {
    let start = Instant::now();
    let eye = scene.camera.eye.as_dvec3();
    let radius_m = scene.bounds().radius();
    let emitter = Emitter::new(light);
    let decide = |receiver: &Receiver| {
        if light.is_area() {
            of_area(scene, casters, &emitter, receiver, radius_m)
        } else {
            of_receiver(casters, light, receiver, eye, radius_m)
        }
    };

    let (width, height) = (receivers.size.x as usize, receivers.size.y as usize);
    watch.start("exact truth", u64::from(receivers.size.y));
    let rows: Result<Vec<Vec<_>>, Interrupted> = (0..height)
        .into_par_iter()
        .map(|y| {
            if watch.interrupted() {
                return Err(Interrupted);
            }
            let row = (y * width..(y + 1) * width).map(|i| asked(receivers, classes, i).as_ref().map(decide)).collect();
            watch.advance(1);
            Ok(row)
        })
        .collect();
    let pixels = rows?.concat();
    let rays = (pixels.iter().flatten().count() * emitter.count()) as u64;
    let mask = TruthMask { size: receivers.size, pixels };
    Ok(ExactTruth { mask, rays, ms: start.elapsed().as_secs_f64() * 1e3 })
}

/// The exact share of an area light's points that a receiver sees. Undecided as soon as one of them is.
#[must_use]
pub fn of_area(scene: &Scene, casters: &Casters, emitter: &Emitter, receiver: &Receiver, scene_radius_m: f64) -> Truth {
    let mut seen = 0_usize;
    for verdict in of_points(scene, casters, emitter, receiver, scene_radius_m) {
        match verdict {
            Occlusion::Clear => seen += 1,
            Occlusion::Blocked => {}
            Occlusion::Doubtful => return Truth::Undecided,
        }
    }
    // A count over a count is a visibility.
    Visibility::new((seen as f64 / emitter.count() as f64) as f32).map_or(Truth::Undecided, Truth::Known)
}

/// What a receiver sees of each of an area light's points, in order. A point behind the receiver's surface, as the eye
/// sees it, is blocked by it.
pub fn of_points<'a>(
    scene: &'a Scene,
    casters: &'a Casters,
    emitter: &'a Emitter,
    receiver: &'a Receiver,
    scene_radius_m: f64,
) -> impl Iterator<Item = Occlusion> + 'a {
    let eye = scene.camera.eye.as_dvec3();
    let rounding_m = rounding_radius_m(receiver, eye);
    let eye_side = scene.facing(receiver.triangle, eye.extend(1.0));
    emitter.points_for(receiver.point_in_world).map(move |point| {
        let side = scene.facing(receiver.triangle, point);
        if side == 0.0 || (side > 0.0) != (eye_side > 0.0) {
            return Occlusion::Blocked;
        }
        let segment = Segment::towards(receiver.point_in_world, point, scene_radius_m);
        casters.occlusion(&segment, Some(receiver.triangle), rounding_m)
    })
}

/// Decides one receiver, of an area light for its centre alone; `scene_radius_m` is that of the scene's bounds. What replays start from.
#[must_use]
pub fn of_receiver(casters: &Casters, light: &Light, receiver: &Receiver, eye: DVec3, scene_radius_m: f64) -> Truth {
    let segment = light.segment_from(receiver.point_in_world, scene_radius_m);
    match casters.occlusion(&segment, Some(receiver.triangle), rounding_radius_m(receiver, eye)) {
        Occlusion::Clear => Truth::Known(Visibility::LIT),
        Occlusion::Blocked => Truth::Known(Visibility::SHADOW),
        Occlusion::Doubtful => Truth::Undecided,
    }
}

/// Roundings of f64 that a receiver's point may be off by, with a good margin: the ray's direction takes about 12 of
/// them, the distance to the plane 8, the point itself 2.
const ROUNDINGS: f64 = 32.0;

/// How far, in metres, a receiver's computed point may lie from where its pixel-centre ray meets its triangle.
///
/// The point is eye + s·direction. Rounding the direction swings the ray by a few ulp of the distance; rounding s
/// shifts the point along it; and the final sum rounds to the ulp of the coordinates. On a surface seen at a grazing
/// angle both move the hit by 1/cos of the angle of incidence more.
pub(super) fn rounding_radius_m(receiver: &Receiver, eye: DVec3) -> f64 {
    let (point, sight) = (receiver.point_in_world, receiver.point_in_world - eye);
    let distance = sight.length();
    // Seen edge-on there is no bound; this one, sixteen times the distance, says as much.
    let cosine = (receiver.normal_in_world.dot(sight).abs() / distance).max(f64::EPSILON);
    0.5 * f64::EPSILON * ROUNDINGS * (point.length() + eye.length() + distance / cosine)
}
