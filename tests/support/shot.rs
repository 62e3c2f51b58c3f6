//! A shot: one light of one scene on the one device of a test's process, with its truth, ready to be evaluated often.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "tests fail by panicking"
)]

use super::scenes::folder_of;
use glam::UVec2;
use gnomon::cause::Cause;
use gnomon::evaluate::{Effort, EvaluateError, Evaluation, Question, View, evaluate};
use gnomon::gpu::Gpu;
use gnomon::mask::Truth;
use gnomon::scene::{LoadOptions, Scene, SceneError, load};
use gnomon::technique::{Spec, TechniqueError};
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
