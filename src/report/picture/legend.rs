//! What the colours of a sheet mean: scales for measured values, swatches for names.

use super::palette::{FAINT_TEXT, FRAME, TEXT};
use super::sheet::{Item, Sheet};
use embedded_graphics::mono_font::MonoFont;
use embedded_graphics::mono_font::iso_8859_1::FONT_8X13;
use embedded_graphics::pixelcolor::Rgb888;
use glam::UVec2;

const FONT: &MonoFont = &FONT_8X13;

/// Lengths in units of the text's scale.
const SWATCH: u32 = 13;
const SWATCH_TO_LABEL: u32 = 7;
const SWATCH_GAP: u32 = 24;
const BAR_HEIGHT: u32 = 12;
const WIDEST_BAR: u32 = 400;
const TICK: u32 = 4;

/// A bar of colours with marks below it.
pub(super) struct ColourScale {
    /// The colour at 0..=1 along the bar.
    pub(super) colour: Box<dyn Fn(f32) -> Rgb888>,
    /// Positions 0..=1 along the bar with their labels.
    pub(super) marks: Vec<(f32, String)>,
}

/// A small square of a colour, and what it stands for.
pub(super) struct Swatch {
    pub(super) colour: Rgb888,
    pub(super) label: String,
}

impl Sheet<'_> {
    /// Draws a scale of at most `width` pixels below `at`, and returns where it ends.
    pub(super) fn colour_scale(&mut self, at: UVec2, width: u32, scale: &ColourScale) -> u32 {
        let size = UVec2::new(width.min(self.units(WIDEST_BAR)), self.units(BAR_HEIGHT));
        self.add(Item::Framed { at, size, colour: FRAME });
        let step = self.units(1);
        for x in (0..size.x).step_by(step as usize) {
            let colour = (scale.colour)(x as f32 / (size.x - step).max(1) as f32);
            self.add(Item::Filled {
                at: at + UVec2::new(x, 0),
                size: UVec2::new(step.min(size.x - x), size.y),
                colour,
            });
        }
        let tick_top = at.y + size.y + step;
        let label_top = tick_top + self.units(TICK + 2);
        for (position, label) in &scale.marks {
            let x = at.x + (position * (size.x - step) as f32) as u32;
            let tick = UVec2::new(step, self.units(TICK));
            self.add(Item::Filled { at: UVec2::new(x, tick_top), size: tick, colour: FAINT_TEXT });
            // Centred below its mark, but not beyond the bar's ends.
            let label_width = self.text_width(FONT, label.chars().count());
            let left = x.saturating_sub(label_width / 2).min((at.x + size.x).saturating_sub(label_width)).max(at.x);
            self.text(UVec2::new(left, label_top), FONT, FAINT_TEXT, label.clone());
        }
        label_top + self.line_height(FONT)
    }

    /// Swatches in rows from margin to margin.
    pub(super) fn swatches(&mut self, swatches: impl IntoIterator<Item = Swatch>) {
        let (row_start, row_end) = (self.left(), self.left() + self.inner_width);
        let line = self.line_height(FONT) + self.units(3);
        let mut left = row_start;
        for Swatch { colour, label } in swatches {
            let label_at = self.units(SWATCH + SWATCH_TO_LABEL);
            let width = label_at + self.text_width(FONT, label.chars().count());
            if left > row_start && left + width > row_end {
                left = row_start;
                self.bottom += line;
            }
            let at = UVec2::new(left, self.bottom);
            self.add(Item::Framed { at, size: UVec2::splat(self.units(SWATCH)), colour });
            self.text(at + UVec2::new(label_at, 0), FONT, TEXT, label);
            left += width + self.units(SWATCH_GAP);
        }
        self.bottom += line;
        self.gap();
    }
}
