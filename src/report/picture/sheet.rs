//! The layout of a picture: a heading, panels side by side, and below them a legend.
//!
//! Things are stacked from top to bottom within a fixed width; where each goes is known before the first pixel is drawn.
//! All lengths but those of panels are multiples of the text's scale, which grows with the sheet.

use super::canvas::{Canvas, PaintRow};
use super::legend::ColourScale;
use super::palette::{FAINT_TEXT, FRAME, SHEET, TEXT};
use super::{Caption, PictureError};
use crate::report::format::{printable, wrapped};
use embedded_graphics::mono_font::MonoFont;
use embedded_graphics::mono_font::iso_8859_1::{FONT_9X15, FONT_9X15_BOLD, FONT_10X20};
use embedded_graphics::pixelcolor::Rgb888;
use glam::UVec2;

/// Images are enlarged as far as their larger side stays within this.
const ENLARGED_UP_TO_PX: u32 = 360;
/// One step of the text's scale per so many pixels of panels, so that text stays readable when the sheet is shown small.
const PANELS_PER_TEXT_SCALE_PX: u32 = 1100;

/// Lengths in units of the text's scale.
const MARGIN: u32 = 24;
const PANEL_GAP: u32 = 20;
const BLOCK_GAP: u32 = 14;
const LINE_GAP: u32 = 5;
/// Room for a panel's title and scale, and for the heading of a sheet.
const NARROWEST_COLUMN: u32 = 300;
const NARROWEST_SHEET: u32 = 640;

/// A panel of a sheet.
pub(super) struct Panel<'a> {
    /// Stands above it.
    pub(super) title: &'static str,
    /// Colours its rows.
    pub(super) paint: Box<PaintRow<'a>>,
    /// Stands below it.
    pub(super) scale: Option<ColourScale>,
}

/// What will be drawn, and where.
pub(super) enum Item<'a> {
    Text { at: UVec2, font: &'static MonoFont<'static>, colour: Rgb888, text: String },
    Framed { at: UVec2, size: UVec2, colour: Rgb888 },
    Filled { at: UVec2, size: UVec2, colour: Rgb888 },
    Panel { at: UVec2, paint: Box<PaintRow<'a>> },
}

/// A sheet that is being laid out.
pub(super) struct Sheet<'a> {
    image: UVec2,
    enlargement: u32,
    text_scale: u32,
    column_width: u32,
    pub(super) inner_width: u32,
    /// Where the next thing goes.
    pub(super) bottom: u32,
    items: Vec<Item<'a>>,
}

impl<'a> Sheet<'a> {
    /// A sheet for so many panels of an image of that size.
    pub(super) fn new(image: UVec2, panels: u32) -> Self {
        let enlargement = (ENLARGED_UP_TO_PX / image.max_element()).max(1);
        let panel_width = image.x * enlargement;
        let text_scale = ((panels * panel_width + PANELS_PER_TEXT_SCALE_PX / 2) / PANELS_PER_TEXT_SCALE_PX).max(1);
        let column_width = panel_width.max(NARROWEST_COLUMN * text_scale);
        let columns_width = panels * column_width + (panels - 1) * PANEL_GAP * text_scale;
        Self {
            image,
            enlargement,
            text_scale,
            column_width,
            inner_width: columns_width.max(NARROWEST_SHEET * text_scale),
            bottom: MARGIN * text_scale,
            items: Vec::new(),
        }
    }

    /// What the sheet is about: scene and light, technique, and a summary.
    pub(super) fn heading(&mut self, caption: &Caption, summary: &str) {
        self.paragraph(&FONT_10X20, TEXT, &format!("{} / {}", caption.scene, caption.light));
        self.paragraph(&FONT_9X15, TEXT, caption.technique);
        self.paragraph(&FONT_9X15, FAINT_TEXT, summary);
        self.gap();
    }

    /// The panels, each below its title and above its scale.
    pub(super) fn panels(&mut self, panels: Vec<Panel<'a>>) {
        let size = self.image * self.enlargement;
        let top = self.bottom + self.line_height(&FONT_9X15_BOLD);
        let mut left = self.left();
        let (title_top, mut bottom) = (self.bottom, top + size.y);
        for panel in panels {
            self.text(UVec2::new(left, title_top), &FONT_9X15_BOLD, TEXT, panel.title.to_owned());
            self.add(Item::Framed { at: UVec2::new(left, top), size, colour: SHEET });
            self.add(Item::Panel { at: UVec2::new(left, top), paint: panel.paint });
            if let Some(scale) = panel.scale {
                let end =
                    self.colour_scale(UVec2::new(left, top + size.y + self.units(LINE_GAP)), self.column_width, &scale);
                bottom = bottom.max(end);
            }
            left += self.column_width + self.units(PANEL_GAP);
        }
        self.bottom = bottom;
        self.gap();
    }

    /// Draws everything.
    pub(super) fn into_png(self) -> Result<Vec<u8>, PictureError> {
        let margin = self.units(MARGIN);
        let size = UVec2::new(self.inner_width + 2 * margin, self.bottom + margin - self.units(BLOCK_GAP));
        let mut canvas = Canvas::new(size, SHEET)?;
        for item in &self.items {
            match item {
                Item::Text { at, font, colour, text } => canvas.text(*at, font, self.text_scale, *colour, text),
                Item::Filled { at, size, colour } => canvas.fill(*at, *size, *colour),
                Item::Framed { at, size, colour } => {
                    canvas.frame(*at, *size, self.text_scale, FRAME);
                    canvas.fill(*at, *size, *colour);
                }
                Item::Panel { at, paint } => canvas.image(*at, self.image, self.enlargement, paint),
            }
        }
        canvas.into_png()
    }

    /// Text from margin to margin.
    fn paragraph(&mut self, font: &'static MonoFont<'static>, colour: Rgb888, text: &str) {
        let characters = self.inner_width / self.text_width(font, 1);
        for line in wrapped(&printable(text), characters as usize) {
            self.text(UVec2::new(self.left(), self.bottom), font, colour, line);
            self.bottom += self.line_height(font);
        }
    }

    /// A line of text with its top left corner at `at`.
    pub(super) fn text(&mut self, at: UVec2, font: &'static MonoFont<'static>, colour: Rgb888, text: String) {
        self.add(Item::Text { at, font, colour, text });
    }

    pub(super) fn add(&mut self, item: Item<'a>) {
        self.items.push(item);
    }

    /// Space between two blocks.
    pub(super) fn gap(&mut self) {
        self.bottom += self.units(BLOCK_GAP);
    }

    /// Where things begin.
    pub(super) fn left(&self) -> u32 {
        self.units(MARGIN)
    }

    /// Pixels of a length in units of the text's scale.
    pub(super) fn units(&self, length: u32) -> u32 {
        length * self.text_scale
    }

    /// Pixels from one line to the next.
    pub(super) fn line_height(&self, font: &MonoFont) -> u32 {
        self.units(font.character_size.height + LINE_GAP)
    }

    /// Pixels that so many characters take.
    pub(super) fn text_width(&self, font: &MonoFont, characters: usize) -> u32 {
        self.units(characters as u32 * (font.character_size.width + font.character_spacing))
    }
}
