//! `gnomon truth` and `gnomon mask`: one light's visibility as an image that other programs can read.

use super::args::{MaskArgs, OracleChoice, TruthArgs};
use super::context::{ask, load, mitsuba_for, only_light, open_gpu, prepare};
use super::output::{ImageFormat, OutFile};
use super::terminal::{Terminal, say};
use super::{exit, report};
use crate::evaluate::View;
use crate::report::mask_image::{MaskImage, MaskImageError};
use crate::technique::Spec;

pub(super) fn truth(args: &TruthArgs, terminal: &Terminal) -> anyhow::Result<u8> {
    let scene = load(&args.scene.scene, args.scene.size)?;
    let light = only_light(&scene, &args.scene)?;
    let out = OutFile::open(&args.output)?;
    let gpu = open_gpu()?;
    let view = View::new(&gpu, &scene)?;
    let mut mitsuba = mitsuba_for(args.oracle, &view)?;
    let question = ask(&view, light, args.oracle, mitsuba.as_mut(), terminal)?;
    let truth = match &question.mitsuba {
        Some(check) if args.oracle == OracleChoice::Mitsuba => &check.mask,
        _ => &question.truth.mask,
    };
    out.write(&encoded(&MaskImage::from(truth), out.format)?)?;
    report::mitsuba_line(&question).iter().for_each(|line| say(line));
    say(&format!("wrote {}", args.output.display()));
    Ok(exit::OK)
}

pub(super) fn mask(args: &MaskArgs, terminal: &Terminal) -> anyhow::Result<u8> {
    let spec = Spec::parse(&args.technique)?;
    let scene = load(&args.scene.scene, args.scene.size)?;
    let light = only_light(&scene, &args.scene)?;
    let out = OutFile::open(&args.output)?;
    let gpu = open_gpu()?;
    let view = View::new(&gpu, &scene)?;
    let classes = view.receivers.classify(&scene, light);
    let mask = prepare(&spec, &view, light, &classes)?.run()?.mask;
    terminal.proceed()?;
    out.write(&encoded(&MaskImage::from(&mask), out.format)?)?;
    say(&format!("wrote {}", args.output.display()));
    Ok(exit::OK)
}

fn encoded(image: &MaskImage, format: ImageFormat) -> Result<Vec<u8>, MaskImageError> {
    match format {
        ImageFormat::Png => image.to_png(),
        ImageFormat::Exr => image.to_exr(),
    }
}
