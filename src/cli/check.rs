//! `gnomon check`: every technique on every light of every scene, as a table and, with --out, as files.

use super::answered::Answered;
use super::args::CheckArgs;
use super::command::Subject;
use super::context::{ask, load, mitsuba_for, open_gpu};
use super::imagery::Collector;
use super::output::OutFolder;
use super::tasks::{Task, tasks};
use super::terminal::{Terminal, complain, say_or_end, width};
use super::{exit, pictures, report};
use crate::evaluate::{Evaluation, Question, View, time_evaluations};
use crate::gpu::Gpu;
use crate::report::export::{EXPORTERS, Exporter};
use crate::report::html::Imagery;
use crate::report::model::{Report, Run, Status};
use crate::report::table::table;
use crate::scene::Scene;
use crate::suggest::hint;
use crate::technique::Spec;
use anyhow::{Context, bail};
use std::path::{Path, PathBuf};

/// So many answers at most are kept to be timed in turn: what is done should soon be on the disk.
const COMPARED: usize = 16;
/// And so many bytes.
const COMPARED_BYTES: usize = 1 << 30;

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
            let mut compared = Vec::new();
            let ended = of_light.iter().try_for_each(|task| {
                compared.push(Answered::new(&view, &question, task, self.args, self.terminal)?);
                let bytes: usize = compared.iter().map(Answered::bytes).sum();
                if compared.len() == COMPARED || bytes > COMPARED_BYTES {
                    self.add(path, &view, &question, std::mem::take(&mut compared))?;
                }
                anyhow::Ok(())
            });
            // What is done is reported even when the rest was not to be.
            self.add(path, &view, &question, compared)?;
            ended?;
        }
        Ok(())
    }

    /// Times some answers in turn, and adds their runs to the report and the pictures to the folder.
    fn add(
        &mut self,
        path: &Path,
        view: &View<'_>,
        question: &Question<'_>,
        mut compared: Vec<Answered<'_, '_>>,
    ) -> anyhow::Result<()> {
        let mut evaluations: Vec<&mut Evaluation<'_>> = compared.iter_mut().filter_map(Answered::evaluation).collect();
        match time_evaluations(view, &mut evaluations, self.terminal) {
            Err(error) if !error.is_interrupt() => complain(&format!("warning: there are no times: {error}")),
            _ => {}
        }
        for answered in compared {
            let task = answered.task;
            let size = view.scene.image_size;
            let subject = Subject { scene: path, light: &task.light.name, spec: &task.spec, size };
            let options = subject.check(self.args.jitter, self.args.motion) + self.args.oracle.option();
            let run = answered.run(report::question(view.scene, task.light, &task.spec, options), question);
            let evaluation = answered.outcome.as_ref().ok().map(|answer| &answer.evaluation);
            let explain = subject.explain_some_pixel();
            self.pixels.add(question, evaluation.map(|evaluation| (evaluation, explain.as_str())))?;
            if let (Some(out), Some(evaluation)) = (&self.out, evaluation) {
                pictures::write_run(out, self.runs.len(), view, question, &run, evaluation)?;
            }
            self.runs.push(run);
            self.deeper.push(subject.diagnose());
        }
        Ok(())
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
