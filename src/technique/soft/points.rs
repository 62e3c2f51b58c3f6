//! The points of a soft shadow as lights of their own, which a hard technique can handle.

use super::Pattern;
use super::pattern::on_disc;
use crate::scene::{Emitter, Light, LightKind};
use crate::technique::Job;
use glam::{DVec2, DVec3, Vec3};

/// The points on the light of a job, as point lights. A sphere's lie on the disc that faces the middle of the asked
/// receivers: fixed points cannot face each of them.
pub(super) fn point_lights(job: &Job<'_>, pattern: Pattern, count: u32, seed: u64) -> Vec<Light> {
    let seen_from = middle_of_asked(job);
    let positions: Vec<DVec3> = match pattern {
        Pattern::Truth => {
            let emitter = Emitter::new(&with_samples(job.light, count));
            emitter.points_for(seen_from).map(|point| point.truncate()).collect()
        }
        _ => pattern.points(count, seed).into_iter().map(|at| place(job.light, at, seen_from)).collect(),
    };
    positions.into_iter().map(|position| at(job.light, position.as_vec3())).collect()
}

/// The light's centre as a point light.
pub(super) fn at_centre(light: &Light) -> Light {
    at(light, light.homogeneous().truncate().as_vec3())
}

fn at(light: &Light, position: Vec3) -> Light {
    let aim = match light.kind {
        LightKind::Rectangle { aim, .. } | LightKind::Sphere { aim, .. } | LightKind::Point { aim, .. } => aim,
        LightKind::Spot { .. } | LightKind::Directional { .. } => Vec3::ZERO,
    };
    let kind = LightKind::Point { position, aim, attenuation: [1.0, 0.0, 0.0] };
    // Whether a pixel is asked at all is decided by the light's centre.
    Light { kind, range_m: f64::INFINITY, ..light.clone() }
}

fn with_samples(light: &Light, count: u32) -> Light {
    let mut light = light.clone();
    if let LightKind::Rectangle { samples, .. } | LightKind::Sphere { samples, .. } = &mut light.kind {
        *samples = count;
    }
    light
}

/// A place of the unit square on the light.
fn place(light: &Light, at: DVec2, seen_from: DVec3) -> DVec3 {
    let centre = light.homogeneous().truncate();
    match light.kind {
        LightKind::Rectangle { half_width, half_height, .. } => {
            let from_middle = 2.0 * at - 1.0;
            centre + half_width.as_dvec3() * from_middle.x + half_height.as_dvec3() * from_middle.y
        }
        LightKind::Sphere { radius_m, .. } => {
            let towards = (centre - seen_from).try_normalize().unwrap_or(DVec3::Y);
            let (right, up) = towards.any_orthonormal_pair();
            let on_disc = on_disc(at) * f64::from(radius_m);
            centre + right * on_disc.x + up * on_disc.y
        }
        LightKind::Point { .. } | LightKind::Directional { .. } | LightKind::Spot { .. } => centre,
    }
}

fn middle_of_asked(job: &Job<'_>) -> DVec3 {
    let points = job.fitted_to.points();
    points.iter().sum::<DVec3>() / points.len().max(1) as f64
}
