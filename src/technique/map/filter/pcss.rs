//! `pcss`: percentage-closer soft shadows. The mean distance of the blockers around the receiver gives the width of the
//! penumbra that they throw, and that the width of the kernel.
//!
//! R. Fernando, "Percentage-Closer Soft Shadows", 2005. Assumes that blockers lie on one plane, parallel to the rectangle or
//! the disc that the light shows, and that the light looks at them from there: the kernel is then the light as the receiver
//! sees it through that plane. Known failures: blockers at several distances, blockers that the search
//! misses, and the limits of the widths (`filter-width`). Formulas: docs/map.md#percentage-closer-soft-shadows.

use super::turn::{TURN, shifted, turned};
use super::{Asked, Blocker, Filter, Kernel, NUMBERS};
use crate::gpu::shader::{Wgsl, wgsl};
use crate::scene::{Light, LightKind};
use crate::technique::map::projection::Gradients;
use crate::technique::param::{Choice, ChoiceNumber};
use glam::{DVec2, DVec3, IVec2, Vec2, Vec4};
use std::f64::consts::PI;

/// k taps in the kernel, and others in the search.
#[derive(Debug)]
pub(super) struct Pcss;

/// Where the numbers hold the light's half sides, and where the places of the taps begin.
const HALVES: usize = 1;
const PLACES: usize = 3;

impl Filter for Pcss {
    fn choice(&self) -> Choice {
        Choice { name: "pcss", number: Some(ChoiceNumber { min: 1, max: 256, default: 32 }) }
    }
    fn shader(&self) -> Wgsl {
        wgsl!("map/filter/pcss.wgsl")
    }
    fn builds_on(&self) -> &'static [Wgsl] {
        &[NUMBERS, TURN]
    }
    /// Kernels follow from what the map holds: the fit leaves no room for them.
    fn radius_texels(&self, _kernel: &Kernel) -> f64 {
        0.0
    }
    fn bias_kernel(&self, _kernel: &Kernel) -> f64 {
        0.5
    }
    /// For a light without extent.
    fn taps(&self, _kernel: &Kernel, position_in_texels: DVec2, tap: &mut dyn FnMut(IVec2, f64)) {
        tap(position_in_texels.floor().as_ivec2(), 1.0);
    }
    fn texel_reads(&self, kernel: &Kernel) -> u32 {
        kernel.search_taps + kernel.number
    }
    fn reads_map(&self) -> bool {
        true
    }
    fn needs_linear_depth(&self) -> bool {
        true
    }
    fn softens(&self) -> bool {
        true
    }
    fn reaches_by_tap(&self) -> bool {
        true
    }

    fn taps_at(&self, asked: &Asked<'_>, blocker: Blocker<'_>, tap: &mut dyn FnMut(IVec2, f64)) {
        let (kernel, position) = (asked.kernel, asked.placed.position_in_texels);
        let cone = Cone::of(asked);
        let search = cone.limited(cone.spread(cone.near_m), kernel.max_texels);
        let (mut depth, mut blockers) = (0.0, 0.0);
        for i in 0..kernel.search_taps {
            if let Some(found) = blocker(cone.texel(asked, PLACES + i as usize, search)) {
                depth += found;
                blockers += 1.0;
            }
        }
        if blockers == 0.0 {
            return;
        }
        let blocker_m = cone.distance_m + (depth / blockers - cone.depth) * cone.metres_per_depth;
        let spread = cone.limited(cone.spread(blocker_m), kernel.max_texels);
        if spread * cone.widest < kernel.min_texels {
            tap(position.floor().as_ivec2(), 1.0);
            return;
        }
        for i in 0..kernel.number {
            let texel = cone.texel(asked, PLACES + (kernel.search_taps + i) as usize, spread);
            tap(texel, 1.0 / f64::from(kernel.number));
        }
    }

    /// The light's half sides (a sphere's radius, or the tangent of a sun's, with a 1 behind it), then the places of the
    /// search's taps and those of the kernel's: in the unit square for a rectangle, else in the unit disc.
    fn numbers(&self, kernel: &Kernel, light: &Light) -> Vec<Vec4> {
        let counts =
            [kernel.search_taps as f32, kernel.number as f32, kernel.min_texels as f32, kernel.max_texels as f32];
        let halves = match light.kind {
            LightKind::Rectangle { half_width, half_height, .. } => [half_width.extend(0.0), half_height.extend(0.0)],
            LightKind::Sphere { radius_m, .. } => [Vec4::new(radius_m, 0.0, 0.0, 1.0), Vec4::ZERO],
            LightKind::Sun { angular_radius_rad, .. } => {
                [Vec4::new(angular_radius_rad.tan() as f32, 0.0, 0.0, 1.0), Vec4::ZERO]
            }
            LightKind::Point { .. } | LightKind::Directional { .. } | LightKind::Spot { .. } => [Vec4::ZERO; 2],
        };
        let places = if halves[0].w == 1.0 { disc } else { square };
        let of_taps = [kernel.search_taps, kernel.number].into_iter().flat_map(places);
        std::iter::once(Vec4::from_array(counts))
            .chain(halves)
            .chain(of_taps.map(|p| p.extend(0.0).extend(0.0)))
            .collect()
    }
}

/// What a receiver sees of the light, in its view.
struct Cone {
    /// The light's half sides, or two radii of the disc that it shows, metres; of a sun, metres for each metre to the
    /// blocker.
    halves_in_world: [DVec3; 2],
    /// How wide the wider of both is in the map at the receiver: texels.
    widest: f64,
    /// Whether the light is infinitely far away.
    is_parallel: bool,
    /// Of the receiver in its view.
    depth: f64,
    /// The same along the axis: from the light, or of parallel light from the view's near plane.
    distance_m: f64,
    /// Of the view's near plane.
    near_m: f64,
    /// Along the axis, away from the light.
    metres_per_depth: f64,
}

impl Cone {
    fn of(asked: &Asked<'_>) -> Self {
        let (view, point) = (asked.view, asked.placed.point_in_world);
        let site = view.site(point);
        let Gradients { u, v, depth } = site.gradients;
        let axis = (view.depth_sign * depth).normalize();
        let metres_per_depth = view.depth_sign / depth.length();
        let beyond_near_m = (site.at.depth - (1.0 - view.cleared())) * metres_per_depth;
        let is_parallel = asked.light.w == 0.0;
        let distance_m = if is_parallel { beyond_near_m } else { axis.dot(point - asked.light.truncate()) };
        let ray = if is_parallel { axis } else { (point - asked.light.truncate()).normalize() };
        let sides = [asked.numbers[HALVES], asked.numbers[HALVES + 1]];
        let radius_m = f64::from(sides[0].x);
        let halves_in_world = if sides[0].w == 1.0 {
            // Nothing in the map changes along the ray, so u changes across it.
            let across = u.normalize();
            [across, ray.cross(across)].map(|direction| radius_m * direction)
        } else {
            sides.map(|side| side.truncate().as_dvec3())
        };
        let on_map = |half: DVec3| view.texels.as_dvec2() * DVec2::new(u.dot(half), v.dot(half));
        let [first, second] = halves_in_world.map(|half| on_map(half).length());
        Self {
            halves_in_world,
            widest: 2.0 * first.max(second),
            is_parallel,
            depth: site.at.depth,
            distance_m,
            near_m: distance_m - beyond_near_m,
            metres_per_depth,
        }
    }

    /// How wide the light is at the receiver, seen through a point before it: a factor of its halves.
    fn spread(&self, blocker_m: f64) -> f64 {
        (self.distance_m - blocker_m) / if self.is_parallel { 1.0 } else { blocker_m }
    }

    /// A spread that is no wider than that many texels.
    fn limited(&self, spread: f64, max_texels: f64) -> f64 {
        if spread * self.widest > max_texels { max_texels / self.widest } else { spread }
    }

    /// The texel of a tap.
    fn texel(&self, asked: &Asked<'_>, index: usize, spread: f64) -> IVec2 {
        let listed = Vec2::new(asked.numbers[index].x, asked.numbers[index].y).as_dvec2();
        let place = if asked.numbers[HALVES].w == 1.0 {
            turned(asked.kernel, asked.pixel, listed)
        } else {
            2.0 * shifted(asked.kernel, asked.pixel, listed) - 1.0
        };
        let [first, second] = self.halves_in_world;
        let beside = asked.placed.point_in_world + spread * (place.x * first + place.y * second);
        let at = asked.view.project(beside);
        // Kernels wider than the map may reach behind the light.
        let place = if at.q > 0.0 { at.uv * asked.view.texels.as_dvec2() } else { asked.placed.position_in_texels };
        place.floor().as_ivec2()
    }
}

/// Places in the unit square: J. Hammersley, "Monte Carlo Methods for Solving Multivariable Problems", 1960.
fn square(count: u32) -> Vec<Vec2> {
    let height = |i: u32| (f64::from(i.reverse_bits()) + 0.5) / 2.0_f64.powi(32);
    (0..count).map(|i| DVec2::new((f64::from(i) + 0.5) / f64::from(count), height(i)).as_vec2()).collect()
}

/// Places in the unit disc: H. Vogel, "A Better Way to Construct the Sunflower Head", 1979.
fn disc(count: u32) -> Vec<Vec2> {
    let golden_angle = PI * (3.0 - 5.0_f64.sqrt());
    let place = |i: f64| DVec2::from_angle(i * golden_angle) * ((i + 0.5) / f64::from(count)).sqrt();
    (0..count).map(|i| place(i.into()).as_vec2()).collect()
}
