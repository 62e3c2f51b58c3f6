//! The results of a sweep on disk: results.jsonl, held by one process at a time.

use crate::cli::output::OutFolder;
use crate::trade::record::{Recovered, line, recover};
use crate::trade::{Header, Record};
use anyhow::{Context, ensure};
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// The file's name.
const NAME: &str = "results.jsonl";

/// An open results.jsonl.
#[derive(Debug)]
pub(super) struct ResultsFolder {
    path: PathBuf,
    file: File,
    records: Vec<Record>,
}

impl ResultsFolder {
    /// Goes on with the folder's results, or begins them. A torn last line is cut off.
    pub(super) fn open(folder: &Path, header: &Header) -> anyhow::Result<Self> {
        let path = folder.join(NAME);
        fs::create_dir_all(folder).with_context(|| format!("{}: cannot be made", folder.display()))?;
        let open = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(&path);
        let mut file = open.with_context(|| format!("{}: cannot be opened", path.display()))?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => anyhow::bail!("{}: another gnomon is writing it", path.display()),
            Err(TryLockError::Error(error)) => {
                return Err(error).with_context(|| format!("{}: locking", path.display()));
            }
        }
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).with_context(|| format!("{}: cannot be read", path.display()))?;
        let recovered = recover(&bytes).with_context(|| path.display().to_string())?;
        let whole = recovered.as_ref().map_or(0, |recovered| recovered.whole_bytes);
        let mut results = Self { path, file, records: Vec::new() };
        results.cut_at(whole as u64)?;
        match recovered {
            None => results.write(&line(header)?)?,
            Some(Recovered { header: found, records, .. }) => {
                ensure!(
                    found == *header,
                    "{}: was begun by {} {} on {} ({}), which is not what measures now; choose another --out",
                    results.path.display(),
                    found.tool.name,
                    found.tool.version,
                    found.adapter.name,
                    found.adapter.driver
                );
                results.records = records;
            }
        }
        Ok(results)
    }

    /// Rows so far, in the order in which they came.
    pub(super) fn records(&self) -> &[Record] {
        &self.records
    }

    /// Whether a row is there already.
    pub(super) fn holds(&self, question: &str, technique: &str) -> bool {
        self.records.iter().any(|record| record.is_of(question, technique))
    }

    /// Adds a row; once this returns, it survives whatever happens to the process.
    pub(super) fn append(&mut self, record: Record) -> anyhow::Result<()> {
        self.write(&line(&record)?)?;
        self.records.push(record);
        Ok(())
    }

    fn cut_at(&mut self, length: u64) -> anyhow::Result<()> {
        let cut = self.file.set_len(length).and_then(|()| self.file.seek(SeekFrom::End(0)));
        cut.with_context(|| format!("{}: cannot be written", self.path.display()))?;
        Ok(())
    }

    fn write(&mut self, bytes: &[u8]) -> anyhow::Result<()> {
        let written = self.file.write_all(bytes).and_then(|()| self.file.sync_data());
        written.with_context(|| format!("{}: cannot be written", self.path.display()))
    }
}

/// The results that a folder holds.
pub(super) fn read(folder: &Path) -> anyhow::Result<Recovered> {
    let path = folder.join(NAME);
    let bytes = fs::read(&path).with_context(|| format!("{}: cannot be read", path.display()))?;
    recover(&bytes)
        .with_context(|| path.display().to_string())?
        .with_context(|| format!("{}: holds no results", path.display()))
}

/// Puts results into a folder in place of those it holds.
pub(super) fn replace(folder: &Path, header: &Header, records: &[Record]) -> anyhow::Result<()> {
    let mut bytes = line(header)?;
    for record in records {
        bytes.extend(line(record)?);
    }
    OutFolder::open(folder)?.write(NAME, &bytes)?;
    Ok(())
}
