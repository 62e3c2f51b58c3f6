//! A light's view frustum and its matrices: computed in f64, rounded once to f32, and from then on the rounded numbers
//! are what both the GPU and its f64 twins use.

use glam::{DMat4, DVec2, DVec3, DVec4, Mat4, UVec2, dcamera::rh};

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
    /// Width and height of the map in texels.
    pub texels: UVec2,
    /// What the rasteriser uses: world to wgpu clip space, rounded.
    pub light_clip_from_world: Mat4,
    /// What lookups use: world to (u, v, depth, 1) × q with v down, rounded.
    pub map_from_world: Mat4,
}

/// The map's texture coordinates from clip space: the one place where v is flipped.
const MAP_FROM_CLIP: DMat4 = DMat4::from_cols(
    DVec4::new(0.5, 0.0, 0.0, 0.0),
    DVec4::new(0.0, -0.5, 0.0, 0.0),
    DVec4::new(0.0, 0.0, 1.0, 0.0),
    DVec4::new(0.5, 0.5, 0.0, 1.0),
);

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
    /// Rounds the matrices of a fit.
    #[must_use]
    pub fn new(
        light_view_from_world: DMat4,
        window: Window,
        (near_m, far_m): (f64, f64),
        shape: Shape,
        reversed: bool,
        texels: UVec2,
    ) -> Self {
        let clip_from_view = clip_from_view(window, near_m, far_m, shape, reversed);
        let light_clip_from_world = clip_from_view * light_view_from_world;
        Self {
            light_view_from_world,
            window,
            near_m,
            far_m,
            shape,
            reversed,
            texels,
            light_clip_from_world: light_clip_from_world.as_mat4(),
            map_from_world: (MAP_FROM_CLIP * light_clip_from_world).as_mat4(),
        }
    }

    /// Texel width and height where q = 1: metres for parallel rays, per metre of distance for perspective ones.
    #[must_use]
    pub fn texel_at_q1(&self) -> DVec2 {
        (self.window.max - self.window.min) / self.texels.as_dvec2()
    }

    /// Texel width and height in metres at a homogeneous q (the view distance of a perspective map, else 1).
    #[must_use]
    pub fn texel_m(&self, q: f64) -> DVec2 {
        self.texel_at_q1() * q
    }

    /// `[a, b]`: one unit of depth is `a + b q²` metres along the view.
    #[must_use]
    pub fn metres_per_depth_terms(&self) -> [f64; 2] {
        let range = self.far_m - self.near_m;
        match self.shape {
            Shape::Parallel => [range, 0.0],
            Shape::Perspective => [0.0, range / (self.near_m * self.far_m)],
        }
    }

    /// Metres along the view per unit of depth at q.
    #[must_use]
    pub fn metres_per_depth(&self, q: f64) -> f64 {
        let [a, b] = self.metres_per_depth_terms();
        a + b * q * q
    }

    /// (u q, v q, depth q, q) of a world point, in f64 through the rounded matrix.
    #[must_use]
    pub fn project(&self, point_in_world: DVec3) -> DVec4 {
        self.map_from_world.as_dmat4() * point_in_world.extend(1.0)
    }

    /// Change of depth per unit of u and of v along a plane through `point_in_world`: depth is affine in (u, v) on any
    /// plane, for parallel and perspective maps alike.
    #[must_use]
    pub fn depth_gradient(&self, world_from_map: &DMat4, point_in_world: DVec3, normal_in_world: DVec3) -> DVec2 {
        let plane = normal_in_world.extend(-normal_in_world.dot(point_in_world));
        let plane_in_map = world_from_map.transpose() * plane;
        DVec2::new(-plane_in_map.x, -plane_in_map.y) / plane_in_map.z
    }

    /// Signed so that larger is farther from the light: +1 forward, −1 reversed.
    #[must_use]
    pub fn depth_sign(&self) -> f64 {
        if self.reversed { -1.0 } else { 1.0 }
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

    fn frustum(shape: Shape, reversed: bool) -> LightFrustum {
        let window = Window { min: DVec2::new(-1.0, -0.5), max: DVec2::new(2.0, 1.5) };
        LightFrustum::new(DMat4::IDENTITY, window, (1.0, 30.0), shape, reversed, UVec2::new(64, 32))
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
                let frustum = frustum(shape, reversed);
                for distance in [1.0, 2.5, 30.0] {
                    let scale = if shape == Shape::Parallel { 1.0 } else { distance };
                    let top_left = DVec3::new(-scale, 1.5 * scale, -distance);
                    let map = frustum.project(top_left);
                    let (uv, depth) = (map.truncate().truncate() / map.w, map.z / map.w);
                    assert!(uv.abs().max_element() < ROUNDING, "{shape:?} {reversed} {uv}");
                    assert!((depth - expected_depth(shape, reversed, distance)).abs() < ROUNDING);
                    assert!((map.w - scale).abs() < ROUNDING * scale);
                }
            }
        }
    }

    #[test]
    fn depth_gradient_equals_finite_differences() {
        for shape in [Shape::Parallel, Shape::Perspective] {
            let frustum = frustum(shape, true);
            let world_from_map = frustum.map_from_world.as_dmat4().inverse();
            let (point, normal) = (DVec3::new(0.3, 0.2, -7.0), DVec3::new(0.4, -0.5, 1.0).normalize());
            let gradient = frustum.depth_gradient(&world_from_map, point, normal);
            let map_of = |p: DVec3| frustum.project(p).truncate() / frustum.project(p).w;
            for tangent in [normal.any_orthonormal_vector(), normal.cross(normal.any_orthonormal_vector())] {
                let step = map_of(point + 1e-4 * tangent) - map_of(point - 1e-4 * tangent);
                let predicted = gradient.dot(step.truncate());
                assert!((predicted - step.z).abs() < 1e-6 * step.length(), "{shape:?}: {predicted} {}", step.z);
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
