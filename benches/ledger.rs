//! What explanations cost: `explain` and `diagnose` on the kitchen (on the torus where the kitchen was not fetched) at
//! 1024 × 1024 beside `check` on the same input, each from the scene file on. The ratios are what counts; each should
//! stay below 3.

#![allow(clippy::print_stdout, reason = "a bench prints its table")]

use glam::UVec2;
use gnomon::evaluate::{Effort, Trials, View, diagnose, evaluate, search_bias};
use gnomon::gpu::Gpu;
use gnomon::receiver::PixelClass;
use gnomon::scene::{LoadOptions, Scene, load};
use gnomon::technique::Spec;
use gnomon::truth;
use gnomon::verdict::{WRONG_ABOVE_HARD, judge, ledger};
use gnomon::watch::Unwatched;
use std::error::Error;
use std::hint::black_box;
use std::path::Path;
use std::time::{Duration, Instant};

type Done = Result<(), Box<dyn Error>>;
/// A command's work on the scene of that name.
type Work = fn(&Gpu, &str, &Spec) -> Done;

const SIZE: UVec2 = UVec2::splat(1024);
const LIGHT: &str = "sun";
/// Each is timed this often, in turn, and its best time counts.
const ROUNDS: u32 = 3;

fn main() -> Done {
    let name = ["kitchen", "torus"].into_iter().find(|name| scene(name).is_ok()).ok_or("no scene")?;
    let spec = Spec::parse("map")?;
    let gpu = Gpu::open()?;
    let works: [(&str, Work); 3] = [("check", check), ("explain", explain), ("diagnose", diagnosed)];
    let mut best = [Duration::MAX; 3];
    for _ in 0..ROUNDS {
        for ((_, work), best) in works.iter().zip(&mut best) {
            let start = Instant::now();
            work(&gpu, name, &spec)?;
            *best = start.elapsed().min(*best);
        }
    }
    println!("{name}, light '{LIGHT}', {}, {} x {}", spec.short(), SIZE.x, SIZE.y);
    for ((what, _), time) in works.iter().zip(best) {
        let ratio = time.as_secs_f64() / best[0].as_secs_f64();
        println!("{what:<10} {:>8.0} ms {ratio:>6.2}", time.as_secs_f64() * 1e3);
    }
    Ok(())
}

fn scene(name: &str) -> Result<Scene, Box<dyn Error>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name);
    Ok(load(&folder, &LoadOptions { size: Some(SIZE), ..LoadOptions::default() })?)
}

/// The verdict, its causes and the cost.
fn check(gpu: &Gpu, name: &str, spec: &Spec) -> Done {
    let scene = scene(name)?;
    let view = View::new(gpu, &scene)?;
    let question = view.ask(scene.light(LIGHT).ok_or("no such light")?, &Unwatched)?;
    let evaluation = evaluate(&view, &question, spec, Effort::CAUSES, &Unwatched)?;
    black_box(evaluation.ledger.wrong.len());
    Ok(())
}

/// Everything about the pixel in the middle: the truth of it alone, the technique's whole answer.
fn explain(gpu: &Gpu, name: &str, spec: &Spec) -> Done {
    let scene = scene(name)?;
    let view = View::new(gpu, &scene)?;
    let light = scene.light(LIGHT).ok_or("no such light")?;
    let classes = view.receivers.classify(&scene, light);
    let pixel = (classes.len() / 2..classes.len())
        .chain(0..classes.len())
        .find(|pixel| classes[*pixel] == PixelClass::Asked)
        .ok_or("nothing is asked")?;
    let mut only_this = vec![PixelClass::NotLit; classes.len()];
    only_this[pixel] = PixelClass::Asked;
    let truth = truth::exact(&scene, &view.casters, light, &view.receivers, &only_this, &Unwatched)?.mask;
    let prepared = spec.technique().prepare(spec, view.job(light, &classes))?;
    let mask = prepared.run()?.mask;
    let replay = prepared.replay(&mask, &[pixel as u32])?;
    let verdict = judge(&only_this, &truth, &mask, WRONG_ABOVE_HARD)?;
    black_box(ledger(&verdict, &truth, &mask, &replay)?.cause_of(pixel as u32));
    black_box(prepared.lookup_facts(pixel as u32)?.len());
    Ok(())
}

/// Every cause with the fixes that were tried, and the search for a bias.
fn diagnosed(gpu: &Gpu, name: &str, spec: &Spec) -> Done {
    let scene = scene(name)?;
    let view = View::new(gpu, &scene)?;
    let question = view.ask(scene.light(LIGHT).ok_or("no such light")?, &Unwatched)?;
    let evaluation = evaluate(&view, &question, spec, Effort::CAUSES, &Unwatched)?;
    let mut trials = Trials::new(&view, &question);
    black_box(diagnose(&mut trials, spec, &evaluation, &Unwatched)?.len());
    black_box(search_bias(&mut trials, spec, &Unwatched)?.is_some());
    Ok(())
}
