//! What an ideal rasteriser would store: the exact depth along the ray through each texel's centre, cast in f64; or, in
//! views that are drawn in straight pieces, what these leave at the texel's centre.

use super::bias::Clearance;
use super::lookup::Lookup;
use super::projection::View;
use crate::cast::{Casters, Hit};
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
#[derive(Debug, Default)]
pub(in crate::technique) struct ExactTexels {
    pub(in crate::technique) indices: Vec<u32>,
    texels: Vec<ExactTexel>,
}

impl ExactTexels {
    /// Casts through the centres of the texels with these indices (layer by layer, row by row; any order, repeats allowed).
    pub(in crate::technique) fn cast(scene: &Scene, casters: &Casters, lookup: &Lookup, indices: Vec<u32>) -> Self {
        Self::default().and_cast(scene, casters, lookup, indices)
    }

    /// The same with more texels.
    pub(in crate::technique) fn and_cast(
        self,
        scene: &Scene,
        casters: &Casters,
        lookup: &Lookup,
        mut indices: Vec<u32>,
    ) -> Self {
        indices.extend(&self.indices);
        indices.par_sort_unstable();
        indices.dedup();
        let of = |index: &u32| {
            self.rank(*index).map_or_else(|| exact_texel(scene, casters, lookup, *index), |rank| self.at(rank))
        };
        let texels = indices.par_iter().map(of).collect();
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

/// A caster's surface at a place in a view, as far as it is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Surface {
    pub(super) triangle: u32,
    /// Not yet clamped to 0..=1.
    pub(super) depth: f64,
    /// What the rasteriser adds.
    pub(super) bias: f64,
}

fn exact_texel(scene: &Scene, casters: &Casters, lookup: &Lookup, index: u32) -> ExactTexel {
    let (view, texel) = lookup.texel_of(index);
    let centre = texel.as_dvec2() + 0.5;
    let surfaces = drawn_in_pieces(lookup, view, centre).unwrap_or_else(|| cast(scene, casters, lookup, view, centre));
    held(lookup, view, &surfaces)
}

/// What a texel holds at whose centre these surfaces are drawn.
pub(super) fn held(lookup: &Lookup, view: usize, surfaces: &[Surface]) -> ExactTexel {
    let cleared = lookup.views[view].cleared();
    let mut texel_holds = ExactTexel { depth: cleared, unbiased_depth: cleared, triangle: None };
    let mut depths = Vec::new();
    for surface in surfaces {
        let unbiased_depth = surface.depth.clamp(0.0, 1.0);
        let depth = (surface.depth + surface.bias).clamp(0.0, 1.0);
        let is_nearer = |a: f64, b: f64| lookup.views[view].is_nearer(a, b);
        if texel_holds.triangle.is_none() || is_nearer(depth, texel_holds.depth) {
            texel_holds = ExactTexel { depth, triangle: Some(surface.triangle), ..texel_holds };
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

/// The casters along the ray through a place in a view.
pub(super) fn cast(
    scene: &Scene,
    casters: &Casters,
    lookup: &Lookup,
    view: usize,
    position_in_texels: DVec2,
) -> Vec<Surface> {
    let Some(ray) = lookup.ray_through(view, position_in_texels, &casters.bounds()) else { return Vec::new() };
    let mut hits = Vec::new();
    casters.all_hits(&ray, None, &mut hits);
    let surface = |hit: &Hit| {
        let corners = scene.triangle_in_world(hit.triangle);
        let point_in_world = ray.from.lerp(ray.to, hit.t);
        let depth = lookup.rasterised_depth(view, corners, point_in_world)?;
        let bias = lookup.hardware_bias(view, corners, point_in_world);
        lookup.draws_side(scene, hit.triangle).then_some(Surface { triangle: hit.triangle, depth, bias })
    };
    hits.iter().filter_map(surface).collect()
}

/// The pieces at a place in a view that is drawn in pieces; `None` if it is not.
pub(super) fn drawn_in_pieces(lookup: &Lookup, view: usize, position_in_texels: DVec2) -> Option<Vec<Surface>> {
    let (index, view) = (view, &lookup.views[view]);
    let mut surfaces = Vec::new();
    view.drawn.as_ref()?.at(view, position_in_texels, &mut |cover| {
        if lookup.draws_depth(index, cover.depth) && lookup.draws_facing(if cover.faces_light { 1.0 } else { -1.0 }) {
            let bias = lookup.rasteriser_bias(view, cover.largest_depth.clamp(0.0, 1.0), cover.slope_per_texel);
            surfaces.push(Surface { triangle: cover.caster, depth: cover.depth, bias });
        }
    });
    Some(surfaces)
}
