//! The projection axis: how the light's view is laid out in the map.
//!
//! Adding one: a file here and a line in [`registry`].

mod clip;
mod frustum;
mod single;

pub use frustum::{LightFrustum, Shape, Window};

use super::Settings;
use super::Unsupported;
use crate::scene::{Light, Scene};
use glam::DVec3;

/// Every projection.
#[must_use]
pub fn registry() -> &'static [&'static dyn Projection] {
    &[&single::Single]
}

/// A layout of the light's view.
pub trait Projection: Sync {
    /// Its name in specifications.
    fn name(&self) -> &'static str;
    /// Whether it can hold this light's receivers.
    ///
    /// # Errors
    /// The typed reason why not.
    fn supports(&self, scene: &Scene, light: &Light, settings: &Settings) -> Result<(), Unsupported>;
    /// The light's frustum. `visible` are the asked receivers of the picture, for fits that follow the camera.
    ///
    /// # Errors
    /// The typed reason why none holds them.
    fn fit(
        &self,
        scene: &Scene,
        light: &Light,
        settings: &Settings,
        visible: &[DVec3],
    ) -> Result<LightFrustum, Unsupported>;
}

/// A registered projection; the first one for a name that no declared parameter can hold.
#[must_use]
pub fn by_name(name: &str) -> &'static dyn Projection {
    registry().iter().copied().find(|projection| projection.name() == name).unwrap_or(registry()[0])
}
