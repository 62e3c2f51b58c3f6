//! `gnomon compare`: what changed from one report.json to another.

use super::args::CompareArgs;
use super::exit;
use super::terminal::say_or_end;
use crate::report::Report;
use crate::report::compare::{Tolerance, changes_as_text, compare};
use crate::report::model::SCHEMA;
use anyhow::{Context, ensure};
use std::path::Path;

pub(super) fn run(args: &CompareArgs) -> anyhow::Result<u8> {
    let (before, after) = (read(&args.before)?, read(&args.after)?);
    let tolerance =
        Tolerance { wrong_fraction: args.max_new_wrong, work_ratio: args.max_work_ratio, ms_ratio: args.max_ms_ratio };
    let changes = compare(&before, &after, &tolerance);
    let is_worse = changes.iter().any(|change| !change.regressions.is_empty());
    let code = if is_worse { exit::BUDGET } else { exit::OK };
    say_or_end(&changes_as_text(&changes), code);
    Ok(code)
}

/// A report.json, or the one in a folder.
fn read(path: &Path) -> anyhow::Result<Report> {
    let file = if path.is_dir() { path.join("report.json") } else { path.to_owned() };
    let bytes = std::fs::read(&file).with_context(|| format!("{}: cannot be read", file.display()))?;
    let report: Report =
        serde_json::from_slice(&bytes).with_context(|| format!("{}: is no report of gnomon's", file.display()))?;
    ensure!(report.schema == SCHEMA, "{}: has schema {}, this gnomon reads {SCHEMA}", file.display(), report.schema);
    Ok(report)
}
