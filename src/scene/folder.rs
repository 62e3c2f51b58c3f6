//! The folder a scene lives in: every file it names is relative to a folder in there and stays inside, also through
//! symbolic links. A scene from a stranger cannot make gnomon read anything else.

use super::error::{Place, SceneError};
use std::{
    io,
    path::{Component, Path, PathBuf},
};

/// A scene's folder.
#[derive(Debug)]
pub(super) struct Folder {
    /// As the user wrote it: for messages.
    shown: PathBuf,
    /// Without links.
    canonical: PathBuf,
}

impl Folder {
    /// The folder that holds `file`.
    pub(super) fn around(file: &Path) -> Result<Self, SceneError> {
        let parent = parent_of(file);
        let canonical =
            parent.canonicalize().map_err(|source| SceneError::Open { path: file.to_path_buf(), source })?;
        Ok(Self { shown: parent.to_path_buf(), canonical })
    }

    /// As the user wrote it.
    pub(super) fn path(&self) -> &Path {
        &self.shown
    }

    /// The folder's own name: what a scene is called in reports.
    pub(super) fn name(&self) -> String {
        self.canonical.file_name().map_or_else(|| "scene".into(), |name| name.to_string_lossy().into_owned())
    }

    /// Reads the file that `place` names as `file`, relative to `base`. Gives the path for messages and the bytes.
    pub(super) fn read(&self, base: &Path, file: &str, place: &Place) -> Result<(PathBuf, Vec<u8>), SceneError> {
        let escape =
            |why| SceneError::Escape { place: place.clone(), file: file.into(), why, folder: self.shown.clone() };
        let unreadable = |source| SceneError::Reference {
            place: place.clone(),
            file: file.into(),
            folder: base.to_path_buf(),
            source,
        };
        for component in Path::new(file).components() {
            match component {
                Component::Normal(_) | Component::CurDir => {}
                Component::ParentDir => return Err(escape("climbs out of its folder with ..")),
                Component::RootDir | Component::Prefix(_) => return Err(escape("is an absolute path")),
            }
        }
        let path = base.join(file);
        let canonical = path.canonicalize().map_err(unreadable)?;
        if !canonical.starts_with(&self.canonical) {
            return Err(escape("leads out of the scene's folder through a symbolic link"));
        }
        if !canonical.is_file() {
            return Err(unreadable(io::Error::new(io::ErrorKind::InvalidInput, "this is no file")));
        }
        let bytes = std::fs::read(&canonical).map_err(unreadable)?;
        Ok((path, bytes))
    }
}

/// The folder a file lies in; `.` for a bare file name.
pub(super) fn parent_of(file: &Path) -> &Path {
    file.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."))
}
