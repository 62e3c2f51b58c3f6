//! `gnomon diagnose`: what is wrong, why, and what each fix really does.

use super::args::DiagnoseArgs;
use super::command::Subject;
use super::context::{lights, load, open_gpu};
use super::exit;
use super::terminal::{Terminal, say};
use crate::cause::Cause;
use crate::evaluate::{
    BiasVerdict, Diagnosis, Effort, EvaluateError, Outcome, Trials, View, diagnose, evaluate, search_bias,
};
use crate::technique::{Spec, TechniqueError};

pub(super) fn run(args: &DiagnoseArgs, terminal: &Terminal) -> anyhow::Result<u8> {
    let spec = Spec::parse(&args.technique)?;
    let scene = load(&args.scene.scene, args.scene.size)?;
    let lights = lights(&scene, args.scene.light.as_deref())?;
    let gpu = open_gpu()?;
    let view = View::new(&gpu, &scene)?;
    for light in lights {
        let subject = |spec| Subject { scene: &args.scene.scene, light: &light.name, spec, size: scene.image_size };
        let question = view.ask(light, terminal)?;
        say(&format!("{}, light '{}', {}", scene.name, light.name, spec.short()));
        let evaluation = match evaluate(&view, &question, &spec, Effort::CAUSES, terminal) {
            Err(EvaluateError::Technique(TechniqueError::Unsupported(why))) => {
                say(&format!("  not applicable: {why}\n"));
                continue;
            }
            other => other?,
        };
        let predicted = evaluation.prepared.facts();
        predicted.iter().for_each(|(label, value)| say(&format!("  {label:<18} {value}")));
        let before = Outcome::of(&evaluation);
        let asked = evaluation.verdict.pixels.asked;
        say(&format!("  {} of {asked} asked pixels are wrong\n", before.wrong));
        let mut trials = Trials::new(&view, &question);
        let diagnoses = diagnose(&mut trials, &spec, &evaluation, terminal)?;
        terminal.finish();
        for diagnosis in &diagnoses {
            say(&described(subject(&spec), diagnosis, &before, gpu.adapter().is_software));
        }
        let is_bias = |d: &Diagnosis| matches!(d.cause, Cause::Acne | Cause::Curvature | Cause::PeterPanning);
        if diagnoses.iter().any(is_bias) {
            let found = search_bias(&mut trials, &spec, terminal)?;
            terminal.finish();
            found.iter().for_each(|verdict| say(&bias_verdict(verdict)));
        }
        let best =
            diagnoses.iter().flat_map(|d| &d.trials).filter_map(|(spec, outcome)| Some((spec, outcome.as_ref().ok()?)));
        if let Some((fix, outcome)) =
            best.min_by_key(|(_, outcome)| outcome.wrong).filter(|(_, o)| o.wrong < before.wrong)
        {
            say(&format!(
                "best fix tried: {} leaves {} wrong pixels\nnext step: {}\n",
                fix.short(),
                outcome.wrong,
                subject(fix).check(0, 0)
            ));
        }
    }
    Ok(exit::OK)
}

fn described(subject: Subject<'_>, diagnosis: &Diagnosis, before: &Outcome, is_software: bool) -> String {
    let width = subject.size.x;
    let pixels: Vec<String> = diagnosis.worst.iter().map(|p| format!("{},{}", p % width, p / width)).collect();
    let mut text = format!(
        "{}: {} px, {:.1} % of the wrong ones, sum {:+.1}\n  {}\n  e.g. at {}\n",
        diagnosis.cause.name(),
        diagnosis.pixels,
        100.0 * diagnosis.share,
        diagnosis.sum,
        diagnosis.cause.meaning(),
        pixels.join("  ")
    );
    for (fix, outcome) in &diagnosis.trials {
        let effect = match outcome {
            Ok(after) => effect(diagnosis.cause, before, after, is_software),
            Err(why) => why.clone(),
        };
        text += &format!("  tried {}: {effect}\n", subject.spec.changes_to(fix));
    }
    if let Some(pixel) = diagnosis.worst.first() {
        text += &format!("  look closer: {}\n", subject.explain(*pixel));
    }
    text
}

/// "acne 3120 → 0 px, peter-panning 0 → 44 px, wrong 3200 → 124 px, GPU time +2 %".
fn effect(cause: Cause, before: &Outcome, after: &Outcome, is_software: bool) -> String {
    let mut parts = vec![format!("{} {} → {} px", cause.name(), before.of_cause(cause), after.of_cause(cause))];
    for other in Cause::ALL.into_iter().filter(|other| *other != cause) {
        let (old, new) = (before.of_cause(other), after.of_cause(other));
        if old != new {
            parts.push(format!("{} {old} → {new} px", other.name()));
        }
    }
    parts.push(format!("all wrong {} → {} px", before.wrong, after.wrong));
    let growth = |old: f64, new: f64| 100.0 * (new / old - 1.0);
    if let Some(ratio) = after.ms_ratio {
        let mark = if is_software { " (software adapter)" } else { "" };
        parts.push(format!("GPU time {:+.0} %{mark}", growth(1.0, ratio)));
    }
    parts.push(format!("memory {:+.0} %", growth(before.cost.bytes as f64, after.cost.bytes as f64)));
    parts.join(", ")
}

fn bias_verdict(verdict: &BiasVerdict) -> String {
    let tried: Vec<String> = verdict
        .tried
        .iter()
        .map(|(spec, own, detached)| {
            format!("  {}: self-shadowing {own} px, peter-panning {detached} px", spec.short())
        })
        .collect();
    let conclusion = verdict
        .free_of_both
        .as_ref()
        .map_or_else(|| "no bias value tried clears both".to_owned(), |spec| format!("{} clears both", spec.short()));
    format!("biases compared:\n{}\n  {conclusion}\n", tried.join("\n"))
}
