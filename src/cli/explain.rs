//! `gnomon explain`: everything about one pixel.

use super::args::ExplainArgs;
use super::command::Subject;
use super::context::{load, only_light, open_gpu, prepare};
use super::exit;
use super::terminal::{Terminal, say};
use crate::evaluate::{View, replay_from_truth};
use crate::mask::Truth;
use crate::receiver::{PixelClass, Receiver};
use crate::scene::{Light, Scene};
use crate::shade::terminator;
use crate::technique::Spec;
use crate::truth;
use crate::verdict::{entries_of_pixel, judge, ledger, wrong_above};
use anyhow::bail;
use glam::DVec3;

pub(super) fn run(args: &ExplainArgs, terminal: &Terminal) -> anyhow::Result<u8> {
    let spec = Spec::parse(&args.technique)?;
    let scene = load(&args.scene.scene, args.scene.size)?;
    let light = only_light(&scene, &args.scene)?;
    let size = scene.image_size;
    if args.pixel.cmpge(size).any() {
        bail!("pixel {},{} lies outside the picture of {} x {} pixels", args.pixel.x, args.pixel.y, size.x, size.y);
    }
    let index = args.pixel.y * size.x + args.pixel.x;
    let gpu = open_gpu()?;
    let view = View::new(&gpu, &scene)?;
    let classes = view.receivers.classify(&scene, light);
    let prepared = prepare(&spec, &view, light, &classes)?;
    say(&format!(
        "pixel {},{} of {}, light '{}', {}",
        args.pixel.x,
        args.pixel.y,
        scene.name,
        light.name,
        spec.short()
    ));
    let Some(receiver) = view.receivers.pixels[index as usize] else {
        say("  background: no geometry at this pixel's centre");
        return Ok(exit::OK);
    };
    say(&surface(&scene, &receiver));
    if terminator(&scene, &view.receivers, light)[index as usize] {
        say(
            "  shading          the facet is turned away from the light while its interpolated normal is still lit: the \
             smooth-shading terminator, which looks like acne and which no shadow technique causes",
        );
    }
    match classes[index as usize] {
        PixelClass::Asked => {}
        PixelClass::FacingAway => {
            say("  not asked: the surface is turned away from the light and dark by the lighting model");
            return Ok(exit::OK);
        }
        PixelClass::NotLit | PixelClass::Background => {
            say("  not asked: outside the light's cone or range, or on a mesh that does not receive shadows");
            return Ok(exit::OK);
        }
    }
    say(&shadow_ray(&view, light, &receiver));
    // The technique answers for the whole picture, because its fit may depend on it; the truth for this pixel only.
    let mut only_this = vec![PixelClass::NotLit; classes.len()];
    only_this[index as usize] = PixelClass::Asked;
    let truth = truth::exact(&scene, &view.casters, light, &view.receivers, &only_this, terminal)?.mask;
    let Some(Truth::Known(exact)) = truth.pixels[index as usize] else {
        say("  undecided: the verdict changes when the receiver moves by its own rounding error");
        return Ok(exit::OK);
    };
    let mask = prepared.run()?.mask;
    let answer = mask.pixels[index as usize].map_or(f32::NAN, crate::mask::Visibility::get);
    say(&format!("  truth            {}\n  technique        {answer}", exact.get()));
    let replay = replay_from_truth(prepared.as_ref(), &spec, light, &truth, &mask, &[index])?;
    let verdict = judge(&only_this, &truth, &mask, wrong_above(light))?;
    let ledger = ledger(&verdict, &truth, &mask, &replay)?;
    say("  stages           value   change   cause");
    for entry in entries_of_pixel(&replay, index).unwrap_or_default() {
        let cause = if entry.contribution == 0.0 { "" } else { entry.cause.name() };
        say(&format!("    {:<14} {:>6.4}  {:>+7.4}   {cause}", entry.stage, entry.value, entry.contribution));
    }
    for (label, value) in prepared.lookup_facts(index)? {
        say(&format!("  {label:<22} {value}"));
    }
    if let Some(footprint) = prepared.footprint(index) {
        say(&format!(
            "  {:<22} m = {:.2} pixels (distance factor {:.2}, tilt factor {:.2})",
            "texel in the picture", footprint.m, footprint.perspective_factor, footprint.projective_factor
        ));
    }
    match ledger.cause_of(index) {
        None => say("verdict: right"),
        Some(cause) => {
            let error = f64::from(answer) - f64::from(exact.get());
            let named_wrong = if ledger.wrong.is_empty() { "off, but not wrong," } else { "wrong" };
            say(&format!("verdict: {named_wrong} by {error:+.4}: {}: {}", cause.name(), cause.meaning()));
            if let Some(fix) = spec.technique().remedies(&spec, cause).first() {
                let subject = Subject { scene: &args.scene.scene, light: &light.name, spec: &spec, size };
                say(&format!("knob: {} ({})", spec.changes_to(fix), fix.short()));
                say(&format!("next step: {}", subject.diagnose()));
            }
        }
    }
    Ok(exit::OK)
}

fn point(scene: &Scene, rebased: DVec3) -> String {
    let p = rebased + scene.origin_in_file;
    format!("({:.6}, {:.6}, {:.6}) m", p.x, p.y, p.z)
}

fn surface(scene: &Scene, receiver: &Receiver) -> String {
    let normal = receiver.normal_in_world;
    format!(
        "  receiver         {} on triangle {} of mesh '{}'\n  normal           ({:.4}, {:.4}, {:.4})",
        point(scene, receiver.point_in_world),
        receiver.triangle,
        scene.mesh_of(receiver.triangle).name,
        normal.x,
        normal.y,
        normal.z
    )
}

fn shadow_ray(view: &View<'_>, light: &Light, receiver: &Receiver) -> String {
    let segment = light.segment_from(receiver.point_in_world, view.scene.bounds().radius());
    let towards = (segment.to - segment.from).normalize_or_zero();
    let incidence = receiver.normal_in_world.dot(towards).clamp(-1.0, 1.0).acos().to_degrees();
    let occluder = view.casters.nearest_hit(&segment, Some(receiver.triangle)).map_or_else(
        || "nothing: lit".to_owned(),
        |hit| {
            let distance_m = hit.t * (segment.to - segment.from).length();
            let mesh = &view.scene.mesh_of(hit.triangle).name;
            format!("triangle {} of mesh '{mesh}', {distance_m:.6} m away", hit.triangle)
        },
    );
    format!(
        "  shadow ray       towards ({:.4}, {:.4}, {:.4}), {incidence:.2} degrees from the normal\n  occluder         {occluder}",
        towards.x, towards.y, towards.z
    )
}
