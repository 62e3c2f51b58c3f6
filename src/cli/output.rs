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
    /// Makes the folder and proves that files can be written there.
    pub(super) fn open(path: &Path) -> anyhow::Result<Self> {
        let hint = || format!("{}: cannot write there; name another folder with --out", path.display());
        std::fs::create_dir_all(path).with_context(hint)?;
        NamedTempFile::new_in(path).with_context(hint)?;
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
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        OutFolder::open(folder)?;
        if path.is_dir() {
            bail!("{}: is a folder; name a file", path.display());
        }
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
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let write = || -> std::io::Result<()> {
        let mut file = NamedTempFile::new_in(folder)?;
        file.write_all(bytes)?;
        file.as_file().sync_data()?;
        // A temporary file is private; a result is as readable as any new file.
        make_readable(file.as_file())?;
        file.persist(path).map_err(|error| error.error)?;
        Ok(())
    };
    write().with_context(|| format!("{}: could not be written; nothing was left behind", path.display()))
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
