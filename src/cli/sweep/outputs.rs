//! What a sweep leaves beside its rows: report.json and results.csv of all of them, the fronts, and plots.

use crate::cli::output::OutFolder;
use crate::cli::pictures::file_name;
use crate::report::Report;
use crate::report::export::Exporter;
use crate::report::html::Imagery;
use crate::report::model::Run;
use crate::technique::Cost;
use crate::trade::plot::{Mark, plot};
use crate::trade::{Header, Point, Record, front};
use anyhow::Context;
use std::path::Path;

/// A cost that configurations are ranked by.
struct CostAxis {
    name: &'static str,
    /// For a plot, with its unit.
    label: &'static str,
    of: fn(&Cost) -> Option<f64>,
}

const COST_AXES: [CostAxis; 2] = [
    CostAxis {
        name: "work",
        label: "counted work: vertices + fragments + 32-bit words of maps and buffers",
        of: |cost| cost.work().map(|work| work as f64),
    },
    CostAxis { name: "ms", label: "GPU time, median, ms", of: |cost| cost.gpu_ms.map(|time| time.median) },
];

/// Writes everything and says where.
pub(super) fn write(folder: &Path, header: &Header, records: Vec<Record>) -> anyhow::Result<String> {
    let out = OutFolder::open(folder)?;
    let runs = records.into_iter().map(|record| record.run).collect();
    let report = Report { tool: header.tool.clone(), ..Report::new(header.adapter.clone(), runs) };
    let mut written = Vec::new();
    for (format, name) in [("json", "report.json"), ("csv", "results.csv")] {
        let exporter = Exporter::named(format).context("the format is known")?;
        written.push(out.write(name, &(exporter.write)(&report, &Imagery::default())?)?);
    }
    let mut fronts = csv::Writer::from_writer(Vec::new());
    fronts.write_record(["scene", "light", "cost_axis", "cost", "wrong_fraction", "technique"])?;
    let mut questions: Vec<(&str, &str, [u32; 2])> = report.runs.iter().map(question).collect();
    questions.dedup();
    for asked in questions {
        let of_question: Vec<&Run> = report.runs.iter().filter(|run| question(run) == asked).collect();
        for axis in COST_AXES {
            let judged = of_question.iter().filter_map(|run| Some((*run, figures(run, &axis)?)));
            let (runs, points): (Vec<&Run>, Vec<Point>) = judged.unzip();
            for index in front(&points) {
                let (run, Point { error, cost }) = (runs[index], points[index]);
                let (cost, error) = (cost.to_string(), error.to_string());
                fronts.write_record([asked.0, asked.1, axis.name, &cost, &error, &run.typed])?;
            }
            let title = format!("{} / {}, {} x {}", asked.0, asked.1, asked.2[0], asked.2[1]);
            let mark = |(run, point): (&&Run, &Point)| Mark {
                family: run.technique.split(':').next().unwrap_or_default().to_owned(),
                label: run.typed.clone(),
                error: point.error,
                cost: point.cost,
            };
            let marks: Vec<Mark> = runs.iter().zip(&points).map(mark).collect();
            if let Some(svg) = plot(&title, axis.label, &marks, least_error(&runs))? {
                let name = format!("{}.{}.{}.svg", file_name(asked.0), file_name(asked.1), axis.name);
                written.push(out.write(&name, svg.as_bytes())?);
            }
        }
    }
    let bytes = fronts.into_inner().map_err(csv::IntoInnerError::into_error)?;
    written.push(out.write("fronts.csv", &bytes)?);
    Ok(written.iter().map(|path| format!("wrote {}", path.display())).collect::<Vec<_>>().join("\n"))
}

fn question(run: &Run) -> (&str, &str, [u32; 2]) {
    (&run.scene, &run.light, run.image)
}

fn figures(run: &Run, axis: &CostAxis) -> Option<Point> {
    Some(Point { error: run.error?.wrong_fraction?, cost: (axis.of)(run.cost.as_ref()?)? })
}

/// Half a pixel of those asked: less than any error there can be.
fn least_error(runs: &[&Run]) -> f64 {
    let asked = runs.iter().filter_map(|run| Some(run.pixels?.asked)).max().unwrap_or(1);
    0.5 / asked.max(1) as f64
}
