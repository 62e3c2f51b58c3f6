//! What trading costs: a truth taken from the cache beside one worked out; and the HTML report of twenty runs. Each line
//! says what it should stay below.

#![allow(clippy::print_stdout, reason = "a bench prints its table")]

use glam::UVec2;
use gnomon::evaluate::{Effort, TruthStore, View, evaluate, occluders};
use gnomon::gpu::Gpu;
use gnomon::report::Report;
use gnomon::report::export::Exporter;
use gnomon::report::html::{Imagery, QuestionImages, RunImages};
use gnomon::report::model::{Adapter, Question, Run};
use gnomon::scene::{Light, LoadOptions, Scene, load};
use gnomon::technique::Spec;
use gnomon::trade::specs_of_grids;
use gnomon::truth::TruthKey;
use gnomon::watch::Unwatched;
use std::cell::RefCell;
use std::collections::HashMap;
use std::error::Error;
use std::path::Path;
use std::time::Instant;

type Done<T = ()> = Result<T, Box<dyn Error>>;

const SIZE: UVec2 = UVec2::splat(1024);
fn main() -> Done {
    let gpu = Gpu::open()?;
    truth_cache(&gpu)?;
    html(&gpu)
}

fn scene(name: &str, size: UVec2) -> Done<Scene> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name);
    Ok(load(&folder, &LoadOptions { size: Some(size), ..LoadOptions::default() })?)
}

/// Truths in memory.
#[derive(Default)]
struct Memory(RefCell<HashMap<TruthKey, Vec<u8>>>);

impl TruthStore for Memory {
    fn get(&self, key: &TruthKey) -> Option<Vec<u8>> {
        self.0.borrow().get(key).cloned()
    }
    fn put(&self, key: &TruthKey, entry: &[u8]) {
        self.0.borrow_mut().insert(*key, entry.to_vec());
    }
    fn refuse(&self, _key: &TruthKey, _why: &str) {}
}

/// The kitchen's truth (the torus' where the kitchen was not fetched), cold and warm; the second should take less than 5 %.
fn truth_cache(gpu: &Gpu) -> Done {
    let scene = scene("kitchen", SIZE).or_else(|_| scene("torus", SIZE))?;
    let (view, store) = (View::new(gpu, &scene)?, Memory::default());
    let mut ms = [0.0; 2];
    for ms in &mut ms {
        let start = Instant::now();
        view.ask_stored(&scene.lights[0], &store, &Unwatched)?;
        *ms = start.elapsed().as_secs_f64() * 1e3;
    }
    let bytes: usize = store.0.borrow().values().map(Vec::len).sum();
    println!(
        "truth of {}, 1024 x 1024: cold {:.0} ms, warm {:.0} ms, {:.1} % (below 5); {bytes} bytes kept",
        scene.name,
        ms[0],
        ms[1],
        100.0 * ms[1] / ms[0]
    );
    Ok(())
}

/// Twenty runs at 1024²: bytes of the page (below 60 MB), and the time to write it.
fn html(gpu: &Gpu) -> Done {
    let scene = scene("kitchen", SIZE).or_else(|_| scene("torus", SIZE))?;
    let view = View::new(gpu, &scene)?;
    let grids = ["map:size=64..1024,filter=nearest|pcf-box5,bias=none|closed-form".to_owned()];
    let specs = specs_of_grids(&grids)?;
    let question = view.ask(light_for(&specs[0], &scene, gpu)?, &Unwatched)?;
    let mut imagery = Imagery::default();
    imagery.ask(&QuestionImages {
        classes: &question.classes,
        truth: &question.truth.mask,
        receivers: &view.receivers,
        occluders: &occluders(&view, &question),
        meshes: &scene.meshes,
    })?;
    let mut runs = Vec::new();
    for spec in &specs {
        let evaluation = evaluate(&view, &question, spec, Effort::CAUSES, &Unwatched)?;
        let pixels = 0..question.classes.len() as u32;
        let m: Vec<Option<f64>> = pixels.map(|pixel| evaluation.prepared.footprint(pixel).map(|f| f.m)).collect();
        let (mask, ledger, replay) = (&evaluation.mask, &evaluation.ledger, &evaluation.replay);
        imagery.answer(&RunImages { explain: "", mask, ledger, replay, m: &m })?;
        runs.push(
            Run::judged(asked(&scene, question.light, spec), &evaluation.verdict).explained_by(&evaluation.ledger),
        );
    }
    let report = Report::new(Adapter::default(), runs);
    let start = Instant::now();
    let page = (Exporter::named("html").ok_or("no such format")?.write)(&report, &imagery)?;
    let (runs, megabytes, ms) = (report.runs.len(), page.len() as f64 / 1e6, start.elapsed().as_secs_f64() * 1e3);
    println!("report.html of {runs} runs at 1024 x 1024: {megabytes:.1} MB (below 60), written in {ms:.0} ms");
    if let Some(file) = std::env::args().skip(1).find(|arg| arg.ends_with(".html")) {
        std::fs::write(file, page)?;
    }
    Ok(())
}

/// The first light that a technique applies to.
fn light_for<'s>(spec: &Spec, scene: &'s Scene, gpu: &Gpu) -> Done<&'s Light> {
    let applies = |light: &&Light| spec.technique().supports(spec, scene, light, gpu).is_ok();
    Ok(scene.lights.iter().find(applies).ok_or("no light that the technique applies to")?)
}

fn asked(scene: &Scene, light: &Light, spec: &Spec) -> Question {
    Question {
        scene: scene.name.clone(),
        light: light.name.clone(),
        typed: spec.typed.clone(),
        technique: spec.to_string(),
        command: String::new(),
        image: scene.image_size,
        wrong_above: 0.5,
    }
}
