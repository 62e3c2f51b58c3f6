//! Loading: from a path to a [`Scene`].

use super::{
    Scene, bare, build,
    error::{Place, SceneError},
    folder::Folder,
    source::{self, Source},
};
use glam::{DVec3, UVec2};
use std::{
    io,
    path::{Path, PathBuf},
};

/// The file that makes a folder a scene.
const SCENE_FILE: &str = "scene.toml";

/// What a caller may ask for beyond the file.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LoadOptions {
    /// Image width and height in pixels; `None` keeps the file's.
    pub size: Option<UVec2>,
    /// Where the whole scene is put.
    pub placement: Placement,
}

/// A uniform scale, then a translation, applied in f64 after the file's own transforms to all meshes, lights (with
/// target and range), planes and the camera (with near and far). Intensities stay. Meant for trying a scene at extremes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// Above 0.
    pub scale: f64,
    /// Metres.
    pub translate: DVec3,
}

impl Default for Placement {
    fn default() -> Self {
        Self { scale: 1.0, translate: DVec3::ZERO }
    }
}

impl Placement {
    /// Itself, if it is one.
    pub(super) fn checked(&self, source: &Source) -> Result<&Self, SceneError> {
        if self.scale.is_finite() && self.scale > 0.0 && self.translate.is_finite() {
            return Ok(self);
        }
        Err(SceneError::Value {
            place: Place::file(&source.path),
            key: "placement".into(),
            problem: format!(
                "asked for has scale {} and translation {}: the scale must be above 0, both finite",
                self.scale, self.translate
            ),
        })
    }
}

/// Loads the scene at `path`: a folder that holds `scene.toml`, a scene file, or a bare `.obj` (see
/// [`super::scene_file_for_obj`]). A scene file's scene is called like its folder, an OBJ's like the file.
///
/// # Errors
/// [`SceneError`] if anything cannot be read or is out of range; nothing is guessed.
pub fn load(path: &Path, options: &LoadOptions) -> Result<Scene, SceneError> {
    let open = |source| SceneError::Open { path: path.to_path_buf(), source };
    let metadata = std::fs::metadata(path).map_err(open)?;
    let file = if metadata.is_dir() { path.join(SCENE_FILE) } else { path.to_path_buf() };
    match file.extension().and_then(|extension| extension.to_str()).map(str::to_ascii_lowercase).as_deref() {
        Some("toml") => load_scene_file(&file, options),
        Some("obj") => load_obj(&file, options),
        _ => Err(open(io::Error::new(io::ErrorKind::InvalidInput, "neither a folder nor a .toml or .obj file"))),
    }
}

fn load_scene_file(path: &Path, options: &LoadOptions) -> Result<Scene, SceneError> {
    let bytes = std::fs::read(path).map_err(|source| SceneError::Open { path: path.to_path_buf(), source })?;
    let text = String::from_utf8(bytes).map_err(|e| {
        let line = 1 + e.as_bytes()[..e.utf8_error().valid_up_to()].iter().filter(|&&byte| byte == b'\n').count();
        SceneError::Toml { place: Place::line(path, line), message: "not UTF-8 text: save the file as UTF-8".into() }
    })?;
    let (file, source) = source::parse(path, &text)?;
    let folder = Folder::around(path)?;
    build::build(folder.name(), &file, &source, &folder, options)
}

fn load_obj(path: &Path, options: &LoadOptions) -> Result<Scene, SceneError> {
    let file = bare::scene_file_for_obj(path)?;
    let name = path.file_stem().map_or_else(PathBuf::new, PathBuf::from).to_string_lossy().into_owned();
    build::build(name, &file, &Source::without_text(path), &Folder::around(path)?, options)
}
