//! The error map: truth, technique and signed error side by side. The picture of a run.

use super::legend::{ColourScale, Swatch};
use super::palette::{FALSE_LIGHT, FALSE_SHADOW, UNCOMPARED, dim, grey, signed_error, uncompared};
use super::sheet::{Panel, Sheet};
use super::{Caption, PictureError, check_sizes};
use crate::mask::{Mask, TruthMask};
use crate::receiver::PixelClass;
use crate::report::format::{grouped, percent, significant};
use crate::verdict::{PixelCounts, Verdict};
use embedded_graphics::pixelcolor::Rgb888;

/// What an error map is made from; every list has one entry per pixel of the truth.
#[derive(Debug, Clone, Copy)]
pub struct ErrorMap<'a> {
    /// For the heading.
    pub caption: Caption<'a>,
    /// What each pixel was asked.
    pub classes: &'a [PixelClass],
    /// The exact answer.
    pub truth: &'a TruthMask,
    /// The technique's answer.
    pub mask: &'a Mask,
    /// What it is worth.
    pub verdict: &'a Verdict,
}

/// The error map as PNG.
///
/// # Errors
/// Inputs of different sizes, and a picture without pixels or too large.
pub fn error_map(map: &ErrorMap) -> Result<Vec<u8>, PictureError> {
    let inputs = [
        ("truth", map.truth.pixels.len()),
        ("mask", map.mask.pixels.len()),
        ("class list", map.classes.len()),
        ("verdict", map.verdict.signed_error.len()),
    ];
    check_sizes(map.truth.size, &inputs)?;
    let mut sheet = Sheet::new(map.truth.size, 3);
    sheet.heading(&map.caption, &summary(map.verdict));
    sheet.panels(vec![truth_panel(map), technique_panel(map), error_panel(map)]);
    sheet.swatches(swatches(&map.verdict.pixels));
    sheet.into_png()
}

fn truth_panel<'a>(map: &ErrorMap<'a>) -> Panel<'a> {
    let ErrorMap { classes, truth, .. } = *map;
    panel(map, "truth", visibility_scale(), move |pixel| match uncompared(classes[pixel], truth.pixels[pixel]) {
        Ok(visibility) => grey(visibility),
        Err(colour) => colour,
    })
}

fn technique_panel<'a>(map: &ErrorMap<'a>) -> Panel<'a> {
    let ErrorMap { classes, truth, mask, .. } = *map;
    panel(map, "technique", visibility_scale(), move |pixel| {
        match (uncompared(classes[pixel], truth.pixels[pixel]), mask.pixels[pixel]) {
            (Ok(_), Some(visibility)) => grey(visibility.get()),
            (Ok(exact), None) => dim(exact),
            (Err(colour), _) => colour,
        }
    })
}

fn error_panel<'a>(map: &ErrorMap<'a>) -> Panel<'a> {
    let ErrorMap { classes, truth, verdict, .. } = *map;
    panel(map, "signed error (technique - truth)", error_scale(), move |pixel| {
        match (uncompared(classes[pixel], truth.pixels[pixel]), verdict.signed_error[pixel]) {
            (Ok(exact), Some(error)) => signed_error(error as f32, exact),
            (Ok(exact), None) => dim(exact),
            (Err(colour), _) => colour,
        }
    })
}

/// A panel of one colour per pixel (`y * width + x`).
fn panel<'a>(
    map: &ErrorMap,
    title: &'static str,
    scale: ColourScale,
    colour: impl Fn(usize) -> Rgb888 + Sync + 'a,
) -> Panel<'a> {
    let width = map.truth.size.x as usize;
    let paint = move |y: usize, row: &mut [Rgb888]| {
        for (x, pixel) in row.iter_mut().enumerate() {
            *pixel = colour(y * width + x);
        }
    };
    Panel { title, paint: Box::new(paint), scale: Some(scale) }
}

fn visibility_scale() -> ColourScale {
    let marks = vec![(0.0, "0 shadow".to_owned()), (0.5, "0.5".to_owned()), (1.0, "1 lit".to_owned())];
    ColourScale { colour: Box::new(grey), marks }
}

/// From −1 to +1. A pixel can only be too dark where the truth is light and too bright where it is dark, so each half of
/// the scale lies over that truth.
fn error_scale() -> ColourScale {
    let colour = |position: f32| {
        let error = 2.0 * position - 1.0;
        signed_error(error, if error < 0.0 { 1.0 } else { 0.0 })
    };
    let marks = vec![(0.0, "-1 false shadow".to_owned()), (0.5, "0".to_owned()), (1.0, "+1 false light".to_owned())];
    ColourScale { colour: Box::new(colour), marks }
}

fn summary(verdict: &Verdict) -> String {
    let Some(mean) = verdict.error.mean_abs else { return "no pixel was asked and decided".to_owned() };
    let share = percent(verdict.error.wrong_fraction.unwrap_or(0.0));
    let n = &verdict.pixels;
    let edge = verdict.error.edge_distance_px;
    let edge =
        edge.map_or(String::new(), |edge| format!(", 99 % within {} px of a shadow edge", significant(edge.p99)));
    let (wrong, asked) = (grouped(n.wrong), grouped(n.asked));
    format!("{wrong} of {asked} asked pixels wrong ({share}){edge}; mean |e| {}", significant(mean))
}

fn swatches(n: &PixelCounts) -> Vec<Swatch> {
    let swatch = |colour, name: &str, count| Swatch { colour, label: format!("{name} {}", grouped(count)) };
    let wrong =
        [swatch(FALSE_SHADOW, "false shadow", n.false_shadow), swatch(FALSE_LIGHT, "false light", n.false_light)];
    let counts = [n.background, n.facing_away, n.not_lit, n.undecided];
    let uncompared = UNCOMPARED.iter().zip(counts).map(|(class, count)| swatch(class.colour, class.name, count));
    wrong.into_iter().chain(uncompared).collect()
}
