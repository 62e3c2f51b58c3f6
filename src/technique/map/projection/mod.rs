//! The projection axis: how the light's view is laid out in the map. A projection fits one or several [`View`]s, one
//! layer of the map each, and says which of them a receiver reads.
//!
//! Adding one: a file here, a WGSL file of the same stem in `shaders/map/projection/` that defines `select_views` unless
//! there is one view only, a line in [`registry`].

mod adaptive;
mod body;
mod cascaded;
mod clip;
mod cube;
mod drawn;
mod dual_paraboloid;
mod fit;
mod frustum;
mod homogeneous;
mod knobs;
mod light_space;
mod light_space_perspective;
mod pancaked;
mod paraboloid;
mod perspective;
mod pieces;
mod quadtree;
mod single;
mod site;
mod trapezoidal;
mod view;

pub(in crate::technique::map) use drawn::Drawn;
pub use frustum::{LightFrustum, Shape, Window};
pub use knobs::{Knobs, params};
pub(in crate::technique::map) use pancaked::Pancaked;
pub use site::{Site, bent};
pub(in crate::technique) use view::GpuView;
pub use view::{Gradients, InMap, Layout, Rows, View};

use super::Settings;
use super::Unsupported;
use crate::gpu::shader::{Wgsl, wgsl};
use crate::receiver::Receiver;
use crate::scene::{Light, Scene};
use crate::technique::TechniqueError;
use glam::DVec3;

/// Every projection.
#[must_use]
pub fn registry() -> &'static [&'static dyn Projection] {
    &[
        &single::Single,
        &cube::Cube,
        &dual_paraboloid::DualParaboloid,
        &cascaded::Cascaded,
        &perspective::Perspective,
        &trapezoidal::Trapezoidal,
        &light_space_perspective::LightSpacePerspective,
        &adaptive::Adaptive,
    ]
}

/// `select_views` of projections with one view.
const ONE_VIEW: Wgsl = wgsl!("map/projection/one_view.wgsl");

/// A layout of the light's view.
pub trait Projection: Sync {
    /// Its name in specifications.
    fn name(&self) -> &'static str;
    /// The WGSL that defines `select_views`.
    fn shader(&self) -> Wgsl;
    /// The WGSL of its views' layout.
    fn layout(&self) -> Wgsl {
        wgsl!("map/homogeneous.wgsl")
    }
    /// Whether its views can store distance from the light, along one axis or along the rays, in place of projected depth.
    fn has_linear_depth(&self) -> bool {
        false
    }
    /// Whether its depth is what the rasteriser makes of the corners' own, so that moving these moves it.
    fn has_rasterised_depth(&self) -> bool {
        true
    }
    /// Whether there is always one view only.
    fn has_one_view(&self) -> bool {
        self.shader() == ONE_VIEW
    }
    /// Whether its views look out from the light without a warp, so that a penumbra around a receiver has the light's shape.
    fn is_unwarped(&self) -> bool {
        false
    }
    /// Whether all its views measure depth alike, so that what one holds can be compared in another.
    fn shares_depth(&self) -> bool {
        self.has_one_view()
    }
    /// Whether it can hold this light's receivers.
    ///
    /// # Errors
    /// The typed reason why not.
    fn supports(&self, scene: &Scene, light: &Light, settings: &Settings) -> Result<(), Unsupported>;
    /// What it needs, in words, that only a fit can tell.
    fn needs_of_picture(&self) -> &'static [&'static str] {
        &[]
    }
    /// The views, at least one. `visible` are the asked receivers of the picture, for fits that follow the camera.
    ///
    /// # Errors
    /// The typed reason why none holds them.
    fn fit(
        &self,
        scene: &Scene,
        light: &Light,
        settings: &Settings,
        visible: &[DVec3],
    ) -> Result<Vec<View>, Unsupported>;
    /// Other views in place of the fitted ones, after a look at what some hold; `None` to keep those.
    ///
    /// # Errors
    /// As [`Projection::fit`], and what the device reported.
    fn refine(
        &self,
        _scene: &Scene,
        _light: &Light,
        _settings: &Settings,
        _scout: &dyn Scout,
    ) -> Result<Option<Refined>, TechniqueError> {
        Ok(None)
    }
    /// Side of each layer, texels.
    fn layer_texels(&self, settings: &Settings) -> u32 {
        settings.size
    }
    /// As many views as there may be.
    fn most_views(&self, _settings: &Settings) -> u32 {
        MOST_VIEWS
    }
    /// The views that answer for a world point; the f64 twin of `select_views`.
    fn select(&self, _views: &[View], _point_in_world: DVec3) -> Shares {
        Shares::one(0)
    }
    /// How far a world point is from where another view than `view`, which answers for it, would: texels of `view`.
    /// `None` where there is no other.
    fn seam_texels(&self, _views: &[View], _view: usize, _point_in_world: DVec3) -> Option<f64> {
        None
    }
}

/// Most views of projections that know how many they need: eight cascades.
const MOST_VIEWS: u32 = 8;

/// What a projection may ask before it settles on its views.
pub trait Scout {
    /// The receivers that are asked.
    fn receivers(&self) -> Vec<Receiver>;
    /// How large a texel of a view is in the picture at a receiver, pixels; `None` where the light sees it edge-on.
    fn m(&self, view: &View, receiver: &Receiver) -> Option<f64>;
    /// The depths of each of some views of equal size, drawn for the occasion: row by row.
    ///
    /// # Errors
    /// What the device reported.
    fn depths(&self, views: &[View]) -> Result<Vec<Vec<f64>>, TechniqueError>;
}

/// What a refinement came to.
#[derive(Debug, Clone)]
pub struct Refined {
    /// The views, at least one.
    pub views: Vec<View>,
    /// Label and value, for people.
    pub facts: Vec<(String, String)>,
}

/// Which views answer for a point, by index, and with which weights: one, or two that are blended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shares {
    /// The view that the point belongs to.
    pub first: usize,
    /// The view that it is blended with.
    pub second: usize,
    /// Weight of the second; the first has the rest.
    pub second_weight: f64,
}

impl Shares {
    /// One view alone.
    #[must_use]
    pub fn one(view: usize) -> Self {
        Self { first: view, second: view, second_weight: 0.0 }
    }

    /// Views of some weight.
    pub fn iter(self) -> impl Iterator<Item = (usize, f64)> {
        let both = [(self.first, 1.0 - self.second_weight), (self.second, self.second_weight)];
        both.into_iter().filter(|(_, weight)| *weight > 0.0)
    }
}

/// A registered projection; the first one for a name that no declared parameter can hold.
#[must_use]
pub fn by_name(name: &str) -> &'static dyn Projection {
    registry().iter().copied().find(|projection| projection.name() == name).unwrap_or(registry()[0])
}
