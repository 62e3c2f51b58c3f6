//! One shadow-map lookup: select the view, place the receiver in it, guard, bias, compare. This f64 twin is the
//! specification of `shaders/map/lookup.wgsl`: same names, same order. Formulas: docs/map.md#lookup and docs/map.md#bias.

use super::bias::Amounts;
use super::filter::Kernel;
use super::projection::{Projection, Shares, Site, View};
use super::settings::{Border, CasterSides, NearMode, Seam};
use super::{DepthFormat, Settings};
use crate::scene::{Bounds, Light, Scene, Segment};
use bytemuck::{Pod, Zeroable};
use glam::{DVec2, DVec3, DVec4, IVec2, UVec2};

/// Rasterisers snap vertices to a grid of at least 1/256 texel where it matters here, which tilts a plane's depth by up
/// to that much of its slope; interpolation adds up to four units of 2⁻²⁴ per texel from the map's corner.
fn raster_slack_texels(texels: u32) -> f64 {
    1.0 / 256.0 + 4.0 * f64::from(texels) * 2.0_f64.powi(-24)
}

/// Format steps that a closed-form bias adds for the rounding of both sides of the comparison.
const FORMAT_STEPS: f64 = 4.0;

/// Everything a lookup needs besides the receiver.
#[derive(Clone)]
pub struct Lookup {
    /// The fitted views, one layer of the map each.
    pub views: Vec<View>,
    /// The bias amounts.
    pub bias: Amounts,
    projection: &'static dyn Projection,
    seam: Seam,
    border: Border,
    near_mode: NearMode,
    caster_sides: CasterSides,
    format: DepthFormat,
    light: DVec4,
    /// Whether each tap is biased for as far as it is, not for the widest kernel.
    reaches_by_tap: bool,
}

impl std::fmt::Debug for Lookup {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Lookup").field("projection", &self.projection.name()).field("views", &self.views).finish()
    }
}

/// Why a receiver has no place in a view.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outside {
    /// Behind the light or beside the map.
    Frustum,
    /// Before the near plane.
    Near,
    /// Behind the far plane.
    Far,
}

/// A receiver placed in a view.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placed {
    /// Index of the view.
    pub view: usize,
    /// Where the comparison takes place: the receiver, moved along its normal if the bias says so.
    pub point_in_world: DVec3,
    /// uv × texels.
    pub position_in_texels: DVec2,
    /// Depth of that point.
    pub depth: f64,
    /// Depth compared with the stored one: `depth` less the bias.
    pub reference: f64,
}

/// A texel that a lookup reads, and the receiver as its view sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tap {
    /// The receiver in the texel's view, which is not its own view for taps across a seam.
    pub placed: Placed,
    /// The texel.
    pub texel: IVec2,
}

impl Placed {
    /// The texel that holds the point.
    #[must_use]
    pub fn own_texel(&self) -> IVec2 {
        self.position_in_texels.floor().as_ivec2()
    }
}

impl Lookup {
    /// For the views of one light.
    #[must_use]
    pub fn new(views: Vec<View>, settings: &Settings, light: &Light) -> Self {
        Self {
            views,
            bias: settings.bias_amounts(),
            projection: settings.projection,
            seam: settings.seam,
            border: settings.border,
            near_mode: settings.near_mode,
            caster_sides: settings.caster_sides,
            format: settings.format,
            light: light.homogeneous(),
            reaches_by_tap: settings.filter.reaches_by_tap(),
        }
    }

    /// The same lookup with no bias at all.
    #[must_use]
    pub fn without_bias(&self) -> Self {
        Self { bias: Amounts::NONE, ..self.clone() }
    }

    /// The light: w = 1, or 0 with a vector towards it.
    #[must_use]
    pub(super) fn light(&self) -> DVec4 {
        self.light
    }

    /// Width and height of every view in texels.
    #[must_use]
    pub fn texels(&self) -> UVec2 {
        self.views[0].texels
    }

    /// The views that answer for a receiver.
    #[must_use]
    pub fn select(&self, point_in_world: DVec3) -> Shares {
        self.projection.select(&self.views, point_in_world)
    }

    /// A world point as its own view sees it, through the guard.
    ///
    /// # Errors
    /// Which side of the view it is on, if it is outside.
    pub fn project(&self, point_in_world: DVec3) -> Result<Site<'_>, Outside> {
        self.project_in(self.select(point_in_world).first, point_in_world)
    }

    /// A world point as a view sees it, through the guard.
    ///
    /// # Errors
    /// Which side of the view it is on, if it is outside.
    pub fn project_in(&self, view: usize, point_in_world: DVec3) -> Result<Site<'_>, Outside> {
        let site = self.views[view].site(point_in_world);
        // Negated, so that NaN is outside.
        let is_beside = !(site.at.uv.min_element() >= 0.0 && site.at.uv.max_element() < 1.0);
        if site.at.q <= 0.0 || is_beside {
            return Err(Outside::Frustum);
        }
        if !(0.0..=1.0).contains(&site.at.depth) {
            let is_near = (site.at.depth < 0.0) != (site.view.depth_sign < 0.0);
            return Err(if is_near { Outside::Near } else { Outside::Far });
        }
        Ok(site)
    }

    /// Whether casters are drawn with that side towards the light.
    #[must_use]
    pub fn draws_side(&self, scene: &Scene, triangle: u32) -> bool {
        match self.caster_sides {
            CasterSides::All => true,
            CasterSides::LightFacing => scene.facing(triangle, self.light) > 0.0,
            CasterSides::AwayFacing => scene.facing(triangle, self.light) < 0.0,
        }
    }

    /// The depth of a caster's point in a view, not yet clamped to 0..=1; `None` if it is not drawn.
    #[must_use]
    pub fn drawn_depth(&self, view: usize, point_in_world: DVec3) -> Option<f64> {
        let site = self.views[view].site(point_in_world);
        let is_drawn = site.at.q > 0.0 && (self.near_mode != NearMode::Extend || (0.0..=1.0).contains(&site.at.depth));
        is_drawn.then_some(site.at.depth)
    }

    /// Places a receiver in a view.
    ///
    /// # Errors
    /// Which side of the view it is on, if it is outside and the border does not stretch.
    pub fn place(&self, view: usize, point_in_world: DVec3, normal_in_world: DVec3) -> Result<Placed, Outside> {
        let moved = self.moved_along_normal(view, point_in_world, normal_in_world);
        match self.project_in(view, moved) {
            Err(outside) if self.border != Border::ClampEdge || self.views[view].project(moved).q <= 0.0 => {
                Err(outside)
            }
            Ok(_) | Err(_) => Ok(self.placed(view, moved, normal_in_world, DVec2::splat(self.bias.closed_form_kernel))),
        }
    }

    /// A moved receiver in any view, with a bias for texels up to `reach_texels` away.
    fn placed(&self, view: usize, moved: DVec3, normal_in_world: DVec3, reach_texels: DVec2) -> Placed {
        let site = self.views[view].site(moved);
        let depth = if self.border == Border::ClampEdge { site.at.depth.clamp(0.0, 1.0) } else { site.at.depth };
        let reference = depth - site.view.depth_sign * self.bias_depth(&site, normal_in_world, reach_texels);
        Placed { view, point_in_world: moved, position_in_texels: site.position_in_texels(), depth, reference }
    }

    fn moved_along_normal(&self, view: usize, point_in_world: DVec3, normal_in_world: DVec3) -> DVec3 {
        if self.bias.normal_texels == 0.0 {
            return point_in_world;
        }
        let texel_m = self.views[view].site(point_in_world).texel_m().max_element();
        let towards_light = (self.light.truncate() - point_in_world * self.light.w).normalize_or_zero();
        let sine = normal_in_world.cross(towards_light).length();
        point_in_world + normal_in_world * (self.bias.normal_texels * texel_m * sine)
    }

    /// How far the comparison is moved towards the light, in units of depth.
    fn bias_depth(&self, site: &Site<'_>, normal_in_world: DVec3, reach_texels: DVec2) -> f64 {
        let along_light = self.bias.depth_m / site.metres_per_depth();
        if self.bias.closed_form_kernel == 0.0 {
            return along_light;
        }
        along_light + self.closed_form(site, normal_in_world, reach_texels)
    }

    /// The closed-form bias: what suffices, but no more than the cap (docs/map.md#bias), in units of depth.
    #[must_use]
    pub fn closed_form(&self, site: &Site<'_>, normal_in_world: DVec3, reach_texels: DVec2) -> f64 {
        let cap = self.bias.cap_texels * site.texel_m().max_element() / site.metres_per_depth();
        self.sufficient_bias(site, normal_in_world, reach_texels).min(cap)
    }

    /// The bias that the receiver's own slope needs for texels up to that far away, in units of depth.
    #[must_use]
    pub fn sufficient_bias(&self, site: &Site<'_>, normal_in_world: DVec3, reach_texels: DVec2) -> f64 {
        let slope_per_texel = site.slope_per_texel(normal_in_world);
        let reach = reach_texels + raster_slack_texels(self.texels().max_element());
        reach.dot(slope_per_texel) + site.rounding(slope_per_texel) + FORMAT_STEPS * self.format.step(site.at.depth)
    }

    /// The texel of a placed receiver's view, or beyond the view's side what stands for it; `None` outside the map.
    #[must_use]
    pub fn tap(&self, placed: &Placed, normal_in_world: DVec3, texel: IVec2) -> Option<Tap> {
        if self.is_inside(texel) {
            let reach_texels = (texel.as_dvec2() + 0.5 - placed.position_in_texels).abs().max(DVec2::splat(0.5));
            let placed = match self.reaches_by_tap && self.bias.closed_form_kernel != 0.0 {
                true => self.placed(placed.view, placed.point_in_world, normal_in_world, reach_texels),
                false => *placed,
            };
            return Some(Tap { placed, texel });
        }
        let across = if self.seam == Seam::PerTap { self.tap_across(placed, normal_in_world, texel) } else { None };
        let is_clamped = self.seam == Seam::Clamp || self.border == Border::ClampEdge;
        across.or_else(|| {
            let nearest = texel.clamp(IVec2::ZERO, self.texels().as_ivec2() - 1);
            is_clamped.then_some(Tap { placed: *placed, texel: nearest })
        })
    }

    /// The texel of another view that a texel beyond the side of the receiver's view falls in.
    fn tap_across(&self, placed: &Placed, normal_in_world: DVec3, texel: IVec2) -> Option<Tap> {
        let own = &self.views[placed.view];
        let uv = (texel.as_dvec2() + 0.5) / own.texels.as_dvec2();
        let at = own.project(placed.point_in_world);
        let beside = own.layout.point_beside(&own.rows, placed.point_in_world, &at, uv);
        let view = self.select(beside).first;
        let found = self.views[view].project(beside);
        let texel = (found.uv * own.texels.as_dvec2()).floor().as_ivec2();
        let site = self.views[view].site(placed.point_in_world);
        if view == placed.view || found.q <= 0.0 || site.at.q <= 0.0 || !self.is_inside(texel) {
            return None;
        }
        let reach_texels = (texel.as_dvec2() + 0.5 - site.position_in_texels()).abs();
        Some(Tap { placed: self.placed(view, placed.point_in_world, normal_in_world, reach_texels), texel })
    }

    /// What the comparison gives outside the map.
    #[must_use]
    pub fn border_visibility(&self) -> f64 {
        if self.border == Border::Shadow { 0.0 } else { 1.0 }
    }

    /// Whether a reference depth is lit by a stored one. Equality is lit.
    #[must_use]
    pub fn is_lit(&self, view: usize, reference: f64, stored: f64) -> bool {
        self.views[view].depth_sign * (reference - stored) <= 0.0
    }

    fn is_inside(&self, texel: IVec2) -> bool {
        texel.min_element() >= 0 && texel.cmplt(self.texels().as_ivec2()).all()
    }

    /// Index of a texel, layer by layer and row by row, or `None` outside its view.
    #[must_use]
    pub fn texel_index(&self, view: usize, texel: IVec2) -> Option<u32> {
        let size = self.texels();
        let row = view as u32 * size.y + texel.y as u32;
        self.is_inside(texel).then(|| row * size.x + texel.x as u32)
    }

    /// View and texel of an index.
    #[must_use]
    pub fn texel_of(&self, index: u32) -> (usize, UVec2) {
        let size = self.texels();
        let row = index / size.x;
        ((row / size.y) as usize, UVec2::new(index % size.x, row % size.y))
    }

    /// What the rasteriser adds to the depth of a triangle: its constant and slope, away from the light.
    #[must_use]
    pub fn hardware_bias(&self, view: usize, [a, b, c]: [DVec3; 3]) -> f64 {
        if self.bias.constant_units == 0 && self.bias.slope == 0.0 {
            return 0.0;
        }
        let view = &self.views[view];
        let depth_of = |corner: DVec3| view.project(corner).depth.clamp(0.0, 1.0);
        let largest = depth_of(a).max(depth_of(b)).max(depth_of(c));
        let slope = view.site(a).slope_per_texel((b - a).cross(c - a).normalize_or_zero()).max_element();
        let constant = f64::from(self.bias.constant_units) * self.format.hardware_unit(largest);
        let bias = constant + self.bias.slope * slope;
        let clamped = if self.bias.clamp > 0.0 { bias.min(self.bias.clamp) } else { bias };
        view.depth_sign * clamped
    }

    /// All world points within `bounds` that a view's map position looks along, nearest to the light first.
    #[must_use]
    pub fn ray_through(&self, view: usize, position_in_texels: DVec2, bounds: &Bounds) -> Option<Segment> {
        self.views[view].ray_through(position_in_texels, bounds)
    }

    /// The uniform of the shader.
    #[must_use]
    pub(super) fn uniform(&self, kernel: &Kernel) -> LookupUniform {
        let (fixed_step, float_step) = match self.format {
            DepthFormat::Depth32Float => (0.0, f32::EPSILON),
            fixed => (fixed.step(1.0) as f32, 0.0),
        };
        LookupUniform {
            light: self.light.as_vec4().to_array(),
            texels: self.texels().as_vec2().to_array(),
            kernel: kernel.number,
            seam: self.seam as u32,
            border: self.border as u32,
            closed_form_kernel: self.bias.closed_form_kernel as f32,
            raster_slack_texels: raster_slack_texels(self.texels().max_element()) as f32,
            cap_texels: self.bias.cap_texels as f32,
            normal_texels: self.bias.normal_texels as f32,
            depth_m: self.bias.depth_m as f32,
            fixed_step,
            float_step,
            reaches_by_tap: self.reaches_by_tap.into(),
            turns: kernel.turns.into(),
            seed: kernel.seed,
            padding: 0,
        }
    }
}

/// `Lookup` of `shaders/map/lookup.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(super) struct LookupUniform {
    light: [f32; 4],
    texels: [f32; 2],
    kernel: u32,
    seam: u32,
    border: u32,
    closed_form_kernel: f32,
    raster_slack_texels: f32,
    cap_texels: f32,
    normal_texels: f32,
    depth_m: f32,
    fixed_step: f32,
    float_step: f32,
    reaches_by_tap: u32,
    turns: u32,
    seed: u32,
    padding: u32,
}

#[cfg(test)]
mod tests {
    use super::LookupUniform;
    use crate::gpu::layout::{rust_layout, wgsl_layout};
    use crate::technique::map::projection::GpuView;
    use crate::technique::map::shader_modules;

    #[test]
    fn the_uniforms_lie_as_the_shaders_read_them() {
        let lookups: Vec<_> =
            shader_modules().into_iter().filter(|(label, _)| label.starts_with("map lookup")).collect();
        assert!(!lookups.is_empty());
        for (label, files) in lookups {
            let in_rust = rust_layout!(LookupUniform {
                light,
                texels,
                kernel,
                seam,
                border,
                closed_form_kernel,
                raster_slack_texels,
                cap_texels,
                normal_texels,
                depth_m,
                fixed_step,
                float_step,
                reaches_by_tap,
                turns,
                seed,
                padding,
            });
            assert_eq!(wgsl_layout(&files, "Lookup"), in_rust, "{label}");
            let in_rust = rust_layout!(GpuView {
                u_row,
                v_row,
                q_row,
                depth_row,
                depth_q_row,
                selector,
                depth_sign,
                blend_per_m,
                padding
            });
            assert_eq!(wgsl_layout(&files, "View"), in_rust, "{label}");
        }
    }
}
