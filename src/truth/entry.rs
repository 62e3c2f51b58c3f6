//! A truth as bytes, to be kept between calls: which question it answers, what it says, and a checksum over both.

use super::{ExactTruth, TruthKey};
use crate::mask::{Truth, TruthMask, Visibility};
use flate2::Compression;
use flate2::read::ZlibDecoder;
use flate2::write::ZlibEncoder;
use glam::UVec2;
use sha2::{Digest, Sha256};
use std::io::{Read, Write};

/// What every entry of this layout begins with.
const MAGIC: &[u8] = b"gnomon truth 1\n";
/// Bytes of the checksum at the end.
const CHECKSUM: usize = 32;
/// Numbers that stand for what is no visibility: both are NaNs, which no visibility is.
const NOT_ASKED: u32 = u32::MAX;
const UNDECIDED: u32 = u32::MAX - 1;

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

/// The truth as bytes.
///
/// # Errors
/// What the compression reports.
pub fn encode(key: &TruthKey, truth: &ExactTruth) -> std::io::Result<Vec<u8>> {
    let UVec2 { x, y } = truth.mask.size;
    let mut bytes = [MAGIC, &key.0].concat();
    bytes.extend(x.to_le_bytes().into_iter().chain(y.to_le_bytes()));
    bytes.extend(truth.rays.to_le_bytes().into_iter().chain(truth.ms.to_le_bytes()));
    let number = |pixel: &Option<Truth>| match pixel {
        None => NOT_ASKED,
        Some(Truth::Undecided) => UNDECIDED,
        Some(Truth::Known(visibility)) => visibility.get().to_bits(),
    };
    let numbers: Vec<u8> = truth.mask.pixels.iter().flat_map(|pixel| number(pixel).to_le_bytes()).collect();
    let mut encoder = ZlibEncoder::new(bytes, Compression::fast());
    encoder.write_all(&numbers)?;
    let mut bytes = encoder.finish()?;
    let checksum = Sha256::digest(&bytes);
    bytes.extend(checksum);
    Ok(bytes)
}

/// The truth that some bytes hold, if they are whole and answer the question of that key.
///
/// # Errors
/// [`EntryError`] says which of the two they are not.
pub fn decode(key: &TruthKey, bytes: &[u8]) -> Result<ExactTruth, EntryError> {
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
    let mut numbers = Vec::new();
    ZlibDecoder::new(rest).read_to_end(&mut numbers).map_err(|_| EntryError::Damaged)?;
    let (numbers, left_over) = numbers.as_chunks();
    let pixels: Option<Vec<Option<Truth>>> = numbers.iter().map(|bytes| pixel(u32::from_le_bytes(*bytes))).collect();
    let pixels =
        pixels.filter(|pixels| left_over.is_empty() && pixels.len() as u64 == u64::from(size.x) * u64::from(size.y));
    let mask = TruthMask { size, pixels: pixels.ok_or(EntryError::Damaged)? };
    Ok(ExactTruth { mask, rays: u64::from_le_bytes(*rays), ms: f64::from_le_bytes(*ms) })
}

/// What a number says of a pixel; `None` for one that says nothing.
fn pixel(number: u32) -> Option<Option<Truth>> {
    match number {
        NOT_ASKED => Some(None),
        UNDECIDED => Some(Some(Truth::Undecided)),
        bits => Visibility::new(f32::from_bits(bits)).map(|visibility| Some(Truth::Known(visibility))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn truth() -> ExactTruth {
        let known = |value: f32| Some(Truth::Known(Visibility::new(value).unwrap()));
        let pixels = vec![None, Some(Truth::Undecided), known(0.0), known(1.0), known(0.375), None];
        ExactTruth { mask: TruthMask { size: UVec2::new(3, 2), pixels }, rays: 4, ms: 1.5 }
    }

    #[test]
    fn it_reads_back_exactly() {
        let key = TruthKey([7; 32]);
        assert_eq!(decode(&key, &encode(&key, &truth()).unwrap()), Ok(truth()));
    }

    #[test]
    fn any_flipped_byte_and_any_torn_end_is_noticed() {
        let key = TruthKey([7; 32]);
        let bytes = encode(&key, &truth()).unwrap();
        for at in 0..bytes.len() {
            let mut flipped = bytes.clone();
            flipped[at] ^= 1 << (at % 8);
            assert_eq!(decode(&key, &flipped), Err(EntryError::Damaged), "{at}");
            assert_eq!(decode(&key, &bytes[..at]), Err(EntryError::Damaged), "{at}");
        }
    }

    #[test]
    fn an_answer_to_another_question_is_refused() {
        let bytes = encode(&TruthKey([7; 32]), &truth()).unwrap();
        assert_eq!(decode(&TruthKey([8; 32]), &bytes), Err(EntryError::Foreign));
    }
}
