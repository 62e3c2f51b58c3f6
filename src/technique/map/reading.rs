//! What the lookups of some pixels read, for their replay: the exact depth of every texel and the one that the GPU holds.

use super::exact_texels::{ExactTexel, ExactTexels};
use super::filter::{Asked, Blocker};
use super::lookup::{Lookup, Placed, Tap};
use super::outline::Points;
use super::prepared::PreparedMap;
use crate::receiver::Receiver;
use crate::technique::TechniqueError;
use glam::IVec2;
use rayon::prelude::*;

/// See the module.
pub(super) struct Reading<'r> {
    map: &'r PreparedMap<'r>,
    /// Every texel that these lookups read.
    texels: ExactTexels,
    /// What the GPU holds in them.
    stored: Vec<f64>,
    /// The silhouettes' points as they should be drawn over the GPU's depths.
    points: Option<Points>,
    /// What the GPU drew.
    stored_points: Option<Points>,
}

/// Which depths a lookup is replayed with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Depths {
    /// Those of an ideal rasteriser.
    Exact,
    /// The same without the rasteriser's bias.
    Unbiased,
    /// Those that the GPU holds.
    Stored,
}

/// A receiver in one view, about to be looked up.
#[derive(Debug, Clone, Copy)]
pub(super) struct Looked<'a> {
    pub(super) lookup: &'a Lookup,
    pub(super) pixel: u32,
    pub(super) receiver: Receiver,
    pub(super) placed: Placed,
}

impl Looked<'_> {
    /// What a texel of the receiver's view, or beyond its side, stands for; `None` outside the map.
    pub(super) fn tap(&self, texel: IVec2) -> Option<Tap> {
        self.lookup.tap(&self.placed, self.receiver.normal_in_world, texel)
    }

    /// The same where blockers are looked for: in the receiver's view, and beyond its side where views measure depth
    /// alike.
    fn searched(&self, texel: IVec2) -> Option<Tap> {
        let view = self.placed.view;
        let is_own = self.lookup.views[view].holds(texel);
        self.tap(texel).filter(|tap| is_own || (self.lookup.shares_depth() && tap.placed.view != view))
    }
}

impl<'r> Reading<'r> {
    /// Of the lookups of these pixels, with the bias and (`unbiased`) without.
    pub(super) fn new(map: &'r PreparedMap<'_>, unbiased: &Lookup, pixels: &[u32]) -> Result<Self, TechniqueError> {
        let points = match &map.silhouettes {
            Some(edges) => Some(Points::drawn(edges, &map.lookup.views[0], &map.all_depths()?)),
            None => None,
        };
        let stored_points = map.passes.points(map.job.gpu)?;
        let mut reading = Self { map, texels: ExactTexels::default(), stored: Vec::new(), points, stored_points };
        reading.read(unbiased, pixels)?;
        if map.settings.filter.reads_map() {
            // What the first texels hold decides which are read next.
            reading.read(unbiased, pixels)?;
        }
        Ok(reading)
    }

    /// Adds every texel that is read, as far as what is known leads.
    fn read(&mut self, unbiased: &Lookup, pixels: &[u32]) -> Result<(), TechniqueError> {
        let map = self.map;
        let indices = pixels.par_iter().flat_map_iter(|pixel| self.read_by(*pixel, unbiased)).collect();
        let known = std::mem::take(&mut self.texels);
        self.texels = known.and_cast(map.job.scene, map.job.casters, &map.lookup, indices);
        self.stored = map.passes.gather(map.job.gpu, &map.lookup, &self.texels.indices)?;
        Ok(())
    }

    fn read_by(&self, pixel: u32, unbiased: &Lookup) -> Vec<u32> {
        let mut indices = Vec::new();
        let Some(receiver) = self.map.receiver(pixel) else { return indices };
        let shares = self.map.lookup.select(receiver.point_in_world);
        for (view, lookup) in shares.iter().flat_map(|(view, _)| [(view, &self.map.lookup), (view, unbiased)]) {
            let Some(placed) = place(lookup, view, &receiver) else { continue };
            let looked = Looked { lookup, pixel, receiver, placed };
            let index = |tap: Tap| lookup.texel_index(tap.placed.view, tap.texel);
            indices.extend(looked.tap(self.own_texel(&placed)).and_then(index));
            for depths in [Depths::Exact, Depths::Unbiased, Depths::Stored] {
                let mut searched = Vec::new();
                let mut blocker = |texel: IVec2| {
                    searched.extend(looked.searched(texel).and_then(index));
                    self.blocker(depths, &looked, texel)
                };
                self.texels_of(depths, &looked, &mut blocker, &mut |texel, _| {
                    indices.extend(looked.tap(texel).and_then(index));
                });
                indices.append(&mut searched);
            }
        }
        indices
    }

    /// Calls `tap` with what each tap of a lookup reads (`None` outside the map) and its weight.
    pub(super) fn each_tap(&self, depths: Depths, looked: &Looked<'_>, tap: &mut dyn FnMut(Option<Tap>, f64)) {
        let mut blocker = |texel: IVec2| self.blocker(depths, looked, texel);
        self.texels_of(depths, looked, &mut blocker, &mut |texel, weight| tap(looked.tap(texel), weight));
    }

    /// The mean of what `answer` says about each tap of a lookup; lit without taps.
    pub(super) fn mean(
        &self,
        depths: Depths,
        looked: &Looked<'_>,
        answer: &mut dyn FnMut(Option<Tap>, f64) -> f64,
    ) -> f64 {
        let mut sum = None;
        self.each_tap(depths, looked, &mut |tap, weight| {
            *sum.get_or_insert(0.0) += weight * answer(tap, weight);
        });
        sum.unwrap_or(1.0)
    }

    /// The texels of a lookup and their weights: those of the filter or, with silhouettes, the one on the same side of
    /// the outline.
    fn texels_of(&self, depths: Depths, looked: &Looked<'_>, blocker: Blocker<'_>, tap: &mut dyn FnMut(IVec2, f64)) {
        let points = if depths == Depths::Stored { &self.stored_points } else { &self.points };
        let Some(points) = points else {
            let asked = Asked {
                kernel: &self.map.settings.kernel,
                numbers: &self.map.numbers,
                pixel: looked.pixel,
                view: &looked.lookup.views[looked.placed.view],
                placed: &looked.placed,
                light: looked.lookup.light(),
            };
            return self.map.settings.filter.taps_at(&asked, blocker, tap);
        };
        tap(points.texel(looked.placed.position_in_texels), 1.0);
    }

    /// The depth of a texel that is nearer to the light than the receiver.
    fn blocker(&self, depths: Depths, looked: &Looked<'_>, texel: IVec2) -> Option<f64> {
        let tap = looked.searched(texel)?;
        self.depth(depths, &tap).filter(|depth| !looked.lookup.is_lit(tap.placed.view, tap.placed.reference, *depth))
    }

    /// The texel that alone answers for a receiver.
    pub(super) fn own_texel(&self, placed: &Placed) -> IVec2 {
        self.points.as_ref().map_or_else(|| placed.own_texel(), |points| points.texel(placed.position_in_texels))
    }

    /// What a texel that a lookup reads holds.
    pub(super) fn depth(&self, depths: Depths, tap: &Tap) -> Option<f64> {
        match depths {
            Depths::Exact => self.exact(tap).map(|texel| texel.depth),
            Depths::Unbiased => self.exact(tap).map(|texel| texel.unbiased_depth),
            Depths::Stored => self.rank(tap).map(|rank| self.stored[rank]),
        }
    }

    /// What an ideal map holds there.
    pub(super) fn exact(&self, tap: &Tap) -> Option<ExactTexel> {
        self.rank(tap).map(|rank| self.texels.at(rank))
    }

    fn rank(&self, tap: &Tap) -> Option<usize> {
        self.map.lookup.texel_index(tap.placed.view, tap.texel).and_then(|index| self.texels.rank(index))
    }
}

/// A receiver in a view; `None` outside it.
pub(super) fn place(lookup: &Lookup, view: usize, receiver: &Receiver) -> Option<Placed> {
    lookup.place(view, receiver.point_in_world, receiver.normal_in_world).ok()
}
