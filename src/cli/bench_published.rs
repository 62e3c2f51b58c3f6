//! `gnomon bench-published`: published experiments, repeated, with the error of every answer beside them.

use super::args::BenchPublishedArgs;
use super::columns::{columns, text};
use super::context::{load, open_gpu};
use super::exit;
use super::terminal::{Terminal, say};
use crate::scene::Scene;
use crate::trade::published::{EXPERIMENTS, Experiment, Lab, SCENES};

pub(super) fn run(args: &BenchPublishedArgs, terminal: &Terminal) -> anyhow::Result<u8> {
    let load = |name: &&str| load(&args.folder.join(name), args.size);
    let scenes: Vec<Scene> = SCENES.iter().map(load).collect::<anyhow::Result<_>>()?;
    let gpu = open_gpu()?;
    let adapter = gpu.adapter();
    say(&format!("on {} ({}, {})", adapter.name, adapter.backend, adapter.driver));
    let lab = Lab::new(&gpu, terminal);
    if lab.is_software() {
        say("a software adapter: conclusions are held against counted work; milliseconds are only told");
    }
    let (mut held, mut all) = (0, 0);
    for run in EXPERIMENTS {
        terminal.proceed()?;
        let experiment = run(&lab, &scenes)?;
        terminal.finish();
        say(&told(&experiment));
        held += experiment.rows.iter().filter(|row| row.holds == Some(true)).count();
        all += experiment.rows.iter().filter(|row| row.holds.is_some()).count();
    }
    say(&format!("\n{held} of {all} published conclusions hold here"));
    Ok(exit::OK)
}

fn told(experiment: &Experiment) -> String {
    let mut table = columns();
    table.add_row(["", "published", "here", "error here", "holds"]);
    for row in &experiment.rows {
        let holds = row.holds.map_or("", |holds| if holds { "yes" } else { "NO" });
        table.add_row([&row.what, &row.published, &row.here, &row.error, holds]);
    }
    format!("\n{}\n  {}\n{}", experiment.title, experiment.source, text(table, "  "))
}
