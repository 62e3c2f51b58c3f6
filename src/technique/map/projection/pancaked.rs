//! What a rasteriser makes of triangles whose corners before the near plane the vertex shader moves to it, along the
//! light's rays (`near_mode=vertex-clamp`, known as pancaking). A triangle that lies before the plane with all of itself
//! is drawn flat on it, and a triangle behind it as it is; one that reaches through it gets another plane, farther from
//! the light. Twin of `shaders/map/caster_pancaked.wgsl`. Formulas: docs/map.md#pancaking.

use super::site::Site;
use super::view::{Gradients, InMap, View, apply};
use glam::DVec3;

/// A triangle that reaches through the near plane, as it is drawn.
#[derive(Debug, Clone, Copy)]
pub(in crate::technique::map) struct Pancaked {
    corners_in_world: [DVec3; 3],
    /// Depth times its divisor at each corner.
    depth_q: DVec3,
}

impl Pancaked {
    /// In a view whose depth has no divisor of its own; `None` for triangles with all corners on one side of its near
    /// plane.
    pub(in crate::technique::map) fn of(view: &View, corners_in_world: [DVec3; 3]) -> Option<Self> {
        let near_depth = 1.0 - view.cleared();
        let drawn = corners_in_world.map(|corner| {
            let (depth_q, at_near) = (apply(view.rows.depth, corner), near_depth * apply(view.rows.q, corner));
            let is_before = view.is_nearer(depth_q, at_near);
            (is_before, if is_before { at_near } else { depth_q })
        });
        let reaches_through = drawn.iter().any(|(is_before, _)| *is_before) && !drawn.iter().all(|(before, _)| *before);
        reaches_through
            .then(|| Self { corners_in_world, depth_q: DVec3::from_array(drawn.map(|(_, depth_q)| depth_q)) })
    }

    /// A point of the triangle, with the depth that it is drawn with and how that changes along the triangle.
    pub(in crate::technique::map) fn site<'v>(&self, view: &'v View, point_in_world: DVec3) -> Site<'v> {
        let [a, b, c] = self.corners_in_world;
        let normal = (b - a).cross(c - a);
        // Each corner's share of a point grows from the opposite side towards it.
        let of_shares = [c - b, a - c, b - a].map(|side| normal.cross(side) / normal.length_squared());
        let shares = self.depth_q.to_array().into_iter().zip(of_shares);
        let of_depth_q: DVec3 = shares.map(|(depth_q, of_share)| depth_q * of_share).sum();
        let site = view.site(point_in_world);
        let depth = (self.depth_q.x + of_depth_q.dot(point_in_world - a)) / site.at.q;
        let of_q = view.rows.q.truncate().as_dvec3();
        Site {
            at: InMap { depth, ..site.at },
            gradients: Gradients { depth: (of_depth_q - depth * of_q) / site.at.q, ..site.gradients },
            ..site
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cast::testing::Random;
    use crate::technique::map::projection::{LightFrustum, Shape, Window};
    use crate::technique::map::settings::DepthMetric;
    use glam::{DMat4, UVec2};

    const NEAR_M: f64 = 2.0;
    /// The f32 rows of a view: a few units of 2^-24, in depths of which a perspective one has most near the light.
    const ROUNDING: f64 = 1e-5;

    fn views() -> impl Iterator<Item = View> {
        let shapes = [Shape::Parallel, Shape::Perspective];
        shapes.into_iter().flat_map(|shape| [false, true].map(|reversed| (shape, reversed))).map(|(shape, reversed)| {
            let frustum = LightFrustum {
                light_view_from_world: DMat4::IDENTITY,
                window: Window::square(1.0),
                near_m: NEAR_M,
                far_m: 30.0,
                shape,
                reversed,
                depth_metric: DepthMetric::Projected,
                texels: UVec2::splat(64),
            };
            frustum.view("test")
        })
    }

    /// Depth that grows from 0 at the near plane.
    fn forward(view: &View, depth: f64) -> f64 {
        if view.depth_sign > 0.0 { depth } else { 1.0 - depth }
    }

    /// A sheet that falls from `d0` before the near plane to `d1` behind it is drawn from the plane to `d1`.
    #[test]
    fn a_slope_is_drawn_from_the_near_plane_to_its_far_end() {
        let (first_m, last_m) = (0.5, 9.5);
        for view in views().filter(|view| view.rows.q == glam::Vec4::W) {
            let corners =
                [DVec3::new(-1.0, -1.0, -first_m), DVec3::new(-1.0, 1.0, -first_m), DVec3::new(1.0, -1.0, -last_m)];
            let pancaked = Pancaked::of(&view, corners).unwrap();
            for share in [0.0, 0.3, 0.9] {
                let point = corners[0].lerp(corners[2], share);
                let depth = forward(&view, pancaked.site(&view, point).at.depth);
                let expected = (share * (last_m - NEAR_M)) / (30.0 - NEAR_M);
                assert!((depth - expected).abs() < ROUNDING, "{share}: {depth} {expected}");
                let moved_m = (NEAR_M - first_m) * (1.0 - share);
                let plain = forward(&view, view.project(point).depth);
                assert!(((depth - plain) * (30.0 - NEAR_M) - moved_m).abs() < 30.0 * ROUNDING);
            }
        }
    }

    /// Moving corners away from the light moves no point towards it, nor before what clamping each point would give; the
    /// homogeneous interpolation of a rasteriser agrees, and the gradient is that of the depth.
    #[test]
    fn points_only_move_away_from_the_light() {
        let mut random = Random(5);
        for view in views() {
            let mut bent = 0;
            for _ in 0..300 {
                let mut place =
                    || DVec3::new(random.unit() - 0.5, random.unit() - 0.5, 0.5 - 5.0 * random.unit()) * 2.0;
                let corners = [place(), place(), place()];
                let Some(pancaked) = Pancaked::of(&view, corners) else { continue };
                let shares = DVec3::new(random.unit(), random.unit(), random.unit()) + 0.01;
                let shares = shares / shares.element_sum();
                let point: DVec3 = corners.iter().zip(shares.to_array()).map(|(corner, share)| *corner * share).sum();
                let site = pancaked.site(&view, point);
                if site.at.q < 0.1 {
                    continue;
                }
                bent += 1;
                let (drawn, plain) = (forward(&view, site.at.depth), forward(&view, view.project(point).depth));
                assert!(drawn > plain.max(0.0) - ROUNDING, "{drawn} {plain}");
                let clip = corners.map(|corner| view.clip_from_world.as_dmat4() * corner.extend(1.0));
                let moved = clip.map(|at| if view.depth_sign > 0.0 { at.z.max(0.0) } else { at.z.min(at.w) });
                let interpolated =
                    shares.dot(DVec3::from_array(moved)) / shares.dot(DVec3::from_array(clip.map(|at| at.w)));
                assert!((site.at.depth - interpolated).abs() < ROUNDING * interpolated.abs().max(1.0));
                let step = 1e-6 * (corners[1] - corners[0]);
                let beside = pancaked.site(&view, point + step).at.depth;
                let change = site.gradients.depth.dot(step);
                assert!((beside - site.at.depth - change).abs() < 1e-3 * change.abs() + 1e-12, "{change}");
            }
            assert!(bent > 50, "{bent}");
        }
    }

    #[test]
    fn triangles_on_one_side_of_the_plane_keep_theirs() {
        for view in views() {
            for from_m in [-1.0, 0.1, 3.0] {
                let corners = [DVec3::ZERO, DVec3::X, DVec3::new(0.2, 1.0, -0.5)].map(|p| p - from_m * DVec3::Z);
                assert!(Pancaked::of(&view, corners).is_none(), "{from_m}");
            }
        }
    }
}
