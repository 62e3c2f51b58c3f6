//! Planes: one number per pixel, packed without loss into text that a page can carry and a browser can unpack.
//!
//! Few different values become a palette and an index per pixel; ids become the difference from the pixel before, which
//! is mostly zero on a surface. The bytes (little endian) are compressed as gzip, which every browser unpacks by itself, and
//! written in base64, which no parser of HTML can mistake for anything.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::GzEncoder;
use serde::Serialize;
use std::collections::HashMap;
use std::io::{self, Write};

/// Palettes beyond this many values compress no better than the values themselves.
const LARGEST_PALETTE: usize = 1 << 16;

/// How a plane's bytes are to be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
enum Layout {
    /// One byte per pixel.
    U8,
    /// Two bytes per pixel.
    U16,
    /// Four bytes per pixel, each the difference from the pixel before, modulo 2³².
    Delta32,
    /// A 64-bit float per pixel.
    F64,
}

/// One number per pixel.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Plane {
    layout: Layout,
    /// What the numbers are indices into; `None` where they are the values.
    palette: Option<Vec<f64>>,
    /// Base64 of gzip of the numbers.
    data: String,
}

impl Plane {
    /// Small numbers, as they are.
    pub(super) fn of_bytes(bytes: &[u8]) -> io::Result<Self> {
        Ok(Self { layout: Layout::U8, palette: None, data: packed(bytes)? })
    }

    /// Ids, or ascending numbers.
    pub(super) fn of_ids(ids: &[u32]) -> io::Result<Self> {
        let before = std::iter::once(&0).chain(ids);
        let bytes: Vec<u8> =
            ids.iter().zip(before).flat_map(|(id, before)| id.wrapping_sub(*before).to_le_bytes()).collect();
        Ok(Self { layout: Layout::Delta32, palette: None, data: packed(&bytes)? })
    }

    /// Exact values. NaN stands for none and reads back as NaN.
    pub(super) fn of_values(values: &[f64]) -> io::Result<Self> {
        let Some((palette, indices)) = palette(values) else {
            let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
            return Ok(Self { layout: Layout::F64, palette: None, data: packed(&bytes)? });
        };
        let (layout, bytes): (Layout, Vec<u8>) = if palette.len() <= 1 << 8 {
            (Layout::U8, indices.iter().map(|index| *index as u8).collect())
        } else {
            (Layout::U16, indices.iter().flat_map(|index| index.to_le_bytes()).collect())
        };
        Ok(Self { layout, palette: Some(palette), data: packed(&bytes)? })
    }
}

/// The different values in the order of their first pixel, and the index of each pixel's; `None` if there are too many.
fn palette(values: &[f64]) -> Option<(Vec<f64>, Vec<u16>)> {
    let mut palette = Vec::new();
    let mut known: HashMap<u64, u16> = HashMap::new();
    let mut indices = Vec::with_capacity(values.len());
    for value in values {
        let index = match known.get(&value.to_bits()) {
            Some(index) => *index,
            None if palette.len() == LARGEST_PALETTE => return None,
            None => {
                let next = palette.len() as u16;
                palette.push(*value);
                known.insert(value.to_bits(), next);
                next
            }
        };
        indices.push(index);
    }
    Some((palette, indices))
}

fn packed(bytes: &[u8]) -> io::Result<String> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(bytes)?;
    Ok(STANDARD.encode(encoder.finish()?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::read::GzDecoder;
    use std::io::Read;

    fn unpacked(plane: &Plane) -> Vec<u8> {
        let mut bytes = Vec::new();
        GzDecoder::new(STANDARD.decode(&plane.data).unwrap().as_slice()).read_to_end(&mut bytes).unwrap();
        bytes
    }

    #[test]
    fn few_values_become_a_palette() {
        let values = [0.5, f64::NAN, 0.5, -0.0, 0.0];
        let plane = Plane::of_values(&values).unwrap();
        assert_eq!((plane.layout, unpacked(&plane)), (Layout::U8, vec![0, 1, 0, 2, 3]));
        let palette: Vec<u64> = plane.palette.unwrap().iter().map(|value| value.to_bits()).collect();
        assert_eq!(palette, [0.5, f64::NAN, -0.0, 0.0].map(f64::to_bits));
    }

    #[test]
    fn many_values_stay_themselves() {
        let some: Vec<f64> = (0..300).map(|i| f64::from(i) / 7.0).collect();
        assert_eq!(Plane::of_values(&some).unwrap().layout, Layout::U16);
        let many: Vec<f64> = (0..70_000).map(|i| f64::from(i) / 7.0).collect();
        let plane = Plane::of_values(&many).unwrap();
        assert_eq!((plane.layout, &plane.palette), (Layout::F64, &None));
        let back: Vec<f64> = unpacked(&plane).as_chunks().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect();
        assert!(back == many);
    }

    #[test]
    fn ids_come_back_from_their_differences() {
        let ids = [7, 7, 3, u32::MAX, 0];
        let differences = unpacked(&Plane::of_ids(&ids).unwrap());
        let mut last = 0_u32;
        let back = differences.as_chunks().0.iter().map(|bytes| {
            last = last.wrapping_add(u32::from_le_bytes(*bytes));
            last
        });
        assert!(back.eq(ids));
    }
}
