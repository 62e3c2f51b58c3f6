//! The pixels of a sheet: filling, framing, text and enlarged images.

use super::PictureError;
use embedded_graphics::draw_target::DrawTarget;
use embedded_graphics::geometry::{OriginDimensions, Point, Size};
use embedded_graphics::mono_font::{MonoFont, MonoTextStyle};
use embedded_graphics::pixelcolor::{Rgb888, RgbColor};
use embedded_graphics::text::{Baseline, Text};
use embedded_graphics::{Drawable, Pixel};
use glam::UVec2;
use rayon::prelude::*;
use std::convert::Infallible;

/// Colours one row of an image: given its number and one colour per pixel to fill in.
pub(super) type PaintRow<'a> = dyn Fn(usize, &mut [Rgb888]) + Sync + 'a;

/// Bytes of a pixel.
const CHANNELS: usize = 3;

/// An 8-bit RGB picture.
pub(super) struct Canvas {
    size: UVec2,
    rgb: Vec<u8>,
}

impl Canvas {
    /// A canvas of one colour.
    pub(super) fn new(size: UVec2, colour: Rgb888) -> Result<Self, PictureError> {
        let bytes = (size.x as usize).checked_mul(size.y as usize).and_then(|area| area.checked_mul(CHANNELS));
        let bytes = bytes.filter(|&bytes| bytes <= isize::MAX as usize).ok_or(PictureError::Area { size })?;
        let mut canvas = Self { size, rgb: vec![0; bytes] };
        canvas.fill(UVec2::ZERO, size, colour);
        Ok(canvas)
    }

    /// Fills a rectangle; what lies outside the canvas is cut off.
    pub(super) fn fill(&mut self, at: UVec2, size: UVec2, colour: Rgb888) {
        let end = (at + size).min(self.size);
        let columns = at.x as usize * CHANNELS..end.x.max(at.x) as usize * CHANNELS;
        let stride = self.stride();
        for row in self.rgb.chunks_mut(stride).take(end.y as usize).skip(at.y as usize) {
            if let Some(pixels) = row.get_mut(columns.clone()) {
                pixels.as_chunks_mut().0.fill(bytes_of(colour));
            }
        }
    }

    /// Draws a frame of that thickness around, not over, a rectangle. `at` leaves room for it.
    pub(super) fn frame(&mut self, at: UVec2, size: UVec2, thickness: u32, colour: Rgb888) {
        let thick = UVec2::splat(thickness);
        let (outer, across) = (at - thick, size + 2 * thick);
        self.fill(outer, UVec2::new(across.x, thickness), colour);
        self.fill(outer + UVec2::new(0, across.y - thickness), UVec2::new(across.x, thickness), colour);
        self.fill(outer, UVec2::new(thickness, across.y), colour);
        self.fill(outer + UVec2::new(across.x - thickness, 0), UVec2::new(thickness, across.y), colour);
    }

    /// Writes one line of text with its top left corner at `at`, its font enlarged by a whole factor.
    pub(super) fn text(&mut self, at: UVec2, font: &MonoFont, scale: u32, colour: Rgb888, text: &str) {
        let mut enlarged = Enlarged { canvas: self, at, scale };
        let style = MonoTextStyle::new(font, colour);
        let Ok(_) = Text::with_baseline(text, Point::zero(), style, Baseline::Top).draw(&mut enlarged);
    }

    /// Draws an image with its top left corner at `at`, each of its pixels as a square of `scale` × `scale`. It has to
    /// lie within the canvas.
    pub(super) fn image(&mut self, at: UVec2, size: UVec2, scale: u32, paint: &PaintRow) {
        let stride = self.stride();
        let (left, scale, width) = (at.x as usize * CHANNELS, scale as usize, size.x as usize);
        let rows = at.y as usize * stride..(at.y as usize + size.y as usize * scale) * stride;
        self.rgb[rows].par_chunks_mut(stride * scale).enumerate().for_each_init(
            || vec![Rgb888::BLACK; width],
            |colours, (y, rows)| {
                paint(y, colours);
                let (first, others) = rows.split_at_mut(stride);
                let columns = left..left + width * scale * CHANNELS;
                let (pixels, _) = first[columns.clone()].as_chunks_mut();
                for (square, &colour) in pixels.chunks_exact_mut(scale).zip(colours.iter()) {
                    square.fill(bytes_of(colour));
                }
                for other in others.chunks_exact_mut(stride) {
                    other[columns.clone()].copy_from_slice(&first[columns.clone()]);
                }
            },
        );
    }

    /// The picture as a PNG file without metadata.
    pub(super) fn into_png(self) -> Result<Vec<u8>, PictureError> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, self.size.x, self.size.y);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(png::Compression::Fast);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&self.rgb)?;
        writer.finish()?;
        Ok(bytes)
    }

    /// Bytes of a row, at least one so that rows can be told apart.
    fn stride(&self) -> usize {
        (self.size.x as usize * CHANNELS).max(1)
    }
}

fn bytes_of(colour: Rgb888) -> [u8; CHANNELS] {
    [colour.r(), colour.g(), colour.b()]
}

/// A part of a canvas on which every pixel drawn is a square.
struct Enlarged<'a> {
    canvas: &'a mut Canvas,
    at: UVec2,
    scale: u32,
}

impl OriginDimensions for Enlarged<'_> {
    fn size(&self) -> Size {
        let size = self.canvas.size.saturating_sub(self.at) / self.scale;
        Size::new(size.x, size.y)
    }
}

impl DrawTarget for Enlarged<'_> {
    type Color = Rgb888;
    type Error = Infallible;

    fn draw_iter<I: IntoIterator<Item = Pixel<Rgb888>>>(&mut self, pixels: I) -> Result<(), Infallible> {
        for Pixel(at, colour) in pixels {
            if let (Ok(x), Ok(y)) = (u32::try_from(at.x), u32::try_from(at.y)) {
                self.canvas.fill(self.at + self.scale * UVec2::new(x, y), UVec2::splat(self.scale), colour);
            }
        }
        Ok(())
    }
}
