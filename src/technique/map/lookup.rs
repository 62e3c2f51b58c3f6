//! One shadow-map lookup: select the view, place the receiver in it, guard, bias, compare. This f64 twin is the
//! specification of `shaders/map/lookup.wgsl`: same names, same order. Formulas: docs/map.md#lookup and docs/map.md#bias.

use super::bias::{Amounts, Clearance};
use super::filter::Kernel;
use super::projection::{Projection, Shares, Site, View, bent};
use super::settings::{Border, CasterSides, NearMode, Seam};
use super::{DepthFormat, Settings};
use crate::scene::{Bounds, Light, Segment};
use crate::technique::InView;
use bytemuck::{Pod, Zeroable};
use glam::{DVec2, DVec3, DVec4, IVec2, UVec2};

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
    pub(super) near_mode: NearMode,
    pub(super) caster_sides: CasterSides,
    pub(super) format: DepthFormat,
    pub(super) light: DVec4,
    /// Whether each tap is biased for as far as it is, not for the widest kernel.
    reaches_by_tap: bool,
    /// The grid that vertices of casters are snapped to.
    pub(super) vertex_step_texels: f64,
}

impl std::fmt::Debug for Lookup {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Lookup").field("projection", &self.projection.name()).field("views", &self.views).finish()
    }
}

/// What most devices have.
const USUAL_VERTEX_STEP: f64 = 1.0 / 256.0;

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
    /// By how much that changes from one texel to the next along u and along v.
    pub reference_per_texel: DVec2,
    /// How fast that bends.
    pub bend_per_texel: DVec2,
    /// By how much it changes at most.
    pub reference_reach: f64,
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

    /// The same with the reference of one texel of its view.
    #[must_use]
    pub fn at_texel(&self, texel: IVec2) -> Self {
        if self.reference_per_texel == DVec2::ZERO {
            return *self;
        }
        let away = texel.as_dvec2() + 0.5 - self.position_in_texels;
        let change = bent(self.reference_per_texel, self.bend_per_texel, away)
            .clamp(-self.reference_reach, self.reference_reach);
        Self { reference: (self.reference + change).clamp(0.0, 1.0), ..*self }
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
            vertex_step_texels: USUAL_VERTEX_STEP,
        }
    }

    /// The same for maps that a device draws which snaps vertices to a grid of that many texels.
    #[must_use]
    pub fn drawn_with_step(self, vertex_step_texels: f64) -> Self {
        Self { vertex_step_texels, ..self }
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

    /// Whether all views measure depth alike.
    #[must_use]
    pub(super) fn shares_depth(&self) -> bool {
        self.projection.shares_depth()
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

    /// The view that mainly answers for a receiver, and how far it is to its seam.
    #[must_use]
    pub fn in_view(&self, point_in_world: DVec3) -> InView {
        let view = self.select(point_in_world).first;
        InView { view, seam_texels: self.projection.seam_texels(&self.views, view, point_in_world) }
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
            Ok(_) | Err(_) => Ok(self.placed(view, moved, normal_in_world, DVec2::splat(self.own_reach_texels()))),
        }
    }

    /// A moved receiver in any view, with a bias for texels up to `reach_texels` away.
    fn placed(&self, view: usize, moved: DVec3, normal_in_world: DVec3, reach_texels: DVec2) -> Placed {
        let site = self.views[view].site(moved);
        let depth = if self.border == Border::ClampEdge { site.at.depth.clamp(0.0, 1.0) } else { site.at.depth };
        let reference = depth - site.view.depth_sign * self.bias_depth(&site, normal_in_world, reach_texels);
        let follows_plane = self.bias.clearance == Clearance::ReceiverPlane;
        Placed {
            view,
            point_in_world: moved,
            position_in_texels: site.position_in_texels(),
            depth,
            reference,
            reference_per_texel: if follows_plane { site.depth_per_texel(normal_in_world) } else { DVec2::ZERO },
            bend_per_texel: if follows_plane { site.bend_per_texel(normal_in_world) } else { DVec2::ZERO },
            reference_reach: self.cap_depth(&site),
        }
    }

    /// The texel of a placed receiver's view, or beyond the view's side what stands for it; `None` outside the map.
    #[must_use]
    pub fn tap(&self, placed: &Placed, normal_in_world: DVec3, texel: IVec2) -> Option<Tap> {
        let own = &self.views[placed.view];
        if own.holds(texel) {
            return Some(Tap { placed: self.placed_for(placed, normal_in_world, texel), texel });
        }
        let across = if self.seam == Seam::PerTap { self.tap_across(placed, normal_in_world, texel) } else { None };
        let is_clamped = self.seam == Seam::Clamp || self.border == Border::ClampEdge;
        across.or_else(|| {
            let nearest = own.layout.nearest_texel(texel, own.texels);
            is_clamped.then_some(Tap { placed: placed.at_texel(nearest), texel: nearest })
        })
    }

    /// A receiver with the reference that one of its view's texels is compared with: biased for as far as that is, where
    /// filters ask for it.
    fn placed_for(&self, placed: &Placed, normal_in_world: DVec3, texel: IVec2) -> Placed {
        if !self.reaches_by_tap || self.bias.clearance != Clearance::ClosedForm {
            return placed.at_texel(texel);
        }
        let reach_texels = (texel.as_dvec2() + 0.5 - placed.position_in_texels).abs().max(DVec2::splat(0.5));
        self.placed(placed.view, placed.point_in_world, normal_in_world, reach_texels)
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
        if view == placed.view || found.q <= 0.0 || site.at.q <= 0.0 || !self.views[view].holds(texel) {
            return None;
        }
        let is_on_plane = self.bias.clearance == Clearance::ReceiverPlane;
        let away = (texel.as_dvec2() + 0.5 - site.position_in_texels()).abs();
        let reach_texels = if is_on_plane { DVec2::ZERO } else { away };
        let placed = self.placed(view, placed.point_in_world, normal_in_world, reach_texels);
        Some(Tap { placed: placed.at_texel(texel), texel })
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

    /// Index of a texel, layer by layer and row by row, or `None` outside its view.
    #[must_use]
    pub fn texel_index(&self, view: usize, texel: IVec2) -> Option<u32> {
        let size = self.texels();
        let row = view as u32 * size.y + texel.y as u32;
        let is_inside = texel.min_element() >= 0 && texel.cmplt(size.as_ivec2()).all();
        is_inside.then(|| row * size.x + texel.x as u32)
    }

    /// View and texel of an index.
    #[must_use]
    pub fn texel_of(&self, index: u32) -> (usize, UVec2) {
        let size = self.texels();
        let row = index / size.x;
        ((row / size.y) as usize, UVec2::new(index % size.x, row % size.y))
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
            clearance: self.bias.clearance as u32,
            bias_kernel: self.bias.kernel as f32,
            raster_slack_texels: self.raster_slack_texels() as f32,
            cap_texels: self.bias.cap_texels as f32,
            normal_texels: self.bias.normal_texels as f32,
            depth_m: self.bias.depth_m as f32,
            depth_texels: self.bias.depth_texels as f32,
            fixed_step,
            float_step,
            reaches_by_tap: self.reaches_by_tap.into(),
            turns: kernel.turns.into(),
            seed: kernel.seed,
            pattern_radius_texels: kernel.pattern_radius_texels as f32,
            mask_level: kernel.mask_level,
            shares_depth: self.shares_depth().into(),
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
    clearance: u32,
    bias_kernel: f32,
    raster_slack_texels: f32,
    cap_texels: f32,
    normal_texels: f32,
    depth_m: f32,
    depth_texels: f32,
    fixed_step: f32,
    float_step: f32,
    reaches_by_tap: u32,
    turns: u32,
    seed: u32,
    pattern_radius_texels: f32,
    mask_level: u32,
    shares_depth: u32,
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
                clearance,
                bias_kernel,
                raster_slack_texels,
                cap_texels,
                normal_texels,
                depth_m,
                depth_texels,
                fixed_step,
                float_step,
                reaches_by_tap,
                turns,
                seed,
                pattern_radius_texels,
                mask_level,
                shares_depth,
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
                edge_rad,
                padding
            });
            assert_eq!(wgsl_layout(&files, "View"), in_rust, "{label}");
        }
    }
}
