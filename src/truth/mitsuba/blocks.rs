//! The one binary layout in which gnomon and the oracle exchange arrays; its twin is `oracle/gnomon_oracle/blocks.py`,
//! its description docs/oracle.md#exchange.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::collections::HashMap;
use std::ops::Range;

const MAGIC: [u8; 8] = *b"gnomon\x00\x01";
const ALIGNMENT: usize = 8;

/// A file under construction.
#[derive(Debug)]
pub(super) struct Writer {
    about: Value,
    listed: Vec<Entry>,
    bodies: Vec<Vec<u8>>,
}

#[derive(Debug, Serialize, Deserialize)]
struct Entry {
    name: String,
    r#type: String,
    shape: Vec<usize>,
}

#[derive(Serialize, Deserialize)]
struct Header {
    about: Value,
    arrays: Vec<Entry>,
}

impl Writer {
    /// Without arrays yet; `about` is a JSON object.
    pub(super) fn new(about: Value) -> Self {
        Self { about, listed: Vec::new(), bodies: Vec::new() }
    }

    /// With an array of f64, `row` numbers a row.
    pub(super) fn f64s(self, name: &str, values: impl IntoIterator<Item = f64>, row: &[usize]) -> Self {
        self.array(name, "f64", values.into_iter().flat_map(f64::to_le_bytes).collect(), 8, row)
    }

    /// With an array of f32.
    pub(super) fn f32s(self, name: &str, values: impl IntoIterator<Item = f32>, row: &[usize]) -> Self {
        self.array(name, "f32", values.into_iter().flat_map(f32::to_le_bytes).collect(), 4, row)
    }

    /// With a list of u32.
    pub(super) fn u32s(self, name: &str, values: impl IntoIterator<Item = u32>) -> Self {
        self.array(name, "u32", values.into_iter().flat_map(u32::to_le_bytes).collect(), 4, &[])
    }

    fn array(mut self, name: &str, kind: &str, body: Vec<u8>, size: usize, row: &[usize]) -> Self {
        let rows = body.len() / (size * row.iter().product::<usize>());
        let shape = std::iter::once(rows).chain(row.iter().copied()).collect();
        self.listed.push(Entry { name: name.to_owned(), r#type: kind.to_owned(), shape });
        self.bodies.push(body);
        self
    }

    /// The file's bytes.
    pub(super) fn finish(self) -> Result<Vec<u8>, String> {
        let header =
            serde_json::to_vec(&Header { about: self.about, arrays: self.listed }).map_err(|e| e.to_string())?;
        let length = u32::try_from(header.len()).map_err(|e| e.to_string())?;
        let mut bytes = MAGIC.to_vec();
        bytes.extend(length.to_le_bytes());
        bytes.extend(header);
        for body in self.bodies {
            bytes.resize(bytes.len().next_multiple_of(ALIGNMENT), 0);
            bytes.extend(body);
        }
        Ok(bytes)
    }
}

/// A file that was read.
#[derive(Debug)]
pub(super) struct Reader {
    bytes: Vec<u8>,
    about: Map<String, Value>,
    arrays: HashMap<String, (String, Range<usize>)>,
}

impl Reader {
    /// Checks the layout; the error says what is wrong.
    pub(super) fn new(bytes: Vec<u8>) -> Result<Self, String> {
        let (magic, rest) = bytes.split_at_checked(MAGIC.len()).ok_or("the file is cut off")?;
        if magic != MAGIC {
            return Err("not a gnomon block file".to_owned());
        }
        let (length, rest) = rest.split_first_chunk().ok_or("the file is cut off")?;
        let header = rest.get(..u32::from_le_bytes(*length) as usize).ok_or("the header is cut off")?;
        let Header { about, arrays: listed } = serde_json::from_slice(header).map_err(|e| e.to_string())?;
        let Value::Object(about) = about else { return Err("the header tells nothing".to_owned()) };
        let mut at = MAGIC.len() + length.len() + header.len();
        let mut arrays = HashMap::new();
        for Entry { name, r#type, shape } in listed {
            let size = size_of_type(&r#type)?;
            at = at.next_multiple_of(ALIGNMENT);
            let length = shape.iter().try_fold(size, |all, side| all.checked_mul(*side));
            let end = length.and_then(|length| at.checked_add(length)).filter(|end| *end <= bytes.len());
            let end = end.ok_or_else(|| format!("array '{name}' is cut off"))?;
            arrays.insert(name, (r#type, at..end));
            at = end;
        }
        Ok(Self { bytes, about, arrays })
    }

    /// An entry of the header, in the type that it should have.
    pub(super) fn about<T: for<'d> Deserialize<'d>>(&self, key: &str) -> Result<T, String> {
        let value = self.about.get(key).ok_or_else(|| format!("no '{key}'"))?;
        T::deserialize(value).map_err(|e| format!("'{key}': {e}"))
    }

    /// A list of bytes, `count` long.
    pub(super) fn u8s(&self, name: &str, count: usize) -> Result<&[u8], String> {
        self.body(name, "u8", count)
    }

    /// A list of u32, `count` long.
    pub(super) fn u32s(&self, name: &str, count: usize) -> Result<Vec<u32>, String> {
        let words = self.body(name, "u32", count)?.as_chunks::<4>().0;
        Ok(words.iter().map(|word| u32::from_le_bytes(*word)).collect())
    }

    fn body(&self, name: &str, kind: &str, count: usize) -> Result<&[u8], String> {
        let (found, range) = self.arrays.get(name).ok_or_else(|| format!("no array '{name}'"))?;
        let fits = found == kind && Some(range.len()) == count.checked_mul(size_of_type(kind)?);
        let body = self.bytes.get(range.clone()).filter(|_| fits);
        body.ok_or_else(|| format!("array '{name}' is no list of {count} {kind}"))
    }
}

fn size_of_type(kind: &str) -> Result<usize, String> {
    match kind {
        "u8" => Ok(1),
        "u32" | "f32" => Ok(4),
        "f64" => Ok(8),
        _ => Err(format!("no such type as '{kind}'")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn file() -> Vec<u8> {
        let writer = Writer::new(json!({"task": "rays"})).f64s("d", [1.5, -0.0, f64::MAX], &[3]);
        writer.u32s("own", [7]).f32s("f", [0.5, 2.0], &[]).finish().unwrap()
    }

    #[test]
    fn what_is_written_is_read() {
        let read = Reader::new(file()).unwrap();
        assert_eq!(read.about::<String>("task").unwrap(), "rays");
        assert_eq!(read.body("d", "f64", 3).unwrap()[..8], 1.5_f64.to_le_bytes());
        assert_eq!(read.u32s("own", 1).unwrap(), [7]);
        assert!(read.u32s("own", 2).is_err() && read.u32s("d", 3).is_err() && read.u8s("none", 0).is_err());
        assert!(read.about::<u32>("task").is_err() && read.about::<u32>("none").is_err());
    }

    #[test]
    fn a_file_cut_off_anywhere_or_foreign_is_refused() {
        let whole = file();
        for length in 0..whole.len() {
            assert!(Reader::new(whole[..length].to_vec()).is_err(), "{length}");
        }
        let mut foreign = whole;
        foreign[0] = b'G';
        assert!(Reader::new(foreign).is_err());
    }
}
