//! The usual layout: u, v and depth are quotients of linear functions of the world point, as one 4 × 4 matrix (or two,
//! if depth is not warped along) gives them. Twin of `shaders/map/homogeneous.wgsl`.

use super::site::{Site, bent};
use super::view::{Gradients, InMap, Layout, Rows, apply};
use crate::scene::{Bounds, Segment};
use glam::{DVec2, DVec3, IVec2, UVec2, Vec4};

/// See the module.
#[derive(Debug)]
pub(super) struct Homogeneous;

/// Rays reach beyond the scene's box by this share of its radius, so that no rounding cuts its surface off.
pub(super) const BEYOND: f64 = 1e-3;
/// Relative rounding of an f32 position through the rows.
pub(super) const POSITION_ROUNDING: f64 = f32::EPSILON as f64;

impl Layout for Homogeneous {
    fn project(&self, rows: &Rows, point_in_world: DVec3) -> InMap {
        let q = apply(rows.q, point_in_world);
        let uv = DVec2::new(apply(rows.u, point_in_world), apply(rows.v, point_in_world)) / q;
        InMap { uv, depth: apply(rows.depth, point_in_world) / apply(rows.depth_q, point_in_world), q }
    }

    fn gradients(&self, rows: &Rows, point_in_world: DVec3, at: &InMap) -> Gradients {
        let of_quotient = |row: Vec4, divisor: Vec4, value: f64, divided_by: f64| {
            (row.truncate().as_dvec3() - value * divisor.truncate().as_dvec3()) / divided_by
        };
        Gradients {
            u: of_quotient(rows.u, rows.q, at.uv.x, at.q),
            v: of_quotient(rows.v, rows.q, at.uv.y, at.q),
            depth: of_quotient(rows.depth, rows.depth_q, at.depth, apply(rows.depth_q, point_in_world)),
        }
    }

    /// On the plane of equal q, or for parallel rays on the plane across them: u and v are affine there, so this is exact.
    fn point_beside(&self, rows: &Rows, point_in_world: DVec3, at: &InMap, uv: DVec2) -> DVec3 {
        let Gradients { u, v, .. } = self.gradients(rows, point_in_world, at);
        let of_q = rows.q.truncate().as_dvec3();
        let normal = if of_q == DVec3::ZERO { u.cross(v) } else { of_q };
        let step = uv - at.uv;
        point_in_world + (step.x * v.cross(normal) + step.y * normal.cross(u)) / normal.dot(u.cross(v))
    }

    /// The planes u = const and v = const meet in a line; what lies behind the view is cut off.
    fn ray_through(&self, rows: &Rows, uv: DVec2, bounds: &Bounds, depth_sign: f64) -> Option<Segment> {
        let plane = |row: Vec4, value: f64| row.as_dvec4() - value * rows.q.as_dvec4();
        let (a, b) = (plane(rows.u, uv.x), plane(rows.v, uv.y));
        let (normal_a, normal_b) = (a.truncate(), b.truncate());
        let along = normal_a.cross(normal_b);
        let centre = bounds.centre();
        let off = |plane: glam::DVec4| -plane.dot(centre.extend(1.0));
        let closest =
            centre + (off(a) * normal_b.cross(along) + off(b) * along.cross(normal_a)) / along.length_squared();
        let radius = (1.0 + BEYOND) * bounds.radius().max(f64::MIN_POSITIVE);
        let half_squared = radius * radius - (closest - centre).length_squared();
        if half_squared.is_nan() || half_squared <= 0.0 {
            return None;
        }
        let step = along.normalize() * half_squared.sqrt();
        let (from, to) = in_front(rows, closest - step, closest + step)?;
        let depth = |point: DVec3| apply(rows.depth, point) / apply(rows.depth_q, point);
        let middle = from.midpoint(to);
        let slope = self.gradients(rows, middle, &InMap { uv, depth: depth(middle), q: apply(rows.q, middle) }).depth;
        let runs_away = depth_sign * slope.dot(to - from) >= 0.0;
        Some(if runs_away { Segment { from, to } } else { Segment { from: to, to: from } })
    }

    /// The rounding of the point and the rows to f32; and where depth has a divisor of its own, what planes bend.
    fn slack(&self, site: &Site<'_>, normal_in_world: DVec3, slope_per_texel: DVec2, reach_texels: DVec2) -> f64 {
        let rows = &site.view.rows;
        let reach = |row: Vec4| row.as_dvec4().abs().dot(site.point_in_world.abs().extend(1.0));
        let quotient = |row: Vec4, divisor: Vec4, value: f64, of: f64| (reach(row) + value.abs() * reach(divisor)) / of;
        let depth_q = apply(rows.depth_q, site.point_in_world);
        let depth = quotient(rows.depth, rows.depth_q, site.at.depth, depth_q);
        let u = quotient(rows.u, rows.q, site.at.uv.x, site.at.q);
        let v = quotient(rows.v, rows.q, site.at.uv.y, site.at.q);
        let slope = slope_per_texel * site.view.texels.as_dvec2();
        let bend = if rows.depth_q == rows.q { 0.0 } else { bend(site, normal_in_world, reach_texels) };
        POSITION_ROUNDING * (depth + slope.x * u + slope.y * v) + bend
    }

    fn bend_per_texel(&self, site: &Site<'_>, normal_in_world: DVec3) -> DVec2 {
        let rows = &site.view.rows;
        if rows.depth_q == rows.q {
            return DVec2::ZERO;
        }
        let relative = |row: Vec4, value: f64| row.truncate().as_dvec3() / value;
        let of_ratio = relative(rows.q, site.at.q) - relative(rows.depth_q, apply(rows.depth_q, site.point_in_world));
        site.change_per_texel(of_ratio, normal_in_world)
    }

    fn nearest_texel(&self, texel: IVec2, texels: UVec2) -> IVec2 {
        texel.clamp(IVec2::ZERO, texels.as_ivec2() - 1)
    }
}

/// By how much more than its slope says a plane comes nearer to the light within so many texels: most at a corner.
fn bend(site: &Site<'_>, normal_in_world: DVec3, reach_texels: DVec2) -> f64 {
    let nearer_per_texel = -site.view.depth_sign * site.depth_per_texel(normal_in_world);
    let bend_per_texel = site.bend_per_texel(normal_in_world);
    let corners = [DVec2::new(1.0, 1.0), DVec2::new(1.0, -1.0), DVec2::new(-1.0, 1.0), DVec2::new(-1.0, -1.0)];
    let nearer = |corner: DVec2| bent(nearer_per_texel, bend_per_texel, corner * reach_texels);
    let straight = nearer_per_texel.abs().dot(reach_texels);
    corners.map(nearer).into_iter().fold(straight, f64::max) - straight
}

/// The part of a segment where q > 0.
fn in_front(rows: &Rows, from: DVec3, to: DVec3) -> Option<(DVec3, DVec3)> {
    let (at_from, at_to) = (apply(rows.q, from), apply(rows.q, to));
    let crossing = || from.lerp(to, at_from / (at_from - at_to));
    match (at_from > 0.0, at_to > 0.0) {
        (true, true) => Some((from, to)),
        (true, false) => Some((from, crossing())),
        (false, true) => Some((crossing(), to)),
        (false, false) => None,
    }
}
