//! results.jsonl: one line per finished row of a sweep, appended as it comes, so that whatever ends the process costs at
//! most the row at hand.
//!
//! The first line says who measured; every other one is a row. A line is whole once it ends in a line feed: a torn last
//! line is cut off when the sweep goes on.

use crate::report::model::{Adapter, Run, Tool};
use serde::{Deserialize, Serialize};

/// Who measured the rows of a file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Header {
    /// Layout version of the file.
    pub sweep: u32,
    /// Program and version.
    pub tool: Tool,
    /// What rendered.
    pub adapter: Adapter,
}

/// The layout that this version writes.
pub const LAYOUT: u32 = 1;

/// A finished row.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Its place in the whole sweep, over all shards.
    pub row: usize,
    /// What was asked, as a content hash of scene, camera, light, size, adapter and version.
    pub question: String,
    /// What came of it.
    pub run: Run,
}

impl Record {
    /// Whether this row answers a question with a technique (its canonical spelling).
    #[must_use]
    pub fn is_of(&self, question: &str, technique: &str) -> bool {
        self.question == question && self.run.technique == technique
    }
}

/// What a file holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Recovered {
    /// Its first line.
    pub header: Header,
    /// Its rows, in the order of the file.
    pub records: Vec<Record>,
    /// Bytes up to the end of the last whole line: where the next line goes.
    pub whole_bytes: usize,
}

/// Why a file cannot be gone on with.
#[derive(Debug, thiserror::Error)]
#[error("line {line} is no row of a sweep: {why}")]
pub struct RecordError {
    /// Line number, from 1.
    line: usize,
    /// What the JSON reader says.
    #[source]
    why: serde_json::Error,
}

/// Reads what is whole of a file; `None` if not even its first line is.
///
/// # Errors
/// A whole line that is no row: the file is somebody else's, or was edited.
pub fn recover(bytes: &[u8]) -> Result<Option<Recovered>, RecordError> {
    let whole_bytes = bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |at| at + 1);
    let mut lines = bytes[..whole_bytes].split_inclusive(|byte| *byte == b'\n').enumerate();
    let error = |index: usize| move |why| RecordError { line: index + 1, why };
    let Some((index, first)) = lines.next() else { return Ok(None) };
    let header = serde_json::from_slice(first).map_err(error(index))?;
    let records = lines.map(|(index, line)| serde_json::from_slice(line).map_err(error(index)));
    Ok(Some(Recovered { header, records: records.collect::<Result<_, _>>()?, whole_bytes }))
}

/// One line of the file, with its line feed.
///
/// # Errors
/// None that these types can cause; the JSON library's are passed on.
pub fn line(value: &impl Serialize) -> Result<Vec<u8>, serde_json::Error> {
    let mut bytes = serde_json::to_vec(value)?;
    bytes.push(b'\n');
    Ok(bytes)
}

/// Rows of several files as those of one sweep: in the order of the sweep, each row once, the first that was read.
#[must_use]
pub fn joined(files: impl IntoIterator<Item = Vec<Record>>) -> Vec<Record> {
    let mut records: Vec<Record> = files.into_iter().flatten().collect();
    records.sort_by_key(|record| record.row);
    let mut kept: Vec<Record> = Vec::with_capacity(records.len());
    for record in records {
        if !kept.iter().rev().any(|other| other.is_of(&record.question, &record.run.technique)) {
            kept.push(record);
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::model::tests::{full_run, report};

    fn record(row: usize, technique: &str) -> Record {
        let mut run = full_run("kitchen");
        run.technique = technique.to_owned();
        Record { row, question: "q".to_owned(), run }
    }

    fn file() -> (Vec<u8>, Header) {
        let report = report();
        let header = Header { sweep: LAYOUT, tool: report.tool, adapter: report.adapter };
        let lines = [line(&header), line(&record(0, "a")), line(&record(1, "b"))];
        (lines.into_iter().flat_map(Result::unwrap).collect(), header)
    }

    #[test]
    fn what_is_whole_comes_back_wherever_the_file_was_torn() {
        let (bytes, header) = file();
        let ends: Vec<usize> = (0..bytes.len()).filter(|&at| bytes[at] == b'\n').map(|at| at + 1).collect();
        for length in 0..=bytes.len() {
            let whole = ends.iter().filter(|&&end| end <= length).count();
            match recover(&bytes[..length]).unwrap() {
                None => assert_eq!(whole, 0),
                Some(recovered) => {
                    assert_eq!((recovered.records.len() + 1, recovered.whole_bytes), (whole, ends[whole - 1]));
                    assert_eq!(recovered.header, header);
                    assert!(recovered.records.iter().eq([record(0, "a"), record(1, "b")].iter().take(whole - 1)));
                }
            }
        }
    }

    #[test]
    fn a_whole_line_of_something_else_is_refused() {
        let (mut bytes, _) = file();
        let at = bytes.len() - 3;
        bytes[at] = b'#';
        assert!(recover(&bytes).unwrap_err().to_string().starts_with("line 3 is no row of a sweep"));
    }

    #[test]
    fn files_join_in_the_order_of_the_sweep_without_doubles() {
        let files = [vec![record(3, "d"), record(0, "a")], vec![record(2, "c"), record(0, "a"), record(1, "b")]];
        let rows: Vec<usize> = joined(files).iter().map(|record| record.row).collect();
        assert_eq!(rows, [0, 1, 2, 3]);
    }
}
