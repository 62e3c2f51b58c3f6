//! The repository's own files, for tests of its structure.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

use std::fs;
use std::path::Path;

/// Path below `folder` (with `/`) and text of every file with this extension, in order of their paths.
pub(crate) fn files_below(folder: &Path, extension: &str) -> Vec<(String, String)> {
    let mut found = Vec::new();
    collect(folder, "", extension, &mut found);
    found.sort();
    found
}

fn collect(folder: &Path, prefix: &str, extension: &str, found: &mut Vec<(String, String)>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = format!("{prefix}{}", path.file_name().unwrap().to_str().unwrap());
        if path.is_dir() {
            collect(&path, &format!("{name}/"), extension, found);
        } else if path.extension().is_some_and(|found| found == extension) {
            found.push((name, fs::read_to_string(&path).unwrap()));
        }
    }
}
