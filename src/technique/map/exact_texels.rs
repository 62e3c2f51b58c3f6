//! What an ideal rasteriser would store: the exact depth along the ray through each texel's centre, cast in f64.

use super::bias::Clearance;
use super::lookup::Lookup;
use super::projection::View;
use crate::cast::Casters;
use crate::scene::Scene;
use glam::DVec2;
use rayon::prelude::*;

/// One texel of the ideal map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::technique) struct ExactTexel {
    /// Depth with the rasteriser's bias, or halfway to the next surface behind; the cleared value where nothing casts.
    pub(in crate::technique) depth: f64,
    /// What the depth would be without any bias.
    pub(in crate::technique) unbiased_depth: f64,
    /// The triangle it came from.
    pub(in crate::technique) triangle: Option<u32>,
}

/// The texels that some lookups read, sorted by index.
#[derive(Debug)]
pub(in crate::technique) struct ExactTexels {
    pub(in crate::technique) indices: Vec<u32>,
    texels: Vec<ExactTexel>,
}

impl ExactTexels {
    /// Casts through the centres of the texels with these indices (layer by layer, row by row; any order, repeats allowed).
    pub(in crate::technique) fn cast(scene: &Scene, casters: &Casters, lookup: &Lookup, mut indices: Vec<u32>) -> Self {
        indices.par_sort_unstable();
        indices.dedup();
        let texels = indices.par_iter().map(|index| exact_texel(scene, casters, lookup, *index)).collect();
        Self { indices, texels }
    }

    /// Position of a texel in `indices`; only for texels that were asked for.
    pub(in crate::technique) fn rank(&self, index: u32) -> Option<usize> {
        self.indices.binary_search(&index).ok()
    }

    /// The texel at a rank.
    pub(in crate::technique) fn at(&self, rank: usize) -> ExactTexel {
        self.texels[rank]
    }
}

fn exact_texel(scene: &Scene, casters: &Casters, lookup: &Lookup, index: u32) -> ExactTexel {
    let (view, texel) = lookup.texel_of(index);
    exact_at(scene, casters, lookup, view, texel.as_dvec2() + 0.5)
}

/// What a texel would hold whose centre is anywhere in a view.
pub(super) fn exact_at(
    scene: &Scene,
    casters: &Casters,
    lookup: &Lookup,
    view: usize,
    position_in_texels: DVec2,
) -> ExactTexel {
    let cleared = lookup.views[view].cleared();
    let mut texel_holds = ExactTexel { depth: cleared, unbiased_depth: cleared, triangle: None };
    let Some(ray) = lookup.ray_through(view, position_in_texels, &casters.bounds()) else { return texel_holds };
    let mut hits = Vec::new();
    casters.all_hits(&ray, None, &mut hits);
    let is_nearer = |a: f64, b: f64| lookup.views[view].is_nearer(a, b);
    let mut depths = Vec::new();
    for hit in hits.iter().filter(|hit| lookup.draws_side(scene, hit.triangle)) {
        let Some(drawn) = lookup.drawn_depth(view, ray.from.lerp(ray.to, hit.t)) else { continue };
        let unbiased_depth = drawn.clamp(0.0, 1.0);
        let bias = lookup.hardware_bias(view, scene.triangle_in_world(hit.triangle));
        let depth = (drawn + bias).clamp(0.0, 1.0);
        if texel_holds.triangle.is_none() || is_nearer(depth, texel_holds.depth) {
            texel_holds = ExactTexel { depth, triangle: Some(hit.triangle), ..texel_holds };
        }
        if is_nearer(unbiased_depth, texel_holds.unbiased_depth) {
            texel_holds.unbiased_depth = unbiased_depth;
        }
        depths.push(depth);
    }
    if lookup.bias.clearance == Clearance::Midpoint {
        texel_holds.depth = midpoint(&lookup.views[view], texel_holds.depth, &depths);
    }
    texel_holds
}

/// The middle between the nearest of some depths and the nearest one behind it, or nothing where there is none.
fn midpoint(view: &View, nearest: f64, depths: &[f64]) -> f64 {
    let is_behind = |depth: &&f64| view.depth_sign * (**depth - nearest) > SAME_LAYER * nearest.abs();
    let behind = depths.iter().filter(is_behind);
    let second = behind.copied().reduce(|a, b| if view.is_nearer(b, a) { b } else { a });
    second.map_or(view.cleared(), |second| 0.5 * (nearest + second))
}

/// What is no farther behind the nearest surface is that surface, relative to its depth: four units of the last place.
const SAME_LAYER: f64 = 4.0 * f32::EPSILON as f64;
