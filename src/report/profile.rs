//! A profile as CSV, and as an SVG plot: truth, technique, and under them the width that the distances predict.

use crate::evaluate::Sample;
use plotters::prelude::{
    ChartBuilder, Color, IntoDrawingArea, LineSeries, PathElement, RGBColor, SVGBackend, ShapeStyle, WHITE,
};

/// Pixels of the plot.
const SIZE: (u32, u32) = (960, 480);
/// M. Okabe, K. Ito, "Color Universal Design", 2008.
const TRUTH: RGBColor = RGBColor(0x1B, 0x1D, 0x21);
const TECHNIQUE: RGBColor = RGBColor(0xD5, 0x5E, 0x00);
const PREDICTED: RGBColor = RGBColor(0x00, 0x72, 0xB2);

/// A profile that cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum ProfileError {
    /// The table.
    #[error("the profile's table cannot be written")]
    Csv(#[from] csv::Error),
    /// The plot.
    #[error("the profile's plot cannot be drawn: {0}")]
    Plot(String),
}

/// One line per sample: column, row, metres along the line, visibilities, predicted width in metres; empty where there
/// is none.
///
/// # Errors
/// The writer's.
pub fn profile_csv(samples: &[Sample]) -> Result<Vec<u8>, ProfileError> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(["x", "y", "along_m", "truth", "technique", "predicted_width_m"])?;
    for sample in samples {
        let optional = |value: Option<f64>| value.map_or_else(String::new, |value| value.to_string());
        writer.write_record([
            sample.pixel.x.to_string(),
            sample.pixel.y.to_string(),
            sample.along_m.to_string(),
            optional(sample.truth),
            optional(sample.technique),
            optional(sample.predicted_m),
        ])?;
    }
    writer.into_inner().map_err(|error| ProfileError::Csv(error.into_error().into()))
}

/// The plot as SVG: visibility of truth and technique over metres along the line, and where a penumbra is predicted its
/// width as a bar around its middle. `spans` are the predicted stretches, from and to in metres.
///
/// # Errors
/// What the drawing library reports.
pub fn profile_plot(title: &str, samples: &[Sample], spans: &[[f64; 2]]) -> Result<String, ProfileError> {
    let mut text = String::new();
    draw(&mut text, title, samples, spans).map_err(|error| ProfileError::Plot(error.to_string()))?;
    Ok(text)
}

fn draw(
    text: &mut String,
    title: &str,
    samples: &[Sample],
    spans: &[[f64; 2]],
) -> Result<(), Box<dyn std::error::Error>> {
    let length_m = samples.last().map_or(1.0, |last| last.along_m).max(f64::MIN_POSITIVE);
    let area = SVGBackend::with_string(text, SIZE).into_drawing_area();
    area.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&area)
        .caption(title, ("sans-serif", 15))
        .margin(12)
        .x_label_area_size(38)
        .y_label_area_size(46)
        .build_cartesian_2d(0.0..length_m, -0.08..1.04)?;
    chart.configure_mesh().x_desc("metres along the line").y_desc("visibility").draw()?;
    let curve = |of: fn(&Sample) -> Option<f64>| -> Vec<Vec<(f64, f64)>> {
        let known = samples.split(|sample| of(sample).is_none());
        known.map(|run| run.iter().filter_map(|s| Some((s.along_m, of(s)?))).collect()).collect()
    };
    for (colour, label, of) in
        [(TECHNIQUE, "technique", (|s| s.technique) as fn(&Sample) -> Option<f64>), (TRUTH, "truth", |s| s.truth)]
    {
        let style = ShapeStyle::from(colour).stroke_width(2);
        for (index, run) in curve(of).into_iter().enumerate() {
            let series = chart.draw_series(LineSeries::new(run, style))?;
            if index == 0 {
                series.label(label).legend(move |(x, y)| PathElement::new([(x, y), (x + 16, y)], style));
            }
        }
    }
    let style = ShapeStyle::from(PREDICTED).stroke_width(5);
    let bars = spans.iter().map(|[from_m, to_m]| PathElement::new([(*from_m, -0.04), (*to_m, -0.04)], style));
    let series = chart.draw_series(bars)?;
    series.label("predicted").legend(move |(x, y)| PathElement::new([(x, y), (x + 16, y)], style));
    chart.configure_series_labels().background_style(WHITE.mix(0.8)).border_style(TRUTH).draw()?;
    area.present()?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::UVec2;

    #[test]
    fn table_and_plot_hold_every_curve() {
        let sample = |x: u32| Sample {
            pixel: UVec2::new(x, 7),
            along_m: f64::from(x) * 0.5,
            truth: Some(0.25),
            technique: (x != 1).then_some(1.0),
            predicted_m: None,
        };
        let samples: Vec<Sample> = (0..3).map(sample).collect();
        let table = String::from_utf8(profile_csv(&samples).unwrap()).unwrap();
        assert_eq!(table.lines().nth(2), Some("1,7,0.5,0.25,,"));
        let plot = profile_plot("a & b", &samples, &[[0.1, 0.4]]).unwrap();
        assert!(plot.starts_with("<svg") && plot.contains("a &amp; b"));
        for word in ["truth", "technique", "predicted", "metres along the line"] {
            assert!(plot.contains(word), "{word}");
        }
    }
}
