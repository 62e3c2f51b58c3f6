//! Evaluations for tests: the shipped scenes, and scenes of a test's own, judged on one device.

#![allow(dead_code, reason = "every test uses its own share")]
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "tests fail by panicking"
)]

use glam::UVec2;
use gnomon::cause::Cause;
use gnomon::evaluate::{Effort, Evaluation, Question, View, evaluate};
use gnomon::gpu::Gpu;
use gnomon::mask::Truth;
use gnomon::scene::{Light, LoadOptions, Scene, SceneError, load};
use gnomon::technique::Spec;
use gnomon::watch::Unwatched;
use std::path::Path;
use std::sync::LazyLock;

static GPU: LazyLock<Gpu> = LazyLock::new(|| Gpu::open().expect("an adapter: `gnomon doctor` says what is missing"));

/// One light of one scene, with its truth.
pub(crate) struct Shot<'s> {
    pub(crate) view: View<'s>,
    pub(crate) question: Question<'s>,
}

impl<'s> Shot<'s> {
    pub(crate) fn new(scene: &'s Scene, light: &'s Light) -> Self {
        let view = View::new(&GPU, scene).expect("the scene fits the device");
        let question = view.ask(light, &Unwatched).expect("nobody stops it");
        Self { view, question }
    }

    /// What a technique answers, and why it is wrong.
    pub(crate) fn evaluate(&self, spec: &str) -> Evaluation<'_> {
        self.evaluate_spec(&parsed(spec))
    }

    pub(crate) fn evaluate_spec(&self, spec: &Spec) -> Evaluation<'_> {
        evaluate(&self.view, &self.question, spec, Effort::CAUSES, &Unwatched)
            .unwrap_or_else(|error| panic!("{}: {error}", spec.short()))
    }

    /// The pixels that are asked and decided.
    pub(crate) fn asked(&self) -> Vec<u32> {
        let is_known = |truth: &Option<Truth>| matches!(truth, Some(Truth::Known(_)));
        let truths = (0_u32..).zip(&self.question.truth.mask.pixels);
        truths.filter(|(_, truth)| is_known(truth)).map(|(pixel, _)| pixel).collect()
    }

    /// The specification; a lamp with receivers all around gets a frustum that cuts some of them off.
    pub(crate) fn supported(&self, spec: &str) -> Spec {
        let (spec, default) = (parsed(spec), parsed("map"));
        match default.technique().supports(&default, self.view.scene, self.question.light, &GPU) {
            Ok(()) => spec,
            Err(_) => spec.with("fov_deg", "120").expect("a legal angle"),
        }
    }
}

pub(crate) fn parsed(spec: &str) -> Spec {
    Spec::parse(spec).expect("a legal specification")
}

/// Every scene in `scenes/` whose meshes are there, in the order of their names. A scene left out is told.
pub(crate) fn shipped_scenes(size: UVec2) -> Vec<Scene> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes");
    let entries = std::fs::read_dir(folder).expect("the scenes folder");
    let mut names: Vec<String> =
        entries.map(|entry| entry.expect("readable").file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names.iter().filter_map(|name| shipped_if_fetched(name, size)).collect()
}

/// A scene of `scenes/` that needs nothing fetched.
pub(crate) fn shipped(name: &str, size: UVec2) -> Scene {
    shipped_if_fetched(name, size).expect("a scene of the repository")
}

/// A scene of `scenes/`; `None`, and a line that says so, if its meshes were not fetched.
pub(crate) fn shipped_if_fetched(name: &str, size: UVec2) -> Option<Scene> {
    let path = format!("{}/scenes/{name}", env!("CARGO_MANIFEST_DIR"));
    let options = LoadOptions { size: Some(size), ..LoadOptions::default() };
    match load(Path::new(&path), &options) {
        Ok(scene) => Some(scene),
        Err(error @ SceneError::Reference { .. }) => {
            println!("skipped: scene '{name}': {error}");
            None
        }
        Err(error) => panic!("scene '{name}': {error}"),
    }
}

/// A scene from the text of a scene file and of its one mesh, `model.obj`.
pub(crate) fn written(scene_file: &str, model: &str) -> Scene {
    let folder = tempfile::TempDir::new().expect("a temporary folder");
    std::fs::write(folder.path().join("scene.toml"), scene_file).expect("writable");
    std::fs::write(folder.path().join("model.obj"), model).expect("writable");
    load(folder.path(), &LoadOptions::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// Wrong pixels of an evaluation that bear one of these causes.
pub(crate) fn named(evaluation: &Evaluation<'_>, causes: &[Cause]) -> Vec<u32> {
    let of_cause = evaluation.ledger.wrong.iter().filter(|(_, cause)| causes.contains(cause));
    of_cause.map(|(pixel, _)| *pixel).collect()
}
