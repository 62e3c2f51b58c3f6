//! `gnomon advise`: the cheapest technique that keeps to a budget, what the next cheaper one gets wrong, and why.

use super::args::AdviseArgs;
use super::command::Subject;
use super::context::{load, only_light, open_gpu};
use super::exit;
use super::terminal::{Terminal, say, say_or_end};
use crate::evaluate::{Effort, EvaluateError, Outcome, Question, View, evaluate, jittered, time_evaluations};
use crate::gpu::Gpu;
use crate::scene::{Light, Scene};
use crate::technique::{Cost, Spec, registry};
use crate::trade::advise::{Line, Search, Trial, lines, search};
use crate::trade::specs_of_grids;
use crate::watch::{Quiet, Watch as _};
use anyhow::{Context, ensure};
use std::collections::BTreeMap;

/// What is searched unless the user types grids: for maps the knobs that users turn first, and every way to count volumes.
const GRIDS: [&str; 5] = [
    "map:size=128..8192,fit=scene|receivers,filter=nearest|pcf-box3|pcf-box5,bias=closed-form|slope",
    "map:projection=cube,size=128..4096,filter=nearest|pcf-box3|pcf-box5",
    "map:projection=cascaded,size=128..4096,filter=nearest|pcf-box3|pcf-box5",
    "map:projection=light-space-perspective|trapezoidal,size=128..8192,filter=nearest|pcf-box3|pcf-box5",
    "volume:count=z-pass|z-fail|mixed|zp-plus",
];
/// An error so many times the budget at the first texel phase is not brought within it by the others.
const HOPELESS: f64 = 4.0;
/// Causes named for the next cheaper configuration.
const NAMED_CAUSES: usize = 3;

pub(super) fn run(args: &AdviseArgs, terminal: &Terminal) -> anyhow::Result<u8> {
    let specs = candidates(&args.grid)?;
    let scene = load(&args.scene.scene, args.scene.size)?;
    let light = only_light(&scene, &args.scene)?;
    let gpu = open_gpu()?;
    let (specs, left_out) = applicable(specs, &scene, light, &gpu);
    let view = View::new(&gpu, &scene)?;
    let question = view.ask(light, terminal)?;
    let asked = question.truth.mask.pixels.iter().flatten().count();
    ensure!(asked > 0, "no pixel of scene '{}' is asked about light '{}'", scene.name, light.name);
    let adviser = Adviser { args, view: &view, question: &question, terminal };
    let lines = lines(&specs);
    let mut costs = BTreeMap::new();
    terminal.start("searching", (specs.len() as u64).div_ceil(4));
    let lengths: Vec<usize> = lines.iter().map(|line| line.steps.len()).collect();
    let search = search(&lengths, args.max_wrong, |line, step| {
        terminal.advance(1);
        let spec = &lines[line].steps[step];
        let Some(measured) = adviser.measure(spec)? else { return Ok(None) };
        let trial = measured.trial(spec, args.max_ms);
        costs.insert((line, step), measured);
        Ok::<_, anyhow::Error>(Some(trial))
    })?;
    terminal.finish();
    let told = Told { adviser: &adviser, lines: &lines, measured: &costs, search: &search, total: specs.len() };
    say(&told.heading(&scene, light));
    let code = told.answer()?;
    say_or_end(&left_out.join("\n"), code);
    Ok(code)
}

/// The grids typed; else our own, and every other technique as it is by default.
fn candidates(grids: &[String]) -> anyhow::Result<Vec<Spec>> {
    if !grids.is_empty() {
        return Ok(specs_of_grids(grids)?);
    }
    let others = registry().iter().map(|technique| technique.id());
    let own = GRIDS.iter().map(|grid| (*grid).to_owned());
    let covered = |id: &str| GRIDS.iter().any(|grid| grid.split(':').next() == Some(id));
    let grids: Vec<String> = own.chain(others.filter(|id| !covered(id)).map(str::to_owned)).collect();
    Ok(specs_of_grids(&grids)?)
}

/// The specifications that apply to this light, and which do not and why, one line per reason.
fn applicable(specs: Vec<Spec>, scene: &Scene, light: &Light, gpu: &Gpu) -> (Vec<Spec>, Vec<String>) {
    let mut reasons: Vec<(String, &'static str, usize)> = Vec::new();
    let applies = |spec: &Spec| {
        let supports = |spec: &Spec| spec.technique().supports(spec, scene, light, gpu);
        let family = spec.technique().id();
        let is_cube = family == "map" && spec.choice("projection").0 == "cube";
        let fits_in_one = || spec.with("projection", "single").is_ok_and(|single| supports(&single).is_ok());
        let why = match supports(spec) {
            Ok(()) if is_cube && fits_in_one() => "one frustum holds all receivers: no need for a cube".to_owned(),
            Ok(()) => return true,
            Err(why) => why.to_string(),
        };
        match reasons.iter_mut().find(|(known, of, _)| (known, *of) == (&why, family)) {
            Some((.., count)) => *count += 1,
            None => reasons.push((why, family, 1)),
        }
        false
    };
    let specs = specs.into_iter().filter(applies).collect();
    let line =
        |(why, family, count): (String, &str, usize)| format!("left out      {family} ({count} configurations): {why}");
    (specs, reasons.into_iter().map(line).collect())
}

/// What a configuration showed over the texel phases.
struct Measured {
    mean: f64,
    worst: f64,
    phases: usize,
    cost: Cost,
    is_software: bool,
}

impl Measured {
    fn ms(&self) -> Option<f64> {
        self.cost.gpu_ms.map(|time| time.median)
    }

    /// On a software adapter counted work ranks, on a real one time does.
    fn trial(&self, spec: &Spec, max_ms: Option<f64>) -> Trial {
        let by_work = Trial::by_work(spec, self.mean, &self.cost);
        let trial = match (by_work, self.ms()) {
            (Some(by_work), ms) if self.is_software || ms.is_none() => by_work,
            (_, ms) => {
                let cost = ms.unwrap_or(self.cost.bytes as f64);
                Trial { error: self.mean, cost, next_cost: cost, least_cost: 0.0, is_allowed: true }
            }
        };
        let is_allowed = max_ms.is_none_or(|limit| self.ms().is_some_and(|ms| ms <= limit));
        Trial { is_allowed, ..trial }
    }
}

/// Measures configurations.
struct Adviser<'a> {
    args: &'a AdviseArgs,
    view: &'a View<'a>,
    question: &'a Question<'a>,
    terminal: &'a Terminal,
}

impl Adviser<'_> {
    /// `None` for a configuration that gives no answer.
    fn measure(&self, spec: &Spec) -> anyhow::Result<Option<Measured>> {
        let is_software = self.view.gpu.adapter().is_software;
        let is_timed = self.args.max_ms.is_some() || !is_software;
        let quiet = Quiet(self.terminal);
        let measured = evaluate(self.view, self.question, spec, Effort::VERDICT, &quiet).and_then(|mut evaluation| {
            if is_timed {
                time_evaluations(self.view, &mut [&mut evaluation], &quiet)?;
            }
            let first = evaluation.verdict.error.wrong_fraction.unwrap_or(0.0);
            let phases = if first > HOPELESS * self.args.max_wrong { 0 } else { self.args.phases };
            let mut errors: Vec<f64> =
                jittered(self.view, self.question, spec, phases, &quiet)?.into_iter().map(|(_, error)| error).collect();
            if errors.is_empty() {
                errors.push(first);
            }
            let mean = errors.iter().sum::<f64>() / errors.len() as f64;
            let worst = errors.iter().copied().fold(0.0, f64::max);
            Ok(Measured { mean, worst, phases: errors.len(), cost: evaluation.cost, is_software })
        });
        match measured {
            Ok(measured) => Ok(Some(measured)),
            Err(error) if error.is_interrupt() => Err(error.into()),
            Err(EvaluateError::Technique(_)) => Ok(None),
            Err(error) => Err(error.into()),
        }
    }

    /// What is wrong with a configuration, the main causes with their shares.
    fn causes(&self, spec: &Spec) -> anyhow::Result<String> {
        let quiet = Quiet(self.terminal);
        let outcome = Outcome::of(&evaluate(self.view, self.question, spec, Effort::CAUSES, &quiet)?);
        let mut causes: Vec<_> = outcome.wrong_by_cause.into_iter().collect();
        causes.sort_by_key(|(_, pixels)| std::cmp::Reverse(*pixels));
        let share = |pixels: u64| 100.0 * pixels as f64 / outcome.wrong.max(1) as f64;
        let named =
            causes.iter().take(NAMED_CAUSES).map(|(cause, pixels)| format!("{} {:.0} %", cause.name(), share(*pixels)));
        Ok(named.collect::<Vec<_>>().join(", "))
    }
}

/// A search in words.
struct Told<'a> {
    adviser: &'a Adviser<'a>,
    lines: &'a [Line],
    measured: &'a BTreeMap<(usize, usize), Measured>,
    search: &'a Search,
    total: usize,
}

impl Told<'_> {
    fn heading(&self, scene: &Scene, light: &Light) -> String {
        let AdviseArgs { max_wrong, max_ms, .. } = self.adviser.args;
        let time = max_ms.map_or_else(String::new, |ms| format!(" in at most {ms} ms"));
        let (x, y) = (scene.image_size.x, scene.image_size.y);
        format!(
            "{} / {}, {x} x {y}: at most {} wrong{time}; {} of {} configurations tried",
            scene.name,
            light.name,
            percent(*max_wrong),
            self.search.tried.len(),
            self.total
        )
    }

    /// Says the answer or the closest, and returns the exit code.
    fn answer(&self) -> anyhow::Result<u8> {
        let tried = &self.search.tried;
        let Some(answer) = self.search.answer else {
            let allowed =
                tried.iter().filter(|(.., trial)| trial.is_allowed).min_by(|a, b| a.2.error.total_cmp(&b.2.error));
            let closest = allowed.or_else(|| tried.iter().min_by(|a, b| a.2.error.total_cmp(&b.2.error)));
            let (line, step, _) = closest.context("no configuration gave an answer")?;
            say("answer        none");
            self.say_one("closest", (*line, *step), true)?;
            return Ok(exit::BUDGET);
        };
        self.say_one("answer", answer, false)?;
        let cost = tried.iter().find(|(line, step, _)| (*line, *step) == answer).map_or(0.0, |(.., trial)| trial.cost);
        let cheaper = tried.iter().filter(|(.., trial)| trial.cost < cost).max_by(|a, b| a.2.cost.total_cmp(&b.2.cost));
        match cheaper {
            Some((line, step, _)) => self.say_one("next cheaper", (*line, *step), true)?,
            None => say("next cheaper  nothing that was tried"),
        }
        Ok(exit::OK)
    }

    fn say_one(&self, label: &str, at: (usize, usize), with_causes: bool) -> anyhow::Result<()> {
        let (spec, measured) = (&self.lines[at.0].steps[at.1], &self.measured[&at]);
        let phases = match measured.phases {
            1 => String::new(),
            phases => format!(" on average over {phases} texel phases, {} at worst", percent(measured.worst)),
        };
        say(&format!("{label:<13} {}\n              {} wrong{phases}", spec.short(), percent(measured.mean)));
        say(&format!("              {}", cost_in_words(&measured.cost, measured.is_software)));
        if with_causes {
            let causes = self.adviser.causes(spec)?;
            if !causes.is_empty() {
                say(&format!("              because of {causes}"));
            }
        }
        let Question { light, .. } = self.adviser.question;
        let scene = &self.adviser.args.scene.scene;
        let subject = Subject { scene, light: &light.name, spec, size: self.adviser.view.scene.image_size };
        say(&format!("              {}", subject.check(self.adviser.args.phases, 0)));
        Ok(())
    }
}

fn cost_in_words(cost: &Cost, is_software: bool) -> String {
    let work = cost.work().map(|work| format!("counted work {work}"));
    let mark = if is_software { " (software adapter)" } else { "" };
    let ms = cost.gpu_ms.map(|time| format!("{:.3} ms{mark}", time.median));
    let parts = [work, Some(format!("{} bytes", cost.bytes)), ms];
    parts.into_iter().flatten().collect::<Vec<_>>().join(", ")
}

fn percent(share: f64) -> String {
    format!("{} %", (share * 1e8).round() / 1e6)
}
