//! A projective texture replayed in f64, one approximation at a time: exact → no depth, no self-shadow → coverage →
//! sampling → filter → the GPU's answer.

use super::prepared::PreparedPicture;
use crate::cast::Occlusion;
use crate::cause::{Cause, Replay, Stage};
use crate::mask::Mask;
use crate::receiver::Receiver;
use crate::scene::Segment;
use crate::technique::Prepared;
use crate::technique::footprint::aliasing_cause;
use crate::technique::map::{ExactTexels, Outside};
use glam::{DVec2, IVec2};
use rayon::prelude::*;

/// A stage's value and the cause that owns its change, for one pixel.
#[derive(Debug, Clone, Copy)]
struct Step {
    value: f64,
    cause: Cause,
}

/// Stage names in order.
const STAGES: [&str; 5] = ["no depth", "coverage", "sampling", "filter", "gpu"];

pub(super) fn replay(picture: &PreparedPicture<'_>, answer: &Mask, pixels: &[u32]) -> Replay {
    let texels = texels_read(picture, pixels);
    let replayed: Vec<(f64, [Step; STAGES.len()])> =
        pixels.par_iter().filter_map(|pixel| replay_pixel(picture, &texels, answer, *pixel)).collect();
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

fn lit(is_lit: bool) -> f64 {
    if is_lit { 1.0 } else { 0.0 }
}

fn takes_shadow(picture: &PreparedPicture<'_>, receiver: &Receiver) -> bool {
    picture.settings.takes_shadow(picture.job.scene.mesh_of(receiver.triangle))
}

/// Where the picture is read for a receiver, in texels; `None` where it is not.
fn position(picture: &PreparedPicture<'_>, receiver: &Receiver) -> Option<DVec2> {
    takes_shadow(picture, receiver)
        .then(|| picture.place(receiver.point_in_world))?
        .map(|site| site.position_in_texels())
}

fn each_tap(picture: &PreparedPicture<'_>, position_in_texels: DVec2, tap: &mut dyn FnMut(IVec2, f64)) {
    let map = &picture.settings.map;
    map.filter.taps(&map.kernel, position_in_texels, tap);
}

/// Every texel that the lookups of these pixels and their sampling stage read.
fn texels_read(picture: &PreparedPicture<'_>, pixels: &[u32]) -> ExactTexels {
    let of_pixel = |pixel: &u32| {
        let mut indices = Vec::new();
        if let Some(at) = picture.receiver(*pixel).and_then(|receiver| position(picture, &receiver)) {
            indices.extend(picture.lookup.texel_index(0, at.floor().as_ivec2()));
            each_tap(picture, at, &mut |texel, _| indices.extend(picture.lookup.texel_index(0, texel)));
        }
        indices
    };
    let indices = pixels.par_iter().flat_map_iter(of_pixel).collect();
    ExactTexels::cast(picture.job.scene, picture.job.casters, &picture.lookup, indices)
}

/// 0 where a caster covers the texel's centre.
fn white(picture: &PreparedPicture<'_>, texels: &ExactTexels, texel: IVec2) -> f64 {
    let rank = picture.lookup.texel_index(0, texel).and_then(|index| texels.rank(index));
    lit(rank.is_none_or(|rank| texels.at(rank).triangle.is_none()))
}

fn replay_pixel(
    picture: &PreparedPicture<'_>,
    texels: &ExactTexels,
    answer: &Mask,
    pixel: u32,
) -> Option<(f64, [Step; STAGES.len()])> {
    let receiver = picture.receiver(pixel)?;
    let answered = f64::from(answer.pixels.get(pixel as usize).copied().flatten()?.get());
    let radius_m = picture.job.scene.bounds().radius();
    let segment = picture.job.light.segment_from(receiver.point_in_world, radius_m);
    let exact = lit(picture.job.casters.occlusion(&segment, Some(receiver.triangle), 0.0) == Occlusion::Clear);

    let (model, coverage) = line_through(picture, &receiver, &segment);
    let position = position(picture, &receiver);
    let sampling = position.map_or(1.0, |at| white(picture, texels, at.floor().as_ivec2()));
    let filter = position.map_or(1.0, |at| {
        let mut value = 0.0;
        each_tap(picture, at, &mut |texel, weight| value += weight * white(picture, texels, texel));
        value
    });
    let steps = [
        Step { value: model, cause: Cause::TechniqueModel },
        coverage,
        Step { value: sampling, cause: aliasing_cause(picture.footprint(pixel).as_ref()) },
        Step { value: filter, cause: Cause::FilterWidth },
        Step { value: answered, cause: Cause::Precision },
    ];
    Some((exact, steps))
}

/// The whole line from the light through a receiver: whether anything on it casts, and whether the frustum sees that.
fn line_through(picture: &PreparedPicture<'_>, receiver: &Receiver, segment: &Segment) -> (f64, Step) {
    if !takes_shadow(picture, receiver) {
        return (1.0, Step { value: 1.0, cause: Cause::ClippingFrustum });
    }
    let bounds = picture.job.scene.bounds();
    let away = (segment.from - segment.to).normalize_or_zero();
    let beyond_all_m = 2.0 * ((segment.from - bounds.centre()).length() + bounds.radius());
    let line = Segment { from: segment.to, to: segment.from + away * beyond_all_m };
    let mut hits = Vec::new();
    picture.job.casters.all_hits(&line, None, &mut hits);
    let is_in_picture = picture.place(receiver.point_in_world).is_some();
    let clipped_by = hits.iter().map(|hit| picture.lookup.project(line.from.lerp(line.to, hit.t)).err());
    let clipped_by: Vec<Option<Outside>> = clipped_by.collect();
    let is_black = is_in_picture && clipped_by.contains(&None);
    let cause = match clipped_by.into_iter().flatten().next().filter(|_| is_in_picture) {
        Some(Outside::Near) => Cause::ClippingNear,
        Some(Outside::Far) => Cause::ClippingFar,
        Some(Outside::Frustum) | None => Cause::ClippingFrustum,
    };
    (lit(hits.is_empty()), Step { value: lit(!is_black), cause })
}

/// Where one pixel's lookup went, for people.
pub(super) fn lookup_facts(picture: &PreparedPicture<'_>, pixel: u32) -> Vec<(String, String)> {
    let Some(receiver) = picture.receiver(pixel) else { return Vec::new() };
    let fact = |label: &str, value: String| (label.to_owned(), value);
    let Some(at) = position(picture, &receiver) else {
        let is_thrown = takes_shadow(picture, &receiver);
        let why = if is_thrown { "does not reach here: lit" } else { "not thrown on this mesh, which casts: lit" };
        return vec![fact("picture", why.to_owned())];
    };
    let texels = texels_read(picture, &[pixel]);
    let mut facts = vec![fact("position", format!("({:.4}, {:.4}) texels", at.x, at.y))];
    /// More taps than this are not listed one by one.
    const LISTED_TAPS: usize = 25;
    let width = picture.lookup.texels().x;
    for (rank, index) in texels.indices.iter().enumerate().take(LISTED_TAPS) {
        let holds = texels.at(rank).triangle.map_or_else(
            || "white".to_owned(),
            |triangle| format!("black, by triangle {triangle} of {}", picture.job.scene.mesh_of(triangle).name),
        );
        facts.push(fact(&format!("texel ({}, {})", index % width, index / width), holds));
    }
    facts
}
