//! The cause map: every wrong pixel in the colour of its cause, over the dimmed truth.
//!
//! Pixels that differ without being wrong have their cause's colour at half strength.

use super::cause_colours::colour;
use super::colour::blend;
use super::legend::Swatch;
use super::palette::{UNCOMPARED, dim, uncompared};
use super::sheet::{Panel, Sheet};
use super::{Caption, PictureError, check_sizes};
use crate::cause::Cause;
use crate::mask::TruthMask;
use crate::receiver::PixelClass;
use crate::report::format::{grouped, percent};
use crate::verdict::Ledger;
use embedded_graphics::pixelcolor::Rgb888;

/// How strong the colour of a pixel is that differs without being wrong.
pub(super) const MERELY_DIFFERING: f32 = 0.5;

/// What a cause map is made from; every list has one entry per pixel of the truth.
#[derive(Debug, Clone, Copy)]
pub struct CauseMap<'a> {
    /// For the heading.
    pub caption: Caption<'a>,
    /// What each pixel was asked.
    pub classes: &'a [PixelClass],
    /// The exact answer.
    pub truth: &'a TruthMask,
    /// The causes.
    pub ledger: &'a Ledger,
}

/// The cause map as PNG.
///
/// # Errors
/// Inputs of different sizes, and a picture without pixels or too large.
pub fn cause_map(map: &CauseMap) -> Result<Vec<u8>, PictureError> {
    let size = map.truth.size;
    check_sizes(size, &[("truth", map.truth.pixels.len()), ("class list", map.classes.len())])?;
    let causes = cause_per_pixel(map);
    let paint = move |y: usize, row: &mut [Rgb888]| {
        for (x, pixel) in row.iter_mut().enumerate() {
            *pixel = colour_of(map, &causes, y * size.x as usize + x);
        }
    };
    let mut sheet = Sheet::new(size, 1);
    sheet.heading(&map.caption, &summary(map.ledger));
    sheet.panels(vec![Panel { title: "causes of wrong pixels", paint: Box::new(paint), scale: None }]);
    sheet.swatches(cause_swatches(map.ledger));
    sheet.swatches(UNCOMPARED.map(|class| Swatch { colour: class.colour, label: class.name.to_owned() }));
    sheet.into_png()
}

/// The cause of each pixel that has one, with the strength of its colour.
fn cause_per_pixel(map: &CauseMap) -> Vec<Option<(Cause, f32)>> {
    let mut causes = vec![None; map.truth.pixels.len()];
    let lists = [(&map.ledger.wrong, 1.0), (&map.ledger.merely_differing, MERELY_DIFFERING)];
    for (list, strength) in lists {
        for &(pixel, cause) in list {
            if let Some(slot) = causes.get_mut(pixel as usize) {
                *slot = Some((cause, strength));
            }
        }
    }
    causes
}

fn colour_of(map: &CauseMap, causes: &[Option<(Cause, f32)>], pixel: usize) -> Rgb888 {
    match (uncompared(map.classes[pixel], map.truth.pixels[pixel]), causes[pixel]) {
        (Ok(truth), Some((cause, strength))) => blend(dim(truth), colour(cause), strength),
        (Ok(truth), None) => dim(truth),
        (Err(colour), _) => colour,
    }
}

fn summary(ledger: &Ledger) -> String {
    let causes = ledger.causes.values().filter(|share| share.pixels > 0).count();
    let (wrong, causes_are) = (ledger.wrong.len() as u64, if causes == 1 { "cause" } else { "causes" });
    format!("{} wrong pixels, {causes} {causes_are}", grouped(wrong))
}

/// The causes of wrong pixels, most pixels first.
fn cause_swatches(ledger: &Ledger) -> Vec<Swatch> {
    let mut shares: Vec<(Cause, u64)> = ledger.causes.iter().map(|(&cause, share)| (cause, share.pixels)).collect();
    shares.retain(|&(_, pixels)| pixels > 0);
    shares.sort_by_key(|&(_, pixels)| std::cmp::Reverse(pixels));
    let wrong = ledger.wrong.len() as f64;
    let label = |cause: Cause, pixels: u64| {
        format!("{} {} px, {}", cause.name(), grouped(pixels), percent(pixels as f64 / wrong))
    };
    shares.into_iter().map(|(cause, pixels)| Swatch { colour: colour(cause), label: label(cause, pixels) }).collect()
}
