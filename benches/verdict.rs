//! What judging costs beside finding the truth: verdict and error map of a 1024² picture of the kitchen (the torus where
//! the kitchen was not fetched), as a share of the truth's time in the same run; and the peak memory of `gnomon check`.

#![allow(clippy::print_stdout, reason = "a bench prints its table")]

use glam::UVec2;
use gnomon::evaluate::View;
use gnomon::gpu::Gpu;
use gnomon::mask::{Mask, Truth, Visibility};
use gnomon::report::picture::{Caption, ErrorMap, error_map};
use gnomon::scene::{LoadOptions, load};
use gnomon::verdict::{WRONG_ABOVE_HARD, judge};
use gnomon::watch::Unwatched;
use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Width and height of the picture.
const SIZE: UVec2 = UVec2::splat(1024);
/// Everything is timed this often; the median counts.
const ROUNDS: usize = 7;
/// Every so many-th asked pixel of the judged mask is wrong.
const WRONG_EVERY: usize = 100;
/// How often the child's memory is looked at; the kernel keeps the peak, so only its last moments can escape.
const SAMPLING: Duration = Duration::from_millis(5);

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scene_path = scene_path();
    let scene = load(&scene_path, &LoadOptions { size: Some(SIZE), ..LoadOptions::default() })?;
    let gpu = Gpu::open()?;
    let view = View::new(&gpu, &scene)?;
    let light = &scene.lights[0];
    let mut truths = Vec::new();
    let mut verdicts = Vec::new();
    let question = view.ask(light, &Unwatched)?;
    let mask = slightly_wrong(&question.truth.mask.pixels);
    let mut wrong = 0;
    for _ in 0..ROUNDS {
        let began = Instant::now();
        black_box(view.ask(light, &Unwatched)?);
        truths.push(began.elapsed());
        let began = Instant::now();
        let (classes, truth) = (&question.classes, &question.truth.mask);
        let verdict = judge(classes, truth, &mask, WRONG_ABOVE_HARD)?;
        let caption = Caption { scene: &scene.name, light: &light.name, technique: "bench" };
        black_box(error_map(&ErrorMap { caption, classes, truth, mask: &mask, verdict: &verdict })?);
        verdicts.push(began.elapsed());
        wrong = verdict.pixels.wrong;
    }
    let (truth, verdict) = (median(truths), median(verdicts));
    println!("{} / {}, {} rays, {wrong} wrong pixels", scene.name, light.name, question.truth.rays);
    println!("truth                    {:>8.1} ms", ms(truth));
    println!("verdict and error map    {:>8.1} ms   {:.2} of the truth", ms(verdict), ms(verdict) / ms(truth));
    report_memory(&scene_path)?;
    Ok(())
}

fn scene_path() -> PathBuf {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let has_kitchen = scenes.join("kitchen/kitchen.obj").is_file();
    scenes.join(if has_kitchen { "kitchen" } else { "torus" })
}

fn slightly_wrong(truth: &[Option<Truth>]) -> Mask {
    let answer = |(index, truth): (usize, &Option<Truth>)| {
        truth.map(|truth| {
            let is_lit = matches!(truth, Truth::Known(Visibility::LIT));
            if is_lit == index.is_multiple_of(WRONG_EVERY) { Visibility::SHADOW } else { Visibility::LIT }
        })
    };
    Mask { size: SIZE, pixels: truth.iter().enumerate().map(answer).collect() }
}

/// Peak memory of the command, sampled from the kernel's account of the child process while it runs.
fn report_memory(scene: &Path) -> std::io::Result<()> {
    let mut child = Command::new(env!("CARGO_BIN_EXE_gnomon"))
        .arg("check")
        .arg(scene)
        .args(["--size", "1024x1024"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()?;
    let mut peak_kib = 0_u32;
    while child.try_wait()?.is_none() {
        // Without a /proc there is nothing to read, and nothing is reported.
        let status = std::fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap_or_default();
        let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        peak_kib = line.and_then(|kib| kib.trim().trim_end_matches(" kB").parse().ok()).unwrap_or(peak_kib);
        std::thread::sleep(SAMPLING);
    }
    println!("peak memory of check     {:>8.0} MB", f64::from(peak_kib) * 1024.0 / 1e6);
    Ok(())
}

fn median(mut times: Vec<Duration>) -> Duration {
    times.sort();
    times[times.len() / 2]
}

fn ms(time: Duration) -> f64 {
    1e3 * time.as_secs_f64()
}
