//! What most commands begin with: the scene, the lights asked about, the device.

use super::args::SceneArgs;
use super::terminal::complain;
use crate::evaluate::View;
use crate::gpu::Gpu;
use crate::receiver::PixelClass;
use crate::scene::{self, Light, LoadOptions, Scene};
use crate::suggest::hint;
use crate::technique::{Prepared, Spec};
use anyhow::{Context, bail};
use glam::UVec2;
use std::path::Path;

/// Loads a scene and tells its warnings.
pub(super) fn load(path: &Path, size: Option<UVec2>) -> anyhow::Result<Scene> {
    let scene = scene::load(path, &LoadOptions { size, ..LoadOptions::default() })?;
    for warning in &scene.warnings {
        complain(&format!("warning: scene '{}': {warning}", scene.name));
    }
    Ok(scene)
}

/// Opens the device.
pub(super) fn open_gpu() -> anyhow::Result<Gpu> {
    Gpu::open().context("opening the graphics device")
}

/// The lights to look at: the named one, or all.
pub(super) fn lights<'s>(scene: &'s Scene, name: Option<&str>) -> anyhow::Result<Vec<&'s Light>> {
    let Some(name) = name else { return Ok(scene.lights.iter().collect()) };
    match scene.light(name) {
        Some(light) => Ok(vec![light]),
        None => {
            let names: Vec<&str> = scene.lights.iter().map(|light| light.name.as_str()).collect();
            let hint = hint(name, names.iter().copied());
            bail!("scene '{}' has no light '{name}'{hint}; it has {}", scene.name, names.join(", "))
        }
    }
}

/// A technique for a command that cannot go on without it.
pub(super) fn prepare<'j>(
    spec: &Spec,
    view: &'j View<'_>,
    light: &'j Light,
    classes: &'j [PixelClass],
) -> anyhow::Result<Box<dyn Prepared + 'j>> {
    let prepared = spec.technique().prepare(spec, view.job(light, classes));
    prepared.with_context(|| format!("'{}' cannot answer for light '{}'", spec.short(), light.name))
}

/// The one light of a command that writes one file.
pub(super) fn only_light<'s>(scene: &'s Scene, args: &SceneArgs) -> anyhow::Result<&'s Light> {
    match lights(scene, args.light.as_deref())?.as_slice() {
        [light] => Ok(light),
        many => {
            let names: Vec<&str> = many.iter().map(|light| light.name.as_str()).collect();
            bail!("scene '{}' has several lights: choose one with --light {}", scene.name, names.join(" or --light "))
        }
    }
}
