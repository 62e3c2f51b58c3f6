//! A picture as bytes: sRGB for the eye, linear floats for tools.
//!
//! The sRGB curve is that of IEC 61966-2-1:1999; colours are clamped to 0..=1 first. EXR keeps them as they are.

use super::Picture;
use glam::Vec3;
use image::{DynamicImage, ImageFormat, ImageResult, Rgb, Rgb32FImage, RgbImage};
use std::io::Cursor;

impl Picture {
    /// 8-bit sRGB.
    #[must_use]
    pub fn to_srgb8(&self) -> RgbImage {
        RgbImage::from_fn(self.size.x, self.size.y, |x, y| Rgb(self.colour(x, y).to_array().map(srgb8_from_linear)))
    }

    /// A PNG file of 8-bit sRGB.
    ///
    /// # Errors
    /// The encoder's, for a picture without pixels.
    pub fn to_png(&self) -> ImageResult<Vec<u8>> {
        encoded(&self.to_srgb8().into(), ImageFormat::Png)
    }

    /// An OpenEXR file of linear 32-bit floats, not clamped.
    ///
    /// # Errors
    /// The encoder's, for a picture without pixels.
    pub fn to_exr(&self) -> ImageResult<Vec<u8>> {
        let linear = Rgb32FImage::from_fn(self.size.x, self.size.y, |x, y| Rgb(self.colour(x, y).to_array()));
        encoded(&linear.into(), ImageFormat::OpenExr)
    }

    fn colour(&self, x: u32, y: u32) -> Vec3 {
        self.linear_rgb[y as usize * self.size.x as usize + x as usize]
    }
}

fn encoded(image: &DynamicImage, format: ImageFormat) -> ImageResult<Vec<u8>> {
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, format)?;
    Ok(bytes.into_inner())
}

fn srgb8_from_linear(linear: f32) -> u8 {
    (srgb_from_linear(linear.clamp(0.0, 1.0)) * 255.0).round() as u8
}

/// The sRGB curve, 0..=1 to 0..=1.
fn srgb_from_linear(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::UVec2;

    /// The inverse curve, from the same standard.
    fn linear_from_srgb(srgb: f32) -> f32 {
        if srgb <= 0.040_45 { srgb / 12.92 } else { ((srgb + 0.055) / 1.055).powf(2.4) }
    }

    fn picture() -> Picture {
        let linear_rgb = vec![Vec3::ZERO, Vec3::splat(0.5), Vec3::new(7.5, -0.25, 1.0)];
        Picture { size: UVec2::new(3, 1), linear_rgb }
    }

    #[test]
    fn every_srgb_byte_survives_the_round_trip() {
        assert!((0..=255).all(|byte| srgb8_from_linear(linear_from_srgb(f32::from(byte) / 255.0)) == byte));
        // Control: a plain power of 2.2 does not.
        assert!((0..=255).any(|byte| srgb8_from_linear((f32::from(byte) / 255.0).powf(2.2)) != byte));
    }

    #[test]
    fn known_values_and_clamping() {
        assert_eq!(picture().to_srgb8().into_raw(), [0, 0, 0, 188, 188, 188, 255, 0, 255]);
    }

    #[test]
    fn png_holds_the_srgb_bytes() {
        let read = image::load_from_memory(&picture().to_png().unwrap()).unwrap();
        assert_eq!(read.into_rgb8(), picture().to_srgb8());
    }

    #[test]
    fn exr_holds_the_linear_floats_unclamped() {
        let read = image::load_from_memory(&picture().to_exr().unwrap()).unwrap().into_rgb32f();
        let expected: Vec<f32> = picture().linear_rgb.iter().flat_map(|colour| colour.to_array()).collect();
        assert_eq!(read.into_raw(), expected);
    }

    #[test]
    fn a_picture_without_pixels_is_an_error() {
        let empty = Picture { size: UVec2::ZERO, linear_rgb: vec![] };
        assert!(empty.to_png().is_err());
    }
}
