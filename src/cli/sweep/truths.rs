//! Truths kept in a folder, one file per question, named by its content hash.

use crate::cli::output::OutFolder;
use crate::cli::terminal::complain;
use crate::evaluate::TruthStore;
use crate::truth::TruthKey;
use std::fs;
use std::path::{Path, PathBuf};

/// A folder of truths.
pub(super) struct TruthFolder<'p> {
    path: &'p Path,
}

impl<'p> TruthFolder<'p> {
    /// The folder is made with its first file.
    pub(super) fn new(path: &'p Path) -> Self {
        Self { path }
    }

    fn file(&self, key: &TruthKey) -> PathBuf {
        self.path.join(Self::name(key))
    }

    fn name(key: &TruthKey) -> String {
        format!("{key}.truth")
    }
}

impl TruthStore for TruthFolder<'_> {
    fn get(&self, key: &TruthKey) -> Option<Vec<u8>> {
        fs::read(self.file(key)).ok()
    }

    fn put(&self, key: &TruthKey, entry: &[u8]) {
        // A cache that cannot be written costs time, not results.
        if let Err(error) = OutFolder::open(self.path).and_then(|folder| folder.write(&Self::name(key), entry)) {
            complain(&format!("warning: a truth could not be kept: {error:#}"));
        }
    }

    fn refuse(&self, key: &TruthKey, why: &str) {
        complain(&format!("warning: {} is not used: {why}; the truth is worked out again", self.file(key).display()));
    }
}
