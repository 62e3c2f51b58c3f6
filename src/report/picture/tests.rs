//! Pictures of a made-up scene: that they hold what they should, at every size, and refuse what they must.

use super::*;
use crate::cause::Cause;
use crate::mask::{Mask, Truth, TruthMask, Visibility};
use crate::receiver::PixelClass;
use crate::report::model::tests::HOSTILE;
use crate::verdict::{Ledger, Verdict, WRONG_ABOVE_HARD, judge};
use embedded_graphics::pixelcolor::{Rgb888, RgbColor};
use glam::Vec2;
use std::collections::BTreeSet;
use std::io::Cursor;

const CAPTION: Caption = Caption { scene: "kitchen", light: "lamp", technique: "map:size=512,filter=pcf-box3" };

/// A sky, a wall turned away, a floor with a round shadow, and a technique whose shadow is a little off.
struct Scene {
    classes: Vec<PixelClass>,
    truth: TruthMask,
    mask: Mask,
    verdict: Verdict,
    ledger: Ledger,
}

impl Scene {
    fn new(width: u32, height: u32) -> Self {
        let size = UVec2::new(width, height);
        let places: Vec<Vec2> =
            (0..width * height).map(|i| (UVec2::new(i % width, i / width).as_vec2() + 0.5) / size.as_vec2()).collect();
        let classes: Vec<PixelClass> = places.iter().map(|&p| class_at(p)).collect();
        let shadow =
            |p: Vec2, centre: Vec2| if (p - centre).length() < 0.25 { Visibility::SHADOW } else { Visibility::LIT };
        let truth = |p: Vec2| match shadow(p, Vec2::new(0.5, 0.65)) {
            _ if (p.x - 0.9).abs() < 0.01 => Truth::Undecided,
            visibility => Truth::Known(visibility),
        };
        let asked = |i: usize| classes[i] == PixelClass::Asked;
        let truth =
            TruthMask { size, pixels: places.iter().enumerate().map(|(i, &p)| asked(i).then(|| truth(p))).collect() };
        let answer = |p: Vec2| {
            let blurred = Visibility::new(((p.x * 40.0).sin() * 0.2 + 0.8).clamp(0.0, 1.0)).unwrap_or(Visibility::LIT);
            if p.y > 0.92 { blurred } else { shadow(p, Vec2::new(0.51, 0.66)) }
        };
        let mask = Mask { size, pixels: places.iter().map(|&p| Some(answer(p))).collect() };
        let verdict = judge(&classes, &truth, &mask, WRONG_ABOVE_HARD).unwrap();
        let ledger = ledger_of(&verdict);
        Self { classes, truth, mask, verdict, ledger }
    }

    fn error_map(&self, caption: Caption) -> Vec<u8> {
        let Self { classes, truth, mask, verdict, .. } = self;
        error_map(&ErrorMap { caption, classes, truth, mask, verdict }).unwrap()
    }

    fn cause_map(&self) -> Vec<u8> {
        let Self { classes, truth, ledger, .. } = self;
        cause_map(&CauseMap { caption: CAPTION, classes, truth, ledger }).unwrap()
    }
}

fn class_at(p: Vec2) -> PixelClass {
    match p {
        p if p.y < 0.15 => PixelClass::Background,
        p if p.y < 0.3 && p.x < 0.4 => PixelClass::FacingAway,
        p if p.y < 0.3 && p.x > 0.7 => PixelClass::NotLit,
        _ => PixelClass::Asked,
    }
}

/// False shadow is called acne on the left and aliasing on the right, false light peter-panning.
fn ledger_of(verdict: &Verdict) -> Ledger {
    let mut ledger = Ledger::default();
    for (pixel, error) in (0_u32..).zip(&verdict.signed_error) {
        let cause = match error {
            Some(error) if *error > 0.0 => Cause::PeterPanning,
            Some(_) if pixel % verdict.size.x < verdict.size.x / 2 => Cause::Acne,
            _ => Cause::EdgeAliasing,
        };
        let share = ledger.causes.entry(cause).or_default();
        if verdict.is_wrong(pixel as usize) {
            share.pixels += 1;
            ledger.wrong.push((pixel, cause));
        } else if verdict.is_differing(pixel as usize) {
            ledger.merely_differing.push((pixel, cause));
        }
    }
    ledger
}

/// Texels of one pixel each, looked up everywhere but in the top row.
fn flat_m_map(size: UVec2, m: f32) -> Vec<u8> {
    let places: Vec<UVec2> = (0..size.x * size.y).map(|i| UVec2::new(i % size.x, i / size.x)).collect();
    let below_top = |at: &UVec2| at.y > 0;
    let m: Vec<Option<f32>> = places.iter().map(|at| below_top(at).then_some(m)).collect();
    let texel: Vec<Option<Vec2>> =
        places.iter().map(|at| below_top(at).then(|| Vec2::new(at.x as f32 + 0.5, 0.5))).collect();
    value_map(&ValueMap { caption: CAPTION, size, m: &m, texel: &texel }).unwrap()
}

/// The pixels of a PNG, which has to be 8-bit RGB without metadata.
fn pixels_of(png: &[u8]) -> (UVec2, Vec<[u8; 3]>) {
    let mut reader = ::png::Decoder::new(Cursor::new(png)).read_info().unwrap();
    let mut rgb = vec![0; reader.output_buffer_size().unwrap()];
    let frame = reader.next_frame(&mut rgb).unwrap();
    assert_eq!((frame.color_type, frame.bit_depth), (::png::ColorType::Rgb, ::png::BitDepth::Eight));
    let chunks: BTreeSet<&[u8]> = [b"tEXt", b"zTXt", b"iTXt", b"tIME"]
        .into_iter()
        .filter_map(|name| png.windows(4).find(|w| w == name))
        .collect();
    assert!(chunks.is_empty(), "metadata: {chunks:?}");
    (UVec2::new(frame.width, frame.height), rgb.as_chunks().0.to_vec())
}

fn count(png: &[u8], colour: Rgb888) -> u64 {
    let colour = [colour.r(), colour.g(), colour.b()];
    pixels_of(png).1.iter().filter(|&&pixel| pixel == colour).count() as u64
}

#[test]
fn every_wrong_pixel_is_drawn_in_its_colour_and_no_other_is() {
    // 90 pixels are enlarged 4 times.
    let (size, square) = (UVec2::new(90, 60), 16);
    let off = Scene::new(size.x, size.y);
    let mut right = Scene::new(size.x, size.y);
    let truth = right.truth.pixels.iter().map(|truth| match truth {
        Some(Truth::Known(visibility)) => Some(*visibility),
        _ => Some(Visibility::LIT),
    });
    right.mask.pixels = truth.collect();
    right.verdict = judge(&right.classes, &right.truth, &right.mask, WRONG_ABOVE_HARD).unwrap();
    assert_eq!(right.verdict.pixels.differing, 0);
    let (off_png, right_png) = (off.error_map(CAPTION), right.error_map(CAPTION));
    let added = |colour| count(&off_png, colour) - count(&right_png, colour);
    assert_eq!(added(palette::FALSE_SHADOW), off.verdict.pixels.false_shadow * square);
    assert_eq!(added(palette::FALSE_LIGHT), off.verdict.pixels.false_light * square);
    assert!(off.verdict.pixels.false_shadow > 0 && off.verdict.pixels.false_light > 0);
}

#[test]
fn a_cause_map_names_the_causes_that_are_there_and_no_others() {
    let scene = Scene::new(90, 60);
    let png = scene.cause_map();
    for cause in Cause::ALL {
        let wrong = scene.ledger.causes.get(&cause).map_or(0, |share| share.pixels);
        let swatch = if wrong > 0 { 13 * 13 } else { 0 };
        assert_eq!(count(&png, cause_colours::colour(cause)), 16 * wrong + swatch, "{}", cause.name());
    }
    assert!(scene.ledger.causes[&Cause::Acne].pixels > 0 && !scene.ledger.causes.contains_key(&Cause::OpenMesh));
}

#[test]
fn an_m_map_has_a_line_every_twenty_texels() {
    // 100 pixels are enlarged 3 times; lines run before texels 20, 40, 60 and 80, in all rows but the top one.
    let line = colour::blend(colour::rgb(0x2C_A0_2C), Rgb888::BLACK, 0.45);
    let png = flat_m_map(UVec2::new(100, 5), 1.0);
    assert_eq!(count(&png, line), 4 * 4 * 9 + 13 * 13);
    let too_fine = flat_m_map(UVec2::new(100, 5), 0.25);
    assert_eq!(count(&too_fine, line), 13 * 13, "lines of texels of a quarter pixel are left out");
}

#[test]
fn every_size_has_a_picture_and_the_same_input_the_same_bytes() {
    for size in [(1, 1), (3, 7), (31, 500), (640, 2), (1, 2000)].map(|(x, y)| UVec2::new(x, y)) {
        let scene = Scene::new(size.x, size.y);
        let pictures = [(scene.error_map(CAPTION), 3), (scene.cause_map(), 1), (flat_m_map(size, 2.0), 1)];
        for (png, panels) in pictures {
            let (found, _) = pixels_of(&png);
            assert!(found.x >= panels * size.x && found.x >= 640 && found.y > size.y, "{size} {found}");
        }
        assert_eq!(scene.error_map(CAPTION), scene.error_map(CAPTION));
    }
}

#[test]
fn long_and_hostile_names_are_wrapped_and_drawn() {
    let scene = Scene::new(8, 8);
    let long = "a".repeat(3000);
    let calm = pixels_of(&scene.error_map(CAPTION)).0;
    let hostile = scene.error_map(Caption { scene: HOSTILE, light: "Küche 灯", technique: &long });
    let grown = pixels_of(&hostile).0;
    assert!(grown.x == calm.x && grown.y > calm.y);
}

#[test]
fn inputs_of_other_sizes_and_empty_pictures_are_refused() {
    let scene = Scene::new(8, 8);
    let Scene { classes, truth, mask, verdict, ledger } = &scene;
    let short = error_map(&ErrorMap { caption: CAPTION, classes: &classes[1..], truth, mask, verdict });
    assert!(matches!(short, Err(PictureError::Size { what: "class list", found: 63, .. })));
    let other = Scene::new(8, 7);
    let foreign = error_map(&ErrorMap { caption: CAPTION, classes, truth, mask, verdict: &other.verdict });
    assert!(matches!(foreign, Err(PictureError::Size { what: "verdict", found: 56, .. })));
    let short = cause_map(&CauseMap { caption: CAPTION, classes: &classes[1..], truth, ledger });
    assert!(matches!(short, Err(PictureError::Size { .. })));
    for size in [UVec2::new(0, 3), UVec2::new(u32::MAX, 1)] {
        let refused = value_map(&ValueMap { caption: CAPTION, size, m: &[], texel: &[] });
        assert!(matches!(refused, Err(PictureError::Area { .. })));
    }
}
