//! What most commands begin with: the scene, the lights asked about, the device.

use super::args::{OracleChoice, SceneArgs};
use super::terminal::{Terminal, complain};
use crate::evaluate::{Question, View};
use crate::gpu::Gpu;
use crate::receiver::PixelClass;
use crate::scene::{self, Light, LoadOptions, Scene};
use crate::suggest::hint;
use crate::technique::{Prepared, Spec};
use crate::truth::mitsuba::{Mitsuba, MitsubaCheck};
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

/// Mitsuba with the scene's casters, if the choice needs it.
pub(super) fn mitsuba_for(choice: OracleChoice, view: &View<'_>) -> anyhow::Result<Option<Mitsuba>> {
    let wanted = choice != OracleChoice::Exact;
    Ok(wanted.then(|| Mitsuba::new(view.scene, &view.casters)).transpose()?)
}

/// The question about one light, answered by the oracles chosen.
pub(super) fn ask<'s>(
    view: &View<'s>,
    light: &'s Light,
    choice: OracleChoice,
    mitsuba: Option<&mut Mitsuba>,
    terminal: &Terminal,
) -> anyhow::Result<Question<'s>> {
    let mut question = view.ask(light, terminal)?;
    let Some(mitsuba) = mitsuba else { return Ok(question) };
    let asked = mitsuba.check(view.scene, &view.casters, light, &view.receivers, &question.classes, terminal).and_then(
        |check| {
            let estimate = mitsuba.estimate(view.scene, &view.casters, light, &view.receivers, &question.truth.mask)?;
            Ok(MitsubaCheck { estimate, ..check })
        },
    );
    // Ctrl-C ends Mitsuba as well, which then gives no answer.
    terminal.proceed()?;
    let check = asked?;
    if choice == OracleChoice::Mitsuba {
        return Ok(question.answered_by(check));
    }
    question.mitsuba = Some(check);
    Ok(question)
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
