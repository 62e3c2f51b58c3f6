//! Scenes as texts, loaded or refused.

use gnomon::scene::{LoadOptions, Scene, load};
use std::{fs, path::Path};
use tempfile::TempDir;

pub(crate) const SCENE: &str = r#"about = "a tetrahedron over a floor"
size = [64, 48]
[camera]
eye = [0, 3, 6]
target = [0, 0.5, 0]
[[mesh]]
file = "model.obj"
[[light]]
name = "lamp"
kind = "point"
position = [2, 5, 1]
"#;

/// A closed tetrahedron wound outward, and a floor of one quad.
pub(crate) const MODEL: &str = "\
o Tetra
v 1 0.5 1
v -1 0.5 1
v 0 0.5 -1
v 0 2 0
f 1 2 3
f 1 4 2
f 2 4 3
f 3 4 1
o Floor
v -4 0 -4
v -4 0 4
v 4 0 4
v 4 0 -4
f 5 6 7 8
";

/// A folder with `scene.toml` and `model.obj`.
pub(crate) fn folder(scene: &str, model: &str) -> TempDir {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("scene.toml"), scene).unwrap();
    fs::write(folder.path().join("model.obj"), model).unwrap();
    folder
}

pub(crate) fn load_texts(scene: &str, model: &str) -> Result<Scene, String> {
    load_folder(folder(scene, model).path(), &LoadOptions::default())
}

pub(crate) fn load_folder(folder: &Path, options: &LoadOptions) -> Result<Scene, String> {
    load(folder, options).map_err(|e| e.to_string().replace(&format!("{}/", folder.display()), ""))
}

/// `SCENE` with one line replaced, which must exist.
pub(crate) fn edited(from: &str, to: &str) -> String {
    assert!(SCENE.contains(from), "{from}");
    SCENE.replace(from, to)
}

pub(crate) fn refusal(scene: &str, model: &str) -> String {
    load_texts(scene, model).expect_err("must be refused")
}

pub(crate) fn assert_refused(scene: &str, model: &str, place: &str, words: &[&str]) {
    let message = refusal(scene, model);
    assert!(message.starts_with(place), "`{place}` does not start: {message}");
    for word in words {
        assert!(message.contains(word), "`{word}` is not in: {message}");
    }
}

/// Six times the signed volume: positive for outward windings.
pub(crate) fn signed_volume(scene: &Scene, mesh: usize) -> f64 {
    let corners = scene.meshes[mesh].triangles.clone().map(|t| scene.triangle_in_world(t));
    corners.map(|[a, b, c]| a.dot(b.cross(c))).sum()
}
