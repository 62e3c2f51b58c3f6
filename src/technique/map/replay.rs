//! A map replayed in f64, one approximation at a time: exact → coverage → bias → sampling → filter → stored texels →
//! the GPU's answer. Bias stands before sampling: after it, each biased pixel would book a large acne and a large
//! peter-panning that cancel.

use super::exact_texels::{ExactTexel, ExactTexels};
use super::lookup::{Lookup, Outside, Placed};
use super::own_surface::is_own_surface;
use super::prepared::PreparedMap;
use crate::cast::Hit;
use crate::cause::{Cause, Replay, Stage};
use crate::mask::Mask;
use crate::receiver::Receiver;
use crate::technique::footprint::aliasing_cause;
use crate::technique::{Prepared, TechniqueError};
use glam::{DVec3, IVec2};
use rayon::prelude::*;

/// Up to here a filtered answer counts as shadow.
const HALF_LIT: f64 = 0.5;

/// A stage's value and the cause that owns its change, for one pixel.
#[derive(Debug, Clone, Copy)]
struct Step {
    value: f64,
    cause: Cause,
}

impl Step {
    /// Outside the map everything is lit, and `coverage` has said why.
    const OUTSIDE: Self = Self { value: 1.0, cause: Cause::ClippingFrustum };
}

/// Something between a receiver and the light.
#[derive(Debug, Clone, Copy)]
struct Blocker {
    triangle: u32,
    point_in_world: DVec3,
}

/// Stage names in order.
const STAGES: [&str; 6] = ["coverage", "bias", "sampling", "filter", "stored texels", "gpu"];

pub(super) fn replay(map: &PreparedMap<'_>, answer: &Mask, pixels: &[u32]) -> Result<Replay, TechniqueError> {
    let replayer = Replayer::new(map, pixels)?;
    let replayed: Vec<(f64, [Step; STAGES.len()])> =
        pixels.par_iter().filter_map(|pixel| replayer.replay(answer, *pixel)).collect();
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

/// What replays of some pixels share.
pub(super) struct Replayer<'r> {
    map: &'r PreparedMap<'r>,
    /// The lookup without any bias: what the bias is to blame for, it gets right.
    unbiased: Lookup,
    /// Every texel that these pixels' lookups read.
    texels: ExactTexels,
    /// What the GPU holds in them.
    stored: Vec<f64>,
}

impl<'r> Replayer<'r> {
    pub(super) fn new(map: &'r PreparedMap<'_>, pixels: &[u32]) -> Result<Self, TechniqueError> {
        let unbiased = map.lookup.without_bias();
        let texels_of = |pixel: &u32| {
            let receiver = map.receiver(*pixel);
            let mut indices = Vec::new();
            for placed in [&map.lookup, &unbiased].into_iter().filter_map(|lookup| place(lookup, &receiver?).ok()) {
                indices.extend(map.lookup.texel_index(placed.own_texel()));
                each_tap(map, &placed, &mut |texel, _| indices.extend(map.lookup.texel_index(texel)));
            }
            indices
        };
        let indices = pixels.par_iter().flat_map_iter(texels_of).collect();
        let texels = ExactTexels::cast(map.job.scene, map.job.casters, &map.lookup, indices);
        let stored = map.passes.gather(map.job.gpu, &texels.indices)?;
        Ok(Self { map, unbiased, texels, stored })
    }

    /// The exact answer at a pixel and what each stage makes of it.
    fn replay(&self, answer: &Mask, pixel: u32) -> Option<(f64, [Step; STAGES.len()])> {
        let receiver = self.map.receiver(pixel)?;
        let answered = f64::from(answer.pixels.get(pixel as usize).copied().flatten()?.get());
        let hits = self.blockers(&receiver, receiver.point_in_world);
        let exact = visibility(hits.is_empty());
        let coverage = self.coverage(&receiver, &hits);
        let placed = place(&self.map.lookup, &receiver).ok();
        let [bias, sampling, filter] = placed.map_or([Step::OUTSIDE; 3], |placed| {
            let biased = self.biased(&receiver, &placed);
            // Only a blocker that the bias took away asks for the reason.
            let is_lost = biased > coverage.value;
            let cause = if is_lost { self.cause_of_loss(pixel, &receiver) } else { Cause::PeterPanning };
            let sampling = self.sampling(pixel, &receiver, &placed);
            [Step { value: biased, cause }, sampling, self.filter(&receiver, &placed, sampling.value)]
        });
        let precision = |value: f64| Step { value, cause: Cause::Precision };
        let stored_texels = precision(placed.map_or(1.0, |placed| self.by_stored_texels(&placed)));
        Some((exact, [coverage, bias, sampling, filter, stored_texels, precision(answered)]))
    }

    /// What blocks the way from a receiver's point to the light, by the truth's definition: neither the receiver's
    /// triangle nor what continues it in its plane.
    fn blockers(&self, receiver: &Receiver, from: DVec3) -> Vec<Blocker> {
        let casters = self.map.job.casters;
        let segment = self.map.job.light.segment_from(from, self.map.scene_radius_m);
        let mut hits = Vec::new();
        casters.all_hits(&segment, Some(receiver.triangle), &mut hits);
        hits.retain(|hit| !casters.continues(receiver.triangle, hit.triangle));
        let blocker =
            |hit: &Hit| Blocker { triangle: hit.triangle, point_in_world: segment.from.lerp(segment.to, hit.t) };
        hits.iter().map(blocker).collect()
    }

    /// What the light's frustum can see: a receiver outside is lit, a blocker before the near plane is not there.
    fn coverage(&self, receiver: &Receiver, hits: &[Blocker]) -> Step {
        match self.map.lookup.project(receiver.point_in_world) {
            Err(Outside::Frustum) => Step { value: 1.0, cause: Cause::ClippingFrustum },
            Err(Outside::Near) => Step { value: 1.0, cause: Cause::ClippingNear },
            Err(Outside::Far) => Step { value: 1.0, cause: Cause::ClippingFar },
            Ok(_) => {
                let is_seen = |hit: &Blocker| self.map.lookup.project(hit.point_in_world).is_ok();
                Step { value: visibility(!hits.iter().any(is_seen)), cause: Cause::ClippingNear }
            }
        }
    }

    /// The exact ray with the bias: blockers that the comparison cannot tell from the receiver are not there.
    fn biased(&self, receiver: &Receiver, placed: &Placed) -> f64 {
        let lookup = &self.map.lookup;
        let blocks = |hit: &Blocker| {
            lookup.project(hit.point_in_world).is_ok_and(|(_, depth, _)| {
                let by_rasteriser = lookup.hardware_bias(self.map.job.scene.triangle_in_world(hit.triangle));
                !lookup.is_lit(placed.reference, depth + by_rasteriser)
            })
        };
        visibility(!self.blockers(receiver, placed.point_in_world).iter().any(blocks))
    }

    /// Why the blocker is lost that the bias reaches over: the bias, if the map would show it without any; if not, the
    /// texels, which are too coarse for it either way.
    fn cause_of_loss(&self, pixel: u32, receiver: &Receiver) -> Cause {
        let Ok(placed) = place(&self.unbiased, receiver) else { return Cause::PeterPanning };
        let mut value = 0.0;
        each_tap(self.map, &placed, &mut |texel, weight| {
            let is_lit = |found: ExactTexel| self.unbiased.is_lit(placed.reference, found.unbiased_depth);
            value += weight * visibility(self.exact(texel).is_none_or(is_lit));
        });
        if value <= HALF_LIT { Cause::PeterPanning } else { aliasing_cause(self.map.footprint(pixel).as_ref()) }
    }

    /// The answer of the receiver's own texel with exact depth.
    fn sampling(&self, pixel: u32, receiver: &Receiver, placed: &Placed) -> Step {
        let (value, own) = self.compare(receiver, placed, placed.own_texel());
        Step { value, cause: own.unwrap_or_else(|| aliasing_cause(self.map.footprint(pixel).as_ref())) }
    }

    /// The filter's answer with exact depths. It belongs to the receiver's own surface where that is most of what moved
    /// the value.
    fn filter(&self, receiver: &Receiver, placed: &Placed, sampled: f64) -> Step {
        let (mut value, mut self_shadow, mut other) = (0.0, 0.0, 0.0);
        let mut self_cause = Cause::Acne;
        each_tap(self.map, placed, &mut |texel, weight| {
            let (lit, own) = self.compare(receiver, placed, texel);
            value += weight * lit;
            match own {
                Some(cause) => {
                    self_shadow += weight;
                    self_cause = cause;
                }
                None => other += weight * (lit - sampled).abs(),
            }
        });
        let is_self = self_shadow > other && value < sampled;
        Step { value, cause: if is_self { self_cause } else { Cause::FilterWidth } }
    }

    /// The filter's answer with the depths that the GPU holds.
    fn by_stored_texels(&self, placed: &Placed) -> f64 {
        let lookup = &self.map.lookup;
        let mut value = 0.0;
        each_tap(self.map, placed, &mut |texel, weight| {
            let is_lit = self.stored(texel).is_none_or(|depth| lookup.is_lit(placed.reference, depth));
            value += weight * visibility(is_lit);
        });
        value
    }

    /// What one texel answers with exact depth; where that is dark and it holds the receiver's own surface, why.
    fn compare(&self, receiver: &Receiver, placed: &Placed, texel: IVec2) -> (f64, Option<Cause>) {
        match self.exact(texel) {
            Some(found) if !self.map.lookup.is_lit(placed.reference, found.depth) => {
                (0.0, self.self_shadowing(receiver, placed, texel, found))
            }
            _ => (1.0, None),
        }
    }

    /// `acne` or `curvature` where a texel holds the receiver's own surface, by whether the bias that the receiver's
    /// slope needs would clear it; `None` where it holds another surface or nothing.
    fn self_shadowing(&self, receiver: &Receiver, placed: &Placed, texel: IVec2, found: ExactTexel) -> Option<Cause> {
        let map = self.map;
        let triangle = found.triangle?;
        if !is_own_surface(map, receiver, placed, texel, triangle) {
            return None;
        }
        if map.job.casters.same_surface(triangle, receiver.triangle) {
            return Some(Cause::Acne);
        }
        let kernel = map.settings.filter.bias_kernel(map.settings.kernel);
        let at = (placed.q, placed.depth);
        let sufficient = map.lookup.sufficient_bias(placed.point_in_world, receiver.normal_in_world, at, kernel);
        // In place of the bias there is, not on top of it.
        let reference = placed.depth - map.lookup.frustum.depth_sign() * sufficient;
        let is_cleared = map.lookup.is_lit(reference, found.unbiased_depth);
        Some(if is_cleared { Cause::Acne } else { Cause::Curvature })
    }

    fn rank(&self, texel: IVec2) -> Option<usize> {
        self.map.lookup.texel_index(texel).and_then(|index| self.texels.rank(index))
    }

    /// What an ideal map holds in a texel that a lookup reads; `None` outside the map.
    pub(super) fn exact(&self, texel: IVec2) -> Option<ExactTexel> {
        self.rank(texel).map(|rank| self.texels.at(rank))
    }

    /// What the GPU's map holds there.
    pub(super) fn stored(&self, texel: IVec2) -> Option<f64> {
        self.rank(texel).map(|rank| self.stored[rank])
    }
}

pub(super) fn place(lookup: &Lookup, receiver: &Receiver) -> Result<Placed, Outside> {
    lookup.place(receiver.point_in_world, receiver.normal_in_world)
}

pub(super) fn each_tap(map: &PreparedMap<'_>, placed: &Placed, tap: &mut dyn FnMut(IVec2, f64)) {
    map.settings.filter.taps(map.settings.kernel, placed.position_in_texels, tap);
}

fn visibility(is_lit: bool) -> f64 {
    if is_lit { 1.0 } else { 0.0 }
}
