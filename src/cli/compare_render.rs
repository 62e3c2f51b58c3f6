//! `gnomon compare-render`: our pictures against Mitsuba's, radiance by radiance. Agreement says that camera, lights and
//! units mean what a renderer means by them that nobody here wrote.

use super::args::CompareRenderArgs;
use super::context::{lights, load, open_gpu};
use super::exit;
use super::output::OutFolder;
use super::terminal::{Terminal, say};
use crate::cast::Occlusion;
use crate::evaluate::View;
use crate::mask::{Mask, Truth, TruthMask, Visibility};
use crate::receiver::PixelClass;
use crate::scene::{Emitter, Light, LightingMode, Scene, Shading};
use crate::shade::{Picture, Pipeline, shade, shade_points};
use crate::technique::{Spec, TechniqueError};
use crate::truth;
use crate::truth::mitsuba::{Flip, Mitsuba, Rendering};
use crate::verdict::{Noise, RadianceDifference, compare_radiance, critical_deviation, near_edges};
use glam::Vec3;
use serde::Serialize;

/// The chance that any pixel of an area light's picture is found to differ although everything is right.
const ALPHA: f64 = 0.01;

/// One comparison, as compare.json lists it.
#[derive(Debug, Serialize)]
struct Row {
    scene: String,
    light: String,
    /// `truth`, or the technique.
    shadows: String,
    #[serde(flatten)]
    difference: RadianceDifference,
    flip: Flip,
}

pub(super) fn run(args: &CompareRenderArgs, terminal: &Terminal) -> anyhow::Result<u8> {
    let specs = args.technique.iter().map(|typed| Spec::parse(typed)).collect::<Result<Vec<_>, _>>()?;
    let scene = plain(load(&args.scene.scene, args.scene.size)?);
    let lights = lights(&scene, args.scene.light.as_deref())?;
    let out = args.out.as_deref().map(OutFolder::open).transpose()?;
    let gpu = open_gpu()?;
    let view = View::new(&gpu, &scene)?;
    let mut mitsuba = Mitsuba::new(&scene, &view.casters)?;
    let mut rows = Vec::new();
    for light in lights {
        terminal.proceed()?;
        let theirs = mitsuba.render(&scene, light)?;
        let known = view.ask(light, terminal)?.truth.mask;
        let comparison = Comparison::new(&view, light, &theirs, &known);
        let mut pictures = vec![("truth".to_owned(), comparison.by_truth())];
        for spec in &specs {
            terminal.proceed()?;
            match comparison.by_technique(spec) {
                Ok(picture) => pictures.push((spec.short(), picture)),
                Err(TechniqueError::Unsupported(why)) => {
                    say(&format!("{} / {}, {}: not applicable: {why}", scene.name, light.name, spec.short()));
                }
                Err(error) => return Err(error.into()),
            }
        }
        for (index, (shadows, picture)) in pictures.into_iter().enumerate() {
            let white = theirs.mean.iter().filter(|p| p.is_finite()).map(|p| p.max_element()).fold(0.0, f32::max);
            let white = white.max(f32::MIN_POSITIVE);
            let flip = mitsuba.flip(theirs.size, &picture.linear_rgb, &theirs.mean, white)?;
            let difference = comparison.difference(&picture);
            if let Some(out) = &out {
                out.write(&format!("{}.{}.{index}.ours.exr", scene.name, light.name), &picture.to_exr()?)?;
            }
            let row = Row { scene: scene.name.clone(), light: light.name.clone(), shadows, difference, flip };
            say(&line(&row));
            rows.push(row);
        }
        if let Some(out) = &out {
            let picture = Picture { size: theirs.size, linear_rgb: theirs.mean.clone() };
            out.write(&format!("{}.{}.mitsuba.exr", scene.name, light.name), &picture.to_exr()?)?;
        }
    }
    if let Some(out) = &out {
        say(&format!("wrote {}", out.write("compare.json", &serde_json::to_vec_pretty(&rows)?)?.display()));
    }
    let differs = rows.iter().any(|row| row.shadows == "truth" && !row.difference.above.is_empty());
    Ok(if differs { exit::BUDGET } else { exit::OK })
}

/// The scene as both renderers can draw it: matt, flat-shaded, every mesh casting and receiving, no ambient light.
fn plain(mut scene: Scene) -> Scene {
    (scene.shading, scene.mode, scene.ambient) = (Shading::Flat, LightingMode::Physical, Vec3::ZERO);
    for mesh in &mut scene.meshes {
        (mesh.casts, mesh.receives) = (true, true);
    }
    for material in &mut scene.materials {
        (material.specular, material.emission) = (Vec3::ZERO, Vec3::ZERO);
    }
    for light in &mut scene.lights {
        light.range_m = f64::INFINITY;
    }
    scene
}

/// What our pictures of one light are compared with.
struct Comparison<'c> {
    view: &'c View<'c>,
    light: &'c Light,
    theirs: &'c Rendering,
    truth: &'c TruthMask,
    classes: Vec<PixelClass>,
    near_edge: Vec<bool>,
}

impl<'c> Comparison<'c> {
    fn new(view: &'c View<'c>, light: &'c Light, theirs: &'c Rendering, truth: &'c TruthMask) -> Self {
        // A penumbra is no edge: there chance and the light's points explain what may differ.
        let shadow = (!light.is_area()).then_some(truth);
        let near_edge = near_edges(view.scene, &view.receivers, shadow);
        Self { view, light, theirs, truth, classes: view.receivers.classify(view.scene, light), near_edge }
    }

    /// Lit by the exact shadows, of an area light point by point.
    fn by_truth(&self) -> Picture {
        if self.light.is_area() {
            return self.by_points();
        }
        let visibility = |truth: &Option<Truth>| match truth {
            Some(Truth::Known(visibility)) => Some(*visibility),
            Some(Truth::Undecided) | None => None,
        };
        let pixels = self.truth.pixels.iter().map(visibility).collect();
        self.lit(Mask { size: self.truth.size, pixels })
    }

    fn by_points(&self) -> Picture {
        let (scene, emitter) = (self.view.scene, Emitter::new(self.light));
        let radius_m = scene.bounds().radius();
        let seen = |pixel: usize| {
            let receiver = self.view.receivers.pixels[pixel].filter(|_| self.classes[pixel] == PixelClass::Asked)?;
            let points = truth::of_points(scene, &self.view.casters, &emitter, &receiver, radius_m);
            Some(points.map(|verdict| verdict == Occlusion::Clear).collect())
        };
        shade_points(scene, &self.view.receivers, self.light, seen)
    }

    fn by_technique(&self, spec: &Spec) -> Result<Picture, TechniqueError> {
        let prepared = spec.technique().prepare(spec, self.view.job(self.light, &self.classes))?;
        Ok(self.lit(prepared.run()?.mask))
    }

    /// Surfaces turned away are dark whatever a mask says, and so is the background.
    fn lit(&self, mut mask: Mask) -> Picture {
        for (pixel, class) in mask.pixels.iter_mut().zip(&self.classes) {
            if *class == PixelClass::FacingAway {
                *pixel = Some(Visibility::SHADOW);
            }
        }
        let mut picture = shade(self.view.scene, &self.view.receivers, &[(self.light, &mask)], Pipeline::AmbientLit);
        for (pixel, receiver) in picture.linear_rgb.iter_mut().zip(&self.view.receivers.pixels) {
            if receiver.is_none() {
                *pixel = Vec3::ZERO;
            }
        }
        picture
    }

    fn difference(&self, picture: &Picture) -> RadianceDifference {
        let (receivers, ours, theirs) = (&self.view.receivers, &picture.linear_rgb, self.theirs);
        if !self.light.is_area() {
            return compare_radiance(receivers, ours, &theirs.mean, &self.near_edge, None);
        }
        let everything = shade_points(self.view.scene, receivers, self.light, |_| {
            Some(vec![true; Emitter::new(self.light).count()])
        });
        let noise = Noise {
            variance: &theirs.variance,
            critical: critical_deviation(receivers.pixels.len() as u64, ALPHA),
            discrepancy: truth::mitsuba::discrepancy(Emitter::new(self.light).count()),
            unblocked: &everything.linear_rgb,
        };
        compare_radiance(receivers, ours, &theirs.mean, &self.near_edge, Some(noise))
    }
}

fn line(row: &Row) -> String {
    let Row { scene, light, shadows, difference, flip } = row;
    format!(
        "{scene} / {light}, {shadows}: {} of {} pixels differ by more than 0.1 %, the most by {:.2e}; {} within 2 px of an \
         edge left out; FLIP mean {:.4}, max {:.3}, above 0.1 {} px",
        difference.above.len(),
        difference.compared,
        difference.largest,
        difference.near_edges,
        flip.mean,
        flip.max,
        flip.above_a_tenth
    )
}
