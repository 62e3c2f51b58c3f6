//! The m map: how many image pixels one shadow-map texel covers, before anything is measured.
//!
//! B. Lloyd, D. Tuft, S. Yoon, D. Manocha, "Warping and Partitioning for Low Error Shadow Maps", 2006: m = 1 is green, m
//! above 10 dark red, and a grid line is drawn every 20 texels. Between them the colours follow log m.

use super::colour::{along, blend, rgb};
use super::legend::{ColourScale, Swatch};
use super::palette::UNCOMPARED;
use super::sheet::{Panel, Sheet};
use super::{Caption, PictureError, check_sizes};
use crate::report::format::significant;
use embedded_graphics::pixelcolor::{Rgb888, RgbColor};
use glam::{UVec2, Vec2};

/// Texels from one grid line to the next.
const GRID_TEXELS: f32 = 20.0;
/// Grid lines closer than this would cover what they divide, and are left out.
const CLOSEST_GRID_PX: f32 = 6.0;
/// How strongly a grid line darkens.
const GRID_DARKENS: f32 = 0.45;
/// The m at which the colours end.
pub(super) const LARGEST_M: f32 = 10.0;

/// From m = 1 to m = [`LARGEST_M`].
pub(super) const COLOURS: [Rgb888; 5] =
    [rgb(0x2C_A0_2C), rgb(0xB5_CF_3A), rgb(0xF6_D6_43), rgb(0xE8_6A_1E), rgb(0x8B_0A_14)];

/// What an m map is made from; both lists have one entry per pixel, row by row from the top, `None` where the map is not
/// looked up.
#[derive(Debug, Clone, Copy)]
pub struct ValueMap<'a> {
    /// For the heading.
    pub caption: Caption<'a>,
    /// Width and height in pixels.
    pub size: UVec2,
    /// Largest extent of a texel in image pixels.
    pub m: &'a [Option<f32>],
    /// Where the pixel looks into the map, in texels.
    pub texel: &'a [Option<Vec2>],
}

/// The m map as PNG.
///
/// # Errors
/// Inputs of different sizes, and a picture without pixels or too large.
pub fn value_map(map: &ValueMap) -> Result<Vec<u8>, PictureError> {
    check_sizes(map.size, &[("list of m", map.m.len()), ("list of texels", map.texel.len())])?;
    let paint = |y: usize, row: &mut [Rgb888]| {
        for (x, pixel) in row.iter_mut().enumerate() {
            *pixel = colour_at(map, UVec2::new(x as u32, y as u32));
        }
    };
    let mut sheet = Sheet::new(map.size, 1);
    sheet.heading(&map.caption, &summary(map.m));
    let title = "m: image pixels per texel";
    sheet.panels(vec![Panel { title, paint: Box::new(paint), scale: Some(m_scale()) }]);
    sheet.swatches([
        Swatch { colour: blend(COLOURS[0], Rgb888::BLACK, GRID_DARKENS), label: "grid every 20 texels".to_owned() },
        Swatch { colour: UNCOMPARED[0].colour, label: "not looked up".to_owned() },
    ]);
    sheet.into_png()
}

fn colour_at(map: &ValueMap, at: UVec2) -> Rgb888 {
    let pixel = (at.y * map.size.x + at.x) as usize;
    let Some(m) = map.m[pixel] else { return UNCOMPARED[0].colour };
    let colour = along(&COLOURS, m.max(f32::MIN_POSITIVE).ln() / LARGEST_M.ln());
    if m * GRID_TEXELS >= CLOSEST_GRID_PX && is_on_grid(map, at) {
        blend(colour, Rgb888::BLACK, GRID_DARKENS)
    } else {
        colour
    }
}

/// Whether a grid line runs between a pixel and its right or lower neighbour. A jump to another surface is none.
fn is_on_grid(map: &ValueMap, at: UVec2) -> bool {
    let texel = |at: UVec2| {
        let inside = at.x < map.size.x && at.y < map.size.y;
        inside.then(|| map.texel[(at.y * map.size.x + at.x) as usize]).flatten()
    };
    let crosses = |from: Vec2, to: Vec2| {
        let cells = (to / GRID_TEXELS).floor() - (from / GRID_TEXELS).floor();
        cells != Vec2::ZERO && (to - from).abs().max_element() < GRID_TEXELS
    };
    let Some(here) = texel(at) else { return false };
    [UVec2::X, UVec2::Y].into_iter().filter_map(|step| texel(at + step)).any(|there| crosses(here, there))
}

fn m_scale() -> ColourScale {
    let mark = |m: f32, label: &str| (m.ln() / LARGEST_M.ln(), label.to_owned());
    let marks = vec![mark(1.0, "m <= 1"), mark(2.0, "2"), mark(5.0, "5"), mark(10.0, ">= 10")];
    ColourScale { colour: Box::new(|position| along(&COLOURS, position)), marks }
}

fn summary(m: &[Option<f32>]) -> String {
    let mut values: Vec<f32> = m.iter().flatten().copied().collect();
    values.sort_by(f32::total_cmp);
    let (Some(&least), Some(&most)) = (values.first(), values.last()) else {
        return "no pixel looks into the map".to_owned();
    };
    let [least, median, most] = [least, values[values.len() / 2], most].map(|m| significant(f64::from(m)));
    format!("m from {least} to {most}, median {median}")
}
