//! `adaptive`: one frustum cut into tiles of equally many texels, refined where shadow edges pass that the camera sees
//! too coarse.
//!
//! R. Fernando, S. Fernandez, K. Bala, D. Greenberg, "Adaptive Shadow Maps", 2001. A tile is drawn, read back and split
//! where a receiver's texel would be larger than `m_target` pixels and depth jumps between its texels. Known failures:
//! casters that a coarse tile misses never refine it; a spent budget leaves edges coarse. Formulas:
//! docs/map.md#adaptive.

use super::quadtree::{DEEPEST, Rules, Sample, Tile, Tree, place_on_curve, refined};
use super::{LightFrustum, Projection, Refined, Scout, Shape, Shares, View, Window, single};
use crate::gpu::shader::{Wgsl, wgsl};
use crate::scene::{Light, Scene};
use crate::technique::map::settings::{DepthMetric, Settings};
use crate::technique::{TechniqueError, Unsupported};
use glam::{DVec2, DVec3, UVec2, Vec4};

/// A quadtree of views.
#[derive(Debug)]
pub(super) struct Adaptive;

/// Depth jumps where it leaves the straight line through its neighbours by more than this many texels' width.
const JUMP_TEXELS: f64 = 0.25;
/// Texels around a tile that are drawn to see a jump at its side.
const RIM_TEXELS: u32 = 1;
/// Texels that are read back at a time.
const TEXELS_AT_A_TIME: u32 = 1 << 22;

impl Projection for Adaptive {
    fn name(&self) -> &'static str {
        "adaptive"
    }

    fn shader(&self) -> Wgsl {
        wgsl!("map/projection/adaptive.wgsl")
    }

    fn has_linear_depth(&self) -> bool {
        true
    }

    fn is_unwarped(&self) -> bool {
        true
    }

    fn shares_depth(&self) -> bool {
        true
    }

    fn supports(&self, scene: &Scene, light: &Light, settings: &Settings) -> Result<(), Unsupported> {
        single::Single.supports(scene, light, &finest(settings))
    }

    /// The whole frustum as one tile.
    fn fit(
        &self,
        scene: &Scene,
        light: &Light,
        settings: &Settings,
        visible: &[DVec3],
    ) -> Result<Vec<View>, Unsupported> {
        let whole = single::frustum(scene, light, &finest(settings), visible)?;
        Ok(vec![view_of(&whole, Tile::WHOLE, settings.knobs.tile_texels)])
    }

    fn layer_texels(&self, settings: &Settings) -> u32 {
        settings.knobs.tile_texels + 2 * RIM_TEXELS
    }

    fn refine(
        &self,
        scene: &Scene,
        light: &Light,
        settings: &Settings,
        scout: &dyn Scout,
    ) -> Result<Option<Refined>, TechniqueError> {
        let knobs = &settings.knobs;
        let receivers = scout.receivers();
        let visible: Vec<DVec3> = receivers.iter().map(|receiver| receiver.point_in_world).collect();
        let whole = single::frustum(scene, light, &finest(settings), &visible)?;
        let coarsest = view_of(&whole, Tile::WHOLE, knobs.tile_texels);
        let samples = receivers.iter().filter_map(|receiver| {
            let at = coarsest.project(receiver.point_in_world);
            if at.q <= 0.0 {
                return None;
            }
            Some(Sample { uv: at.uv, m: scout.m(&coarsest, receiver)? })
        });
        let rules =
            Rules { max_level: knobs.max_level, max_tiles: budget(settings) as usize, m_target: knobs.m_target };
        let has_jump = |tiles: &[Tile]| {
            if !knobs.edges_only {
                return Ok(vec![true; tiles.len()]);
            }
            let side = knobs.tile_texels + 2 * RIM_TEXELS;
            let at_a_time = (TEXELS_AT_A_TIME / (side * side)).max(1) as usize;
            let mut jumps = Vec::with_capacity(tiles.len());
            for tiles in tiles.chunks(at_a_time) {
                // Projected depth, over a plane, changes by equal steps.
                let scout_of = |tile: &Tile| LightFrustum {
                    depth_metric: DepthMetric::Projected,
                    ..frustum_of(&whole, *tile, knobs.tile_texels, RIM_TEXELS)
                };
                let frusta: Vec<LightFrustum> = tiles.iter().map(scout_of).collect();
                let views: Vec<View> = frusta.iter().map(|frustum| frustum.view("scout")).collect();
                let depths = scout.depths(&views)?;
                jumps.extend(frusta.iter().zip(&depths).map(|(frustum, depths)| jumps_in(frustum, depths)));
            }
            Ok::<_, TechniqueError>(jumps)
        };
        let tree = refined(samples.collect(), &rules, has_jump)?;
        let views = tree.tiles.iter().map(|tile| view_of(&whole, *tile, knobs.tile_texels)).collect();
        Ok(Some(Refined { views, facts: facts(&tree, &rules) }))
    }

    fn most_views(&self, settings: &Settings) -> u32 {
        budget(settings)
    }

    fn select(&self, views: &[View], point_in_world: DVec3) -> Shares {
        let [_, across, x, y] = views[0].selector.as_dvec4().to_array();
        let uv = (DVec2::new(x, y) + views[0].project(point_in_world).uv) / across;
        let cells = f64::from(1 << DEEPEST);
        let place = place_on_curve((uv * cells).floor().clamp(DVec2::ZERO, DVec2::splat(cells - 1.0)).as_uvec2());
        let after = views.partition_point(|view| view.selector.x as u32 <= place);
        Shares::one(after.max(1) - 1)
    }

    /// To the nearest side of the tile that is not the whole map's.
    fn seam_texels(&self, views: &[View], view: usize, point_in_world: DVec3) -> Option<f64> {
        let [_, across, x, y] = views[view].selector.to_array();
        let uv = views[view].project(point_in_world).uv;
        let sides = [(x, uv.x), (across - 1.0 - x, 1.0 - uv.x), (y, uv.y), (across - 1.0 - y, 1.0 - uv.y)];
        let inner = sides.into_iter().filter(|(tiles_beyond, _)| *tiles_beyond > 0.0).map(|(_, distance)| distance);
        Some(inner.reduce(f64::min)? * f64::from(views[view].texels.x))
    }
}

/// The settings of one map with texels as fine as the last level's.
fn finest(settings: &Settings) -> Settings {
    Settings { size: settings.knobs.tile_texels << settings.knobs.max_level, ..*settings }
}

/// Tiles that may be stored: `max_tiles`, but no more texels than a map of `size` has.
fn budget(settings: &Settings) -> u32 {
    let side = (settings.size / settings.knobs.tile_texels).max(1);
    (side * side).min(settings.knobs.max_tiles)
}

/// The part of the whole frustum that a tile holds, and some texels around it.
fn frustum_of(whole: &LightFrustum, tile: Tile, tile_texels: u32, rim_texels: u32) -> LightFrustum {
    let size = (whole.window.max - whole.window.min) / f64::from(1 << tile.level);
    let rim = size * f64::from(rim_texels) / f64::from(tile_texels);
    let corner = tile.cell.as_dvec2() * size;
    // Rows count downwards.
    let min = DVec2::new(whole.window.min.x + corner.x, whole.window.max.y - corner.y - size.y) - rim;
    let window = Window { min, max: min + size + 2.0 * rim };
    LightFrustum { window, texels: UVec2::splat(tile_texels + 2 * rim_texels), ..whole.clone() }
}

/// A tile's view. Its selector holds its first place on the curve, how many tiles of its size there are side by side, and
/// its column and row.
fn view_of(whole: &LightFrustum, tile: Tile, tile_texels: u32) -> View {
    let name = format!("tile {}, {} of level {}", tile.cell.x, tile.cell.y, tile.level);
    let across = (1_u32 << tile.level) as f32;
    let selector = Vec4::new(tile.first() as f32, across, tile.cell.x as f32, tile.cell.y as f32);
    View { selector, ..frustum_of(whole, tile, tile_texels, 0).view(&name) }
}

/// Whether depth jumps anywhere in a drawn frustum: over a plane it changes by equal steps.
fn jumps_in(frustum: &LightFrustum, depths: &[f64]) -> bool {
    let side = frustum.texels.x as usize;
    let texel = (frustum.window.max - frustum.window.min).max_element() / side as f64;
    let range_m = frustum.far_m - frustum.near_m;
    let jumps = |before: f64, here: f64, after: f64| {
        let bend = (before - 2.0 * here + after).abs();
        let (metres_per_depth, texel_m) = match frustum.shape {
            Shape::Parallel => (range_m, texel),
            Shape::Perspective => {
                let forward = if frustum.reversed { 1.0 - here } else { here };
                let distance_m = frustum.near_m * frustum.far_m / (frustum.far_m - forward * range_m);
                (distance_m * distance_m * range_m / (frustum.near_m * frustum.far_m), texel * distance_m)
            }
        };
        bend * metres_per_depth > JUMP_TEXELS * texel_m
    };
    let at = |x: usize, y: usize| depths[y * side + x];
    let inner = 1..side.saturating_sub(1);
    inner.clone().any(|y| {
        inner
            .clone()
            .any(|x| jumps(at(x - 1, y), at(x, y), at(x + 1, y)) || jumps(at(x, y - 1), at(x, y), at(x, y + 1)))
    })
}

/// What people should know about a tree.
fn facts(tree: &Tree, rules: &Rules) -> Vec<(String, String)> {
    let levels = tree.tiles.iter().map(|tile| tile.level);
    let (coarsest, deepest) = (levels.clone().min().unwrap_or(0), levels.max().unwrap_or(0));
    let Tree { not_worth, at_last_level, beyond_budget, tiles } = tree;
    let spent = if *beyond_budget > 0 { ": spent" } else { "" };
    vec![
        ("tiles".to_owned(), format!("{} of {}{spent}; levels {coarsest} to {deepest}", tiles.len(), rules.max_tiles)),
        (
            format!("pixels with m > {}", rules.m_target),
            format!(
                "{not_worth} where no edge is seen, {at_last_level} at the last level, {beyond_budget} beyond the budget"
            ),
        ),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DMat4;

    fn whole(shape: Shape) -> LightFrustum {
        LightFrustum {
            light_view_from_world: DMat4::IDENTITY,
            window: Window { min: DVec2::new(-1.0, -2.0), max: DVec2::new(3.0, 2.0) },
            near_m: 1.0,
            far_m: 30.0,
            shape,
            reversed: true,
            depth_metric: DepthMetric::Projected,
            texels: UVec2::splat(512),
        }
    }

    /// AD-1: a tile's texels are those of one map as fine as its level.
    #[test]
    fn tiles_have_the_texels_of_one_fine_map() {
        for shape in [Shape::Parallel, Shape::Perspective] {
            let whole = whole(shape);
            let fine = LightFrustum { texels: UVec2::splat(64 << 3), ..whole.clone() }.view("map");
            let tile = Tile { level: 3, cell: UVec2::new(5, 2) };
            let view = view_of(&whole, tile, 64);
            let point = DVec3::new(7.0, 2.9, -4.5) * if shape == Shape::Parallel { 0.25 } else { 1.0 };
            let offset = (tile.cell * 64).as_dvec2();
            let [in_tile, in_map] = [&view, &fine].map(|view| view.site(point).position_in_texels());
            assert!((in_tile + offset - in_map).length() < 1e-3, "{in_tile} {in_map}");
            let rim = frustum_of(&whole, tile, 64, 1).view("scout");
            assert!((rim.site(point).position_in_texels() - 1.0 - in_tile).length() < 1e-3);
        }
    }

    #[test]
    fn planes_do_not_jump_and_steps_do() {
        for shape in [Shape::Parallel, Shape::Perspective] {
            let frustum = LightFrustum { texels: UVec2::splat(8), ..whole(shape) };
            let plane: Vec<f64> = (0..64).map(|i| 0.2 + 0.01 * f64::from(i % 8) + 0.003 * f64::from(i / 8)).collect();
            assert!(!jumps_in(&frustum, &plane), "{shape:?}");
            let mut step = plane.clone();
            step.iter_mut().skip(40).for_each(|depth| *depth += 0.3);
            assert!(jumps_in(&frustum, &step), "{shape:?}");
        }
    }

    #[test]
    fn the_budget_is_that_of_a_map_of_that_size() {
        use crate::technique::Spec;
        let of = |typed: &str| budget(&Settings::of(&Spec::parse(typed).unwrap()));
        assert_eq!(of("map:projection=adaptive"), 256);
        assert_eq!(of("map:projection=adaptive,size=512,tile_texels=100"), 25);
        assert_eq!(of("map:projection=adaptive,size=10"), 1);
        assert_eq!(of("map:projection=adaptive,size=16384,max_tiles=77"), 77);
    }
}
