//! Markdown: the summary table, for a README or a comment on a change.

use super::ExportError;
use crate::report::Report;
use crate::report::format::printable;
use crate::report::summary::{BUDGET_NOTE, Summary, software_note};

const HEADS: [&str; 12] = [
    "scene",
    "light",
    "technique",
    "wrong px",
    "wrong",
    "false shadow",
    "false light",
    "mean \\|e\\|",
    "edge p99 px",
    "main causes",
    "GPU ms",
    "budget",
];

/// The report as one table and, below it, what its marks mean.
pub(super) fn to_markdown(report: &Report) -> Result<Vec<u8>, ExportError> {
    let mut text = format!("| {} |\n|{}\n", HEADS.join(" | "), " --- |".repeat(HEADS.len()));
    for run in &report.runs {
        let names = [&run.scene, &run.light, &run.typed].map(|name| escaped(name));
        let summary = Summary::of(run, &report.adapter);
        let causes = summary.causes.join(", ");
        let figures = match &run.why {
            None => [
                summary.wrong,
                summary.wrong_share,
                summary.false_shadow,
                summary.false_light,
                summary.mean_abs,
                summary.edge_p99,
                causes,
                summary.gpu_ms,
                summary.budget,
            ],
            Some(why) => {
                let mut figures = [const { String::new() }; 9];
                figures[0] = format!("{}: {}", Summary::verdictless(run), escaped(why));
                figures
            }
        };
        text.push_str(&format!("| {} | {} |\n", names.join(" | "), figures.join(" | ")));
    }
    let notes = [software_note(&report.adapter), Summary::any_doubtful_budget(report).then(|| BUDGET_NOTE.to_owned())];
    for note in notes.into_iter().flatten() {
        text.push_str(&format!("\n{}\n", escaped(&note)));
    }
    Ok(text.into_bytes())
}

/// Text without any meaning to Markdown or HTML, on one line.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in printable(text).chars() {
        match c {
            '<' => escaped.push_str("&lt;"),
            '&' => escaped.push_str("&amp;"),
            '\\' | '`' | '*' | '_' | '[' | ']' | '#' | '|' | '!' | '~' | '$' => escaped.extend(['\\', c]),
            _ => escaped.push(c),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::model::tests::{HOSTILE, report, report_of};

    fn lines(report: &Report) -> Vec<String> {
        String::from_utf8(to_markdown(report).unwrap()).unwrap().lines().map(str::to_owned).collect()
    }

    /// Cells of a table line: what stands between bars that are not escaped.
    fn cells(line: &str) -> usize {
        line.replace("\\\\", "").replace("\\|", "").matches('|').count() - 1
    }

    #[test]
    fn the_table_has_a_line_per_run_of_equally_many_cells() {
        let lines = lines(&report());
        assert!(lines[..5].iter().all(|line| cells(line) == HEADS.len()), "{lines:#?}");
        assert!(lines[2].starts_with("| kitchen | lamp | map:size=512 | 3 | 42.9 % | 3 | 0 |"), "{}", lines[2]);
        assert!(lines[2].contains("acne 67 %"), "{}", lines[2]);
        assert!(lines[3].contains("not applicable: open mesh, 12 edges"));
        assert!(lines[4].contains("failed: device lost"));
        assert!(lines.iter().any(|line| line.contains("software adapter")));
    }

    #[test]
    fn a_real_adapter_has_no_footnote() {
        let mut report = report();
        report.adapter.software = false;
        assert!(!lines(&report).iter().any(|line| line.contains("software")));
    }

    #[test]
    fn hostile_names_neither_split_cells_nor_become_html() {
        let lines = lines(&report_of(HOSTILE));
        assert_eq!(cells(&lines[2]), HEADS.len());
        assert!(!lines.iter().any(|line| line.contains('<') || line.contains('\u{1b}')));
    }
}
