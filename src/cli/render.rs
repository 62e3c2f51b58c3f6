//! `gnomon render`: the scene as a picture, lit with a technique's shadows or the exact ones.

use super::args::{PipelineName, RenderArgs, Shader};
use super::context::{lights, load, only_light, open_gpu, prepare};
use super::output::{ImageFormat, OutFile};
use super::terminal::{Terminal, say};
use super::{exit, show};
use crate::evaluate::View;
use crate::mask::{Mask, Truth, Visibility};
use crate::receiver::PixelClass;
use crate::scene::Light;
use crate::shade::{BACKGROUND, Picture, Pipeline, shade};
use crate::technique::Spec;
use crate::technique::lighting::light_up;

pub(super) fn run(args: &RenderArgs, terminal: &Terminal) -> anyhow::Result<u8> {
    let shown = args.show.map(|show| show::spec(args, show).map(|spec| (show, spec))).transpose()?;
    let spec = match &shown {
        Some((_, spec)) => Some(spec.clone()),
        None => args.technique.as_deref().map(Spec::parse).transpose()?,
    };
    let scene = load(&args.scene.scene, args.scene.size)?;
    let lights = match shown {
        Some(_) => vec![only_light(&scene, &args.scene)?],
        None => lights(&scene, args.scene.light.as_deref())?,
    };
    let out = OutFile::open(&args.output)?;
    let gpu = open_gpu()?;
    let view = View::new(&gpu, &scene)?;
    let masks = lights
        .into_iter()
        .map(|light| Ok((light, shadows(&view, light, spec.as_ref(), terminal)?)))
        .collect::<anyhow::Result<Vec<(&Light, Mask)>>>()?;
    let lit: Vec<(&Light, &Mask)> = masks.iter().map(|(light, mask)| (*light, mask)).collect();
    terminal.proceed()?;
    let picture = picture(&view, &lit, args)?;
    if let Some((show, spec)) = shown {
        return show::run(&out, show, &view, lit[0].0, &spec, picture);
    }
    let bytes = match out.format {
        ImageFormat::Png => picture.to_png(),
        ImageFormat::Exr => picture.to_exr(),
    }?;
    out.write(&bytes)?;
    say(&format!("wrote {}", args.output.display()));
    Ok(exit::OK)
}

fn picture(view: &View<'_>, lit: &[(&Light, &Mask)], args: &RenderArgs) -> anyhow::Result<Picture> {
    let pipeline = pipeline(args);
    if args.shader == Shader::Cpu || lit.iter().any(|(light, _)| light.is_area()) {
        return Ok(shade(view.scene, &view.receivers, lit, pipeline));
    }
    let linear_rgb = light_up(view.gpu, view.scene, &view.geometry, lit, pipeline, BACKGROUND)?;
    Ok(Picture { size: view.scene.image_size, linear_rgb })
}

fn pipeline(args: &RenderArgs) -> Pipeline {
    match args.pipeline {
        PipelineName::AmbientLit => Pipeline::AmbientLit,
        PipelineName::Black => Pipeline::Black,
        PipelineName::Darkening => Pipeline::Darkening { amount: args.darkening },
    }
}

/// A light's visibility at every pixel it could reach: 0 on surfaces turned away, an undecided pixel half lit.
fn shadows(view: &View<'_>, light: &Light, spec: Option<&Spec>, terminal: &Terminal) -> anyhow::Result<Mask> {
    let classes = view.receivers.classify(view.scene, light);
    let mut mask = match spec {
        Some(spec) => {
            terminal.proceed()?;
            prepare(spec, view, light, &classes)?.run()?.mask
        }
        None => {
            let truth = view.ask(light, terminal)?.truth.mask;
            let visibility = |truth: Truth| match truth {
                Truth::Known(visibility) => Some(visibility),
                Truth::Undecided => Visibility::new(0.5),
            };
            let pixels = truth.pixels.into_iter().map(|pixel| pixel.and_then(visibility)).collect();
            Mask { size: truth.size, pixels }
        }
    };
    for (pixel, class) in mask.pixels.iter_mut().zip(&classes) {
        if *class == PixelClass::FacingAway {
            *pixel = Some(Visibility::SHADOW);
        }
    }
    Ok(mask)
}
