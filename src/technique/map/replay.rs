//! A map replayed in f64, one approximation at a time: exact → coverage → pancaking → bias → chords → sampling → filter →
//! stored texels → the GPU's answer. Bias stands before sampling: after it, each biased pixel would book a large acne and a
//! large peter-panning that cancel. Pancaking is there only where corners of casters are moved to the near plane, chords
//! only where casters are drawn in straight pieces in place of arcs.

use super::bias::Clearance;
use super::exact_texels::{ExactTexel, cast, drawn_in_pieces, held};
use super::lookup::{Lookup, Outside, Placed, Tap};
use super::means::Means;
use super::own_surface::is_own_surface;
use super::prepared::PreparedMap;
use super::reading::{Depths, Looked, Reading, place};
use crate::cast::Hit;
use crate::cause::{Cause, Replay, Stage};
use crate::mask::Mask;
use crate::receiver::Receiver;
use crate::technique::footprint::aliasing_cause;
use crate::technique::{Prepared, TechniqueError};
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// Up to here a filtered answer counts as shadow.
const HALF_LIT: f64 = 0.5;

/// A stage's value and the cause that owns its change, for one pixel.
#[derive(Debug, Clone, Copy)]
struct Step {
    value: f64,
    cause: Cause,
}

/// The stages of one view, up to its stored texels.
type Chain = [Step; STAGES.len() - 1];

/// Something between a receiver and the light.
#[derive(Debug, Clone, Copy)]
struct Blocker {
    triangle: u32,
    point_in_world: DVec3,
}

/// Stage names in order.
const STAGES: [&str; 9] =
    ["coverage", PANCAKING, "bias", CHORDS, "sampling", "filter", MOMENTS, "stored texels", "gpu"];
/// The stage of maps that move corners of casters to the near plane.
const PANCAKING: &str = "pancaking";
/// The stage of maps that are drawn in pieces.
const CHORDS: &str = "chords";
/// The stage of filters that average moments.
const MOMENTS: &str = "moments";

pub(super) fn replay(map: &PreparedMap<'_>, answer: &Mask, pixels: &[u32]) -> Result<Replay, TechniqueError> {
    let replayer = Replayer::new(map, pixels)?;
    let replayed: Vec<(f64, [Step; STAGES.len()])> =
        pixels.par_iter().filter_map(|pixel| replayer.replay(answer, *pixel)).collect();
    let stage = |(index, name): (usize, &'static str)| Stage {
        name,
        values: replayed.iter().map(|(_, steps)| steps[index].value).collect(),
        causes: replayed.iter().map(|(_, steps)| steps[index].cause).collect(),
    };
    let in_pieces = map.lookup.views.iter().any(|view| view.drawn.is_some());
    let is_there = |(_, name): &(usize, &str)| match *name {
        PANCAKING => map.lookup.moves_corners(),
        CHORDS => in_pieces,
        MOMENTS => replayer.means.is_some(),
        _ => true,
    };
    Ok(Replay {
        pixels: pixels.to_vec(),
        exact: replayed.iter().map(|(exact, _)| *exact).collect(),
        stages: STAGES.into_iter().enumerate().filter(is_there).map(stage).collect(),
    })
}

/// What replays of some pixels share.
pub(super) struct Replayer<'r> {
    map: &'r PreparedMap<'r>,
    /// The lookup without any bias: what the bias is to blame for, it gets right.
    unbiased: Lookup,
    pub(super) reading: Reading<'r>,
    means: Option<Means<'r>>,
}

impl<'r> Replayer<'r> {
    pub(super) fn new(map: &'r PreparedMap<'_>, pixels: &[u32]) -> Result<Self, TechniqueError> {
        let unbiased = map.lookup.without_bias();
        let reading = Reading::new(map, &unbiased, pixels)?;
        Ok(Self { map, unbiased, reading, means: Means::read(map, pixels)? })
    }

    /// The exact answer at a pixel and what each stage makes of it.
    fn replay(&self, answer: &Mask, pixel: u32) -> Option<(f64, [Step; STAGES.len()])> {
        let receiver = self.map.receiver(pixel)?;
        let answered = f64::from(answer.pixels.get(pixel as usize).copied().flatten()?.get());
        let hits = self.blockers(&receiver, receiver.point_in_world);
        let exact = visibility(hits.is_empty());
        let shares = self.map.lookup.select(receiver.point_in_world);
        let in_views: Vec<(f64, Chain)> =
            shares.iter().map(|(view, weight)| (weight, self.chain(pixel, &receiver, &hits, view))).collect();
        let gpu = Step { value: answered, cause: Cause::Precision };
        let chain = blended(exact, &in_views);
        Some((exact, std::array::from_fn(|stage| chain.get(stage).copied().unwrap_or(gpu))))
    }

    /// What each stage before the GPU's makes of a receiver in one view.
    fn chain(&self, pixel: u32, receiver: &Receiver, hits: &[Blocker], view: usize) -> Chain {
        let placed = place(&self.map.lookup, view, receiver);
        if let Err(outside) = self.map.lookup.project_in(view, receiver.point_in_world) {
            let stretched = placed.map(|placed| self.looked(pixel, receiver, placed));
            return self.beyond_the_border(outside, stretched);
        }
        let coverage = self.coverage(view, hits);
        let pancaking = Step { value: self.by_pancakes(receiver, view, hits), cause: Cause::ClippingNear };
        let Some(placed) = placed else {
            // Moved out along its normal.
            let border = Step { value: self.map.lookup.border_visibility(), cause: Cause::ClippingFrustum };
            let stored = Step { cause: Cause::Precision, ..border };
            return [coverage, pancaking, border, border, border, border, border, stored];
        };
        let biased = self.biased(receiver, &placed);
        // Only a blocker that the bias took away asks for the reason.
        let is_lost = biased > pancaking.value;
        let cause = if is_lost { self.cause_of_loss(pixel, receiver, view) } else { Cause::PeterPanning };
        let chords = Step { value: self.by_chords(&placed).unwrap_or(biased), cause: Cause::TechniqueModel };
        let looked = self.looked(pixel, receiver, placed);
        let sampling = self.sampling(&looked);
        let filter = self.filter(&looked, sampling.value);
        let moments = self.moments(&looked, filter);
        let stored_texels = Step { value: self.by_stored_texels(&looked), cause: Cause::Precision };
        [coverage, pancaking, Step { value: biased, cause }, chords, sampling, filter, moments, stored_texels]
    }

    fn looked(&self, pixel: u32, receiver: &Receiver, placed: Placed) -> Looked<'_> {
        Looked { lookup: &self.map.lookup, pixel, receiver: *receiver, placed }
    }

    /// Outside the view all of the error is the border's: it answers by itself, or its texels stretch outwards.
    fn beyond_the_border(&self, outside: Outside, stretched: Option<Looked<'_>>) -> Chain {
        let cause = match outside {
            Outside::Near => Cause::ClippingNear,
            Outside::Far => Cause::ClippingFar,
            Outside::Frustum => Cause::ClippingFrustum,
        };
        let border = self.map.lookup.border_visibility();
        let exact = stretched.map_or(border, |looked| self.moments(&looked, self.filter(&looked, border)).value);
        let stored = stretched.map_or(border, |looked| self.by_stored_texels(&looked));
        let clipped = Step { value: exact, cause };
        let stored = Step { value: stored, cause: Cause::Precision };
        [clipped, clipped, clipped, clipped, clipped, clipped, clipped, stored]
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

    /// What the view can see: a blocker before the near plane, or of a side that is not drawn, is not there.
    fn coverage(&self, view: usize, hits: &[Blocker]) -> Step {
        let lookup = &self.map.lookup;
        let draws_side = |hit: &Blocker| lookup.draws_side(self.map.job.scene, hit.triangle);
        let is_drawn = |hit: &Blocker| lookup.drawn_depth(view, hit.point_in_world).is_some();
        let is_blocked = hits.iter().any(|hit| is_drawn(hit) && draws_side(hit));
        let by_sides = !is_blocked && hits.iter().any(is_drawn);
        let cause = if by_sides { Cause::TechniqueModel } else { Cause::ClippingNear };
        Step { value: visibility(!is_blocked), cause }
    }

    /// The same where triangles are bent by moving corners to the near plane: a blocker that this moves behind the
    /// receiver, or beyond the far plane, is not there.
    fn by_pancakes(&self, receiver: &Receiver, view: usize, hits: &[Blocker]) -> f64 {
        let (lookup, scene) = (&self.map.lookup, self.map.job.scene);
        let own_depth = lookup.views[view].project(receiver.point_in_world).depth;
        let blocks = |hit: &Blocker| {
            let corners = scene.triangle_in_world(hit.triangle);
            lookup.drawn_depth(view, hit.point_in_world)?;
            let depth = lookup.rasterised_depth(view, corners, hit.point_in_world)?;
            let is_before = lookup.pancaked(view, corners).is_none() || !lookup.is_lit(view, own_depth, depth);
            (is_before && lookup.draws_side(scene, hit.triangle)).then_some(())
        };
        visibility(!hits.iter().any(|hit| blocks(hit).is_some()))
    }

    /// The exact ray with the bias: blockers that the comparison cannot tell from the receiver are not there.
    fn biased(&self, receiver: &Receiver, placed: &Placed) -> f64 {
        let lookup = &self.map.lookup;
        let scene = self.map.job.scene;
        if lookup.bias.clearance == Clearance::Midpoint {
            let surfaces = cast(scene, self.map.job.casters, lookup, placed.view, placed.position_in_texels);
            let stored = held(lookup, placed.view, &surfaces).depth;
            return visibility(lookup.is_lit(placed.view, placed.reference, stored));
        }
        let blocks = |hit: &Blocker| {
            let corners = scene.triangle_in_world(hit.triangle);
            let drawn = lookup.rasterised_depth(placed.view, corners, hit.point_in_world);
            drawn.filter(|_| lookup.draws_side(scene, hit.triangle)).is_some_and(|depth| {
                let by_rasteriser = lookup.hardware_bias(placed.view, corners, hit.point_in_world);
                !lookup.is_lit(placed.view, placed.reference, (depth + by_rasteriser).clamp(0.0, 1.0))
            })
        };
        visibility(!self.blockers(receiver, placed.point_in_world).iter().any(blocks))
    }

    /// What the pieces that are drawn in place of the casters answer, exactly where the receiver is; `None` where the
    /// casters themselves are drawn.
    fn by_chords(&self, placed: &Placed) -> Option<f64> {
        let lookup = &self.map.lookup;
        let surfaces = drawn_in_pieces(lookup, placed.view, placed.position_in_texels)?;
        let stored = held(lookup, placed.view, &surfaces).depth;
        Some(visibility(lookup.is_lit(placed.view, placed.reference, stored)))
    }

    /// Why the blocker is lost that the bias reaches over: the bias, if the map would show it without any; if not, the
    /// texels, which are too coarse for it either way.
    fn cause_of_loss(&self, pixel: u32, receiver: &Receiver, view: usize) -> Cause {
        let Some(placed) = place(&self.unbiased, view, receiver) else { return Cause::PeterPanning };
        let looked = Looked { lookup: &self.unbiased, ..self.looked(pixel, receiver, placed) };
        let value =
            self.reading.mean(Depths::Unbiased, &looked, &mut |tap, _| self.answer(Depths::Unbiased, &looked, tap));
        if value <= HALF_LIT { Cause::PeterPanning } else { aliasing_cause(self.map.footprint(pixel).as_ref()) }
    }

    /// The answer of the receiver's own texel with exact depth.
    fn sampling(&self, looked: &Looked<'_>) -> Step {
        let own_texel = looked.tap(self.reading.own_texel(&looked.placed));
        let (value, own) = self.compare(looked, own_texel.as_ref());
        Step { value, cause: own.unwrap_or_else(|| aliasing_cause(self.map.footprint(looked.pixel).as_ref())) }
    }

    /// The filter's answer with exact depths. It belongs to the receiver's own surface where that is most of what moved
    /// the value.
    fn filter(&self, looked: &Looked<'_>, sampled: f64) -> Step {
        let (mut self_shadow, mut other) = (0.0, 0.0);
        let mut self_cause = Cause::Acne;
        let value = self.reading.mean(Depths::Exact, looked, &mut |tap, weight| {
            let (lit, own) = self.compare(looked, tap.as_ref());
            match own {
                Some(cause) => {
                    self_shadow += weight;
                    self_cause = cause;
                }
                None => other += weight * (lit - sampled).abs(),
            }
            lit
        });
        let is_self = self_shadow > other && value < sampled;
        Step { value, cause: if is_self { self_cause } else { Cause::FilterWidth } }
    }

    /// What the exact moments of the same kernel allow: more light than there is bleeds in, less is the model's doing.
    fn moments(&self, looked: &Looked<'_>, filter: Step) -> Step {
        let Some(means) = &self.means else { return filter };
        let value = means.exact_visibility(&self.reading, looked);
        let cause = if value > filter.value { Cause::LightBleeding } else { Cause::TechniqueModel };
        Step { value, cause }
    }

    /// The filter's answer with the depths, or the means of moments, that the GPU holds.
    fn by_stored_texels(&self, looked: &Looked<'_>) -> f64 {
        if let Some(means) = &self.means {
            return means.stored_visibility(looked);
        }
        self.reading.mean(Depths::Stored, looked, &mut |tap, _| self.answer(Depths::Stored, looked, tap))
    }

    /// What one texel answers.
    fn answer(&self, depths: Depths, looked: &Looked<'_>, tap: Option<Tap>) -> f64 {
        let lookup = looked.lookup;
        tap.and_then(|tap| Some((tap, self.reading.depth(depths, &tap)?)))
            .map_or(lookup.border_visibility(), |(tap, depth)| {
                visibility(lookup.is_lit(tap.placed.view, tap.placed.reference, depth))
            })
    }

    /// What one texel answers with exact depth; where that is dark and it holds the receiver's own surface, why.
    fn compare(&self, looked: &Looked<'_>, tap: Option<&Tap>) -> (f64, Option<Cause>) {
        let lookup = looked.lookup;
        match tap.and_then(|tap| Some((tap, self.reading.exact(tap)?))) {
            Some((tap, found)) if !lookup.is_lit(tap.placed.view, tap.placed.reference, found.depth) => {
                (0.0, self.self_shadowing(&looked.receiver, tap, found))
            }
            Some(_) => (1.0, None),
            None => (lookup.border_visibility(), None),
        }
    }

    /// `acne` or `curvature` where a texel holds the receiver's own surface, by whether the bias that the receiver's
    /// slope needs would clear it; `None` where it holds another surface or nothing.
    fn self_shadowing(&self, receiver: &Receiver, tap: &Tap, found: ExactTexel) -> Option<Cause> {
        let map = self.map;
        let triangle = found.triangle?;
        if !is_own_surface(map, receiver, tap, triangle) {
            return None;
        }
        if map.job.casters.same_surface(triangle, receiver.triangle) {
            return Some(Cause::Acne);
        }
        let placed = &tap.placed;
        let kernel = DVec2::splat(map.settings.filter.bias_kernel(&map.settings.kernel));
        // For the kernel or, across a seam, for as far as the texel is.
        let reach = (tap.texel.as_dvec2() + 0.5 - placed.position_in_texels).abs().max(kernel);
        let site = map.lookup.views[placed.view].site(placed.point_in_world);
        let sufficient = map.lookup.sufficient_bias(&site, receiver.normal_in_world, reach);
        // In place of the bias there is, not on top of it.
        let reference = placed.depth - site.view.depth_sign * sufficient;
        let is_cleared = map.lookup.is_lit(placed.view, reference, found.unbiased_depth);
        Some(if is_cleared { Cause::Acne } else { Cause::Curvature })
    }
}

/// The stages of one or two views together, by weight; a stage's cause is that of the view in which it moves the value
/// most.
fn blended(exact: f64, in_views: &[(f64, Chain)]) -> Chain {
    let mut before: Vec<f64> = vec![exact; in_views.len()];
    std::array::from_fn(|stage| {
        let (mut value, mut most, mut cause) = (0.0, -1.0, Cause::Precision);
        for ((weight, chain), before) in in_views.iter().zip(&mut before) {
            let step = chain[stage];
            value += weight * step.value;
            let moved = weight * (step.value - *before).abs();
            if moved > most {
                (most, cause) = (moved, step.cause);
            }
            *before = step.value;
        }
        Step { value, cause }
    })
}

fn visibility(is_lit: bool) -> f64 {
    if is_lit { 1.0 } else { 0.0 }
}
