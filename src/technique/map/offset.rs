//! How far a comparison is moved: along the light, along the receiver's normal, and by the rasteriser. This f64 twin is
//! the specification of `shaders/map/offset.wgsl`: same names, same order. Formulas: docs/map.md#bias.

use super::bias::Clearance;
use super::lookup::Lookup;
use super::projection::{Site, View};
use glam::{DVec2, DVec3};

/// Format steps that a closed-form bias adds for the rounding of both sides of the comparison.
const FORMAT_STEPS: f64 = 4.0;

impl Lookup {
    /// How many texels away the reference must clear the receiver's plane: those that neither the move along the normal
    /// nor the plane's own depth takes care of.
    pub(super) fn own_reach_texels(&self) -> f64 {
        if self.bias.clearance == Clearance::ClosedForm { self.bias.kernel } else { 0.0 }
    }

    pub(super) fn moved_along_normal(&self, view: usize, point_in_world: DVec3, normal_in_world: DVec3) -> DVec3 {
        point_in_world + normal_in_world * self.normal_offset_m(view, point_in_world, normal_in_world)
    }

    /// The rasteriser snaps vertices to a grid, which shifts a plane's depths by up to a step of its slope; interpolation adds
    /// up to four units of 2⁻²⁴ per texel from the map's corner.
    pub(super) fn raster_slack_texels(&self) -> f64 {
        self.vertex_step_texels + 4.0 * f64::from(self.texels().max_element()) * 2.0_f64.powi(-24)
    }

    /// How far a receiver is moved along its normal.
    #[must_use]
    pub fn normal_offset_m(&self, view: usize, point_in_world: DVec3, normal_in_world: DVec3) -> f64 {
        let clears_plane = self.bias.clearance == Clearance::Normal;
        if self.bias.normal_texels == 0.0 && !clears_plane {
            return 0.0;
        }
        let site = self.views[view].site(point_in_world);
        let towards_light = (self.light.truncate() - point_in_world * self.light.w).normalize_or_zero();
        let sine = normal_in_world.cross(towards_light).length();
        let typed = self.bias.normal_texels * site.texel_m().max_element() * sine;
        let derived = if clears_plane {
            self.bias.kernel * site.normal_offset_per_texel_m(normal_in_world).element_sum()
        } else {
            0.0
        };
        typed + derived
    }

    /// How far the comparison is moved towards the light, in units of depth.
    pub(super) fn bias_depth(&self, site: &Site<'_>, normal_in_world: DVec3, reach_texels: DVec2) -> f64 {
        let typed_m = self.bias.depth_m + self.bias.depth_texels * site.texel_m().max_element();
        let along_light = typed_m / site.metres_per_depth();
        if matches!(self.bias.clearance, Clearance::None | Clearance::Midpoint) {
            return along_light;
        }
        along_light + self.closed_form(site, normal_in_world, reach_texels)
    }

    /// The most that is derived from the receiver's plane, in units of depth.
    pub(super) fn cap_depth(&self, site: &Site<'_>) -> f64 {
        self.bias.cap_texels * site.texel_m().max_element() / site.metres_per_depth()
    }

    /// The closed-form bias: what suffices, but no more than the cap (docs/map.md#bias), in units of depth.
    #[must_use]
    pub fn closed_form(&self, site: &Site<'_>, normal_in_world: DVec3, reach_texels: DVec2) -> f64 {
        self.sufficient_bias(site, normal_in_world, reach_texels).min(self.cap_depth(site))
    }

    /// The bias that the receiver's own slope needs for texels up to that far away, in units of depth.
    #[must_use]
    pub fn sufficient_bias(&self, site: &Site<'_>, normal_in_world: DVec3, reach_texels: DVec2) -> f64 {
        let slope_per_texel = site.slope_per_texel(normal_in_world);
        let reach = reach_texels + self.raster_slack_texels();
        reach.dot(slope_per_texel)
            + site.slack(normal_in_world, slope_per_texel, reach_texels)
            + FORMAT_STEPS * self.format.step(site.at.depth)
    }

    /// What the rasteriser adds to the depth of a triangle at a point of it: its constant and slope, away from the light.
    #[must_use]
    pub fn hardware_bias(&self, view: usize, corners_in_world: [DVec3; 3], point_in_world: DVec3) -> f64 {
        if self.bias.constant_units == 0 && self.bias.slope == 0.0 {
            return 0.0;
        }
        let pancaked = self.pancaked(view, corners_in_world);
        let (view, [a, b, c]) = (&self.views[view], corners_in_world);
        let depth_of = |corner: DVec3| view.project(corner).depth.clamp(0.0, 1.0);
        let largest = depth_of(a).max(depth_of(b)).max(depth_of(c));
        let site = match pancaked {
            Some(pancaked) => pancaked.site(view, point_in_world),
            None => view.site(point_in_world),
        };
        let slope = site.slope_per_texel((b - a).cross(c - a).normalize_or_zero()).max_element();
        self.rasteriser_bias(view, largest, slope)
    }

    /// What the rasteriser adds to the depth of a triangle, given its largest depth and its slope per texel.
    #[must_use]
    pub(super) fn rasteriser_bias(&self, view: &View, largest: f64, slope: f64) -> f64 {
        let constant = f64::from(self.bias.constant_units) * self.format.hardware_unit(largest);
        let bias = constant + self.bias.slope * slope;
        let clamped = if self.bias.clamp > 0.0 { bias.min(self.bias.clamp) } else { bias };
        view.depth_sign * clamped
    }
}
