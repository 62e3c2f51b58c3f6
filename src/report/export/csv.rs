//! CSV: one line per run, one column per figure, for spreadsheets and plots.
//!
//! Figures that do not apply are empty. Columns are always all there, among them two for each cause. Names are quoted
//! where they need it and never changed, so that a script reads back what the scene says.

use super::ExportError;
use crate::cause::Cause;
use crate::report::Report;
use crate::report::model::{Run, Status};

/// A column: its head, and what stands in it.
struct Column {
    head: String,
    cell: Box<dyn Fn(&Run) -> String>,
}

/// The report as CSV with a head line (RFC 4180, but lines end in a bare line feed).
pub(super) fn to_csv(report: &Report) -> Result<Vec<u8>, ExportError> {
    let columns = columns();
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(columns.iter().map(|column| &column.head))?;
    for run in &report.runs {
        writer.write_record(columns.iter().map(|column| (column.cell)(run)))?;
    }
    writer.into_inner().map_err(|error| csv::Error::from(error.into_error()).into())
}

fn columns() -> Vec<Column> {
    let mut columns = Vec::new();
    let mut add = |head: &str, cell: fn(&Run) -> Option<String>| {
        columns.push(Column { head: head.to_owned(), cell: Box::new(move |run| cell(run).unwrap_or_default()) });
    };
    add_labels(&mut add);
    add_pixels(&mut add);
    add_errors(&mut add);
    add_costs(&mut add);
    add_context(&mut add);
    for cause in Cause::ALL {
        let entry = move |run: &Run| run.causes.as_ref().and_then(|causes| causes.get(&cause).copied());
        let pixels = move |run: &Run| entry(run).map(|entry| entry.pixels.to_string()).unwrap_or_default();
        let sum = move |run: &Run| entry(run).map(|entry| entry.sum.to_string()).unwrap_or_default();
        columns.push(Column { head: format!("{}_pixels", cause.name()), cell: Box::new(pixels) });
        columns.push(Column { head: format!("{}_sum", cause.name()), cell: Box::new(sum) });
    }
    columns
}

/// Adds a column of a head and what stands in it.
type Add<'a> = dyn FnMut(&str, fn(&Run) -> Option<String>) + 'a;

fn text(value: impl ToString + Copy) -> Option<String> {
    Some(value.to_string())
}

fn add_labels(add: &mut Add) {
    add("scene", |run| text(&run.scene));
    add("light", |run| text(&run.light));
    add("typed", |run| text(&run.typed));
    add("technique", |run| text(&run.technique));
    add("command", |run| text(&run.command));
    add("status", |run| {
        text(match run.status {
            Status::Ok => "ok",
            Status::Unsupported => "unsupported",
            Status::Failed => "failed",
        })
    });
    add("why", |run| run.why.clone());
    add("width", |run| text(run.image[0]));
    add("height", |run| text(run.image[1]));
    add("wrong_above", |run| text(run.wrong_above));
}

fn add_pixels(add: &mut Add) {
    add("total", |run| text(run.pixels?.total));
    add("background", |run| text(run.pixels?.background));
    add("facing_away", |run| text(run.pixels?.facing_away));
    add("not_lit", |run| text(run.pixels?.not_lit));
    add("undecided", |run| text(run.pixels?.undecided));
    add("asked", |run| text(run.pixels?.asked));
    add("wrong", |run| text(run.pixels?.wrong));
    add("differing", |run| text(run.pixels?.differing));
    add("false_shadow", |run| text(run.pixels?.false_shadow));
    add("false_light", |run| text(run.pixels?.false_light));
}

fn add_errors(add: &mut Add) {
    add("mean_abs", |run| text(run.error?.mean_abs?));
    add("signed", |run| text(run.error?.signed?));
    add("wrong_fraction", |run| text(run.error?.wrong_fraction?));
    add("largest_blob_px", |run| text(run.error?.largest_blob_px));
    add("edge_distance_px_p50", |run| text(run.error?.edge_distance_px?.p50));
    add("edge_distance_px_p99", |run| text(run.error?.edge_distance_px?.p99));
    add("edge_distance_px_max", |run| text(run.error?.edge_distance_px?.max));
}

fn add_costs(add: &mut Add) {
    add("gpu_ms_median", |run| text(run.cost.as_ref()?.gpu_ms?.median));
    add("gpu_ms_min", |run| text(run.cost.as_ref()?.gpu_ms?.min));
    add("gpu_ms_max", |run| text(run.cost.as_ref()?.gpu_ms?.max));
    add("gpu_ms_runs", |run| text(run.cost.as_ref()?.gpu_ms?.runs));
    add("gbuffer_ms", |run| text(run.cost.as_ref()?.gbuffer_ms?));
    add("prepare_ms", |run| text(run.cost.as_ref()?.prepare_ms?));
    add("bytes", |run| text(run.cost.as_ref()?.bytes));
    add("vertices", |run| text(run.cost.as_ref()?.vertices?));
    add("primitives", |run| text(run.cost.as_ref()?.primitives?));
    add("fragments", |run| text(run.cost.as_ref()?.fragments?));
    add("texel_reads", |run| text(run.cost.as_ref()?.texel_reads?));
}

fn add_context(add: &mut Add) {
    add("oracle", |run| text(&run.truth.as_ref()?.oracle));
    add("rays", |run| text(run.truth.as_ref()?.rays));
    add("truth_ms", |run| text(run.truth.as_ref()?.ms));
    add("disagreements_mitsuba", |run| text(run.truth.as_ref()?.disagreements.mitsuba?));
    add("disagreements_brute", |run| text(run.truth.as_ref()?.disagreements.brute?));
    add("budget_wrong_fraction", |run| text(run.budget?.wrong_fraction?));
    add("budget_mean_abs", |run| text(run.budget?.mean_abs?));
    add("budget_met", |run| text(run.budget?.met));
    add("budget_met_worst_case", |run| text(run.budget?.met_worst_case));
    add("jitter_phases", |run| text(run.jitter?.phases));
    add("jitter_wrong_fraction_mean", |run| text(run.jitter?.wrong_fraction.mean));
    add("jitter_wrong_fraction_min", |run| text(run.jitter?.wrong_fraction.min));
    add("jitter_wrong_fraction_max", |run| text(run.jitter?.wrong_fraction.max));
    add("jitter_wrong_fraction_stddev", |run| text(run.jitter?.wrong_fraction.stddev));
    add("motion_steps", |run| text(run.motion?.steps));
    add("motion_followed", |run| text(run.motion?.followed.name()));
    add("motion_camera_flips_mean", |run| text(run.motion?.camera_flips.mean));
    add("motion_camera_flips_max", |run| text(run.motion?.camera_flips.max));
    add("motion_light_flips_mean", |run| text(run.motion?.light_flips.mean));
    add("motion_light_flips_max", |run| text(run.motion?.light_flips.max));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::model::tests::{HOSTILE, report, report_of};

    /// Lines of cells, the head first.
    fn cells(report: &Report) -> Vec<Vec<String>> {
        let bytes = to_csv(report).unwrap();
        let mut reader = csv::ReaderBuilder::new().has_headers(false).from_reader(bytes.as_slice());
        reader.records().map(|line| line.unwrap().iter().map(str::to_owned).collect()).collect()
    }

    fn cell(lines: &[Vec<String>], run: usize, head: &str) -> String {
        let column = lines[0].iter().position(|h| h == head).unwrap();
        lines[run + 1][column].clone()
    }

    #[test]
    fn every_run_is_one_line_of_all_columns() {
        let lines = cells(&report());
        assert_eq!(lines.len(), 1 + 3);
        assert!(lines.iter().all(|line| line.len() == lines[0].len()));
        let mut heads = lines[0].clone();
        heads.sort_unstable();
        heads.dedup();
        assert_eq!(heads.len(), lines[0].len(), "no head is there twice");
        assert_eq!(cell(&lines, 0, "wrong"), "3");
        assert_eq!(cell(&lines, 0, "acne_sum"), "-2.1");
        assert_eq!(cell(&lines, 0, "gpu_ms_max").parse(), Ok(0.1 + 0.2));
        assert_eq!(cell(&lines, 0, "disagreements_mitsuba"), "");
        assert_eq!(cell(&lines, 1, "wrong"), "");
        assert_eq!(cell(&lines, 1, "why"), "open mesh, 12 edges");
    }

    #[test]
    fn every_cause_has_its_columns() {
        let lines = cells(&report());
        for cause in Cause::ALL {
            assert!(lines[0].contains(&format!("{}_pixels", cause.name())));
        }
        assert_eq!(cell(&lines, 0, "light-bleeding_pixels"), "");
    }

    #[test]
    fn hostile_names_stay_in_their_cell() {
        let lines = cells(&report_of(HOSTILE));
        assert_eq!(lines.len(), 1 + 3);
        assert_eq!(cell(&lines, 0, "scene"), HOSTILE);
        assert_eq!(cell(&lines, 0, "light"), "lamp");
    }
}
