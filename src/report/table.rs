//! The table a terminal shows: one block per scene and light, two lines per technique.
//!
//! Figures that belong together stand above one another, so that 100 columns suffice; technique and causes wrap into
//! what the figures leave. Every block has the same column widths.

use super::Report;
use super::details::{Detail, details};
use super::format::{grouped, printable, wrapped};
use super::model::Run;
use super::summary::{BUDGET_NOTE, Summary, software_note};
use comfy_table::{
    Cell, CellAlignment, ColumnConstraint, ContentArrangement, ContentLineStyle, LineStyle, Table, Width,
};

/// Technique and causes never get narrower than this, whatever the terminal.
const NARROWEST: u16 = 12;

/// Space between two columns.
const GAP: u16 = 2;

/// How far details stand in below the name of their run.
const INDENT: usize = 2;

const HEADS: [&str; 6] = [
    "technique",
    "wrong px\nshare",
    "false shadow\nfalse light",
    "mean |e|\nedge p99",
    "main causes",
    "GPU ms\nbudget",
];

/// Columns whose text wraps.
const TECHNIQUE: usize = 0;
const CAUSES: usize = 4;

/// The report as text of at most `width` columns (if that is at all possible), without colours.
#[must_use]
pub fn table(report: &Report, width: u16) -> String {
    let rows: Vec<[String; 6]> = report.runs.iter().map(|run| cells(run, report)).collect();
    let widths = column_widths(&rows, width);
    let mut text = String::new();
    let mut start = 0;
    for runs in report.runs.chunk_by(|a, b| (&a.scene, &a.light, a.image) == (&b.scene, &b.light, b.image)) {
        let end = start + runs.len();
        text.push_str(&block(runs, &rows[start..end], widths));
        runs.iter().for_each(|run| text.push_str(&detailed(run, width.into())));
        text.push('\n');
        start = end;
    }
    let notes = [software_note(&report.adapter), Summary::any_doubtful_budget(report).then(|| BUDGET_NOTE.to_owned())];
    for note in notes.into_iter().flatten() {
        text.push_str(&note);
        text.push('\n');
    }
    text
}

/// A heading, the runs with a verdict as a table, and a line for each of the others.
fn block(runs: &[Run], rows: &[[String; 6]], widths: [u16; 6]) -> String {
    let mut text = format!("{}\n", heading(runs));
    let judged: Vec<&[String; 6]> =
        runs.iter().zip(rows).filter(|(run, _)| run.pixels.is_some()).map(|(_, row)| row).collect();
    if !judged.is_empty() {
        text.push_str(&formatted(&judged, widths));
    }
    for run in runs.iter().filter(|run| run.pixels.is_none()) {
        let why = printable(run.why.as_deref().unwrap_or_default());
        text.push_str(&format!("{}  {}: {why}\n", printable(&run.typed), Summary::verdictless(run)));
    }
    text
}

/// What else is known of a run, below its name, indented and labelled.
fn detailed(run: &Run, width: usize) -> String {
    let details = details(run);
    let label_width = details.iter().map(|detail| detail.label.len()).max().unwrap_or(0);
    let indent = INDENT + label_width + usize::from(GAP);
    let lines = |detail: Detail| -> String {
        let labels = std::iter::once(detail.label).chain(std::iter::repeat(""));
        let lines = wrapped(&detail.text, width.saturating_sub(indent));
        let line = |(label, line): (&str, &String)| format!("{:indent$}{line}\n", format!("{:INDENT$}{label}", ""));
        labels.zip(&lines).map(line).collect()
    };
    let name = if details.is_empty() { Vec::new() } else { wrapped(&printable(&run.typed), width) };
    name.iter().map(|line| format!("{line}\n")).chain(details.into_iter().map(lines)).collect()
}

fn heading(runs: &[Run]) -> String {
    let run = &runs[0];
    let [width, height] = run.image;
    let names = format!("{} / {}   {width} × {height}", printable(&run.scene), printable(&run.light));
    match runs.iter().find_map(|run| run.pixels) {
        None => names,
        Some(pixels) if pixels.undecided == 0 => format!("{names}, {} asked", grouped(pixels.asked)),
        Some(pixels) => {
            format!("{names}, {} asked, {} undecided", grouped(pixels.asked), grouped(pixels.undecided))
        }
    }
}

fn cells(run: &Run, report: &Report) -> [String; 6] {
    let summary = Summary::of(run, &report.adapter);
    [
        printable(&run.typed),
        format!("{}\n{}", summary.wrong, summary.wrong_share),
        format!("{}\n{}", summary.false_shadow, summary.false_light),
        format!("{}\n{}", summary.mean_abs, summary.edge_p99),
        summary.causes.join("\n"),
        format!("{}\n{}", summary.gpu_ms, summary.budget),
    ]
}

/// Figures get what they need; technique and causes share the rest.
fn column_widths(rows: &[[String; 6]], width: u16) -> [u16; 6] {
    let heads = HEADS.map(str::to_owned);
    let mut widths: [u16; 6] = std::array::from_fn(|column| {
        rows.iter().chain([&heads]).map(|row| longest_line(&row[column])).max().unwrap_or(0)
    });
    let figures: u16 = (0..6).filter(|column| ![TECHNIQUE, CAUSES].contains(column)).map(|column| widths[column]).sum();
    let rest = width.saturating_sub(figures + 5 * GAP);
    let causes = widths[CAUSES].min(rest.saturating_sub(widths[TECHNIQUE]).max(rest / 2)).max(NARROWEST);
    widths[TECHNIQUE] = widths[TECHNIQUE].min(rest.saturating_sub(causes)).max(NARROWEST);
    widths[CAUSES] = causes;
    widths
}

fn longest_line(text: &str) -> u16 {
    text.lines().map(|line| line.chars().count().min(usize::from(u16::MAX)) as u16).max().unwrap_or(0)
}

fn formatted(rows: &[&[String; 6]], widths: [u16; 6]) -> String {
    let mut table = Table::new();
    table.set_content_arrangement(ContentArrangement::Disabled);
    let style = comfy_table::TableStyle::new()
        .header_lines(ContentLineStyle::none())
        .header_separator(LineStyle::none().fill('─'))
        .content_lines(ContentLineStyle::none());
    table.load_style(style).force_no_tty();
    table.set_header(HEADS.iter().enumerate().map(|(column, head)| aligned(column, head)));
    for row in rows {
        let technique = wrapped(&row[TECHNIQUE], usize::from(widths[TECHNIQUE])).join("\n");
        let cells = std::iter::once(technique.as_str()).chain(row[1..].iter().map(String::as_str));
        table.add_row(cells.enumerate().map(|(column, cell)| aligned(column, cell)));
    }
    for (i, (column, width)) in table.column_iter_mut().zip(widths).enumerate() {
        let gap = if i + 1 < HEADS.len() { GAP } else { 0 };
        column.set_padding((0, gap)).set_constraint(ColumnConstraint::Absolute(Width::Fixed(width + gap)));
    }
    table.lines().map(|line| format!("{}\n", line.trim_end())).collect()
}

fn aligned(column: usize, text: &str) -> Cell {
    let alignment = if [TECHNIQUE, CAUSES].contains(&column) { CellAlignment::Left } else { CellAlignment::Right };
    Cell::new(text).set_alignment(alignment)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::model::tests::{HOSTILE, full_run, report, report_of};

    fn widest(text: &str) -> usize {
        text.lines().map(|line| line.chars().count()).max().unwrap()
    }

    #[test]
    fn it_shows_every_run_and_says_why_some_have_no_verdict() {
        let text = table(&report(), 100);
        for shown in [
            "kitchen / lamp   64 × 48, 7 asked, 1 undecided",
            "42.9 %",
            "acne 67 %",
            "1.25*",
            "EXCEEDED",
            "\nmap:size=512\n  seams   in the worst of 2 views, near: ",
            "\n  jitter  2 texel phases: 37.5 % wrong",
            "\n  bias    4.00e-2 m = 1.00 texels along the light",
        ] {
            assert!(text.contains(shown), "{shown} in\n{text}");
        }
        assert!(text.contains("volume:count=z-pass  not applicable: open mesh, 12 edges"), "{text}");
        assert!(text.contains("map:size=16384  failed: device lost"), "{text}");
        assert!(text.contains("* on llvmpipe, a software adapter"), "{text}");
    }

    #[test]
    fn it_keeps_to_the_width_and_uses_it() {
        let mut report = report();
        report.runs[0].typed = "map:size=1024,projection=cascaded,filter=pcf-box3,bias=closed-form".to_owned();
        report.runs.truncate(1);
        report.adapter.software = false;
        for width in [72, 80, 100, 140] {
            let text = table(&report, width);
            assert!(widest(&text) <= usize::from(width), "{width}:\n{text}");
        }
        assert!(table(&report, 140).lines().count() < table(&report, 72).lines().count());
        // Narrower than any table can be: it does its best and does not fail.
        assert!(table(&report, 0).contains("EXCEEDED"));
    }

    #[test]
    fn another_light_is_another_block() {
        let mut report = report();
        let mut run = full_run("kitchen");
        run.light = "sun".to_owned();
        report.runs.push(run);
        assert!(table(&report, 100).contains("kitchen / sun"));
        assert_eq!(table(&report, 100).matches("technique").count(), 2);
    }

    #[test]
    fn hostile_names_stay_on_their_line_and_command_no_terminal() {
        let text = table(&report_of(HOSTILE), 100);
        assert!(!text.contains('\u{1b}') && !text.contains('\u{1}'));
        let calm = table(&report_of("kitchen"), 100);
        assert_eq!(text.lines().count(), calm.lines().count());
    }

    #[test]
    fn an_empty_report_is_an_empty_table() {
        let report = Report::new(crate::report::model::Adapter::default(), Vec::new());
        assert_eq!(table(&report, 100), "");
    }
}
