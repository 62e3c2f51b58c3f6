//! Files out: checked before the long run, written under a temporary name and renamed, so that no half-written file is
//! ever seen.

use anyhow::{Context, bail};
use std::io::Write;
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// A folder that results go to.
#[derive(Debug)]
pub(super) struct OutFolder {
    path: PathBuf,
}

impl OutFolder {
    /// Proves that files can be written there. A folder that does not exist is made with the first file, so that
    /// a command that fails before leaves nothing behind.
    pub(super) fn open(path: &Path) -> anyhow::Result<Self> {
        let existing = path.ancestors().find(|ancestor| ancestor.exists()).unwrap_or(Path::new("."));
        temporary_file_in(existing)
            .with_context(|| format!("{}: files cannot be written there; name another place", path.display()))?;
        Ok(Self { path: path.to_owned() })
    }

    /// Writes one file and returns where.
    pub(super) fn write(&self, name: &str, bytes: &[u8]) -> anyhow::Result<PathBuf> {
        let path = self.path.join(name);
        write_atomically(&path, bytes)?;
        Ok(path)
    }
}

/// A single file to be written later: its format by extension, its folder checked now.
#[derive(Debug)]
pub(super) struct OutFile {
    path: PathBuf,
    /// What the extension says.
    pub(super) format: ImageFormat,
}

/// Picture formats.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ImageFormat {
    /// 8 bits per channel.
    Png,
    /// Float channels.
    Exr,
}

impl OutFile {
    /// Checks extension and folder.
    pub(super) fn open(path: &Path) -> anyhow::Result<Self> {
        let format = image_format(path)?;
        if path.is_dir() {
            bail!("{}: is a folder; name a file", path.display());
        }
        OutFolder::open(folder_of(path))?;
        Ok(Self { path: path.to_owned(), format })
    }

    /// Writes the file.
    pub(super) fn write(&self, bytes: &[u8]) -> anyhow::Result<()> {
        write_atomically(&self.path, bytes)
    }
}

/// PNG or EXR, by extension.
pub(super) fn image_format(path: &Path) -> anyhow::Result<ImageFormat> {
    match path.extension().and_then(|extension| extension.to_str()).map(str::to_ascii_lowercase).as_deref() {
        Some("png") => Ok(ImageFormat::Png),
        Some("exr") => Ok(ImageFormat::Exr),
        _ => bail!("{}: the name must end in .png or .exr", path.display()),
    }
}

fn write_atomically(path: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    let folder = folder_of(path);
    let write = || -> std::io::Result<()> {
        std::fs::create_dir_all(folder)?;
        let mut file = temporary_file_in(folder)?;
        file.as_file_mut().write_all(bytes)?;
        file.as_file().sync_data()?;
        // A temporary file is private; a result is as readable as any new file.
        make_readable(file.as_file())?;
        file.persist(path).map_err(|error| error.error)?;
        Ok(())
    };
    write().with_context(|| format!("{}: could not be written; it is as it was before", path.display()))
}

fn folder_of(file: &Path) -> &Path {
    file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Its error does not tell the temporary name, which means nothing to anybody.
fn temporary_file_in(folder: &Path) -> std::io::Result<NamedTempFile> {
    NamedTempFile::new_in(folder).map_err(|error| error.kind().into())
}

#[cfg(unix)]
fn make_readable(file: &std::fs::File) -> std::io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    file.set_permissions(std::fs::Permissions::from_mode(0o644))
}

#[cfg(not(unix))]
fn make_readable(_file: &std::fs::File) -> std::io::Result<()> {
    Ok(())
}
