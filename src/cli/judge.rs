//! `gnomon judge`: the verdict on a visibility image that somebody else's renderer made.

use super::args::JudgeArgs;
use super::command::{light_option, quoted_path};
use super::context::{load, only_light, open_gpu};
use super::exit;
use super::output::OutFolder;
use super::report::{adapter, truth_source};
use super::terminal::{Terminal, say, width};
use crate::evaluate::View;
use crate::mask::Mask;
use crate::report::mask_image::{MaskImage, MaskImageError};
use crate::report::model::{self, Report, Run};
use crate::report::table::table;
use crate::verdict::{judge, wrong_above};
use anyhow::{Context, anyhow};
use glam::UVec2;

pub(super) fn run(args: &JudgeArgs, terminal: &Terminal) -> anyhow::Result<u8> {
    let file = args.mask.display().to_string();
    let bytes = std::fs::read(&args.mask).with_context(|| format!("{file}: cannot be read"))?;
    let scene = load(&args.scene.scene, args.scene.size)?;
    let mask = decoded(&bytes, scene.image_size).map_err(|error| anyhow!("{file}: {error}"))?;
    let light = only_light(&scene, &args.scene)?;
    let out = args.out.as_deref().map(OutFolder::open).transpose()?;
    let gpu = open_gpu()?;
    let view = View::new(&gpu, &scene)?;
    let question = view.ask(light, terminal)?;
    let verdict = judge(&question.classes, &question.truth.mask, &mask, wrong_above(light))
        .with_context(|| format!("{file}: does not answer for scene '{}', light '{}'", scene.name, light.name))?;
    let typed = format!("file:{file}");
    let asked = model::Question {
        scene: scene.name.clone(),
        light: light.name.clone(),
        technique: typed.clone(),
        typed,
        command: format!(
            "gnomon judge {} {} --size {}x{} {}",
            quoted_path(&args.scene.scene),
            light_option(&light.name),
            scene.image_size.x,
            scene.image_size.y,
            quoted_path(&args.mask)
        ),
        image: scene.image_size,
        wrong_above: wrong_above(light),
    };
    let mut run = Run::judged(asked, &verdict);
    run.truth = Some(truth_source(&question));
    if let Some(out) = &out {
        super::pictures::write_error_map(out, 0, &question, &run, &mask, &verdict)?;
    }
    let report = Report::new(adapter(&gpu), vec![run]);
    terminal.finish();
    say(&table(&report, width()));
    if let Some(out) = &out {
        say(&format!("wrote {}", out.write("report.json", &crate::report::export::to_json(&report)?)?.display()));
    }
    Ok(exit::OK)
}

fn decoded(bytes: &[u8], picture: UVec2) -> Result<Mask, String> {
    MaskImage::decode(bytes, picture).map(|image| image.to_mask()).map_err(|error| match error {
        MaskImageError::Size { found, .. } => format!("{error}; with --size {}x{} they fit", found.x, found.y),
        _ => error.to_string(),
    })
}
