//! A world point as a view sees it, with how the map's coordinates change around it: texel widths, metres per depth and
//! slopes all come from these gradients, so they hold for every projection. Twin of `shaders/map/view.wgsl`.
//!
//! B. Lloyd et al., "Warping and Partitioning for Low Error Shadow Maps", 2006, derive texel sizes likewise.

use super::view::{Gradients, InMap, View};
use glam::{DVec2, DVec3};

/// Change per texel beyond which every bias is at its cap.
const STEEPEST: f64 = 1e3;

/// What is left of a place's divisor, at least; with less its plane is seen edge-on there.
const LEAST_SHARE: f64 = 1e-3;

/// How much depth changes over some texels, given how fast it changes and bends per texel. On a plane the world is affine in
/// the map but for a divisor, and so is depth, but for the ratio of that and its own.
#[must_use]
pub fn bent(change_per_texel: DVec2, bend_per_texel: DVec2, texels: DVec2) -> f64 {
    change_per_texel.dot(texels) / (1.0 - bend_per_texel.dot(texels)).max(LEAST_SHARE)
}

/// See the module.
#[derive(Debug, Clone, Copy)]
pub struct Site<'v> {
    /// The view.
    pub view: &'v View,
    /// The point.
    pub point_in_world: DVec3,
    /// Where it lies.
    pub at: InMap,
    /// How that changes with the point.
    pub gradients: Gradients,
}

impl Site<'_> {
    /// uv × texels.
    #[must_use]
    pub fn position_in_texels(&self) -> DVec2 {
        self.at.uv * self.view.texels.as_dvec2()
    }

    /// Along the light's ray, where u and v do not change; not normalised.
    fn ray(&self) -> DVec3 {
        self.gradients.u.cross(self.gradients.v)
    }

    /// Width and height of a texel in metres, across the light's ray.
    #[must_use]
    pub fn texel_m(&self) -> DVec2 {
        let Gradients { u, v, .. } = self.gradients;
        DVec2::new(v.length(), u.length()) / (self.ray().length() * self.view.texels.as_dvec2())
    }

    /// Metres along the light's ray per unit of depth.
    #[must_use]
    pub fn metres_per_depth(&self) -> f64 {
        let ray = self.ray();
        ray.length() / self.gradients.depth.dot(ray).abs()
    }

    /// World steps that move by one texel along u and along v on a plane through the point.
    #[must_use]
    pub fn texel_steps_m(&self, normal_in_world: DVec3) -> [DVec3; 2] {
        let Gradients { u, v, .. } = self.gradients;
        let volume = normal_in_world.dot(self.ray()) * self.view.texels.as_dvec2();
        [v.cross(normal_in_world) / volume.x, normal_in_world.cross(u) / volume.y]
    }

    /// Change of depth from one texel to the next along u and along v on a plane through the point.
    #[must_use]
    pub fn depth_per_texel(&self, normal_in_world: DVec3) -> DVec2 {
        self.change_per_texel(self.gradients.depth, normal_in_world)
    }

    /// The same of anything with a gradient, per metre.
    pub(super) fn change_per_texel(&self, gradient: DVec3, normal_in_world: DVec3) -> DVec2 {
        // A plane that the light sees edge-on gives infinity or NaN; both are "steepest".
        let bounded = |change: f64| if change.abs() < STEEPEST { change } else { STEEPEST };
        DVec2::from_array(self.texel_steps_m(normal_in_world).map(|step| bounded(gradient.dot(step))))
    }

    /// The same without sign.
    #[must_use]
    pub fn slope_per_texel(&self, normal_in_world: DVec3) -> DVec2 {
        self.depth_per_texel(normal_in_world).abs()
    }

    /// How far along its normal a plane through the point must move for its depth to change by what it changes from one
    /// texel to the next along u and along v. Bounded, even where the light sees the plane edge-on.
    #[must_use]
    pub fn normal_offset_per_texel_m(&self, normal_in_world: DVec3) -> DVec2 {
        let Gradients { u, v, depth } = self.gradients;
        let change = DVec2::new(normal_in_world.dot(depth.cross(v)), normal_in_world.dot(u.cross(depth))).abs();
        change / (depth.dot(self.ray()).abs() * self.view.texels.as_dvec2())
    }

    /// How fast depth bends away from its slope along u and along v on a plane through the point; see [`bent`].
    #[must_use]
    pub fn bend_per_texel(&self, normal_in_world: DVec3) -> DVec2 {
        self.view.layout.bend_per_texel(self, normal_in_world)
    }

    /// By how much texels up to `reach_texels` away may differ from its plane's slope.
    #[must_use]
    pub fn slack(&self, normal_in_world: DVec3, slope_per_texel: DVec2, reach_texels: DVec2) -> f64 {
        self.view.layout.slack(self, normal_in_world, slope_per_texel, reach_texels)
    }
}
