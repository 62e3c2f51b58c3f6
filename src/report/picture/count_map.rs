//! The stencil in false colour: how many volumes were counted at each pixel.

use super::colour::{along, rgb};
use super::legend::Swatch;
use super::palette::UNCOMPARED;
use super::sheet::{Panel, Sheet};
use super::{Caption, PictureError, check_sizes};
use embedded_graphics::pixelcolor::Rgb888;
use glam::UVec2;
use std::collections::BTreeMap;

/// No volume: lit.
const ZERO: Rgb888 = rgb(0xE8_E8_E4);
/// From one volume to the most.
const COUNTS: [Rgb888; 5] = [rgb(0x6B_AE_D6), rgb(0x2C_7F_B8), rgb(0x25_4E_9B), rgb(0x5E_2C_8C), rgb(0x2A_0A_3C)];
/// From one below zero, where a stencil has wrapped, to the least.
const WRAPPED: [Rgb888; 2] = [rgb(0xFF_A6_33), rgb(0xC2_1E_1E)];
/// Counts with a swatch of their own.
const LISTED: usize = 14;

/// What a picture of counts is made from.
#[derive(Debug, Clone, Copy)]
pub struct CountMap<'a> {
    /// For the heading.
    pub caption: Caption<'a>,
    /// Width and height in pixels.
    pub size: UVec2,
    /// The stencil at every pixel, row by row from the top; `None` shows the background.
    pub counts: &'a [Option<u8>],
}

/// The picture as PNG.
///
/// # Errors
/// Inputs of different sizes, and a picture without pixels or too large.
pub fn count_map(map: &CountMap) -> Result<Vec<u8>, PictureError> {
    check_sizes(map.size, &[("list of counts", map.counts.len())])?;
    let mut pixels_of: BTreeMap<i8, usize> = BTreeMap::new();
    for count in map.counts.iter().flatten() {
        *pixels_of.entry(signed(*count)).or_default() += 1;
    }
    let ends = [pixels_of.keys().next(), pixels_of.keys().last()].map(|end| end.copied().unwrap_or_default());
    let (least, most) = (ends[0].min(-1), ends[1].max(1));
    let paint = |y: usize, row: &mut [Rgb888]| {
        let counts = &map.counts[y * map.size.x as usize..];
        for (pixel, count) in row.iter_mut().zip(counts) {
            *pixel = count.map_or(UNCOMPARED[0].colour, |count| colour(signed(count), least, most));
        }
    };
    let mut sheet = Sheet::new(map.size, 1);
    sheet.heading(&map.caption, &format!("counts from {} to {}", ends[0], ends[1]));
    sheet.panels(vec![Panel { title: "stencil: volumes counted", paint: Box::new(paint), scale: None }]);
    let listed = pixels_of
        .iter()
        .take(LISTED)
        .map(|(&count, pixels)| Swatch { colour: colour(count, least, most), label: label(count, *pixels) });
    sheet.swatches(listed.chain([Swatch { colour: UNCOMPARED[0].colour, label: "background".to_owned() }]));
    sheet.into_png()
}

/// A stencil counts modulo 256: its upper half stands for numbers below zero.
fn signed(count: u8) -> i8 {
    i8::from_ne_bytes([count])
}

fn label(count: i8, pixels: usize) -> String {
    match count {
        0 => format!("0, lit: {pixels} px"),
        1.. => format!("{count}: {pixels} px"),
        _ => format!("{count}, stored as {}: {pixels} px", i16::from(count) + 256),
    }
}

fn colour(count: i8, least: i8, most: i8) -> Rgb888 {
    let share = |of: i8, whole: i8| (f32::from(of) - 1.0) / (f32::from(whole) - 1.0).max(1.0);
    match count {
        0 => ZERO,
        1.. => along(&COUNTS, share(count, most)),
        _ => along(&WRAPPED, share(count.saturating_neg(), least.saturating_neg())),
    }
}

#[cfg(test)]
mod tests {
    use super::super::colour::difference::for_the_colour_blind;
    use super::*;

    #[test]
    fn zero_few_many_and_wrapped_look_different() {
        let shown = [0, 1, 4, -1].map(|count| colour(count, -1, 4));
        for (i, a) in shown.iter().enumerate() {
            assert!(shown[..i].iter().all(|b| for_the_colour_blind(*a, *b) > 20.0));
        }
    }

    #[test]
    fn wrapped_counts_are_named_with_what_is_stored() {
        assert_eq!(label(signed(255), 7), "-1, stored as 255: 7 px");
        assert_eq!((label(0, 3), label(2, 1)), ("0, lit: 3 px".to_owned(), "2: 1 px".to_owned()));
    }

    #[test]
    fn a_list_of_another_size_is_refused() {
        let caption = Caption { scene: "s", light: "l", technique: "volume" };
        let map = CountMap { caption, size: UVec2::new(2, 1), counts: &[Some(0)] };
        assert!(count_map(&map).is_err());
        assert!(count_map(&CountMap { counts: &[Some(0), None], ..map }).is_ok());
    }
}
