//! Scenes for tests: those shipped under `scenes/`, ones written on the spot and ones changed in memory; and how a
//! technique does on them.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

use glam::{UVec2, Vec3};
use gnomon::evaluate::{Effort, Evaluation, Question, View, evaluate};
use gnomon::gpu::Gpu;
use gnomon::mask::{Mask, Truth, TruthMask, Visibility};
use gnomon::scene::{LoadOptions, Mesh, Placement, Scene, load};
use gnomon::technique::Spec;
use gnomon::verdict::{Verdict, WRONG_ABOVE_HARD, judge};
use gnomon::watch::Unwatched;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// The folder of a shipped scene.
pub(crate) fn folder_of(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name)
}

/// A shipped scene as its file places it, `size` pixels large.
pub(crate) fn shipped(name: &str, size: [u32; 2]) -> Scene {
    placed(name, size, Placement::default())
}

/// A shipped scene, placed.
pub(crate) fn placed(name: &str, size: [u32; 2], placement: Placement) -> Scene {
    load(&folder_of(name), &LoadOptions { size: Some(UVec2::from_array(size)), placement }).unwrap()
}

/// A folder with these files, by name.
pub(crate) fn written(files: &[(&str, &str)]) -> TempDir {
    let folder = TempDir::new().unwrap();
    for (name, text) in files {
        fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}

/// The scene of a `scene.toml` and a `model.obj` with these texts.
pub(crate) fn scene_of_texts(scene: &str, model: &str) -> Scene {
    let folder = written(&[("scene.toml", scene), ("model.obj", model)]);
    load(folder.path(), &LoadOptions::default()).unwrap()
}

/// The scene with one more mesh of unconnected triangles, which casts and receives.
pub(crate) fn with_triangles(scene: &Scene, corners: &[[Vec3; 3]]) -> Scene {
    let mut scene = scene.clone();
    let (first_vertex, first_triangle) = (scene.positions.len() as u32, scene.triangles.len() as u32);
    scene.positions.extend(corners.as_flattened());
    scene.triangles.extend((0..corners.len() as u32).map(|i| [0, 1, 2].map(|corner| first_vertex + 3 * i + corner)));
    scene.corner_normals.resize(scene.triangles.len(), [Vec3::Y; 3]);
    scene.triangle_material.resize(scene.triangles.len(), 0);
    let triangles = first_triangle..scene.triangles.len() as u32;
    scene.meshes.push(Mesh { name: "added".into(), triangles, casts: true, receives: true });
    scene
}

/// An open device. Every machine that runs the tests has one: `make test` installs a software driver where none answers.
pub(crate) fn gpu() -> Gpu {
    Gpu::open().unwrap()
}

/// The question about the light of that name.
pub(crate) fn ask<'s>(view: &View<'s>, light: &str) -> Question<'s> {
    view.ask(view.scene.light(light).unwrap(), &Unwatched).unwrap()
}

/// A technique's answer to a question, with the causes of its errors.
pub(crate) fn explained<'v>(view: &'v View<'_>, question: &'v Question<'v>, typed: &str) -> Evaluation<'v> {
    evaluate(view, question, &Spec::parse(typed).unwrap(), Effort::CAUSES, &Unwatched).unwrap()
}

/// A technique's answer to a question, judged only.
pub(crate) fn judged<'v>(view: &'v View<'_>, question: &'v Question<'v>, typed: &str) -> Evaluation<'v> {
    evaluate(view, question, &Spec::parse(typed).unwrap(), Effort::VERDICT, &Unwatched).unwrap()
}

/// Any mask judged by the truth of a question.
pub(crate) fn verdict_on(mask: &Mask, question: &Question<'_>) -> Verdict {
    judge(&question.classes, &question.truth.mask, mask, WRONG_ABOVE_HARD).unwrap()
}

/// The truth as an answer: lit where it is undecided.
pub(crate) fn as_mask(truth: &TruthMask) -> Mask {
    let answer = |truth: &Truth| match truth {
        Truth::Known(visibility) => *visibility,
        Truth::Undecided => Visibility::LIT,
    };
    Mask { size: truth.size, pixels: truth.pixels.iter().map(|truth| truth.as_ref().map(answer)).collect() }
}

/// How many pixels the truth knows to be in shadow.
pub(crate) fn shadowed(truth: &TruthMask) -> usize {
    truth.pixels.iter().filter(|truth| **truth == Some(Truth::Known(Visibility::SHADOW))).count()
}
