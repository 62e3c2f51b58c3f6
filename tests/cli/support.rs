//! Running gnomon, scenes to run it on, and reports to read.

use serde_json::Value;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::{env, fs};
use tempfile::TempDir;

/// A call of gnomon that has ended.
pub(crate) struct Call {
    pub(crate) code: Option<i32>,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl Call {
    fn of(output: &Output) -> Self {
        let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).unwrap();
        let call = Self { code: output.status.code(), stdout: text(&output.stdout), stderr: text(&output.stderr) };
        assert!(!call.stderr.contains("panicked"), "{}", call.stderr);
        call
    }

    /// Asserts the exit code, showing what was said if it is another.
    pub(crate) fn returns(self, code: i32) -> Self {
        assert_eq!(self.code, Some(code), "stdout:\n{}\nstderr:\n{}", self.stdout, self.stderr);
        self
    }

    /// Asserts that standard output has all the words.
    pub(crate) fn says(self, words: &[&str]) -> Self {
        words.iter().for_each(|word| assert!(self.stdout.contains(word), "'{word}' is not in:\n{}", self.stdout));
        self
    }

    /// Asserts that the error message has all the words.
    pub(crate) fn complains(self, words: &[&str]) -> Self {
        words.iter().for_each(|word| assert!(self.stderr.contains(word), "'{word}' is not in:\n{}", self.stderr));
        self
    }

    /// What follows `label` on its line of standard output.
    pub(crate) fn after(&self, label: &str) -> &str {
        let line = self.stdout.lines().find_map(|line| line.trim_start().strip_prefix(label));
        line.unwrap_or_else(|| panic!("no '{label}' in:\n{}", self.stdout)).trim()
    }
}

/// gnomon, to be given arguments. It runs in the repository's folder.
pub(crate) fn command() -> Command {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("gnomon"));
    prepare(&mut command);
    command
}

/// gnomon in another folder.
pub(crate) fn gnomon_in(folder: &Path, args: &[impl AsRef<OsStr>]) -> Call {
    Call::of(&command().current_dir(folder).args(args).output().unwrap())
}

/// gnomon with arguments.
pub(crate) fn gnomon(args: &[impl AsRef<OsStr>]) -> Call {
    gnomon_in(Path::new(env!("CARGO_MANIFEST_DIR")), args)
}

/// gnomon with its arguments in one string, split at blanks.
pub(crate) fn typed(line: &str) -> Call {
    gnomon(&line.split_whitespace().collect::<Vec<_>>())
}

/// gnomon with environment variables.
pub(crate) fn gnomon_with(variables: &[(&str, &str)], args: &[&str]) -> Call {
    Call::of(&command().envs(variables.iter().copied()).args(args).output().unwrap())
}

/// A line for the shell, in which `gnomon` is ours.
#[cfg(unix)]
pub(crate) fn shell(folder: &Path, line: &str) -> Call {
    let gnomon = assert_cmd::cargo::cargo_bin!("gnomon");
    let path = env::join_paths([gnomon.parent().unwrap(), Path::new("/usr/bin"), Path::new("/bin")]).unwrap();
    let mut command = Command::new("sh");
    prepare(&mut command);
    Call::of(&command.args(["-c", line]).current_dir(folder).env("PATH", path).output().unwrap())
}

fn prepare(command: &mut Command) {
    command.current_dir(env!("CARGO_MANIFEST_DIR"));
    // Without it the software driver warns on standard error.
    if env::var_os("XDG_RUNTIME_DIR").is_none() {
        command.env("XDG_RUNTIME_DIR", env!("CARGO_TARGET_TMPDIR"));
    }
}

/// A scene of two lights: a tetrahedron over a floor, whose shadow is well inside a picture of 64 x 48.
pub(crate) const SCENE: &str = r#"about = "a tetrahedron over a floor"
size = [64, 48]
[camera]
eye = [0, 3, 6]
target = [0, 0.5, 0]
[[mesh]]
file = "model.obj"
[[light]]
name = "lamp"
kind = "point"
position = [2, 5, 1]
[[light]]
name = "sun"
kind = "directional"
direction = [-1, -2, -1]
"#;

pub(crate) const MODEL: &str = "\
o Tetra
v 1 0.5 1
v -1 0.5 1
v 0 0.5 -1
v 0 2 0
f 1 2 3
f 1 4 2
f 2 4 3
f 3 4 1
o Floor
v -4 0 -4
v -4 0 4
v 4 0 4
v 4 0 -4
f 5 6 7 8
";

/// `folder/name` with a `scene.toml` and its `model.obj`.
pub(crate) fn write_scene(folder: &Path, name: &str, scene: &str) -> PathBuf {
    let path = folder.join(name);
    fs::create_dir_all(&path).unwrap();
    fs::write(path.join("scene.toml"), scene).unwrap();
    fs::write(path.join("model.obj"), MODEL).unwrap();
    path
}

/// An empty folder with [`SCENE`] in `scene`.
pub(crate) fn scene_in_temp() -> TempDir {
    let folder = TempDir::new().unwrap();
    write_scene(folder.path(), "scene", SCENE);
    folder
}

/// The report in a folder.
pub(crate) fn report(folder: &Path) -> Value {
    serde_json::from_slice(&fs::read(folder.join("report.json")).unwrap()).unwrap()
}

/// A report's runs.
pub(crate) fn runs(folder: &Path) -> Vec<Value> {
    report(folder)["runs"].as_array().unwrap().clone()
}

/// Everything below a folder, as paths relative to it, sorted.
pub(crate) fn tree(folder: &Path) -> Vec<String> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            found.push(path.strip_prefix(folder).unwrap().to_string_lossy().into_owned());
            if path.is_dir() {
                folders.push(path);
            }
        }
    }
    found.sort();
    found
}
