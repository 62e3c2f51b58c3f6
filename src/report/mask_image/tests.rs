//! Round trips, what else is accepted, and what is refused with which words.

use super::*;
use ::exr::prelude::{Image, SpecificChannels, Vec2, WritableImage};
use ::png::{BitDepth, ColorType, Encoder};
use proptest::prelude::*;
use std::io::Cursor;

/// 8-bit samples round to the nearest 1/255.
const PNG_STEP: f32 = 0.5 / 255.0 + f32::EPSILON;

fn answered(value: f32) -> MaskPixel {
    MaskPixel::Answered(Visibility::new(value).unwrap())
}

fn png_of(size: UVec2, color: ColorType, depth: BitDepth, samples: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, size.x, size.y);
    encoder.set_color(color);
    encoder.set_depth(depth);
    encoder.write_header().unwrap().write_image_data(samples).unwrap();
    bytes
}

/// A 2 × 1 OpenEXR file of one value per channel and pixel.
fn exr_of(names: [&str; 2], samples: [(f32, f32); 2]) -> Vec<u8> {
    let channels = SpecificChannels::build()
        .with_channel(names[0])
        .with_channel(names[1])
        .with_pixel_fn(|at: Vec2<usize>| samples[at.x()]);
    let mut file = Cursor::new(Vec::new());
    Image::from_channels((2, 1), channels).write().to_buffered(&mut file).unwrap();
    file.into_inner()
}

fn refusal(bytes: &[u8], expected: UVec2) -> String {
    MaskImage::decode(bytes, expected).unwrap_err().to_string()
}

fn pixel() -> impl Strategy<Value = MaskPixel> {
    prop_oneof![Just(MaskPixel::Undecided), Just(MaskPixel::Blank), (0.0_f32..=1.0).prop_map(answered),]
}

fn image() -> impl Strategy<Value = MaskImage> {
    (1_u32..20, 1_u32..20).prop_flat_map(|(x, y)| {
        let pixels = prop::collection::vec(pixel(), (x * y) as usize);
        pixels.prop_map(move |pixels| MaskImage { size: UVec2::new(x, y), pixels })
    })
}

proptest! {
    #[test]
    fn exr_is_exact_and_png_rounds_to_its_step(image in image()) {
        let from_exr = MaskImage::decode(&image.to_exr().unwrap(), image.size).unwrap();
        prop_assert_eq!(&from_exr, &image);
        let from_png = MaskImage::decode(&image.to_png().unwrap(), image.size).unwrap();
        for (read, written) in from_png.pixels.iter().zip(&image.pixels) {
            match (read, written) {
                (MaskPixel::Answered(read), MaskPixel::Answered(written)) => {
                    prop_assert!((read.get() - written.get()).abs() <= PNG_STEP);
                }
                _ => prop_assert_eq!(read, written),
            }
        }
        // What was rounded once is rounded to itself.
        prop_assert_eq!(MaskImage::decode(&from_png.to_png().unwrap(), image.size).unwrap(), from_png);
        prop_assert_eq!(image.to_exr().unwrap(), image.to_exr().unwrap());
    }
}

#[test]
fn masks_and_truths_become_images_and_come_back() {
    let size = UVec2::new(2, 2);
    let half = Visibility::new(0.5).unwrap();
    let mask = Mask { size, pixels: vec![None, Some(Visibility::LIT), Some(Visibility::SHADOW), Some(half)] };
    assert_eq!(MaskImage::from(&mask).to_mask(), mask);
    let known = Some(Truth::Known(half));
    let truth = TruthMask { size, pixels: vec![None, Some(Truth::Undecided), known, known] };
    assert_eq!(MaskImage::from(&truth).to_truth(), truth);
    assert_eq!(MaskImage::from(&truth).to_mask().pixels, [None, None, Some(half), Some(half)]);
}

#[test]
fn the_png_holds_the_documented_samples() {
    let size = UVec2::new(4, 1);
    let pixels = vec![answered(1.0), answered(0.25), MaskPixel::Undecided, MaskPixel::Blank];
    let written = MaskImage { size, pixels }.to_png().unwrap();
    let expected = [255, 255, 64, 255, 0, 128, 0, 0];
    let mut reader = ::png::Decoder::new(Cursor::new(&written)).read_info().unwrap();
    let mut samples = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut samples).unwrap();
    assert_eq!(samples, expected);
}

#[test]
fn grey_and_colour_without_alpha_are_all_answered() {
    let size = UVec2::new(2, 1);
    let expected = vec![answered(0.0), answered(1.0)];
    let files = [
        png_of(size, ColorType::Grayscale, BitDepth::Eight, &[0, 255]),
        png_of(size, ColorType::Grayscale, BitDepth::One, &[0b0100_0000]),
        png_of(size, ColorType::Grayscale, BitDepth::Sixteen, &[0, 0, 255, 255]),
        png_of(size, ColorType::Rgb, BitDepth::Eight, &[0, 0, 0, 255, 255, 255]),
        png_of(size, ColorType::Rgba, BitDepth::Eight, &[0, 0, 0, 255, 255, 255, 255, 255]),
        exr_of(["V", "Z"], [(0.0, 7.0), (1.0, 7.0)]),
    ];
    for (i, file) in files.iter().enumerate() {
        assert_eq!(MaskImage::decode(file, size).unwrap().pixels, expected, "file {i}");
    }
    let sixteen = [0x12, 0x34, 255, 255, 9, 9, 0x80, 0x80];
    let sixteen = png_of(size, ColorType::GrayscaleAlpha, BitDepth::Sixteen, &sixteen);
    let fine = MaskImage::decode(&sixteen, size).unwrap();
    assert_eq!(fine.pixels, [answered(f32::from(0x1234_u16) / 65535.0), MaskPixel::Undecided]);
}

#[test]
fn what_is_no_mask_is_refused_by_name() {
    let size = UVec2::new(2, 1);
    assert!(refusal(b"BM not a mask", size).contains("neither a PNG nor an OpenEXR"));
    assert!(refusal(b"", size).contains("neither a PNG nor an OpenEXR"));

    let colour = png_of(size, ColorType::Rgb, BitDepth::Eight, &[0, 0, 0, 0, 0, 1]);
    assert_eq!(refusal(&colour, size), "pixel (1, 0) is no mask: it is coloured");
    let translucent = png_of(size, ColorType::GrayscaleAlpha, BitDepth::Eight, &[0, 255, 0, 127]);
    assert!(refusal(&translucent, size).starts_with("pixel (1, 0) is no mask: its alpha is 127"));

    let rgb = exr_of(["G", "R"], [(0.0, 0.0); 2]);
    assert_eq!(refusal(&rgb, size), "this is no mask: it has no channel V (visibility), only G, R");
    let nan = exr_of(["V", "A"], [(0.0, 1.0), (f32::NAN, 1.0)]);
    assert_eq!(refusal(&nan, size), "pixel (1, 0) is no mask: its visibility is NaN, which is not in 0..=1");
    let bright = exr_of(["V", "A"], [(1.5, 1.0), (0.0, 1.0)]);
    assert!(refusal(&bright, size).starts_with("pixel (0, 0) is no mask: its visibility is 1.5"));
    let translucent = exr_of(["V", "A"], [(0.0, 0.25), (0.0, 1.0)]);
    assert!(refusal(&translucent, size).starts_with("pixel (0, 0) is no mask: its alpha is 0.25"));
    let unasked = exr_of(["V", "A"], [(f32::NAN, 0.0), (f32::NAN, 0.5)]);
    let unasked = MaskImage::decode(&unasked, size).unwrap();
    assert_eq!(unasked.pixels, [MaskPixel::Blank, MaskPixel::Undecided], "nobody looks at unasked values");
}

#[test]
fn another_size_and_damaged_files_are_refused() {
    let image = MaskImage { size: UVec2::new(2, 1), pixels: vec![answered(0.5); 2] };
    for file in [image.to_png().unwrap(), image.to_exr().unwrap()] {
        let turned = refusal(&file, UVec2::new(1, 2));
        assert_eq!(turned, "the mask is 2 x 1 pixels large, the picture 1 x 2");
        for length in 8..file.len() {
            assert!(length + 20 > file.len() || MaskImage::decode(&file[..length], image.size).is_err(), "{length}");
        }
    }
}

#[test]
fn a_flipped_bit_never_panics() {
    let image = MaskImage { size: UVec2::new(2, 1), pixels: vec![answered(0.5), MaskPixel::Undecided] };
    for file in [image.to_png().unwrap(), image.to_exr().unwrap()] {
        for bit in 0..8 * file.len() {
            let mut damaged = file.clone();
            damaged[bit / 8] ^= 1 << (bit % 8);
            let _ = MaskImage::decode(&damaged, image.size);
        }
    }
}

#[test]
fn masks_that_contradict_themselves_are_not_written() {
    let short = MaskImage { size: UVec2::new(2, 2), pixels: vec![MaskPixel::Blank; 3] };
    let empty = MaskImage { size: UVec2::ZERO, pixels: Vec::new() };
    for image in [short, empty] {
        assert!(matches!(image.to_png(), Err(MaskImageError::Area { .. })));
        assert!(matches!(image.to_exr(), Err(MaskImageError::Area { .. })));
    }
}
