//! The points of a soft shadow as lights of their own, without extent, which a hard technique can handle.

use super::Pattern;
use super::pattern::on_disc;
use crate::scene::{Emitter, Light, LightKind, sun_direction};
use crate::technique::Job;
use glam::{DVec2, DVec3, DVec4};

/// The points on the light of a job, as lights. A sphere's lie on the disc that faces the middle of the asked
/// receivers: fixed points cannot face each of them.
pub(super) fn point_lights(job: &Job<'_>, pattern: Pattern, count: u32, seed: u64) -> Vec<Light> {
    let seen_from = middle_of_asked(job);
    let places: Vec<DVec4> = match pattern {
        Pattern::Truth => {
            let emitter = Emitter::new(&with_samples(job.light, count));
            emitter.points_for(seen_from).collect()
        }
        _ => pattern.points(count, seed).into_iter().map(|at| place(job.light, at, seen_from)).collect(),
    };
    places.into_iter().map(|place| at(job.light, place)).collect()
}

/// The light's centre as a light without extent.
pub(super) fn at_centre(light: &Light) -> Light {
    at(light, light.homogeneous())
}

/// A homogeneous place as a light without extent.
fn at(light: &Light, place: DVec4) -> Light {
    let position = place.truncate().as_vec3();
    let kind = match light.kind {
        LightKind::Rectangle { aim, .. } | LightKind::Sphere { aim, .. } | LightKind::Point { aim, .. } => {
            LightKind::Point { position, aim, attenuation: [1.0, 0.0, 0.0] }
        }
        LightKind::Sun { .. } => LightKind::Directional { towards_light: position },
        LightKind::Spot { .. } | LightKind::Directional { .. } => light.kind,
    };
    // Whether a pixel is asked at all is decided by the light's centre.
    Light { kind, range_m: f64::INFINITY, ..light.clone() }
}

fn with_samples(light: &Light, count: u32) -> Light {
    let mut light = light.clone();
    if let LightKind::Rectangle { samples, .. } | LightKind::Sphere { samples, .. } | LightKind::Sun { samples, .. } =
        &mut light.kind
    {
        *samples = count;
    }
    light
}

/// A place of the unit square on the light, homogeneous.
fn place(light: &Light, at: DVec2, seen_from: DVec3) -> DVec4 {
    let centre = light.homogeneous().truncate();
    match light.kind {
        LightKind::Rectangle { half_width, half_height, .. } => {
            let from_middle = 2.0 * at - 1.0;
            (centre + half_width.as_dvec3() * from_middle.x + half_height.as_dvec3() * from_middle.y).extend(1.0)
        }
        LightKind::Sphere { radius_m, .. } => {
            let towards = (centre - seen_from).try_normalize().unwrap_or(DVec3::Y);
            let (right, up) = towards.any_orthonormal_pair();
            let on_disc = on_disc(at) * f64::from(radius_m);
            (centre + right * on_disc.x + up * on_disc.y).extend(1.0)
        }
        LightKind::Sun { angular_radius_rad, .. } => sun_direction(centre, angular_radius_rad, on_disc(at)).extend(0.0),
        LightKind::Point { .. } | LightKind::Directional { .. } | LightKind::Spot { .. } => light.homogeneous(),
    }
}

fn middle_of_asked(job: &Job<'_>) -> DVec3 {
    let points = job.fitted_to.points();
    points.iter().sum::<DVec3>() / points.len().max(1) as f64
}
