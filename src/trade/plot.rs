//! Error against cost as an SVG plot: one mark per configuration, one kind of mark and colour per family, the front as a
//! line. Both axes are logarithmic, since both span decades.
//!
//! Colours are those of M. Okabe and K. Ito, "Color Universal Design", 2008, and every family has a shape of its own, too.

use super::front::{Point, front};
use plotters::coord::Shift;
use plotters::coord::combinators::{IntoLogRange, LogCoord};
use plotters::element::{DynElement, IntoDynElement};
use plotters::prelude::{
    Cartesian2d, ChartBuilder, ChartContext, Circle, Color, Cross, DrawingArea, EmptyElement, IntoDrawingArea,
    IntoFont, LineSeries, PathElement, RGBColor, Rectangle, SVGBackend, Text, TriangleMarker,
};

/// Pixels of the plot.
const SIZE: (u32, u32) = (1060, 600);
/// Pixels of its right side that the legend has to itself.
const LEGEND_WIDTH: u32 = 190;
/// Pixels of a label's letter, and from one line to the next.
const LETTER: (i32, i32) = (6, 13);
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

type Area<'b> = DrawingArea<SVGBackend<'b>, Shift>;
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

fn draw(area: &Area<'_>, title: &str, cost_axis: &str, marks: &[Mark], least_error: f64) -> Result<(), String> {
    area.fill(&RGBColor(255, 255, 255)).map_err(said)?;
    let (plot, legend) = area.split_horizontally(SIZE.0 - LEGEND_WIDTH);
    let percent = |mark: &Mark| 100.0 * mark.error.max(least_error);
    let x = decades(marks.iter().map(|mark| mark.cost));
    let y = decades(marks.iter().map(percent));
    let mut chart: Chart<'_, '_> = ChartBuilder::on(&plot)
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
    chart.draw_series(LineSeries::new(line, INK.stroke_width(1))).map_err(said)?;
    let families = families(marks);
    let family_of = |mark: &Mark| families.iter().position(|family| *family == mark.family).unwrap_or(0);
    for (mark, point) in marks.iter().zip(&points) {
        area.draw(&shape(family_of(mark), chart.backend_coord(&(point.cost, point.error)))).map_err(said)?;
    }
    draw_labels(&mut chart, marks, &points, &on_front)?;
    draw_legend(&legend, &families, marks.iter().any(|mark| mark.error < least_error))?;
    area.present().map_err(said)
}

fn families(marks: &[Mark]) -> Vec<&str> {
    let mut families: Vec<&str> = marks.iter().map(|mark| mark.family.as_str()).collect();
    families.sort_unstable();
    families.dedup();
    families
}

/// A family's mark at a place.
fn shape<'b, P: Clone + 'b>(family: usize, at: P) -> DynElement<'b, SVGBackend<'b>, P> {
    let (origin, style) = ((0, 0), COLOURS[family % COLOURS.len()].filled());
    match family % 4 {
        0 => (EmptyElement::at(at) + Circle::new(origin, MARK, style)).into_dyn(),
        1 => (EmptyElement::at(at) + TriangleMarker::new(origin, MARK + 1, style)).into_dyn(),
        2 => (EmptyElement::at(at) + Rectangle::new([(-MARK, -MARK), (MARK, MARK)], style)).into_dyn(),
        _ => (EmptyElement::at(at) + Cross::new(origin, MARK, style.stroke_width(2))).into_dyn(),
    }
}

/// Names the configurations on the front, but for those whose names would cover another's.
fn draw_labels(chart: &mut Chart<'_, '_>, marks: &[Mark], points: &[Point], on_front: &[usize]) -> Result<(), String> {
    let mut placed: Vec<[i32; 3]> = Vec::new();
    let width = (SIZE.0 - LEGEND_WIDTH) as i32;
    for &index in on_front {
        let (label, at) = (&marks[index].label, (points[index].cost, points[index].error));
        let (x, y) = chart.backend_coord(&at);
        let length = LETTER.0 * label.chars().count() as i32;
        let offset = if x + length > width { (-8 - length, -16) } else { (8, -16) };
        let covers = |[left, top, long]: &[i32; 3]| {
            (y - top).abs() < LETTER.1 && x + offset.0 < left + long && *left < x + offset.0 + length
        };
        if placed.iter().any(covers) {
            continue;
        }
        placed.push([x + offset.0, y, length]);
        let text = Text::new(label.clone(), offset, ("sans-serif", 12).into_font().color(&INK));
        chart.draw_series(std::iter::once(EmptyElement::at(at) + text)).map_err(said)?;
    }
    Ok(())
}

fn draw_legend(area: &Area<'_>, families: &[&str], any_without_error: bool) -> Result<(), String> {
    let line = |index: usize| 60 + 22 * index as i32;
    let text = |words: &str, at: (i32, i32)| {
        Text::new(words.to_owned(), (at.0, at.1 - 7), ("sans-serif", 13).into_font().color(&INK))
    };
    for (index, family) in families.iter().enumerate() {
        area.draw(&shape(index, (12, line(index)))).map_err(said)?;
        area.draw(&text(family, (26, line(index)))).map_err(said)?;
    }
    let below = line(families.len());
    area.draw(&PathElement::new(vec![(4, below), (20, below)], INK)).map_err(said)?;
    area.draw(&text("front: nothing is", (26, below))).map_err(said)?;
    area.draw(&text("both cheaper and better", (26, below + 16))).map_err(said)?;
    if any_without_error {
        area.draw(&text("no wrong pixel at all is", (4, below + 44))).map_err(said)?;
        area.draw(&text("drawn as half a pixel", (4, below + 60))).map_err(said)?;
    }
    Ok(())
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
        for word in ["work", "wrong pixels of those asked, %", "volume", "&lt;title&gt;", "&lt;&amp;"] {
            assert!(svg.contains(word), "{word}");
        }
        assert!(!svg.contains("<title>") && svg.starts_with("<svg"));
        assert!(plot("empty", "work", &[], 1e-6).unwrap().is_none());
    }
}
