//! Error against cost as an SVG plot: one mark per configuration, one kind of mark and colour per family, the front as a
//! line. Both axes are logarithmic, since both span decades.
//!
//! Colours are those of M. Okabe and K. Ito, "Color Universal Design", 2008, and every family has a shape of its own, too.

use super::front::{Point, front};
use plotters::coord::Shift;
use plotters::coord::combinators::IntoLogRange;
use plotters::coord::combinators::LogCoord;
use plotters::prelude::{
    Cartesian2d, ChartBuilder, ChartContext, Circle, Color, Cross, DrawingArea, EmptyElement, IntoDrawingArea,
    IntoFont, LineSeries, PathElement, Polygon, RGBColor, Rectangle, SVGBackend, SeriesLabelPosition, ShapeStyle, Text,
    TriangleMarker,
};

/// Pixels of the plot.
const SIZE: (u32, u32) = (960, 600);
/// Half the side of a mark, pixels.
const MARK: i32 = 5;
/// Families beyond so many share colour and shape with the first ones.
const COLOURS: [RGBColor; 6] = [
    RGBColor(0x00, 0x72, 0xB2),
    RGBColor(0xD5, 0x5E, 0x00),
    RGBColor(0x00, 0x9E, 0x73),
    RGBColor(0xCC, 0x79, 0xA7),
    RGBColor(0xE6, 0x9F, 0x00),
    RGBColor(0x56, 0xB4, 0xE9),
];
const INK: RGBColor = RGBColor(0x1B, 0x1D, 0x21);
const RULE: RGBColor = RGBColor(0xE2, 0xE4, 0xE8);

/// One configuration.
#[derive(Debug, Clone, PartialEq)]
pub struct Mark {
    /// The technique's family.
    pub family: String,
    /// The technique as typed.
    pub label: String,
    /// Share of wrong pixels, 0..=1.
    pub error: f64,
    /// Cost in the axis's unit, > 0.
    pub cost: f64,
}

/// The plot cannot be drawn.
#[derive(Debug, thiserror::Error)]
#[error("the plot cannot be drawn: {0}")]
pub struct PlotError(String);

type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<LogCoord<f64>, LogCoord<f64>>>;

/// The plot as SVG; `None` without marks. `cost_axis` names the cost with its unit. `least_error` stands for no error at
/// all, which has no logarithm: less than one pixel of those asked.
///
/// # Errors
/// What the drawing library reports.
pub fn plot(title: &str, cost_axis: &str, marks: &[Mark], least_error: f64) -> Result<Option<String>, PlotError> {
    let marks: Vec<Mark> = marks.iter().filter(|mark| mark.cost > 0.0).cloned().collect();
    if marks.is_empty() {
        return Ok(None);
    }
    let mut svg = String::new();
    let area = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
    draw(&area, title, cost_axis, &marks, least_error).map_err(PlotError)?;
    drop(area);
    Ok(Some(svg))
}

fn said(error: impl std::fmt::Display) -> String {
    error.to_string()
}

fn draw(
    area: &DrawingArea<SVGBackend<'_>, Shift>,
    title: &str,
    cost_axis: &str,
    marks: &[Mark],
    least_error: f64,
) -> Result<(), String> {
    area.fill(&RGBColor(255, 255, 255)).map_err(said)?;
    let percent = |mark: &Mark| 100.0 * mark.error.max(least_error);
    let x = decades(marks.iter().map(|mark| mark.cost));
    let y = decades(marks.iter().map(percent));
    let mut chart: Chart<'_, '_> = ChartBuilder::on(area)
        .caption(title, ("sans-serif", 18).into_font().color(&INK))
        .margin(14)
        .x_label_area_size(52)
        .y_label_area_size(84)
        .build_cartesian_2d((x.0..x.1).log_scale(), (y.0..y.1).log_scale())
        .map_err(said)?;
    chart
        .configure_mesh()
        .bold_line_style(RULE)
        .light_line_style(RULE.mix(0.35))
        .axis_style(INK)
        .label_style(("sans-serif", 13))
        .axis_desc_style(("sans-serif", 14))
        .x_desc(cost_axis)
        .y_desc("wrong pixels of those asked, %")
        .x_label_formatter(&|value| spelled(*value))
        .y_label_formatter(&|value| spelled(*value))
        .draw()
        .map_err(said)?;
    let points: Vec<Point> = marks.iter().map(|mark| Point { error: percent(mark), cost: mark.cost }).collect();
    let on_front = front(&points);
    let line = on_front.iter().map(|&index| (points[index].cost, points[index].error));
    chart
        .draw_series(LineSeries::new(line, INK.stroke_width(1)))
        .map_err(said)?
        .label("front: nothing is both cheaper and better")
        .legend(|(x, y)| PathElement::new(vec![(x, y), (x + 18, y)], INK));
    draw_marks(&mut chart, marks, &percent)?;
    let labels = on_front.iter().map(|&index| {
        let beyond_middle = points[index].cost > (x.0 * x.1).sqrt();
        let offset = if beyond_middle { (-8 - 6 * marks[index].label.len() as i32, -16) } else { (8, -16) };
        EmptyElement::at((points[index].cost, points[index].error))
            + Text::new(marks[index].label.clone(), offset, ("sans-serif", 12).into_font().color(&INK))
    });
    chart.draw_series(labels).map_err(said)?;
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::LowerLeft)
        .background_style(RGBColor(255, 255, 255).mix(0.85))
        .border_style(RULE)
        .label_font(("sans-serif", 13))
        .draw()
        .map_err(said)?;
    area.present().map_err(said)
}

fn draw_marks(chart: &mut Chart<'_, '_>, marks: &[Mark], percent: &dyn Fn(&Mark) -> f64) -> Result<(), String> {
    let mut families: Vec<&str> = marks.iter().map(|mark| mark.family.as_str()).collect();
    families.sort_unstable();
    families.dedup();
    for (index, family) in families.into_iter().enumerate() {
        let style = COLOURS[index % COLOURS.len()].filled();
        let own = marks.iter().filter(|mark| mark.family == family).map(|mark| (mark.cost, percent(mark)));
        let own: Vec<(f64, f64)> = own.collect();
        let series = match index % 4 {
            0 => chart.draw_series(own.into_iter().map(|at| Circle::new(at, MARK, style))),
            1 => chart.draw_series(own.into_iter().map(|at| TriangleMarker::new(at, MARK + 1, style))),
            2 => chart.draw_series(own.into_iter().map(|at| EmptyElement::at(at) + square(style))),
            _ => chart.draw_series(own.into_iter().map(|at| Cross::new(at, MARK, style.stroke_width(2)))),
        };
        series.map_err(said)?.label(family).legend(move |(x, y)| {
            Polygon::new(vec![(x + 4, y - 4), (x + 12, y - 4), (x + 12, y + 4), (x + 4, y + 4)], style)
        });
    }
    Ok(())
}

fn square(style: ShapeStyle) -> Rectangle<(i32, i32)> {
    Rectangle::new([(-MARK, -MARK), (MARK, MARK)], style)
}

/// Whole powers of ten around some positive values.
fn decades(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (least, most) = values.fold((f64::INFINITY, 0.0_f64), |(least, most), v| (least.min(v), most.max(v)));
    let (low, high) = (least.log10().floor(), most.log10().ceil());
    (10_f64.powf(low), 10_f64.powf(high.max(low + 1.0)))
}

/// An axis's number: plain where it is short, else with an exponent.
fn spelled(value: f64) -> String {
    if (1e-3..1e5).contains(&value) { format!("{}", (value * 1e6).round() / 1e6) } else { format!("{value:.0e}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mark(family: &str, error: f64, cost: f64) -> Mark {
        Mark { family: family.to_owned(), label: format!("{family}:x=\"<&{cost}"), error, cost }
    }

    #[test]
    fn axes_cover_whole_decades() {
        assert_eq!(decades([3.0, 250.0].into_iter()), (1.0, 1000.0));
        assert_eq!(decades([10.0].into_iter()), (10.0, 100.0));
        assert_eq!([0.001, 0.5, 100.0, 1e5, 1e-6].map(spelled), ["0.001", "0.5", "100", "1e5", "1e-6"]);
    }

    #[test]
    fn a_plot_says_what_its_axes_are_and_escapes_names() {
        let marks = [mark("map", 0.5, 1e4), mark("map", 0.01, 2e6), mark("volume", 0.0, 3e5)];
        let svg = plot("a <title>", "work", &marks, 1e-6).unwrap().unwrap();
        for word in
            ["work", "wrong pixels of those asked, %", "volume", "nothing is both", "&lt;title&gt;", "&lt;&amp;"]
        {
            assert!(svg.contains(word), "{word}");
        }
        assert!(!svg.contains("<title>") && svg.starts_with("<svg"));
        assert!(plot("empty", "work", &[], 1e-6).unwrap().is_none());
    }
}
