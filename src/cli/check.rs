//! `gnomon check`: every technique on every light of every scene, as a table and, with --out, as files.

use super::args::CheckArgs;
use super::command::Subject;
use super::context::{ask, load, mitsuba_for, open_gpu};
use super::imagery::Collector;
use super::output::OutFolder;
use super::tasks::{Task, tasks};
use super::terminal::{Terminal, complain, say_or_end, width};
use super::{exit, pictures, report};
use crate::evaluate::{Effort, EvaluateError, Question, View, evaluate, flips, jittered};
use crate::gpu::Gpu;
use crate::report::export::{EXPORTERS, Exporter};
use crate::report::html::Imagery;
use crate::report::model::{Jitter, Motion, Report, Run, Status};
use crate::report::table::table;
use crate::scene::Scene;
use crate::suggest::hint;
use crate::technique::{Spec, TechniqueError};
use anyhow::{Context, bail};
use std::path::{Path, PathBuf};

/// The runs so far, and where their pictures go.
struct Session<'a> {
    args: &'a CheckArgs,
    gpu: &'a Gpu,
    terminal: &'a Terminal,
    out: Option<OutFolder>,
    runs: Vec<Run>,
    pixels: Collector,
    /// For every run, the command that looks deeper into it.
    deeper: Vec<String>,
    /// What else was found, in words.
    notes: Vec<String>,
}

pub(super) fn run(args: &CheckArgs, terminal: &Terminal) -> anyhow::Result<u8> {
    let exporters = exporters(&args.format)?;
    let specs = args.technique.iter().map(|typed| Spec::parse(typed)).collect::<Result<Vec<_>, _>>()?;
    let out = args.out.as_deref().map(OutFolder::open).transpose()?;
    // Every scene is read before anything long begins: a mistake in the last one should not cost the work of the first.
    let scenes = args.scenes.iter().map(|path| load(path, args.size)).collect::<anyhow::Result<Vec<_>>>()?;
    let scenes: Vec<(&Path, &Scene)> = args.scenes.iter().map(AsRef::as_ref).zip(&scenes).collect();
    let tasks: Vec<Vec<Task<'_>>> =
        scenes.iter().map(|(path, scene)| tasks(path, scene, &specs, args)).collect::<anyhow::Result<_>>()?;
    let gpu = open_gpu()?;
    let pixels = Collector::new(exporters.iter().any(|exporter| exporter.shows_pixels));
    let (runs, deeper, notes) = (Vec::new(), Vec::new(), Vec::new());
    let mut session = Session { args, gpu: &gpu, terminal, out, runs, pixels, deeper, notes };
    let ended = scenes.iter().zip(&tasks).try_for_each(|((path, scene), tasks)| {
        session.check_scene(path, scene, tasks).with_context(|| format!("scene '{}'", scene.name))
    });
    terminal.finish();
    let code = ended.as_ref().map_or_else(exit::code_of, |()| session.verdict_code());
    // What is done is reported even when the rest was not to be.
    let reported = session.report(&exporters, code);
    if let (Err(_), Err(unwritten)) = (&ended, &reported) {
        complain(&format!("error: {}", exit::message(unwritten)));
    }
    ended.and(reported)?;
    Ok(code)
}

impl Session<'_> {
    fn check_scene(&mut self, path: &Path, scene: &Scene, tasks: &[Task<'_>]) -> anyhow::Result<()> {
        let view = View::new(self.gpu, scene)?;
        let mut mitsuba = mitsuba_for(self.args.oracle, &view)?;
        for of_light in tasks.chunk_by(|a, b| a.light.name == b.light.name) {
            let (light, oracle) = (of_light[0].light, self.args.oracle);
            let question = ask(&view, light, oracle, mitsuba.as_mut(), self.terminal)?;
            self.notes.extend(report::mitsuba_line(&question).map(|line| format!("{} / {line}", scene.name)));
            self.pixels.ask(&view, &question)?;
            for task in of_light {
                let subject =
                    Subject { scene: path, light: &task.light.name, spec: &task.spec, size: scene.image_size };
                let run = self.check_task(&view, &question, task, &subject)?;
                self.runs.push(run);
                self.deeper.push(subject.diagnose());
            }
        }
        Ok(())
    }

    /// One run, its pictures written. What a technique cannot do, and what goes wrong with it, is a row of the report.
    fn check_task(
        &mut self,
        view: &View<'_>,
        question: &Question<'_>,
        task: &Task<'_>,
        subject: &Subject<'_>,
    ) -> anyhow::Result<Run> {
        let asked = report::question(
            view.scene,
            task.light,
            &task.spec,
            subject.check(self.args.jitter, self.args.motion) + self.args.oracle.option(),
        );
        let outcome = evaluate(view, question, &task.spec, Effort::FULL, self.terminal).and_then(|evaluation| {
            let phases = jittered(view, question, &task.spec, self.args.jitter, self.terminal)?;
            let moved = flips(view.gpu, view.scene, task.light, &task.spec, self.args.motion, self.terminal)?;
            Ok((evaluation, phases, moved))
        });
        let (evaluation, phases, moved) = match outcome {
            Ok(outcome) => outcome,
            Err(EvaluateError::Technique(TechniqueError::Unsupported(why))) => {
                self.pixels.add(question, None)?;
                return Ok(Run::unsupported(asked, why.to_string()));
            }
            Err(error @ (EvaluateError::Interrupted(_) | EvaluateError::Technique(TechniqueError::Interrupted(_)))) => {
                return Err(error.into());
            }
            Err(error) => {
                self.pixels.add(question, None)?;
                return Ok(Run::failed(asked, error.to_string()));
            }
        };
        let fractions: Vec<f64> = phases.iter().map(|(_, fraction)| *fraction).collect();
        let mut run = Run::judged(asked, &evaluation.verdict).explained_by(&evaluation.ledger);
        run.cost = Some(evaluation.cost.clone());
        run.truth = Some(report::truth_source(question));
        run.jitter = Jitter::of(&fractions);
        run.motion = Motion::of(&moved.of_camera, &moved.of_light);
        run.bias = Some(evaluation.prepared.bias()).filter(|views| !views.is_empty());
        run.budget = task.limits.outcome(&evaluation.verdict, run.jitter);
        self.pixels.add(question, Some((&evaluation, &subject.explain_some_pixel())))?;
        if let Some(out) = &self.out {
            pictures::write_run(out, self.runs.len(), view, question, &run, &evaluation)?;
        }
        Ok(run)
    }

    fn verdict_code(&self) -> u8 {
        if self.runs.iter().any(|run| run.status == Status::Failed) {
            exit::FAILED
        } else if self.runs.iter().any(|run| run.budget.is_some_and(|budget| !budget.met)) {
            exit::BUDGET
        } else {
            exit::OK
        }
    }

    /// Writes the report, then prints it: a reader that goes away early costs no file. `code` is the exit code.
    fn report(&mut self, exporters: &[&Exporter], code: u8) -> anyhow::Result<()> {
        if self.runs.is_empty() {
            return Ok(());
        }
        let report = Report::new(report::adapter(self.gpu), std::mem::take(&mut self.runs));
        let written = self
            .out
            .as_ref()
            .map_or_else(|| Ok(Vec::new()), |out| write(&report, self.pixels.imagery(), exporters, out));
        let mut text = table(&report, width());
        for note in &self.notes {
            text += &format!("\n{note}");
        }
        for path in written.iter().flatten() {
            text += &format!("\nwrote {}", path.display());
        }
        text += &next_step(&report.runs, &self.deeper, self.out.is_none());
        say_or_end(&text, code);
        written.map(drop)
    }
}

fn write(report: &Report, imagery: &Imagery, exporters: &[&Exporter], out: &OutFolder) -> anyhow::Result<Vec<PathBuf>> {
    let file = |exporter: &&Exporter| {
        out.write(&format!("report.{}", exporter.extension), &(exporter.write)(report, imagery)?)
    };
    exporters.iter().map(file).collect()
}

/// The commands that show and look deeper into the worst run.
fn next_step(runs: &[Run], deeper: &[String], pictures: bool) -> String {
    let fraction = |run: &Run| run.error.and_then(|error| error.wrong_fraction);
    let judged = runs.iter().zip(deeper).filter_map(|(run, deeper)| Some((fraction(run)?, run, deeper)));
    match judged.max_by(|a, b| a.0.total_cmp(&b.0)) {
        None => "\nno pixel was compared in any run".to_owned(),
        Some((worst, ..)) if worst <= 0.0 => "\nnothing is wrong in any run".to_owned(),
        Some((_, run, deeper)) => {
            let pictures = if pictures { format!("\npictures:  {} --out out", run.command) } else { String::new() };
            format!("{pictures}\nnext step: {deeper}")
        }
    }
}

/// report.json always, and the formats asked for.
fn exporters(names: &[String]) -> anyhow::Result<Vec<&'static Exporter>> {
    let mut chosen: Vec<&Exporter> = EXPORTERS.iter().filter(|exporter| exporter.name == "json").collect();
    for name in names {
        let Some(exporter) = Exporter::named(name) else {
            let known: Vec<&str> = EXPORTERS.iter().map(|exporter| exporter.name).collect();
            bail!("no report format '{name}'{}; there are {}", hint(name, known.iter().copied()), known.join(", "));
        };
        if chosen.iter().all(|chosen| chosen.name != exporter.name) {
            chosen.push(exporter);
        }
    }
    Ok(chosen)
}
