//! A truth as bytes, to be kept between calls: which question it answers, what it says, and a checksum over both. Pixels are
//! kept as runs of equal ones.

use super::{ExactTruth, TruthKey};
use crate::mask::{Truth, TruthMask, Visibility};
use crate::receiver::PixelClass;
use flate2::Compression;
use flate2::read::ZlibDecoder;
use flate2::write::ZlibEncoder;
use glam::UVec2;
use sha2::{Digest, Sha256};
use std::io::{Read, Write};

/// What every entry of this layout begins with.
const MAGIC: &[u8] = b"gnomon truth 2\n";
/// Bytes of the checksum at the end.
const CHECKSUM: usize = 32;
/// Numbers that stand for what is no visibility: all are NaNs, which no visibility is.
const UNDECIDED: u32 = u32::MAX;
const BACKGROUND: u32 = u32::MAX - 1;
const FACING_AWAY: u32 = u32::MAX - 2;
const NOT_LIT: u32 = u32::MAX - 3;

/// Why bytes are no entry, or not the one looked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum EntryError {
    /// Torn, changed, or of another layout.
    #[error("it is damaged")]
    Damaged,
    /// Whole, but of another scene, camera, light, size, adapter or version.
    #[error("it answers another question")]
    Foreign,
}

/// The class of every pixel and the truth about those asked, as bytes.
///
/// # Errors
/// What the compression reports.
pub fn encode(key: &TruthKey, classes: &[PixelClass], truth: &ExactTruth) -> std::io::Result<Vec<u8>> {
    let UVec2 { x, y } = truth.mask.size;
    let mut bytes = [MAGIC, &key.0].concat();
    bytes.extend(x.to_le_bytes().into_iter().chain(y.to_le_bytes()));
    bytes.extend(truth.rays.to_le_bytes().into_iter().chain(truth.ms.to_le_bytes()));
    let numbers: Vec<u32> =
        classes.iter().zip(&truth.mask.pixels).map(|(class, pixel)| number(*class, *pixel)).collect();
    let runs: Vec<[u32; 2]> = numbers.chunk_by(u32::eq).map(|run| [run.len() as u32, run[0]]).collect();
    let mut encoder = ZlibEncoder::new(bytes, Compression::fast());
    encoder.write_all(bytemuck::cast_slice(&runs))?;
    let mut bytes = encoder.finish()?;
    let checksum = Sha256::digest(&bytes);
    bytes.extend(checksum);
    Ok(bytes)
}

/// What some bytes hold, if they are whole and answer the question of that key.
///
/// # Errors
/// [`EntryError`] says which of the two they are not.
pub fn decode(key: &TruthKey, bytes: &[u8]) -> Result<(Vec<PixelClass>, ExactTruth), EntryError> {
    let (rest, checksum) = bytes.split_last_chunk::<CHECKSUM>().ok_or(EntryError::Damaged)?;
    if Sha256::digest(rest).as_slice() != checksum {
        return Err(EntryError::Damaged);
    }
    let rest = rest.strip_prefix(MAGIC).ok_or(EntryError::Damaged)?;
    let rest = rest.strip_prefix(&key.0).ok_or(EntryError::Foreign)?;
    let (x, rest) = rest.split_first_chunk().ok_or(EntryError::Damaged)?;
    let (y, rest) = rest.split_first_chunk().ok_or(EntryError::Damaged)?;
    let (rays, rest) = rest.split_first_chunk().ok_or(EntryError::Damaged)?;
    let (ms, rest) = rest.split_first_chunk().ok_or(EntryError::Damaged)?;
    let size = UVec2::new(u32::from_le_bytes(*x), u32::from_le_bytes(*y));
    let count = size.x as usize * size.y as usize;
    let mut runs = Vec::new();
    ZlibDecoder::new(rest).read_to_end(&mut runs).map_err(|_| EntryError::Damaged)?;
    let (numbers, left_over) = runs.as_chunks();
    let (runs, odd) = numbers.as_chunks();
    let (mut classes, mut pixels) = (Vec::with_capacity(count), Vec::with_capacity(count));
    for [length, number] in runs {
        let (class, pixel) = pixel(u32::from_le_bytes(*number)).ok_or(EntryError::Damaged)?;
        let end = classes.len() + u32::from_le_bytes(*length) as usize;
        if end > count {
            return Err(EntryError::Damaged);
        }
        classes.resize(end, class);
        pixels.resize(end, pixel);
    }
    if classes.len() != count || !left_over.is_empty() || !odd.is_empty() {
        return Err(EntryError::Damaged);
    }
    let mask = TruthMask { size, pixels };
    Ok((classes, ExactTruth { mask, rays: u64::from_le_bytes(*rays), ms: f64::from_le_bytes(*ms) }))
}

fn number(class: PixelClass, pixel: Option<Truth>) -> u32 {
    match (class, pixel) {
        (PixelClass::Background, _) => BACKGROUND,
        (PixelClass::FacingAway, _) => FACING_AWAY,
        (PixelClass::NotLit, _) => NOT_LIT,
        (PixelClass::Asked, None | Some(Truth::Undecided)) => UNDECIDED,
        (PixelClass::Asked, Some(Truth::Known(visibility))) => visibility.get().to_bits(),
    }
}

/// What a number says of a pixel; `None` for one that says nothing.
fn pixel(number: u32) -> Option<(PixelClass, Option<Truth>)> {
    Some(match number {
        BACKGROUND => (PixelClass::Background, None),
        FACING_AWAY => (PixelClass::FacingAway, None),
        NOT_LIT => (PixelClass::NotLit, None),
        UNDECIDED => (PixelClass::Asked, Some(Truth::Undecided)),
        bits => (PixelClass::Asked, Some(Truth::Known(Visibility::new(f32::from_bits(bits))?))),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn truth() -> (Vec<PixelClass>, ExactTruth) {
        let known = |value: f32| Some(Truth::Known(Visibility::new(value).unwrap()));
        let pixels = vec![None, Some(Truth::Undecided), known(0.0), known(0.0), known(0.375), None, None, known(1.0)];
        let asked = PixelClass::Asked;
        let (background, away, not_lit) = (PixelClass::Background, PixelClass::FacingAway, PixelClass::NotLit);
        let classes = vec![background, asked, asked, asked, asked, away, not_lit, asked];
        (classes, ExactTruth { mask: TruthMask { size: UVec2::new(4, 2), pixels }, rays: 4, ms: 1.5 })
    }

    fn entry(key: &TruthKey) -> Vec<u8> {
        let (classes, truth) = truth();
        encode(key, &classes, &truth).unwrap()
    }

    #[test]
    fn it_reads_back_exactly() {
        let key = TruthKey([7; 32]);
        assert_eq!(decode(&key, &entry(&key)), Ok(truth()));
    }

    #[test]
    fn any_flipped_byte_and_any_torn_end_is_noticed() {
        let key = TruthKey([7; 32]);
        let bytes = entry(&key);
        for at in 0..bytes.len() {
            let mut flipped = bytes.clone();
            flipped[at] ^= 1 << (at % 8);
            assert_eq!(decode(&key, &flipped), Err(EntryError::Damaged), "{at}");
            assert_eq!(decode(&key, &bytes[..at]), Err(EntryError::Damaged), "{at}");
        }
    }

    #[test]
    fn an_answer_to_another_question_is_refused() {
        assert_eq!(decode(&TruthKey([8; 32]), &entry(&TruthKey([7; 32]))), Err(EntryError::Foreign));
    }
}
