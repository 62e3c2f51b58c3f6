//! Masks as image files, so that other renderers can be judged and other tools can read what gnomon knows.
//!
//! PNG holds grey = visibility (0 shadow … 255 lit) and alpha = 255 asked, 128 undecided, 0 all else, both 8 bits; it
//! rounds visibility to the nearest 1/255. OpenEXR holds the same as float channels `V` and `A` (1, 0.5, 0) and rounds
//! nothing. Values are linear: gamma and colour profiles are ignored. Reading also takes grey or colour PNGs without
//! alpha, all of whose pixels then count as answered, and 16-bit ones.

mod exr;
mod png;

use crate::mask::{Mask, Truth, TruthMask, Visibility};
use glam::UVec2;

/// What an image file says of one pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MaskPixel {
    /// The visibility.
    Answered(Visibility),
    /// The truth was asked and is undecided.
    Undecided,
    /// Nothing was asked.
    Blank,
}

/// A mask as image files hold it: of a technique or of the truth.
#[derive(Debug, Clone, PartialEq)]
pub struct MaskImage {
    /// Width and height in pixels.
    pub size: UVec2,
    /// `size.x * size.y` entries, row by row from the top.
    pub pixels: Vec<MaskPixel>,
}

impl From<&Mask> for MaskImage {
    fn from(mask: &Mask) -> Self {
        let pixel = |answer: &Option<Visibility>| answer.map_or(MaskPixel::Blank, MaskPixel::Answered);
        Self { size: mask.size, pixels: mask.pixels.iter().map(pixel).collect() }
    }
}

impl From<&TruthMask> for MaskImage {
    fn from(truth: &TruthMask) -> Self {
        let pixel = |truth: &Option<Truth>| match *truth {
            Some(Truth::Known(visibility)) => MaskPixel::Answered(visibility),
            Some(Truth::Undecided) => MaskPixel::Undecided,
            None => MaskPixel::Blank,
        };
        Self { size: truth.size, pixels: truth.pixels.iter().map(pixel).collect() }
    }
}

impl MaskImage {
    /// As a technique's answer: undecided pixels are not answered.
    #[must_use]
    pub fn to_mask(&self) -> Mask {
        let answer = |pixel: &MaskPixel| match *pixel {
            MaskPixel::Answered(visibility) => Some(visibility),
            MaskPixel::Undecided | MaskPixel::Blank => None,
        };
        Mask { size: self.size, pixels: self.pixels.iter().map(answer).collect() }
    }

    /// As a truth.
    #[must_use]
    pub fn to_truth(&self) -> TruthMask {
        let truth = |pixel: &MaskPixel| match *pixel {
            MaskPixel::Answered(visibility) => Some(Truth::Known(visibility)),
            MaskPixel::Undecided => Some(Truth::Undecided),
            MaskPixel::Blank => None,
        };
        TruthMask { size: self.size, pixels: self.pixels.iter().map(truth).collect() }
    }

    /// As a PNG file; visibilities are rounded to the nearest 1/255.
    ///
    /// # Errors
    /// A size that PNG cannot hold (0, or beyond 2³¹), or one that does not fit the number of pixels.
    pub fn to_png(&self) -> Result<Vec<u8>, MaskImageError> {
        png::encode(self)
    }

    /// As an OpenEXR file, exact.
    ///
    /// # Errors
    /// A size that OpenEXR cannot hold, or one that does not fit the number of pixels.
    pub fn to_exr(&self) -> Result<Vec<u8>, MaskImageError> {
        exr::encode(self)
    }

    /// Reads a PNG or OpenEXR file, told apart by their first bytes. `expected` is the width and height of the picture
    /// it has to be a mask of, checked before any pixel is read.
    ///
    /// # Errors
    /// Bytes of another format or a damaged file, another size, channels that are no mask, a coloured pixel, an answer
    /// that is NaN or outside 0..=1, and an alpha with no meaning.
    pub fn decode(bytes: &[u8], expected: UVec2) -> Result<Self, MaskImageError> {
        if bytes.starts_with(&png::MAGIC) {
            png::decode(bytes, expected)
        } else if bytes.starts_with(&exr::MAGIC) {
            exr::decode(bytes, expected)
        } else {
            Err(MaskImageError::UnknownFormat)
        }
    }

    fn check_area(&self) -> Result<(), MaskImageError> {
        let area = self.size.x as usize * self.size.y as usize;
        if area == 0 || area != self.pixels.len() {
            return Err(MaskImageError::Area { size: self.size, pixels: self.pixels.len() });
        }
        Ok(())
    }
}

/// Why an image file cannot be written or read as a mask.
#[derive(Debug, thiserror::Error)]
pub enum MaskImageError {
    /// Neither PNG nor OpenEXR.
    #[error("this is no mask: it is neither a PNG nor an OpenEXR file")]
    UnknownFormat,
    /// The PNG cannot be written or read.
    #[error("the PNG cannot be used: {0}")]
    Png(String),
    /// The OpenEXR file cannot be written or read.
    #[error("the OpenEXR file cannot be used: {0}")]
    Exr(String),
    /// The image is of another picture.
    #[error("the mask is {} x {} pixels large, the picture {} x {}", found.x, found.y, expected.x, expected.y)]
    Size {
        /// Width and height of the file.
        found: UVec2,
        /// Width and height of the picture.
        expected: UVec2,
    },
    /// A mask that contradicts itself or has no pixel.
    #[error("a mask of {} x {} with {pixels} pixels cannot be written", size.x, size.y)]
    Area {
        /// Its width and height.
        size: UVec2,
        /// Its number of pixels.
        pixels: usize,
    },
    /// The file's channels are not those of a mask.
    #[error("this is no mask: {0}")]
    Channels(String),
    /// A pixel that is no visibility.
    #[error("pixel ({}, {}) is no mask: {what}", at.x, at.y)]
    Pixel {
        /// Column and row.
        at: UVec2,
        /// What is wrong with it.
        what: String,
    },
}

/// The pixels of a file, each given its visibility and alpha, or the error of the first that has no meaning.
fn pixels_from(
    size: UVec2,
    values: impl Iterator<Item = Result<(f32, Alpha), String>>,
) -> Result<MaskImage, MaskImageError> {
    let at = |index: u32| UVec2::new(index % size.x, index / size.x);
    let pixel = |(index, value): (u32, Result<(f32, Alpha), String>)| {
        value
            .and_then(|(value, alpha)| meaning(value, alpha))
            .map_err(|what| MaskImageError::Pixel { at: at(index), what })
    };
    let pixels = (0..).zip(values).map(pixel).collect::<Result<_, _>>()?;
    Ok(MaskImage { size, pixels })
}

/// What alpha says of a pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Alpha {
    Asked,
    Undecided,
    Blank,
}

fn meaning(value: f32, alpha: Alpha) -> Result<MaskPixel, String> {
    match alpha {
        Alpha::Blank => Ok(MaskPixel::Blank),
        Alpha::Undecided => Ok(MaskPixel::Undecided),
        Alpha::Asked => Visibility::new(value)
            .map(MaskPixel::Answered)
            .ok_or_else(|| format!("its visibility is {value}, which is not in 0..=1")),
    }
}

#[cfg(test)]
mod tests;
