//! Masks as PNG: 8-bit grey and alpha out; grey or colour, with or without alpha, any depth in.

use super::{Alpha, MaskImage, MaskImageError, MaskPixel, pixels_from};
use glam::UVec2;
use png::{BitDepth, ColorType, Compression, Decoder, Encoder, Transformations};
use std::io::Cursor;

/// The first bytes of every PNG file.
pub(super) const MAGIC: [u8; 8] = *b"\x89PNG\r\n\x1a\n";

const ASKED: u8 = 255;
const UNDECIDED: u8 = 128;
const BLANK: u8 = 0;

pub(super) fn encode(mask: &MaskImage) -> Result<Vec<u8>, MaskImageError> {
    mask.check_area()?;
    let samples: Vec<u8> = mask.pixels.iter().flat_map(|&pixel| sample_of(pixel)).collect();
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, mask.size.x, mask.size.y);
    encoder.set_color(ColorType::GrayscaleAlpha);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_compression(Compression::Fast);
    let mut writer = encoder.write_header().map_err(unusable)?;
    writer.write_image_data(&samples).map_err(unusable)?;
    writer.finish().map_err(unusable)?;
    Ok(bytes)
}

fn sample_of(pixel: MaskPixel) -> [u8; 2] {
    match pixel {
        MaskPixel::Answered(visibility) => [(visibility.get() * 255.0).round() as u8, ASKED],
        MaskPixel::Undecided => [0, UNDECIDED],
        MaskPixel::Blank => [0, BLANK],
    }
}

pub(super) fn decode(bytes: &[u8], expected: UVec2) -> Result<MaskImage, MaskImageError> {
    let mut decoder = Decoder::new(Cursor::new(bytes));
    decoder.set_transformations(Transformations::EXPAND);
    let mut reader = decoder.read_info().map_err(unusable)?;
    let found = UVec2::new(reader.info().width, reader.info().height);
    if found != expected {
        return Err(MaskImageError::Size { found, expected });
    }
    let length = reader.output_buffer_size().ok_or_else(|| MaskImageError::Png("it is too large".to_owned()))?;
    let mut samples = vec![0; length];
    let info = reader.next_frame(&mut samples).map_err(unusable)?;
    samples.truncate(info.buffer_size());
    let bytes_per_sample = if info.bit_depth == BitDepth::Sixteen { 2 } else { 1 };
    let pixels = samples.chunks_exact(info.color_type.samples() * bytes_per_sample);
    pixels_from(found, pixels.map(|pixel| value_of(pixel, bytes_per_sample)))
}

/// Visibility and alpha of one pixel's samples of one or two bytes each: grey or three colours, then perhaps alpha.
fn value_of(pixel: &[u8], bytes_per_sample: usize) -> Result<(f32, Alpha), String> {
    let samples: [&[u8]; 4] = {
        let mut samples = pixel.chunks_exact(bytes_per_sample);
        std::array::from_fn(|_| samples.next().unwrap_or_default())
    };
    let (grey, alpha) = match samples {
        [grey, [], ..] => (grey, None),
        [grey, alpha, [], _] => (grey, Some(alpha)),
        [red, green, blue, alpha] => {
            if red != green || green != blue {
                return Err("it is coloured".to_owned());
            }
            (red, (!alpha.is_empty()).then_some(alpha))
        }
    };
    // The first byte of a 16-bit sample is its 8-bit value.
    let alpha = match alpha.map_or(ASKED, |alpha| alpha[0]) {
        ASKED => Alpha::Asked,
        UNDECIDED => Alpha::Undecided,
        BLANK => Alpha::Blank,
        other => return Err(format!("its alpha is {other}, which is none of {ASKED}, {UNDECIDED} and {BLANK}")),
    };
    let value = match *grey {
        [high, low] => f32::from(u16::from_be_bytes([high, low])) / 65535.0,
        [grey] => f32::from(grey) / 255.0,
        _ => f32::NAN,
    };
    Ok((value, alpha))
}

fn unusable(error: impl std::fmt::Display) -> MaskImageError {
    MaskImageError::Png(error.to_string())
}
