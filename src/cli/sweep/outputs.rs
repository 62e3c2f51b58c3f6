//! What a sweep leaves beside its rows: report.json and results.csv of all of them, the fronts, and plots.

use crate::cli::output::OutFolder;
use crate::cli::pictures::file_name;
use crate::report::Report;
use crate::report::export::Exporter;
use crate::report::html::Imagery;
use crate::report::model::Run;
use crate::technique::Cost;
use crate::trade::plot::{Mark, PlotError, plot};
use crate::trade::{Header, Point, Record, front};
use anyhow::Context;
use std::path::Path;

/// A cost that configurations are ranked by.
#[derive(Clone, Copy)]
struct CostAxis {
    name: &'static str,
    /// For a plot, with its unit.
    label: &'static str,
    of: fn(&Cost) -> Option<f64>,
}

const COST_AXES: [CostAxis; 2] = [
    CostAxis {
        name: "work",
        label: "counted work: vertices + fragments + texel reads + 32-bit words of maps and buffers",
        of: |cost| cost.work().map(|work| work as f64),
    },
    CostAxis { name: "gbuffers", label: "GPU time, median, multiples of the G-buffer's", of: Cost::gbuffers },
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
    for asked in questions(&report) {
        for axis in COST_AXES {
            let compared = Compared::new(&report, asked, axis);
            compared.write_front(&mut fronts)?;
            if let Some(svg) = compared.plot()? {
                let name = format!("{}.{}.{}.svg", file_name(asked.0), file_name(asked.1), axis.name);
                written.push(out.write(&name, svg.as_bytes())?);
            }
        }
    }
    let bytes = fronts.into_inner().map_err(csv::IntoInnerError::into_error)?;
    written.push(out.write("fronts.csv", &bytes)?);
    Ok(written.iter().map(|path| format!("wrote {}", path.display())).collect::<Vec<_>>().join("\n"))
}

/// Scene, light and picture size: what is asked. Only runs of one question compare.
type Question<'r> = (&'r str, &'r str, [u32; 2]);

fn question(run: &Run) -> Question<'_> {
    (&run.scene, &run.light, run.image)
}

fn questions(report: &Report) -> Vec<Question<'_>> {
    let mut questions: Vec<Question<'_>> = report.runs.iter().map(question).collect();
    questions.dedup();
    questions
}

/// The judged runs of one question with their figures on one axis of cost.
struct Compared<'r> {
    asked: Question<'r>,
    axis: CostAxis,
    runs: Vec<(&'r Run, Point)>,
}

impl<'r> Compared<'r> {
    fn new(report: &'r Report, asked: Question<'r>, axis: CostAxis) -> Self {
        let figures =
            |run: &Run| Some(Point { error: run.error?.wrong_fraction?, cost: (axis.of)(run.cost.as_ref()?)? });
        let of_question = report.runs.iter().filter(|run| question(run) == asked);
        Self { asked, axis, runs: of_question.filter_map(|run| Some((run, figures(run)?))).collect() }
    }

    fn write_front(&self, to: &mut csv::Writer<Vec<u8>>) -> csv::Result<()> {
        let points: Vec<Point> = self.runs.iter().map(|(_, point)| *point).collect();
        for index in front(&points) {
            let (run, Point { error, cost }) = self.runs[index];
            let (scene, light, _) = self.asked;
            to.write_record([scene, light, self.axis.name, &cost.to_string(), &error.to_string(), &run.typed])?;
        }
        Ok(())
    }

    fn plot(&self) -> Result<Option<String>, PlotError> {
        let (scene, light, [width, height]) = self.asked;
        let mark = |(run, point): &(&Run, Point)| Mark {
            family: run.technique.split(':').next().unwrap_or_default().to_owned(),
            label: run.typed.clone(),
            error: point.error,
            cost: point.cost,
        };
        let marks: Vec<Mark> = self.runs.iter().map(mark).collect();
        plot(&format!("{scene} / {light}, {width} x {height}"), self.axis.label, &marks, self.least_error())
    }

    /// Half a pixel of those asked: less than any error there can be.
    fn least_error(&self) -> f64 {
        let asked = self.runs.iter().filter_map(|(run, _)| Some(run.pixels?.asked)).max().unwrap_or(1);
        0.5 / asked.max(1) as f64
    }
}
