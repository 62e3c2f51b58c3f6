//! What can be wrong with a scene: every error says what, where (file and line where there is one) and what to do.

use std::{
    fmt, io,
    path::{Path, PathBuf},
};
use thiserror::Error;

/// Why a scene could not be loaded. [`fmt::Display`] gives one clear message, sometimes of two lines.
#[derive(Debug, Error)]
pub enum SceneError {
    /// The path given for a scene cannot be read, or is none.
    #[error("{}: {source}\n  a scene is a folder that holds scene.toml, a scene.toml, or an .obj file", path.display())]
    Open {
        /// What was asked for.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A file that another file names cannot be read.
    #[error("{place}: cannot read `{file}`: {source}\n  paths are relative to {}", folder.display())]
    Reference {
        /// Where it is named.
        place: Place,
        /// As it is spelled there.
        file: String,
        /// What it is relative to.
        folder: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A path that leaves the scene's folder.
    #[error("{place}: `{file}` {why}\n  copy the file into {} and name it relative to there", folder.display())]
    Escape {
        /// Where it is named.
        place: Place,
        /// As it is spelled there.
        file: String,
        /// How it leaves.
        why: &'static str,
        /// The folder it must stay in.
        folder: PathBuf,
    },
    /// `scene.toml` is no TOML, or a value has the wrong type.
    #[error("{place}: {message}")]
    Toml {
        /// Where.
        place: Place,
        /// What the TOML reader said.
        message: String,
    },
    /// A name that is none of the known ones: a key, a kind, an object, a light.
    #[error("{place}: unknown {what} `{name}`; {}", Suggestion::new(name, known))]
    Unknown {
        /// Where.
        place: Place,
        /// What the name was meant to name.
        what: &'static str,
        /// The name.
        name: String,
        /// All names that would have done.
        known: Vec<String>,
    },
    /// A value that is out of range or contradicts another.
    #[error("{place}: {key} {problem}")]
    Value {
        /// Where.
        place: Place,
        /// The key, with its table: `light[1].cone_deg`.
        key: String,
        /// What is wrong and what would be right.
        problem: String,
    },
    /// A line of an OBJ or MTL file that has no meaning here.
    #[error("{place}: {problem}")]
    Mesh {
        /// Where.
        place: Place,
        /// What is wrong and what to do.
        problem: String,
    },
}

/// A place in a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// The file.
    pub file: PathBuf,
    /// The line, counted from 1; `None` where the file as a whole is meant.
    pub line: Option<usize>,
}

impl Place {
    pub(super) fn line(file: &Path, line: usize) -> Self {
        Self { file: file.to_path_buf(), line: Some(line) }
    }
    pub(super) fn file(file: &Path) -> Self {
        Self { file: file.to_path_buf(), line: None }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            Some(line) => write!(f, "{}:{line}", self.file.display()),
            None => write!(f, "{}", self.file.display()),
        }
    }
}

/// "did you mean …?" when a known name is near enough, else the list of all known names.
struct Suggestion<'a> {
    nearest: Option<&'a str>,
    known: &'a [String],
}

impl<'a> Suggestion<'a> {
    fn new(name: &str, known: &'a [String]) -> Self {
        Self { nearest: crate::suggest::nearest(name, known.iter().map(String::as_str)), known }
    }
}

/// How many known names a message lists: a file may hold hundreds of objects.
const LISTED_NAMES: usize = 20;

impl fmt::Display for Suggestion<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(nearest) = self.nearest {
            return write!(f, "did you mean `{nearest}`?");
        }
        let listed = &self.known[..self.known.len().min(LISTED_NAMES)];
        let more = if listed.len() < self.known.len() { ", …" } else { "" };
        write!(f, "known are {}{more}", listed.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unknown(name: &str) -> String {
        let known = ["cone_deg", "inner_deg", "position"].map(String::from).to_vec();
        SceneError::Unknown { place: Place::line(Path::new("a/scene.toml"), 7), what: "key", name: name.into(), known }
            .to_string()
    }

    #[test]
    fn a_near_name_is_suggested_with_file_and_line() {
        assert_eq!(unknown("cone_degg"), "a/scene.toml:7: unknown key `cone_degg`; did you mean `cone_deg`?");
    }

    #[test]
    fn a_far_name_gets_the_list() {
        assert_eq!(unknown("colour"), "a/scene.toml:7: unknown key `colour`; known are cone_deg, inner_deg, position");
    }
}
