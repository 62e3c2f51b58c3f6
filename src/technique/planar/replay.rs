//! Planar shadows replayed in f64, one approximation at a time: exact → the plane alone receives → what the projection
//! does not guard against → what shows beside the plane → layers → the GPU's answer.

use super::layers::{self, Layer};
use super::prepared::PreparedPlanar;
use super::settings::{Overlap, Placement, Projection};
use super::shadow_plane::Side;
use crate::cast::Occlusion;
use crate::cause::{Cause, Replay, Stage};
use crate::mask::Mask;
use crate::receiver::Receiver;
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// A stage's value and the cause that owns its change, for one pixel.
#[derive(Debug, Clone, Copy)]
struct Step {
    value: f64,
    cause: Cause,
}

/// Stage names in order.
const STAGES: [&str; 5] = ["plane model", "side guards", "plane outline", "overlap", "gpu"];

/// The ray of a pixel.
struct PixelRay {
    eye: DVec3,
    direction: DVec3,
    /// Where it meets the receiver, in multiples of the direction.
    receiver_along: f64,
}

pub(super) fn replay(planar: &PreparedPlanar<'_>, answer: &Mask, pixels: &[u32]) -> Replay {
    let replayed: Vec<(f64, [Step; STAGES.len()])> =
        pixels.par_iter().filter_map(|pixel| replay_pixel(planar, answer, *pixel)).collect();
    let stage = |(index, name): (usize, &'static str)| Stage {
        name,
        values: replayed.iter().map(|(_, steps)| steps[index].value).collect(),
        causes: replayed.iter().map(|(_, steps)| steps[index].cause).collect(),
    };
    Replay {
        pixels: pixels.to_vec(),
        exact: replayed.iter().map(|(exact, _)| *exact).collect(),
        stages: STAGES.into_iter().enumerate().map(stage).collect(),
    }
}

fn replay_pixel(planar: &PreparedPlanar<'_>, answer: &Mask, pixel: u32) -> Option<(f64, [Step; STAGES.len()])> {
    let receiver = planar.receiver(pixel)?;
    let answered = f64::from(answer.pixels.get(pixel as usize).copied().flatten()?.get());
    let segment = planar.job.light.segment_from(receiver.point_in_world, planar.job.scene.bounds().radius());
    let exact = lit(planar.job.casters.occlusion(&segment, Some(receiver.triangle), 0.0) == Occlusion::Clear);

    let ray = pixel_ray(planar, pixel, &receiver);
    let own = own_plane(planar, &receiver);
    let at_own = own.and_then(|plane| Some((plane, plane_point(planar, &ray, plane)?)));
    let model = at_own.map_or(1.0, |(plane, point)| lit(layers::ideal(planar, plane, point).is_empty()));
    let drawn = at_own.map_or_else(Vec::new, |(plane, point)| layers::drawn(planar, plane, point));
    let guarded = lit(drawn.is_empty());
    let shown = match planar.settings.placement {
        Placement::ReceiverMask => drawn.len(),
        Placement::DepthOffset => drawn.len() + beside(planar, &ray, own),
    };
    let overlapped = planar.settings.visibility(shown);
    let steps = [
        Step { value: model, cause: Cause::PlanarModel },
        Step { value: guarded, cause: guard_cause(planar, model, &drawn) },
        Step { value: lit(shown == 0), cause: Cause::ClippingFrustum },
        Step { value: overlapped, cause: Cause::TechniqueModel },
        Step { value: answered, cause: Cause::Precision },
    ];
    Some((exact, steps))
}

fn lit(is_lit: bool) -> f64 {
    if is_lit { 1.0 } else { 0.0 }
}

fn own_plane(planar: &PreparedPlanar<'_>, receiver: &Receiver) -> Option<usize> {
    planar.members.plane_of.get(receiver.triangle as usize).copied().flatten()
}

fn pixel_ray(planar: &PreparedPlanar<'_>, pixel: u32, receiver: &Receiver) -> PixelRay {
    let (scene, size) = (planar.job.scene, planar.job.scene.image_size);
    let centre = DVec2::new((pixel % size.x).into(), (pixel / size.x).into()) + 0.5;
    let (eye, direction) = (scene.camera.eye.as_dvec3(), scene.camera.ray_through(size, centre));
    let receiver_along = (receiver.point_in_world - eye).dot(direction) / direction.length_squared();
    PixelRay { eye, direction, receiver_along }
}

/// The point of a plane that a pixel shows, in front of the camera.
fn plane_point(planar: &PreparedPlanar<'_>, ray: &PixelRay, plane: usize) -> Option<DVec3> {
    let along = planar.planes[plane].along_ray(ray.eye, ray.direction)?;
    (along > 0.0).then(|| ray.eye + along * ray.direction)
}

/// Layers of shadow on other planes that a pixel shows in front of its receiver: without a mask they are seen.
fn beside(planar: &PreparedPlanar<'_>, ray: &PixelRay, own: Option<usize>) -> usize {
    let others = (0..planar.planes.len()).filter(|plane| Some(*plane) != own);
    let in_front = others.filter_map(|plane| {
        let along = planar.planes[plane].along_ray(ray.eye, ray.direction)?;
        // The picture begins at the near plane, at view depth 1 per multiple of the direction.
        let is_seen = along >= planar.job.scene.camera.near_m && along <= ray.receiver_along;
        is_seen.then(|| layers::drawn(planar, plane, ray.eye + along * ray.direction).len())
    });
    in_front.sum()
}

/// Who owns the difference between the ideal shadow on the plane and the one that the projection draws.
fn guard_cause(planar: &PreparedPlanar<'_>, model: f64, drawn: &[Layer]) -> Cause {
    let lost = model == 0.0 && drawn.is_empty();
    if drawn.iter().any(|layer| layer.side == Side::Behind) {
        Cause::FalseShadowBehindPlane
    } else if lost && planar.settings.projection == Projection::Clipped {
        Cause::ClippingFar
    } else {
        Cause::AntiShadow
    }
}

/// Where one pixel's shadow comes from, for people.
pub(super) fn lookup_facts(planar: &PreparedPlanar<'_>, pixel: u32) -> Vec<(String, String)> {
    let Some(receiver) = planar.receiver(pixel) else { return Vec::new() };
    let fact = |label: &str, value: String| (label.to_owned(), value);
    let ray = pixel_ray(planar, pixel, &receiver);
    let Some(plane) = own_plane(planar, &receiver) else {
        let heights = planar.planes.iter().map(|plane| plane.height_m(receiver.point_in_world).abs());
        let nearest = heights.fold(f64::INFINITY, f64::min);
        return vec![fact("plane", format!("none: lit; the nearest is {nearest:.6} m away"))];
    };
    let shadow = &planar.planes[plane];
    let mut facts = vec![
        fact("plane", planar.label(plane)),
        fact("off the plane", format!("{:.3e} m", shadow.height_m(receiver.point_in_world))),
        fact("light height d", format!("{:.6}", shadow.light_height())),
    ];
    /// More layers than this are not listed one by one.
    const LISTED: usize = 10;
    let drawn = plane_point(planar, &ray, plane).map_or_else(Vec::new, |point| layers::drawn(planar, plane, point));
    for layer in drawn.iter().take(LISTED) {
        let mesh = &planar.job.scene.mesh_of(layer.triangle).name;
        let place = match layer.side {
            Side::Behind => "behind the plane",
            Side::Between => "between plane and light",
            Side::Beyond => "reaching beyond the light",
        };
        facts.push(fact("flattened caster", format!("triangle {} of {mesh}, {place}", layer.triangle)));
    }
    let is_single = planar.settings.overlap == Overlap::Stencil;
    let counted = if is_single { drawn.len().min(1) } else { drawn.len() };
    facts.push(fact("layers", format!("{} over this pixel, {counted} drawn", drawn.len())));
    facts
}
