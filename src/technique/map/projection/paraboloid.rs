//! A layout for half of all directions from a light: what a paraboloid mirror around its axis shows. Directions lie on a
//! disc, the axis in its middle; depth is the distance from the light, linearly. Twin of `shaders/map/paraboloid.wgsl`.
//!
//! W. Heidrich, H.-P. Seidel, "View-independent Environment Maps", 1998. With x to the side, y up and z along the axis as
//! seen from the light, and r = |(x, y, z)|, the rows are: u gives x, v gives y, q gives z, depth is what is added to r,
//! and its divisor what the sum is divided by. Formulas: docs/map.md#dual-paraboloid.

use super::homogeneous::{BEYOND, POSITION_ROUNDING};
use super::site::Site;
use super::view::{Gradients, InMap, Layout, Rows, View, apply};
use crate::scene::{Bounds, Segment};
use glam::{DMat3, DVec2, DVec3, IVec2, UVec2, Vec4};

/// See the module.
#[derive(Debug)]
pub(super) struct Paraboloid;

/// The disc fills the map but for a hair: a point on its rim lies in the map in spite of rounding to f32.
const RIM: f64 = 1.0 + 1.0 / 65_536.0;
/// From the disc, y up, to map coordinates less one half.
const MAP_FROM_DISC: DVec2 = DVec2::new(0.5 / RIM, -0.5 / RIM);
/// Texels whose centre lies this many texels beyond the rim still belong to the view, so that every place on the disc
/// has a texel of its own; half a diagonal is needed.
const HELD_TEXELS: f64 = 1.0;
/// Least cosine of tilt that a bias reckons with.
const LEAST_COSINE: f64 = 1e-3;

/// Cosine of the angle to the axis of the farthest texel centre that belongs to a view.
pub(super) fn least_cosine(texels: UVec2) -> f64 {
    let farthest = held_radius(texels.as_dvec2().min_element());
    (1.0 - farthest * farthest) / (1.0 + farthest * farthest)
}

/// Radius on the disc up to which texel centres belong to a view.
fn held_radius(texels: f64) -> f64 {
    1.0 + 2.0 * HELD_TEXELS / texels
}

/// How far a world point lies from the rim of a view's disc, texels; negative beyond it.
pub(super) fn rim_texels(view: &View, point_in_world: DVec3) -> f64 {
    let on_disc = (view.project(point_in_world).uv - 0.5) / MAP_FROM_DISC;
    (1.0 - on_disc.length()) * 0.5 * f64::from(view.texels.x) / RIM
}

/// A world point as seen from the light.
fn in_light(rows: &Rows, point_in_world: DVec3) -> DVec3 {
    DVec3::new(apply(rows.u, point_in_world), apply(rows.v, point_in_world), apply(rows.q, point_in_world))
}

/// Directions of the world from those of the light's view.
fn world_from_light(rows: &Rows) -> DMat3 {
    DMat3::from_cols(axis(rows.u), axis(rows.v), axis(rows.q)).transpose().inverse()
}

fn axis(row: Vec4) -> DVec3 {
    row.truncate().as_dvec3()
}

/// The direction that a place in the map shows, in the light's view.
fn direction(uv: DVec2) -> DVec3 {
    let on_disc = (uv - 0.5) / MAP_FROM_DISC;
    let squared = on_disc.length_squared();
    (2.0 * on_disc).extend(1.0 - squared) / (1.0 + squared)
}

impl Layout for Paraboloid {
    fn project(&self, rows: &Rows, point_in_world: DVec3) -> InMap {
        let seen = in_light(rows, point_in_world);
        let distance = seen.length();
        let q = distance + seen.z;
        let depth = (distance + f64::from(rows.depth.w)) / f64::from(rows.depth_q.w);
        InMap { uv: 0.5 + MAP_FROM_DISC * seen.truncate() / q, depth, q }
    }

    fn gradients(&self, rows: &Rows, point_in_world: DVec3, at: &InMap) -> Gradients {
        let seen = in_light(rows, point_in_world);
        let [side, up, forward] = [rows.u, rows.v, rows.q].map(axis);
        let away = (side * seen.x + up * seen.y + forward * seen.z) / seen.length();
        let of_q = away + forward;
        Gradients {
            u: MAP_FROM_DISC.x * (side - seen.x / at.q * of_q) / at.q,
            v: MAP_FROM_DISC.y * (up - seen.y / at.q * of_q) / at.q,
            depth: away / f64::from(rows.depth_q.w),
        }
    }

    /// At the same distance from the light.
    fn point_beside(&self, rows: &Rows, point_in_world: DVec3, _: &InMap, uv: DVec2) -> DVec3 {
        let seen = in_light(rows, point_in_world);
        point_in_world + world_from_light(rows) * (seen.length() * direction(uv) - seen)
    }

    fn ray_through(&self, rows: &Rows, uv: DVec2, bounds: &Bounds, _: f64) -> Option<Segment> {
        let world_from_light = world_from_light(rows);
        let from = -(world_from_light * in_light(rows, DVec3::ZERO));
        let reach = (bounds.centre() - from).length() + (1.0 + BEYOND) * bounds.radius().max(f64::MIN_POSITIVE);
        Some(Segment { from, to: from + reach * (world_from_light * direction(uv)) })
    }

    /// Rounding; what straight pieces make of a plane's distance, which bends over the disc; and that bend over a kernel.
    fn slack(&self, site: &Site<'_>, normal_in_world: DVec3, slope_per_texel: DVec2, reach_texels: DVec2) -> f64 {
        let rows = &site.view.rows;
        let seen = in_light(rows, site.point_in_world);
        let distance = seen.length();
        let edge_rad = f64::from(site.view.edge_rad() as f32);
        let away = site.gradients.depth.normalize();
        let cosine = normal_in_world.dot(away).abs();
        let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
        let tangent = sine / (cosine - edge_rad * sine).max(LEAST_COSINE);
        let bend_m = distance * (1.0 + tangent + 2.0 * tangent * tangent);
        let reach_rad = (reach_texels * site.texel_m()).length() / distance;
        let bent_m = bend_m * edge_rad * edge_rad / 6.0 + 0.5 * distance * tangent * reach_rad * reach_rad;

        let reach = |row: Vec4| row.as_dvec4().abs().dot(site.point_in_world.abs().extend(1.0));
        let reached_m = reach(rows.u) + reach(rows.v) + reach(rows.q) + distance;
        let slope = slope_per_texel.dot(site.view.texels.as_dvec2());
        let rounding =
            POSITION_ROUNDING * (reached_m / f64::from(rows.depth_q.w).abs() + slope * reached_m / site.at.q);
        rounding + bent_m / f64::from(rows.depth_q.w).abs()
    }

    /// First of the square, then of the disc: means of texels are taken of rows that end at the square's sides.
    fn nearest_texel(&self, texel: IVec2, texels: UVec2) -> IVec2 {
        let size = texels.as_dvec2();
        let texel = texel.clamp(IVec2::ZERO, texels.as_ivec2() - 1);
        let off = 2.0 * (texel.as_dvec2() + 0.5) / size - 1.0;
        let radius = off.length() * RIM;
        let beyond = radius > held_radius(size.min_element());
        let nearest = if beyond { ((0.5 + 0.5 * off / radius) * size).floor().as_ivec2() } else { texel };
        nearest.clamp(IVec2::ZERO, texels.as_ivec2() - 1)
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::technique::map::projection::{LightFrustum, Shape, Window};
    use crate::technique::map::settings::DepthMetric;
    use glam::DMat4;

    /// A view along +z from the origin with near 0 and far 10.
    pub(in crate::technique::map::projection) fn view(size: u32) -> View {
        let frustum = LightFrustum {
            light_view_from_world: DMat4::IDENTITY,
            window: Window::square(1.0),
            near_m: 0.1,
            far_m: 10.0,
            shape: Shape::Perspective,
            reversed: true,
            depth_metric: DepthMetric::Projected,
            texels: UVec2::splat(size),
        };
        let constant = |value: f32| Vec4::new(0.0, 0.0, 0.0, value);
        let rows = Rows { u: Vec4::X, v: Vec4::Y, q: Vec4::Z, depth: constant(-10.0), depth_q: constant(-10.0) };
        View { layout: &Paraboloid, rows, ..frustum.view("half") }
    }

    /// f64 all the way, rows that are exact.
    const EXACT: f64 = 1e-12;

    #[test]
    fn directions_lie_where_the_mirror_shows_them() {
        let view = view(64);
        let uv = |direction: DVec3| view.project(3.0 * direction).uv;
        assert!((uv(DVec3::Z) - 0.5).length() < EXACT);
        assert!((uv(DVec3::X) - DVec2::new(0.5 + 0.5 / RIM, 0.5)).length() < EXACT, "the rim");
        let at = DVec3::new(0.48, -0.36, 0.8);
        assert!((uv(at) - (0.5 + MAP_FROM_DISC * at.truncate() / 1.8)).length() < EXACT);
        assert!((view.project(3.0 * at).depth - 0.7).abs() < EXACT);
        let bounds = Bounds { min: DVec3::splat(-4.0), max: DVec3::splat(4.0) };
        let ray = view.ray_through(uv(at) * 64.0, &bounds).unwrap();
        assert!(ray.from.length() < EXACT && ray.to.normalize().distance(at) < EXACT && ray.to.length() > 6.9);
        let beside = view.layout.point_beside(&view.rows, 3.0 * at, &view.project(3.0 * at), uv(DVec3::Y));
        assert!(beside.distance(3.0 * DVec3::Y) < EXACT);
    }

    #[test]
    fn gradients_equal_finite_differences() {
        let view = view(64);
        let point = DVec3::new(1.0, -2.0, 1.5);
        let site = view.site(point);
        for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
            const STEP: f64 = 1e-5;
            let [a, b] = [-STEP, STEP].map(|step| view.project(point + step * axis));
            let change = (b.uv - a.uv) / (2.0 * STEP);
            let expected = DVec2::new(site.gradients.u.dot(axis), site.gradients.v.dot(axis));
            assert!((change - expected).length() < 1e-8);
            assert!(((b.depth - a.depth) / (2.0 * STEP) - site.gradients.depth.dot(axis)).abs() < 1e-8);
        }
        assert!((site.metres_per_depth() - 10.0).abs() < EXACT);
    }

    /// Texel solid angles, centre to rim, are 4 to 1: 4/(1 + r²)².
    #[test]
    fn texels_at_the_rim_cover_a_quarter_of_the_angle() {
        let view = view(1024);
        let solid_angle = |direction: DVec3| {
            let texel = view.site(direction).texel_m();
            texel.x * texel.y
        };
        assert!((solid_angle(DVec3::Z) / solid_angle(DVec3::X) - 4.0).abs() < 1e-9);
    }

    #[test]
    fn texels_of_the_disc_belong_to_the_view_and_others_lead_back_to_it() {
        let view = view(64);
        for texel in [[0, 32], [63, 31], [32, 63], [10, 10], [9, 9]] {
            assert!(view.holds(IVec2::from_array(texel)), "{texel:?}");
        }
        for texel in [[0, 0], [63, 0], [-1, 32], [32, 64], [7, 7]] {
            let nearest = Paraboloid.nearest_texel(IVec2::from_array(texel), view.texels);
            assert!(!view.holds(IVec2::from_array(texel)) && view.holds(nearest), "{texel:?} {nearest}");
        }
    }
}
