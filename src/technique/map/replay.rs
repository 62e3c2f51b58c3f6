//! A map replayed in f64, one approximation at a time: exact → coverage → bias → sampling → filter → stored texels →
//! the GPU's answer. Bias stands before sampling: after it, each biased pixel would book a large acne and a large
//! peter-panning that cancel.

use super::exact_texels::{ExactTexel, ExactTexels};
use super::lookup::{Outside, Placed};
use super::own_surface::is_own_surface;
use super::prepared::PreparedMap;
use crate::cast::Hit;
use crate::cause::{Cause, Replay, Stage};
use crate::mask::Mask;
use crate::receiver::Receiver;
use crate::scene::Segment;
use crate::technique::footprint::aliasing_cause;
use crate::technique::{Prepared, TechniqueError};
use glam::IVec2;
use rayon::prelude::*;

/// A stage's value and the cause that owns its change, for one pixel.
#[derive(Debug, Clone, Copy)]
struct Step {
    value: f64,
    cause: Cause,
}

/// Stage names in order.
const STAGES: [&str; 6] = ["coverage", "bias", "sampling", "filter", "stored texels", "gpu"];

pub(super) fn replay(map: &PreparedMap<'_>, answer: &Mask, pixels: &[u32]) -> Result<Replay, TechniqueError> {
    let texels = texels_read(map, pixels);
    let stored = map.passes.gather(map.job.gpu, &texels.indices)?;
    let replayed: Vec<(f64, [Step; STAGES.len()])> =
        pixels.par_iter().filter_map(|pixel| replay_pixel(map, &texels, &stored, answer, *pixel)).collect();
    let stage = |(index, name): (usize, &'static str)| Stage {
        name,
        values: replayed.iter().map(|(_, steps)| steps[index].value).collect(),
        causes: replayed.iter().map(|(_, steps)| steps[index].cause).collect(),
    };
    Ok(Replay {
        pixels: pixels.to_vec(),
        exact: replayed.iter().map(|(exact, _)| *exact).collect(),
        stages: STAGES.into_iter().enumerate().map(stage).collect(),
    })
}

fn place(map: &PreparedMap<'_>, receiver: &Receiver) -> Result<Placed, Outside> {
    map.lookup.place(receiver.point_in_world, receiver.normal_in_world)
}

fn each_tap(map: &PreparedMap<'_>, placed: &Placed, tap: &mut dyn FnMut(IVec2, f64)) {
    map.settings.filter.taps(map.settings.kernel, placed.position_in_texels, tap);
}

/// Every texel that the lookups of these pixels and their sampling stage read.
fn texels_read(map: &PreparedMap<'_>, pixels: &[u32]) -> ExactTexels {
    let indices: Vec<u32> = pixels
        .par_iter()
        .flat_map_iter(|pixel| {
            let mut indices = Vec::new();
            if let Some(placed) = map.receiver(*pixel).and_then(|receiver| place(map, &receiver).ok()) {
                indices.extend(map.lookup.texel_index(placed.position_in_texels.floor().as_ivec2()));
                each_tap(map, &placed, &mut |texel, _| indices.extend(map.lookup.texel_index(texel)));
            }
            indices
        })
        .collect();
    ExactTexels::cast(map.job.scene, map.job.casters, &map.lookup, indices)
}

fn replay_pixel(
    map: &PreparedMap<'_>,
    texels: &ExactTexels,
    stored: &[f64],
    answer: &Mask,
    pixel: u32,
) -> Option<(f64, [Step; STAGES.len()])> {
    let receiver = map.receiver(pixel)?;
    let answered = f64::from(answer.pixels.get(pixel as usize).copied().flatten()?.get());
    let segment = map.job.light.segment_from(receiver.point_in_world, map.scene_radius_m);
    let hits = blockers(map, &receiver, &segment);
    let exact = visibility(hits.is_empty());

    let coverage = coverage(map, &receiver, &hits);
    let placed = place(map, &receiver);
    let bias = Step { value: placed.map_or(1.0, |placed| biased(map, &receiver, &placed)), cause: Cause::PeterPanning };
    let sampled = |placed: &Placed, texel: IVec2| -> (f64, Option<ExactTexel>) {
        let found = map.lookup.texel_index(texel).and_then(|index| texels.rank(index)).map(|rank| texels.at(rank));
        (found.map_or(1.0, |found| visibility(map.lookup.is_lit(placed.reference, found.depth))), found)
    };
    let sampling = placed.map_or(Step { value: 1.0, cause: Cause::ClippingFrustum }, |placed| {
        let texel = placed.position_in_texels.floor().as_ivec2();
        let (value, found) = sampled(&placed, texel);
        let is_dark = value < 1.0;
        let own = found.filter(|_| is_dark).and_then(|found| self_shadowing(map, &receiver, &placed, texel, found));
        Step { value, cause: own.unwrap_or_else(|| aliasing_cause(map.footprint(pixel).as_ref())) }
    });
    let filter = placed.map_or(Step { value: 1.0, cause: Cause::FilterWidth }, |placed| {
        let (mut value, mut self_shadow, mut other) = (0.0, 0.0, 0.0);
        let mut self_cause = Cause::Acne;
        each_tap(map, &placed, &mut |texel, weight| {
            let (lit, found) = sampled(&placed, texel);
            value += weight * lit;
            match found.filter(|_| lit == 0.0).and_then(|found| self_shadowing(map, &receiver, &placed, texel, found)) {
                Some(cause) => {
                    self_shadow += weight;
                    self_cause = cause;
                }
                None => other += weight * (lit - sampling.value).abs(),
            }
        });
        // The step belongs to the receiver's own surface where that is most of what moved the value.
        let is_self = self_shadow > other && value < sampling.value;
        Step { value, cause: if is_self { self_cause } else { Cause::FilterWidth } }
    });
    let stored_texels = placed.map_or(1.0, |placed| {
        let mut value = 0.0;
        each_tap(map, &placed, &mut |texel, weight| {
            let depth = map.lookup.texel_index(texel).and_then(|index| texels.rank(index)).map(|rank| stored[rank]);
            value += weight * depth.map_or(1.0, |depth| visibility(map.lookup.is_lit(placed.reference, depth)));
        });
        value
    });
    let precision = |value: f64| Step { value, cause: Cause::Precision };
    Some((exact, [coverage, bias, sampling, filter, precision(stored_texels), precision(answered)]))
}

/// What blocks a segment from a receiver, by the truth's definition: neither the receiver's triangle nor what continues
/// it in its plane.
fn blockers(map: &PreparedMap<'_>, receiver: &Receiver, segment: &Segment) -> Vec<Hit> {
    let casters = map.job.casters;
    let mut hits = Vec::new();
    casters.all_hits(segment, Some(receiver.triangle), &mut hits);
    hits.retain(|hit| !casters.continues(receiver.triangle, hit.triangle));
    hits
}

fn visibility(is_lit: bool) -> f64 {
    if is_lit { 1.0 } else { 0.0 }
}

/// What the light's frustum can see: a receiver outside is lit, a blocker before the near plane is not there.
fn coverage(map: &PreparedMap<'_>, receiver: &Receiver, hits: &[Hit]) -> Step {
    let cause_of = |outside: Outside| match outside {
        Outside::Frustum => Cause::ClippingFrustum,
        Outside::Near => Cause::ClippingNear,
        Outside::Far => Cause::ClippingFar,
    };
    if let Err(outside) = map.lookup.project(receiver.point_in_world) {
        return Step { value: 1.0, cause: cause_of(outside) };
    }
    let segment = map.job.light.segment_from(receiver.point_in_world, map.scene_radius_m);
    let blocked = hits.iter().any(|hit| map.lookup.project(segment.from.lerp(segment.to, hit.t)).is_ok());
    Step { value: visibility(!blocked), cause: Cause::ClippingNear }
}

/// The exact ray with the bias: blockers that the comparison cannot tell from the receiver are not there.
fn biased(map: &PreparedMap<'_>, receiver: &Receiver, placed: &Placed) -> f64 {
    let segment = map.job.light.segment_from(placed.point_in_world, map.scene_radius_m);
    let hits = blockers(map, receiver, &segment);
    let blocks = |hit: &Hit| {
        let Ok((_, depth, _)) = map.lookup.project(segment.from.lerp(segment.to, hit.t)) else { return false };
        let stored = depth + map.lookup.hardware_bias(map.job.scene.triangle_in_world(hit.triangle));
        !map.lookup.is_lit(placed.reference, stored)
    };
    visibility(!hits.iter().any(blocks))
}

/// `acne` or `curvature` where a texel holds the receiver's own surface, by whether the bias that the receiver's slope
/// needs would clear it; `None` where it holds another surface or nothing.
fn self_shadowing(
    map: &PreparedMap<'_>,
    receiver: &Receiver,
    placed: &Placed,
    texel: IVec2,
    found: ExactTexel,
) -> Option<Cause> {
    let triangle = found.triangle?;
    if !is_own_surface(map, receiver, placed, texel, triangle) {
        return None;
    }
    if map.job.casters.same_surface(triangle, receiver.triangle) {
        return Some(Cause::Acne);
    }
    let kernel = map.settings.filter.bias_kernel(map.settings.kernel);
    let sufficient =
        map.lookup.sufficient_bias(placed.point_in_world, receiver.normal_in_world, (placed.q, placed.depth), kernel);
    let reference = placed.depth - map.lookup.frustum.depth_sign() * sufficient;
    // In place of the bias there is, not on top of it.
    let unbiased = found.depth - map.lookup.hardware_bias(map.job.scene.triangle_in_world(triangle));
    Some(if map.lookup.is_lit(reference, unbiased) { Cause::Acne } else { Cause::Curvature })
}

/// Where one pixel's lookup went, for people.
pub(super) fn lookup_facts(map: &PreparedMap<'_>, pixel: u32) -> Result<Vec<(String, String)>, TechniqueError> {
    let Some(receiver) = map.receiver(pixel) else { return Ok(Vec::new()) };
    let fact = |label: &str, value: String| (label.to_owned(), value);
    let placed = match place(map, &receiver) {
        Err(outside) => return Ok(vec![fact("place in the map", format!("outside ({outside:?}): lit"))]),
        Ok(placed) => placed,
    };
    let texels = texels_read(map, &[pixel]);
    let stored = map.passes.gather(map.job.gpu, &texels.indices)?;
    let mut facts = vec![
        fact(
            "position in the map",
            format!("({:.4}, {:.4}) texels", placed.position_in_texels.x, placed.position_in_texels.y),
        ),
        fact("depth, reference", format!("{:.9}, {:.9}", placed.depth, placed.reference)),
    ];
    facts.extend(map.bias_at(&receiver, &placed).facts());
    /// More taps than this are not listed one by one.
    const LISTED_TAPS: usize = 25;
    let width = map.lookup.frustum.texels.x;
    for (index, depth) in texels.indices.iter().zip(&stored).take(LISTED_TAPS) {
        let exact = texels.rank(*index).map(|rank| texels.at(rank));
        let holds = exact.and_then(|texel| texel.triangle).map_or_else(
            || "nothing".to_owned(),
            |triangle| format!("triangle {triangle} of {}", map.job.scene.mesh_of(triangle).name),
        );
        let lit = if map.lookup.is_lit(placed.reference, *depth) { "lit" } else { "shadow" };
        facts.push(fact(
            &format!("texel ({}, {})", index % width, index / width),
            format!("stores {depth:.9} → {lit}; the exact map holds {holds}"),
        ));
    }
    if stored.len() > LISTED_TAPS {
        facts.push(fact("further texels", format!("{}", stored.len() - LISTED_TAPS)));
    }
    Ok(facts)
}
