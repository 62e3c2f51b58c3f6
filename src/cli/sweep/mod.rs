//! `gnomon sweep`: every configuration of some grids on every light of some scenes, appended to results.jsonl as it comes;
//! and `gnomon merge`, which joins what several sweeps found.

mod folder;
mod limits;
mod outputs;
mod rows;
mod truths;

use super::args::{MergeArgs, SweepArgs};
use super::context::{lights, load, open_gpu};
use super::exit;
use super::output::OutFolder;
use super::report::adapter;
use super::terminal::{Terminal, say, say_or_end};
use crate::gpu::Gpu;
use crate::report::Report;
use crate::report::model::Status;
use crate::scene::Scene;
use crate::trade::record::{LAYOUT, joined};
use crate::trade::{Header, specs_of_grids};
use crate::watch::Watch;
use anyhow::{Context, ensure};
use folder::ResultsFolder;
use limits::RowLimits;
pub(super) use rows::Shard;
use rows::{Ended, Row, Session, plan};
use std::path::Path;

pub(super) fn run(args: &SweepArgs, terminal: &Terminal) -> anyhow::Result<u8> {
    let specs = specs_of_grids(&args.grid)?;
    let scenes = args.scenes.iter().map(|path| load(path, args.size)).collect::<anyhow::Result<Vec<_>>>()?;
    let scenes: Vec<(&Path, &Scene)> = args.scenes.iter().map(AsRef::as_ref).zip(&scenes).collect();
    for (_, scene) in &scenes {
        lights(scene, args.light.as_deref())?;
    }
    let rows = plan(&scenes, args.light.as_deref(), &specs, args.shard);
    OutFolder::open(&args.out)?;
    let mut gpu = open_gpu()?;
    let mut results = ResultsFolder::open(&args.out, &header(&gpu))?;
    let truths = args.truth_cache.clone().unwrap_or_else(|| args.out.join("truth"));
    let limits = RowLimits { seconds: args.row_seconds, megabytes: args.row_megabytes };
    terminal.start("sweep", rows.len() as u64);
    let ended: anyhow::Result<()> = scenes.iter().try_for_each(|(path, scene)| {
        let mut pending: Vec<&Row<'_>> = rows.iter().filter(|row| std::ptr::eq(row.scene, *scene)).collect();
        while !pending.is_empty() {
            let mut session = Session { results: &mut results, truths: &truths, limits, terminal };
            match session.measure(&gpu, path, scene, &mut pending)? {
                Ended::AllRows => {}
                Ended::DeviceLost => gpu = open_gpu()?,
            }
        }
        Ok(())
    });
    terminal.finish();
    let records = joined([results.records().to_vec()]);
    let failed = records.iter().filter(|record| record.run.status == Status::Failed).count();
    let written = outputs::write(&args.out, &header(&gpu), records)?;
    ended?;
    let code = if failed > 0 { exit::FAILED } else { exit::OK };
    say_or_end(&format!("{} rows, {failed} failed\n{written}", results.records().len()), code);
    Ok(code)
}

pub(super) fn merge(args: &MergeArgs) -> anyhow::Result<u8> {
    OutFolder::open(&args.out)?;
    let mut header: Option<Header> = None;
    let mut files = Vec::new();
    for folder in &args.folders {
        let found = folder::read(folder)?;
        let first = header.get_or_insert_with(|| found.header.clone());
        ensure!(
            *first == found.header,
            "{}: was measured by {} {} on {}, the first folder by {} {} on {}; such costs do not compare",
            folder.display(),
            found.header.tool.name,
            found.header.tool.version,
            found.header.adapter.name,
            first.tool.name,
            first.tool.version,
            first.adapter.name
        );
        files.push(found.records);
    }
    let header = header.context("no folder to merge")?;
    let records = joined(files);
    folder::replace(&args.out, &header, &records)?;
    let rows = records.len();
    say(&format!("{rows} rows\n{}", outputs::write(&args.out, &header, records)?));
    Ok(exit::OK)
}

fn header(gpu: &Gpu) -> Header {
    let Report { tool, adapter, .. } = Report::new(adapter(gpu), Vec::new());
    Header { sweep: LAYOUT, tool, adapter }
}

/// The user asked to stop, told as every command tells it.
fn proceed(watch: &dyn Watch) -> Result<(), crate::watch::Interrupted> {
    if watch.interrupted() { Err(crate::watch::Interrupted) } else { Ok(()) }
}
