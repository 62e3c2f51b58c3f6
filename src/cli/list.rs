//! `gnomon list`: the scenes of a folder, the techniques and their parameters, the presets, what each handles.

use super::args::{ListArgs, Listed};
use super::columns::{columns, paragraph, text};
use super::terminal::{complain, say};
use super::{exit, matrix};
use crate::scene::{self, LoadOptions};
use crate::technique::{PRESETS, Preset, Technique, registry};
use anyhow::{Context, bail};

pub(super) fn run(args: &ListArgs) -> anyhow::Result<u8> {
    match args.what {
        None => matrix::print()?,
        Some(Listed::Techniques) => registry().iter().for_each(|technique| say(&described(*technique))),
        Some(Listed::Presets) => {
            let mut table = columns();
            for Preset { name, spec, about, is_short_name } in PRESETS {
                let typed = if is_short_name { name.to_owned() } else { format!("preset:{name}") };
                table.add_row([typed.as_str(), spec, about]);
            }
            say(&text(table, ""));
        }
        Some(Listed::Scenes) => {
            let folder = &args.folder;
            let entries = std::fs::read_dir(folder)
                .with_context(|| format!("{}: cannot be read; name the folder with --folder", folder.display()))?;
            let mut paths: Vec<_> = entries.filter_map(Result::ok).map(|entry| entry.path()).collect();
            paths.retain(|path| path.join("scene.toml").is_file());
            paths.sort();
            if paths.is_empty() {
                bail!("{}: no folder in it holds a scene.toml; name another with --folder", folder.display());
            }
            let mut table = columns();
            for path in paths {
                match scene::load(&path, &LoadOptions::default()) {
                    Ok(scene) => {
                        let lights: Vec<&str> = scene.lights.iter().map(|light| light.name.as_str()).collect();
                        let triangles = format!("{} triangles", scene.triangles.len());
                        table.add_row([path.display().to_string(), triangles, lights.join(", "), scene.about]);
                    }
                    Err(error) => complain(&format!("warning: {}", exit::message(&error.into()))),
                }
            }
            say(&text(table, ""));
        }
    }
    Ok(exit::OK)
}

fn described(technique: &dyn Technique) -> String {
    let mut table = columns();
    for param in technique.params() {
        let name =
            if param.unit.is_empty() { param.name.to_owned() } else { format!("{} [{}]", param.name, param.unit) };
        table.add_row([name, param.default.to_string(), param.range(), param.help.to_owned()]);
    }
    format!(
        "{}\n{}\n  parameter, default, values:\n{}\n",
        paragraph(&format!("{}: {}", technique.id(), technique.about()), ""),
        paragraph(technique.citation(), "  "),
        text(table, "  ")
    )
}
