//! `gnomon scaffold`: the scene file that gnomon makes around a bare OBJ, written beside it for editing.

use super::args::ScaffoldArgs;
use super::command::quoted_path;
use super::exit;
use super::output::OutFolder;
use super::terminal::say;
use crate::scene::scene_file_for_obj;
use anyhow::bail;
use std::path::Path;

/// What makes a folder a scene.
const SCENE_FILE: &str = "scene.toml";

pub(super) fn run(args: &ScaffoldArgs) -> anyhow::Result<u8> {
    let text = scene_file_for_obj(&args.obj)?.to_toml()?;
    let folder = args.obj.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let target = folder.join(SCENE_FILE);
    if target.exists() {
        bail!("{}: there is one already; move it away first", target.display());
    }
    OutFolder::open(folder)?.write(SCENE_FILE, text.as_bytes())?;
    say(&format!("wrote {}\nnext step: gnomon check {}", target.display(), quoted_path(folder)));
    Ok(exit::OK)
}
