//! A light's view frustum, computed in f64: the usual way to a [`View`], which rounds it once.

use super::homogeneous::Homogeneous;
use super::view::{Rows, View};
use crate::technique::map::settings::DepthMetric;
use glam::{DMat4, DVec2, DVec3, DVec4, UVec2, Vec4, dcamera::rh};

/// How rays run through the frustum.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// All along the light's direction.
    Parallel,
    /// All from the light's position.
    Perspective,
}

/// The cross-section of a frustum in light view space: metres for parallel rays, tangents for perspective ones.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    /// Left and bottom.
    pub min: DVec2,
    /// Right and top.
    pub max: DVec2,
}

/// A fitted light frustum.
#[derive(Debug, Clone, PartialEq)]
pub struct LightFrustum {
    /// World to light view space, which looks along −z.
    pub light_view_from_world: DMat4,
    /// Cross-section.
    pub window: Window,
    /// Near plane, metres from the light's view point.
    pub near_m: f64,
    /// Far plane, metres.
    pub far_m: f64,
    /// Parallel or perspective.
    pub shape: Shape,
    /// True where 1 is near the light.
    pub reversed: bool,
    /// What depth measures.
    pub depth_metric: DepthMetric,
    /// Width and height of the map in texels.
    pub texels: UVec2,
}

impl Window {
    /// The smallest window around some points; a point at zero without any.
    #[must_use]
    pub fn around(points: impl IntoIterator<Item = DVec2>) -> Self {
        let bounds = points.into_iter().fold(None, |window: Option<Self>, p| {
            Some(window.map_or(Self { min: p, max: p }, |w| Self { min: w.min.min(p), max: w.max.max(p) }))
        });
        bounds.unwrap_or(Self { min: DVec2::ZERO, max: DVec2::ZERO })
    }

    /// A square of half width `half` around zero.
    #[must_use]
    pub fn square(half: f64) -> Self {
        Self { min: DVec2::splat(-half), max: DVec2::splat(half) }
    }

    /// The window grown so that `rim_texels` of `texels` lie outside it on each side (as many as fit), never of zero
    /// width (`least` then), and shifted by a phase in texels.
    #[must_use]
    pub fn with_rim(self, texels: UVec2, rim_texels: f64, least: f64, phase_texels: DVec2) -> Self {
        let texels = texels.as_dvec2();
        let rim = DVec2::splat(rim_texels).min(0.5 * (texels - 1.0));
        let texel = (self.max - self.min).max(DVec2::splat(least)) / (texels - 2.0 * rim);
        let centre = 0.5 * (self.min + self.max) + phase_texels * texel;
        Self { min: centre - 0.5 * texel * texels, max: centre + 0.5 * texel * texels }
    }
}

impl LightFrustum {
    /// World to wgpu clip space.
    #[must_use]
    pub fn clip_from_world(&self) -> DMat4 {
        let Self { window, near_m, far_m, shape, reversed, .. } = *self;
        clip_from_view(window, near_m, far_m, shape, reversed) * self.light_view_from_world
    }

    /// Whether a point lies within the window, before the light.
    #[must_use]
    pub fn sees(&self, point_in_world: DVec3) -> bool {
        let at = self.light_view_from_world.transform_point3(point_in_world);
        let q = if self.shape == Shape::Parallel { 1.0 } else { -at.z };
        let Window { min, max } = self.window;
        let at = at.truncate() / q;
        q > 0.0 && at.cmpge(min).all() && at.cmple(max).all()
    }

    /// The view of a map that this frustum is.
    #[must_use]
    pub fn view(&self, name: &str) -> View {
        let clip_from_world = self.clip_from_world();
        let projected = Rows::of_clip(&clip_from_world);
        let rows = match (self.depth_metric, self.shape) {
            (DepthMetric::Linear, Shape::Perspective) => {
                Rows { depth: self.linear_depth_row().as_vec4(), depth_q: Vec4::W, ..projected }
            }
            // An orthographic depth is linear as it is.
            (DepthMetric::Linear, Shape::Parallel) | (DepthMetric::Projected, _) => projected,
        };
        View {
            name: name.to_owned(),
            window: self.window_text(),
            near_far: format!("{:.6} m, {:.6} m", self.near_m, self.far_m),
            layout: &Homogeneous,
            rows,
            clip_from_world: clip_from_world.as_mat4(),
            selector: Vec4::ZERO,
            blend_per_m: 0.0,
            depth_sign: if self.reversed { -1.0 } else { 1.0 },
            texels: self.texels,
            drawn: None,
        }
    }

    /// (d − n)/(f − n) of the distance d along the view's axis, or 1 less that.
    fn linear_depth_row(&self) -> DVec4 {
        let distance = -self.light_view_from_world.row(2);
        let (first, last) = if self.reversed { (self.far_m, self.near_m) } else { (self.near_m, self.far_m) };
        (distance - first * DVec4::W) / (last - first)
    }

    fn window_text(&self) -> String {
        let size = self.window.max - self.window.min;
        match self.shape {
            Shape::Parallel => format!("{:.4} m x {:.4} m", size.x, size.y),
            Shape::Perspective => {
                let angles = [size.x, size.y].map(|tangents| 2.0 * (0.5 * tangents).atan().to_degrees());
                format!("{:.2} x {:.2} degrees", angles[0], angles[1])
            }
        }
    }
}

/// Light view to wgpu clip space. Exchanging near and far reverses depth; a perspective window is given at the plane
/// that the formula takes for near.
fn clip_from_view(window: Window, near_m: f64, far_m: f64, shape: Shape, reversed: bool) -> DMat4 {
    let (first, last) = if reversed { (far_m, near_m) } else { (near_m, far_m) };
    let Window { min, max } = window;
    match shape {
        Shape::Parallel => rh::proj::directx::orthographic(min.x, max.x, min.y, max.y, first, last),
        Shape::Perspective => {
            let (min, max) = (min * first, max * first);
            rh::proj::directx::frustum(min.x, max.x, min.y, max.y, first, last)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Bounds;

    fn view(shape: Shape, reversed: bool) -> View {
        let window = Window { min: DVec2::new(-1.0, -0.5), max: DVec2::new(2.0, 1.5) };
        let light_view_from_world = DMat4::IDENTITY;
        let texels = UVec2::new(64, 32);
        let depth_metric = DepthMetric::Projected;
        LightFrustum { light_view_from_world, window, near_m: 1.0, far_m: 30.0, shape, reversed, depth_metric, texels }
            .view("test")
    }

    /// Depth of a point `distance` in front of the light, by the formulas of docs/map.md.
    fn expected_depth(shape: Shape, reversed: bool, distance: f64) -> f64 {
        let (n, f) = (1.0, 30.0);
        let forward = match shape {
            Shape::Parallel => (distance - n) / (f - n),
            Shape::Perspective => f / (f - n) * (1.0 - n / distance),
        };
        if reversed { 1.0 - forward } else { forward }
    }

    /// f32 matrices: a few units of 2^-24.
    const ROUNDING: f64 = 1e-6;

    #[test]
    fn window_corners_and_depths_land_where_they_should() {
        for shape in [Shape::Parallel, Shape::Perspective] {
            for reversed in [false, true] {
                let view = view(shape, reversed);
                for distance in [1.0, 2.5, 30.0] {
                    let scale = if shape == Shape::Parallel { 1.0 } else { distance };
                    let at = view.project(DVec3::new(-scale, 1.5 * scale, -distance));
                    assert!(at.uv.abs().max_element() < ROUNDING, "{shape:?} {reversed} {at:?}");
                    assert!((at.depth - expected_depth(shape, reversed, distance)).abs() < ROUNDING);
                    assert!((at.q - scale).abs() < ROUNDING * scale);
                }
            }
        }
    }

    #[test]
    fn texels_and_depth_are_as_wide_as_the_formulas_say() {
        for reversed in [false, true] {
            let parallel = view(Shape::Parallel, reversed);
            let site = parallel.site(DVec3::new(0.3, 0.2, -7.0));
            assert!((site.texel_m() - DVec2::new(3.0 / 64.0, 2.0 / 32.0)).abs().max_element() < ROUNDING);
            assert!((site.metres_per_depth() - 29.0).abs() < 29.0 * ROUNDING);
            // On the axis of a perspective view: width per metre of distance, and d² (f − n) / (n f).
            let perspective = view(Shape::Perspective, reversed);
            let site = perspective.site(DVec3::new(0.0, 0.0, -7.0));
            let off = site.texel_m() - 7.0 * DVec2::new(3.0 / 64.0, 2.0 / 32.0);
            assert!(off.abs().max_element() < ROUNDING, "{off}");
            assert!((site.metres_per_depth() / (49.0 * 29.0 / 30.0) - 1.0).abs() < ROUNDING);
        }
    }

    #[test]
    fn gradients_equal_finite_differences() {
        for shape in [Shape::Parallel, Shape::Perspective] {
            let view = view(shape, true);
            let (point, normal) = (DVec3::new(0.3, 0.2, -7.0), DVec3::new(0.4, -0.5, 1.0).normalize());
            let site = view.site(point);
            let [along_u, along_v] = site.texel_steps_m(normal);
            for (step, texels) in [(along_u, DVec2::X), (along_v, DVec2::Y)] {
                let ends = [-0.5e-3, 0.5e-3].map(|share| view.site(point + share * step));
                let moved = (ends[1].position_in_texels() - ends[0].position_in_texels()) * 1e3;
                assert!((moved - texels).length() < 1e-6, "{shape:?}: {moved}");
                let depth = (ends[1].at.depth - ends[0].at.depth).abs() * 1e3;
                let slope = site.slope_per_texel(normal).dot(texels);
                assert!((depth - slope).abs() < 1e-6 * slope, "{shape:?}: {depth} {slope}");
            }
        }
    }

    #[test]
    fn the_ray_through_a_place_holds_the_points_that_lie_there_nearest_first() {
        let bounds = Bounds { min: DVec3::new(-9.0, -9.0, -20.0), max: DVec3::new(9.0, 9.0, 5.0) };
        for shape in [Shape::Parallel, Shape::Perspective] {
            for reversed in [false, true] {
                let view = view(shape, reversed);
                let place = DVec2::new(40.5, 3.5);
                let ray = view.ray_through(place, &bounds).unwrap();
                for share in [0.1, 0.5, 1.0] {
                    let site = view.site(ray.from.lerp(ray.to, share));
                    assert!((site.position_in_texels() - place).length() < 1e-9 && site.at.q > 0.0);
                }
                assert!(ray.from.z > ray.to.z, "{shape:?} {reversed}");
                let beside = view.layout.point_beside(&view.rows, ray.to, &view.project(ray.to), DVec2::new(0.7, 0.2));
                assert!((view.project(beside).uv - DVec2::new(0.7, 0.2)).length() < 1e-9);
            }
        }
    }

    #[test]
    fn a_triangle_that_faces_the_light_is_wound_as_the_view_says() {
        for shape in [Shape::Parallel, Shape::Perspective] {
            for reversed in [false, true] {
                let view = view(shape, reversed);
                // Counter-clockwise as seen from the light at the origin, or from along +z.
                let corners = [DVec3::new(0.0, 0.0, -5.0), DVec3::new(1.0, 0.0, -5.0), DVec3::new(0.0, 1.0, -5.0)];
                let [a, b, c] = corners.map(|corner| view.project(corner).uv * DVec2::new(1.0, -1.0));
                let light = if shape == Shape::Parallel { DVec4::Z } else { DVec4::W };
                assert_eq!((b - a).perp_dot(c - a).signum(), view.winding(light), "{shape:?} {reversed}");
            }
        }
    }

    #[test]
    fn the_rim_holds_texels_and_tiny_maps_keep_the_window() {
        let window = Window::square(1.0).with_rim(UVec2::splat(10), 2.0, 1e-6, DVec2::ZERO);
        assert!((window.max.x - 10.0 / 6.0).abs() < 1e-12);
        assert_eq!(Window::square(1.0).with_rim(UVec2::ONE, 2.0, 1e-6, DVec2::ZERO), Window::square(1.0));
        let flat = Window::square(0.0).with_rim(UVec2::splat(8), 0.0, 1e-3, DVec2::ZERO);
        assert!(flat.max.x > flat.min.x);
    }
}
