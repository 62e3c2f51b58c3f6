//! One shadow-map lookup: place the receiver in the map, guard, bias, compare. This f64 twin is the specification of
//! `shaders/map/lookup.wgsl`: same names, same order. Formulas: docs/map.md#lookup and docs/map.md#bias.

use super::bias::Amounts;
use super::projection::LightFrustum;
use super::{DepthFormat, Settings};
use crate::scene::Light;
use bytemuck::{Pod, Zeroable};
use glam::{DMat4, DVec2, DVec3, DVec4, IVec2, Mat4};

/// Rasterisers snap vertices to a grid of at least 1/256 texel where it matters here, which tilts a plane's depth by up
/// to that much of its slope; interpolation adds up to four units of 2⁻²⁴ per texel from the map's corner.
fn raster_slack_texels(texels: u32) -> f64 {
    1.0 / 256.0 + 4.0 * f64::from(texels) * 2.0_f64.powi(-24)
}

/// Depth per texel beyond which every bias is at its cap.
const STEEPEST: f64 = 1e3;
/// Relative rounding of an f32 position through a matrix.
const POSITION_ROUNDING: f64 = f32::EPSILON as f64;
/// Format steps that a closed-form bias adds for the rounding of both sides of the comparison.
const FORMAT_STEPS: f64 = 4.0;

/// Everything a lookup needs besides the receiver.
#[derive(Debug, Clone)]
pub struct Lookup {
    /// The fitted frustum.
    pub frustum: LightFrustum,
    /// The bias amounts.
    pub bias: Amounts,
    format: DepthFormat,
    light: DVec4,
    world_from_map: DMat4,
}

/// Why a receiver has no place in the map.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outside {
    /// Behind the light or beside the map.
    Frustum,
    /// Before the near plane.
    Near,
    /// Behind the far plane.
    Far,
}

/// A receiver placed in the map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placed {
    /// Where the comparison takes place: the receiver, moved along its normal if the bias says so.
    pub point_in_world: DVec3,
    /// uv × texels.
    pub position_in_texels: DVec2,
    /// Depth of that point.
    pub depth: f64,
    /// Homogeneous q.
    pub q: f64,
    /// Depth compared with the stored one: `depth` less the bias.
    pub reference: f64,
}

impl Placed {
    /// The texel that holds the point.
    #[must_use]
    pub fn own_texel(&self) -> IVec2 {
        self.position_in_texels.floor().as_ivec2()
    }
}

impl Lookup {
    /// For one frustum and light.
    #[must_use]
    pub fn new(frustum: LightFrustum, settings: &Settings, light: &Light) -> Self {
        Self {
            world_from_map: frustum.map_from_world.as_dmat4().inverse(),
            bias: settings.bias_amounts(),
            format: settings.format,
            light: light.homogeneous(),
            frustum,
        }
    }

    /// The same lookup with no bias at all.
    #[must_use]
    pub fn without_bias(&self) -> Self {
        Self { bias: Amounts::NONE, ..self.clone() }
    }

    /// Places a receiver.
    ///
    /// # Errors
    /// Which side of the frustum it is on, if it is outside.
    pub fn place(&self, point_in_world: DVec3, normal_in_world: DVec3) -> Result<Placed, Outside> {
        let moved = self.moved_along_normal(point_in_world, normal_in_world);
        let (position_in_texels, depth, q) = self.project(moved)?;
        let bias = self.bias_depth(moved, normal_in_world, q, depth);
        let reference = depth - self.frustum.depth_sign() * bias;
        Ok(Placed { point_in_world: moved, position_in_texels, depth, q, reference })
    }

    /// (uv × texels, depth, q) of a point, through the guard.
    ///
    /// # Errors
    /// Which side of the frustum it is on, if it is outside.
    pub fn project(&self, point_in_world: DVec3) -> Result<(DVec2, f64, f64), Outside> {
        let in_map = self.frustum.project(point_in_world);
        let q = in_map.w;
        if q <= 0.0 {
            return Err(Outside::Frustum);
        }
        let (uv, depth) = (in_map.truncate().truncate() / q, in_map.z / q);
        if uv.min_element() < 0.0 || uv.max_element() >= 1.0 {
            return Err(Outside::Frustum);
        }
        if !(0.0..=1.0).contains(&depth) {
            let is_near = (depth < 0.0) != self.frustum.reversed;
            return Err(if is_near { Outside::Near } else { Outside::Far });
        }
        Ok((uv * self.frustum.texels.as_dvec2(), depth, q))
    }

    fn moved_along_normal(&self, point_in_world: DVec3, normal_in_world: DVec3) -> DVec3 {
        let q = self.frustum.project(point_in_world).w;
        let texel_m = self.frustum.texel_m(q).max_element();
        let towards_light = (self.light.truncate() - point_in_world * self.light.w).normalize_or_zero();
        let sine = normal_in_world.cross(towards_light).length();
        point_in_world + normal_in_world * (self.bias.normal_texels * texel_m * sine)
    }

    /// How far the comparison is moved towards the light, in units of depth.
    #[must_use]
    pub fn bias_depth(&self, point_in_world: DVec3, normal_in_world: DVec3, q: f64, depth: f64) -> f64 {
        let along_light = self.bias.depth_m / self.frustum.metres_per_depth(q);
        if self.bias.closed_form_kernel == 0.0 {
            return along_light;
        }
        let kernel = self.bias.closed_form_kernel;
        along_light + self.closed_form(point_in_world, normal_in_world, (q, depth), kernel)
    }

    /// The closed-form bias: what suffices, but no more than the cap (docs/map.md#bias), in units of depth.
    #[must_use]
    pub fn closed_form(
        &self,
        point_in_world: DVec3,
        normal_in_world: DVec3,
        (q, depth): (f64, f64),
        kernel: f64,
    ) -> f64 {
        let cap = self.bias.cap_texels * self.frustum.texel_m(q).max_element() / self.frustum.metres_per_depth(q);
        self.sufficient_bias(point_in_world, normal_in_world, (q, depth), kernel).min(cap)
    }

    /// The bias that the receiver's own slope needs for a kernel of that many texel widths, in units of depth.
    #[must_use]
    pub fn sufficient_bias(
        &self,
        point_in_world: DVec3,
        normal_in_world: DVec3,
        (q, depth): (f64, f64),
        kernel: f64,
    ) -> f64 {
        let metres_per_depth = self.frustum.metres_per_depth(q);
        let texel_m = self.frustum.texel_m(q);
        let slope_per_texel = self.slope_per_texel(point_in_world, normal_in_world);
        let slope = (kernel + raster_slack_texels(self.frustum.texels.max_element())) * slope_per_texel.element_sum();
        let largest = point_in_world.abs().max_element();
        let position =
            largest * POSITION_ROUNDING * (1.0 / metres_per_depth + (slope_per_texel / texel_m).element_sum());
        slope + position + FORMAT_STEPS * self.format.step(depth)
    }

    /// Change of depth from one texel to the next along u and along v on the receiver's plane, without sign.
    #[must_use]
    pub fn slope_per_texel(&self, point_in_world: DVec3, normal_in_world: DVec3) -> DVec2 {
        let gradient = self.frustum.depth_gradient(&self.world_from_map, point_in_world, normal_in_world);
        let slope = gradient.abs() / self.frustum.texels.as_dvec2();
        // A plane that the light sees edge-on gives infinity or NaN; both are "steepest".
        DVec2::new(STEEPEST.min(slope.x), STEEPEST.min(slope.y))
    }

    /// Whether a reference depth is lit by a stored one. Equality is lit.
    #[must_use]
    pub fn is_lit(&self, reference: f64, stored: f64) -> bool {
        self.frustum.depth_sign() * (reference - stored) <= 0.0
    }

    /// Index of a texel row by row, or `None` outside the map, where everything is lit.
    #[must_use]
    pub fn texel_index(&self, texel: IVec2) -> Option<u32> {
        let size = self.frustum.texels.as_ivec2();
        let is_inside = texel.min_element() >= 0 && texel.x < size.x && texel.y < size.y;
        is_inside.then(|| texel.y as u32 * self.frustum.texels.x + texel.x as u32)
    }

    /// What the rasteriser adds to the depth of a triangle: its constant and slope, away from the light.
    #[must_use]
    pub fn hardware_bias(&self, [a, b, c]: [DVec3; 3]) -> f64 {
        if self.bias.constant_units == 0 && self.bias.slope == 0.0 {
            return 0.0;
        }
        let depth_of = |corner: DVec3| {
            let in_map = self.frustum.project(corner);
            (in_map.z / in_map.w).clamp(0.0, 1.0)
        };
        let largest = depth_of(a).max(depth_of(b)).max(depth_of(c));
        let slope = self.slope_per_texel(a, (b - a).cross(c - a).normalize_or_zero()).max_element();
        let constant = f64::from(self.bias.constant_units) * self.format.hardware_unit(largest);
        let bias = constant + self.bias.slope * slope;
        let clamped = if self.bias.clamp > 0.0 { bias.min(self.bias.clamp) } else { bias };
        self.frustum.depth_sign() * clamped
    }

    /// World points on the near and far plane that a map position looks along.
    #[must_use]
    pub fn ray_through(&self, position_in_texels: DVec2) -> [DVec3; 2] {
        let uv = position_in_texels / self.frustum.texels.as_dvec2();
        let (near, far) = if self.frustum.reversed { (1.0, 0.0) } else { (0.0, 1.0) };
        [near, far].map(|depth| self.world_from_map.project_point3(uv.extend(depth)))
    }

    /// The uniform of the shader.
    #[must_use]
    pub(super) fn uniform(&self, kernel: u32) -> LookupUniform {
        let (fixed_step, float_step) = match self.format {
            DepthFormat::Depth32Float => (0.0, f32::EPSILON),
            fixed => (fixed.step(1.0) as f32, 0.0),
        };
        LookupUniform {
            map_from_world: self.frustum.map_from_world,
            plane_in_map_from_world: self.world_from_map.transpose().as_mat4(),
            light: self.light.as_vec4().to_array(),
            texels: self.frustum.texels.as_vec2().to_array(),
            texel_at_q1: self.frustum.texel_at_q1().as_vec2().to_array(),
            metres_per_depth_terms: self.frustum.metres_per_depth_terms().map(|term| term as f32),
            kernel,
            depth_sign: self.frustum.depth_sign() as f32,
            closed_form_kernel: self.bias.closed_form_kernel as f32,
            raster_slack_texels: raster_slack_texels(self.frustum.texels.max_element()) as f32,
            cap_texels: self.bias.cap_texels as f32,
            normal_texels: self.bias.normal_texels as f32,
            depth_m: self.bias.depth_m as f32,
            fixed_step,
            float_step,
            padding: 0,
        }
    }
}

/// `Lookup` of `shaders/map/lookup.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(super) struct LookupUniform {
    map_from_world: Mat4,
    plane_in_map_from_world: Mat4,
    light: [f32; 4],
    texels: [f32; 2],
    texel_at_q1: [f32; 2],
    metres_per_depth_terms: [f32; 2],
    kernel: u32,
    depth_sign: f32,
    closed_form_kernel: f32,
    raster_slack_texels: f32,
    cap_texels: f32,
    normal_texels: f32,
    depth_m: f32,
    fixed_step: f32,
    float_step: f32,
    padding: u32,
}

#[cfg(test)]
mod tests {
    use super::LookupUniform;
    use crate::gpu::layout::{rust_layout, wgsl_layout};
    use crate::technique::map::shader_modules;

    #[test]
    fn the_uniform_lies_as_the_shaders_read_it() {
        let lookups: Vec<_> =
            shader_modules().into_iter().filter(|(label, _)| label.starts_with("map lookup")).collect();
        assert!(!lookups.is_empty());
        for (label, files) in lookups {
            let in_rust = rust_layout!(LookupUniform {
                map_from_world,
                plane_in_map_from_world,
                light,
                texels,
                texel_at_q1,
                metres_per_depth_terms,
                kernel,
                depth_sign,
                closed_form_kernel,
                raster_slack_texels,
                cap_texels,
                normal_texels,
                depth_m,
                fixed_step,
                float_step,
                padding,
            });
            assert_eq!(wgsl_layout(&files, "Lookup"), in_rust, "{label}");
        }
    }
}
