//! `gnomon check`: every technique on every light of every scene, as a table and, with --out, as files.

use super::args::CheckArgs;
use super::context::{lights, load, open_gpu};
use super::output::OutFolder;
use super::pictures;
use super::terminal::{Terminal, complain, say, width};
use super::{exit, report};
use crate::evaluate::{Effort, EvaluateError, Question, View, evaluate, jittered};
use crate::gpu::Gpu;
use crate::report::export::{EXPORTERS, Exporter};
use crate::report::model::{BudgetOutcome, Jitter, Report, Run};
use crate::report::table::table;
use crate::scene::{Light, Scene};
use crate::suggest::hint;
use crate::technique::{Spec, TechniqueError};
use anyhow::{Context, bail};
use std::path::Path;

/// What is checked when neither the command line nor the scene says: the default map, and a finer, filtered one.
const DEFAULT_SPECS: [&str; 2] = ["map", "map:size=2048,filter=pcf-box3"];

/// One technique to run for one light, and the limits on it.
struct Task<'s> {
    light: &'s Light,
    spec: Spec,
    wrong_fraction: Option<f64>,
    mean_abs: Option<f64>,
}

/// The runs so far, and where their pictures go.
struct Session<'a> {
    args: &'a CheckArgs,
    gpu: &'a Gpu,
    terminal: &'a Terminal,
    out: Option<OutFolder>,
    runs: Vec<Run>,
}

pub(super) fn run(args: &CheckArgs, terminal: &Terminal) -> anyhow::Result<u8> {
    let exporters = exporters(&args.format)?;
    let specs = args.technique.iter().map(|typed| Spec::parse(typed)).collect::<Result<Vec<_>, _>>()?;
    // Every scene is read before anything long begins: a mistake in the last one should not cost the work of the first.
    let scenes = args.scenes.iter().map(|path| load(path, args.size)).collect::<anyhow::Result<Vec<_>>>()?;
    let tasks: Vec<Vec<Task<'_>>> =
        scenes.iter().map(|scene| tasks(scene, &specs, args)).collect::<anyhow::Result<_>>()?;
    let gpu = open_gpu()?;
    let out = args.out.as_deref().map(OutFolder::open).transpose()?;
    let mut session = Session { args, gpu: &gpu, terminal, out, runs: Vec::new() };
    let ended = args.scenes.iter().zip(&scenes).zip(&tasks).try_for_each(|((path, scene), tasks)| {
        session.check_scene(path, scene, tasks).with_context(|| format!("scene '{}'", scene.name))
    });
    terminal.finish();
    // What is done is reported even when the rest was not to be.
    session.conclude(&exporters)?;
    ended?;
    Ok(verdict_code(&session.runs))
}

impl Session<'_> {
    fn check_scene(&mut self, path: &Path, scene: &Scene, tasks: &[Task<'_>]) -> anyhow::Result<()> {
        let view = View::new(self.gpu, scene)?;
        for light in &scene.lights {
            let mut of_light = tasks.iter().filter(|task| task.light.name == light.name).peekable();
            if of_light.peek().is_none() {
                continue;
            }
            let question = view.ask(light, self.terminal)?;
            for task in of_light {
                self.check_task(path, &view, &question, task)?;
            }
        }
        Ok(())
    }

    fn check_task(
        &mut self,
        path: &Path,
        view: &View<'_>,
        question: &Question<'_>,
        task: &Task<'_>,
    ) -> anyhow::Result<()> {
        let command = report::command(path, task.light, &task.spec, view.scene.image_size, self.args.jitter);
        let asked = report::question(view.scene, task.light, &task.spec, command);
        let evaluation = match evaluate(view, question, &task.spec, Effort::FULL, self.terminal) {
            Ok(evaluation) => evaluation,
            Err(EvaluateError::Technique(TechniqueError::Unsupported(why))) => {
                self.runs.push(Run::unsupported(asked, why.to_string()));
                return Ok(());
            }
            Err(error @ (EvaluateError::Interrupted(_) | EvaluateError::Technique(TechniqueError::Interrupted(_)))) => {
                return Err(error.into());
            }
            Err(error) => {
                self.runs.push(Run::failed(asked, error.to_string()));
                return Ok(());
            }
        };
        let phases = jittered(view, question, &task.spec, self.args.jitter, self.terminal)?;
        let fractions: Vec<f64> = phases.iter().map(|(_, fraction)| *fraction).collect();
        let mut run = Run::judged(asked, &evaluation.verdict).explained_by(&evaluation.ledger);
        run.cost = Some(evaluation.cost.clone());
        run.truth = Some(report::truth_source(question));
        run.jitter = Jitter::of(&fractions);
        run.budget = budget(task, &evaluation.verdict, run.jitter);
        if let Some(out) = &self.out {
            pictures::write_run(out, self.runs.len(), view, question, &run, &evaluation)?;
        }
        self.runs.push(run);
        Ok(())
    }

    /// Prints the table and writes the report.
    fn conclude(&mut self, exporters: &[&Exporter]) -> anyhow::Result<()> {
        if self.runs.is_empty() {
            return Ok(());
        }
        let report = Report::new(report::adapter(self.gpu), std::mem::take(&mut self.runs));
        say(&table(&report, width()));
        match &self.out {
            None => next_step(&report),
            Some(out) => {
                for exporter in exporters {
                    let path = out.write(&format!("report.{}", exporter.extension), &(exporter.write)(&report)?)?;
                    say(&format!("wrote {}", path.display()));
                }
            }
        }
        self.runs = report.runs;
        Ok(())
    }
}

/// The tasks of one scene: the techniques typed, or the scene's budgets, or the default set.
fn tasks<'s>(scene: &'s Scene, typed: &[Spec], args: &CheckArgs) -> anyhow::Result<Vec<Task<'s>>> {
    let lights = lights(scene, args.light.as_deref())?;
    let budgets = scene
        .budgets
        .iter()
        .map(|budget| {
            let spec =
                Spec::parse(&budget.technique).with_context(|| format!("a [[budget]] of scene '{}'", scene.name))?;
            Ok((spec, budget))
        })
        .collect::<anyhow::Result<Vec<_>>>()?;
    let defaults = || DEFAULT_SPECS.iter().map(|typed| Spec::parse(typed)).collect::<Result<Vec<_>, _>>();
    let mut tasks = Vec::new();
    for light in lights {
        let binding: Vec<_> =
            budgets.iter().filter(|(_, budget)| budget.light.as_ref().is_none_or(|name| *name == light.name)).collect();
        let specs = match (typed, binding.as_slice()) {
            ([], []) => defaults()?,
            ([], binding) => binding.iter().map(|(spec, _)| spec.clone()).collect(),
            (typed, _) => typed.to_vec(),
        };
        tasks.extend(specs.into_iter().map(|spec| {
            let budget = binding.iter().find(|(budgeted, _)| *budgeted == spec).map(|(_, budget)| *budget);
            Task {
                light,
                wrong_fraction: budget.and_then(|budget| budget.wrong_fraction),
                mean_abs: budget.and_then(|budget| budget.mean_abs),
                spec,
            }
        }));
    }
    Ok(tasks)
}

/// The outcome of a task's limits; with jitter, its share of wrong pixels is the mean over the phases.
fn budget(task: &Task<'_>, verdict: &crate::verdict::Verdict, jitter: Option<Jitter>) -> Option<BudgetOutcome> {
    if task.wrong_fraction.is_none() && task.mean_abs.is_none() {
        return None;
    }
    let mut judged = verdict.clone();
    if let Some(jitter) = jitter {
        judged.error.wrong_fraction = Some(jitter.wrong_fraction.mean);
    }
    Some(BudgetOutcome::of(&judged, task.wrong_fraction, task.mean_abs))
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

fn verdict_code(runs: &[Run]) -> u8 {
    use crate::report::model::Status;
    if runs.iter().any(|run| run.status == Status::Failed) {
        exit::FAILED
    } else if runs.iter().any(|run| run.budget.as_ref().is_some_and(|budget| !budget.met)) {
        exit::BUDGET
    } else {
        exit::OK
    }
}

/// The command that looks deeper into the worst run.
fn next_step(report: &Report) {
    let fraction = |run: &Run| run.error.and_then(|error| error.wrong_fraction).unwrap_or(0.0);
    let worst = report.runs.iter().max_by(|a, b| fraction(a).total_cmp(&fraction(b)));
    match worst.filter(|run| fraction(run) > 0.0) {
        Some(run) => {
            say(&format!("pictures:  {} --out out", run.command));
            say(&format!("next step: {}", run.command.replacen("gnomon check", "gnomon diagnose", 1)));
        }
        None => complain("nothing is wrong in any run"),
    }
}
