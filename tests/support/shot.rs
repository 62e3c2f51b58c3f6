//! A shot: one light of one scene on the one device of a test's process, with its truth, ready to be evaluated often.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "tests fail by panicking"
)]

use super::scenes::folder_of;
use glam::{DVec2, UVec2};
use gnomon::cause::Cause;
use gnomon::evaluate::{Effort, EvaluateError, Evaluation, Question, View, evaluate};
use gnomon::gpu::Gpu;
use gnomon::mask::Truth;
use gnomon::receiver::Receiver;
use gnomon::scene::{LoadOptions, Scene, SceneError, load};
use gnomon::technique::map::Lookup;
use gnomon::technique::{Spec, TechniqueError, Unsupported};
use gnomon::watch::Unwatched;
use std::sync::LazyLock;

static GPU: LazyLock<Gpu> = LazyLock::new(super::scenes::gpu);

/// See the module.
pub(crate) struct Shot<'s> {
    pub(crate) view: View<'s>,
    pub(crate) question: Question<'s>,
}

impl<'s> Shot<'s> {
    pub(crate) fn new(scene: &'s Scene, light: &str) -> Self {
        let view = View::new(&GPU, scene).expect("the scene fits the device");
        let question = super::scenes::ask(&view, light);
        Self { view, question }
    }

    /// What a technique answers, and why it is wrong.
    pub(crate) fn evaluate(&self, typed: &str) -> Evaluation<'_> {
        self.evaluate_spec(&parsed(typed))
    }

    pub(crate) fn evaluate_spec(&self, spec: &Spec) -> Evaluation<'_> {
        evaluate(&self.view, &self.question, spec, Effort::CAUSES, &Unwatched)
            .unwrap_or_else(|error| panic!("{}: {error}", spec.short()))
    }

    /// The specification; a lamp with receivers all around gets a frustum that cuts some of them off.
    pub(crate) fn supported(&self, typed: &str) -> Spec {
        let (spec, default) = (parsed(typed), parsed("map"));
        match default.technique().supports(&default, self.view.scene, self.question.light, &GPU) {
            Ok(()) => spec,
            Err(_) => spec.with("fov_deg", "120").unwrap_or(spec),
        }
    }

    /// What a technique answers; `None` if it does not for this light.
    pub(crate) fn evaluate_if_supported(&self, spec: &Spec) -> Option<Evaluation<'_>> {
        match evaluate(&self.view, &self.question, spec, Effort::CAUSES, &Unwatched) {
            Ok(evaluation) => Some(evaluation),
            Err(EvaluateError::Technique(TechniqueError::Unsupported(_))) => None,
            Err(error) => panic!("{}: {error}", spec.short()),
        }
    }

    /// Why a technique does not answer for this light; `None` if it does.
    pub(crate) fn refusal(&self, spec: &Spec) -> Option<Unsupported> {
        match evaluate(&self.view, &self.question, spec, Effort::VERDICT, &Unwatched) {
            Ok(_) => None,
            Err(EvaluateError::Technique(TechniqueError::Unsupported(why))) => Some(why),
            Err(error) => panic!("{}: {error}", spec.short()),
        }
    }

    /// The pixels that are asked and decided.
    pub(crate) fn asked(&self) -> Vec<u32> {
        let is_known = |truth: &Option<Truth>| matches!(truth, Some(Truth::Known(_)));
        let truths = (0_u32..).zip(&self.question.truth.mask.pixels);
        truths.filter(|(_, truth)| is_known(truth)).map(|(pixel, _)| pixel).collect()
    }
}

pub(crate) fn parsed(typed: &str) -> Spec {
    Spec::parse(typed).expect("a legal specification")
}

/// Every scene in `scenes/` in the order of their names. One whose meshes were not fetched is left out, and told.
pub(crate) fn shipped_scenes(size: UVec2) -> Vec<Scene> {
    let entries = std::fs::read_dir(folder_of("")).expect("the scenes folder");
    let mut names: Vec<String> =
        entries.map(|entry| entry.expect("readable").file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names.iter().filter_map(|name| shipped_if_fetched(name, size)).collect()
}

/// A scene of `scenes/`; `None`, and a line that says so, if its meshes were not fetched.
pub(crate) fn shipped_if_fetched(name: &str, size: UVec2) -> Option<Scene> {
    match load(&folder_of(name), &LoadOptions { size: Some(size), ..LoadOptions::default() }) {
        Ok(scene) => Some(scene),
        Err(error @ SceneError::Reference { .. }) => {
            println!("skipped: scene '{name}': {error}");
            None
        }
        Err(error) => panic!("scene '{name}': {error}"),
    }
}

/// Wrong pixels of an evaluation that bear one of these causes.
pub(crate) fn named(evaluation: &Evaluation<'_>, causes: &[Cause]) -> Vec<u32> {
    let of_cause = evaluation.ledger.wrong.iter().filter(|(_, cause)| causes.contains(cause));
    of_cause.map(|(pixel, _)| *pixel).collect()
}

/// The truth at the place where a lookup's texel has its centre, on the receiver's plane.
pub(crate) fn lit_at_texel_centre(shot: &Shot<'_>, lookup: &Lookup, receiver: &Receiver) -> bool {
    let site = lookup.project(receiver.point_in_world).expect("inside a face");
    let at = site.position_in_texels();
    let [along_u, along_v] = site.texel_steps_m(receiver.normal_in_world);
    let aside = at.floor() + 0.5 - at;
    let point = receiver.point_in_world + aside.x * along_u + aside.y * along_v;
    let segment = shot.question.light.segment_from(point, shot.view.scene.bounds().radius());
    shot.view.casters.any_hit(&segment, Some(receiver.triangle)).is_none()
}

/// The mean truth at the places on the receiver's plane where the texels of a kernel around it have their centres, as
/// if its face had no sides; `None` in a corner of the room, where the plane ends.
pub(crate) fn lit_over_kernel(shot: &Shot<'_>, lookup: &Lookup, receiver: &Receiver, taps: i32) -> Option<f64> {
    let view = lookup.select(receiver.point_in_world).first;
    let own = lookup.project(receiver.point_in_world).expect("inside a face").position_in_texels().floor();
    let bounds = shot.view.scene.bounds();
    let normal = receiver.normal_in_world;
    let mut lit = 0.0;
    for (row, column) in (0..taps).flat_map(|row| (0..taps).map(move |column| (row, column))) {
        let aside = DVec2::new(column.into(), row.into()) - f64::from(taps / 2) + 0.5;
        let ray = lookup.ray_through(view, own + aside, &bounds).expect("through the room");
        let along = ray.to - ray.from;
        let point = ray.from + along * (normal.dot(receiver.point_in_world - ray.from) / normal.dot(along));
        if point.clamp(bounds.min, bounds.max).distance(point) > 1e-6 {
            return None;
        }
        let segment = shot.question.light.segment_from(point, bounds.radius());
        lit += f64::from(u8::from(shot.view.casters.any_hit(&segment, Some(receiver.triangle)).is_none()));
    }
    Some(lit / f64::from(taps * taps))
}
