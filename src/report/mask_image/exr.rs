//! Masks as OpenEXR: float channels `V` (visibility) and `A` (1 asked, 0.5 undecided, 0 all else).

use super::{Alpha, MaskImage, MaskImageError, MaskPixel, pixels_from};
use exr::image::read::specific_channels::ReadSpecificChannel;
use exr::meta::MetaData;
use exr::prelude::{Image, ReadChannels, ReadLayers, SpecificChannels, Vec2, WritableImage, read};
use glam::UVec2;
use std::io::Cursor;

/// The first bytes of every OpenEXR file.
pub(super) const MAGIC: [u8; 4] = [0x76, 0x2F, 0x31, 0x01];

const ASKED: f32 = 1.0;
const UNDECIDED: f32 = 0.5;
const BLANK: f32 = 0.0;

/// Value and alpha of one pixel.
type Sample = (f32, f32);

pub(super) fn encode(mask: &MaskImage) -> Result<Vec<u8>, MaskImageError> {
    mask.check_area()?;
    let width = mask.size.x as usize;
    let sample = |at: Vec2<usize>| sample_of(mask.pixels[at.y() * width + at.x()]);
    let channels = SpecificChannels::build().with_channel("V").with_channel("A").with_pixel_fn(sample);
    let mut file = Cursor::new(Vec::new());
    Image::from_channels((width, mask.size.y as usize), channels).write().to_buffered(&mut file).map_err(unusable)?;
    Ok(file.into_inner())
}

fn sample_of(pixel: MaskPixel) -> Sample {
    match pixel {
        MaskPixel::Answered(visibility) => (visibility.get(), ASKED),
        MaskPixel::Undecided => (0.0, UNDECIDED),
        MaskPixel::Blank => (0.0, BLANK),
    }
}

pub(super) fn decode(bytes: &[u8], expected: UVec2) -> Result<MaskImage, MaskImageError> {
    check_header(bytes, expected)?;
    let width = expected.x as usize;
    let file = read()
        .no_deep_data()
        .largest_resolution_level()
        .specific_channels()
        .required("V")
        .optional("A", ASKED)
        .collect_pixels(
            |size, _| vec![(0.0, BLANK); size.area()],
            move |samples: &mut Vec<Sample>, at, sample: Sample| samples[at.y() * width + at.x()] = sample,
        )
        .first_valid_layer()
        .all_attributes()
        .from_buffered(Cursor::new(bytes))
        .map_err(unusable)?;
    let samples = file.layer_data.channel_data.pixels;
    pixels_from(expected, samples.into_iter().map(|(value, alpha)| Ok((value, alpha_of(alpha)?))))
}

/// One layer of the expected size with a channel `V`: everything that can be said without reading a pixel.
fn check_header(bytes: &[u8], expected: UVec2) -> Result<(), MaskImageError> {
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(unusable)?;
    let [header] = meta.headers.as_slice() else {
        return Err(MaskImageError::Channels(format!("it has {} layers instead of one", meta.headers.len())));
    };
    let found = UVec2::new(header.layer_size.x() as u32, header.layer_size.y() as u32);
    if found != expected {
        return Err(MaskImageError::Size { found, expected });
    }
    let names: Vec<String> = header.channels.list.iter().map(|channel| channel.name.to_string()).collect();
    if !names.iter().any(|name| name == "V") {
        let names = names.join(", ");
        return Err(MaskImageError::Channels(format!("it has no channel V (visibility), only {names}")));
    }
    Ok(())
}

fn alpha_of(alpha: f32) -> Result<Alpha, String> {
    [(ASKED, Alpha::Asked), (UNDECIDED, Alpha::Undecided), (BLANK, Alpha::Blank)]
        .into_iter()
        .find_map(|(value, meaning)| (alpha.to_bits() == value.to_bits()).then_some(meaning))
        .ok_or_else(|| format!("its alpha is {alpha}, which is none of {ASKED}, {UNDECIDED} and {BLANK}"))
}

fn unusable(error: impl std::fmt::Display) -> MaskImageError {
    MaskImageError::Exr(error.to_string())
}
