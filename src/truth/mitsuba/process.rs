//! The oracle's process: where its Python is found, and the conversation with it. A job is a block file; its path is
//! one line to the process, and one line comes back that names the answer or says what went wrong.
//!
//! Only places that belong to gnomon are looked at, never the scene's folder or the current one: what is found there is
//! executed.

use super::MitsubaError;
use super::blocks::{Reader, Writer};
use serde::Deserialize;
use std::env;
use std::fs::File;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use tempfile::TempDir;

/// The variable that names the oracle's folder where gnomon does not find it by itself.
pub const FOLDER_VARIABLE: &str = "GNOMON_ORACLE";

#[derive(Debug)]
pub(super) struct Process {
    child: Child,
    /// `None` once it is to end.
    jobs: Option<ChildStdin>,
    replies: BufReader<ChildStdout>,
    folder: TempDir,
    asked: u32,
    /// What answers, e.g. `mitsuba 3.9.1 llvm_ad_rgb`.
    pub(super) version: String,
}

/// A line from the process.
#[derive(Debug, Deserialize)]
#[serde(untagged)]
enum Reply {
    Hello { oracle: String, version: String, variant: String },
    Done { ok: PathBuf },
    Failed { error: String },
}

impl Process {
    pub(super) fn start() -> Result<Self, MitsubaError> {
        let python = installed().ok_or(MitsubaError::Missing)?;
        let folder = tempfile::Builder::new().prefix("gnomon-oracle-").tempdir()?;
        let log = File::create(folder.path().join(LOG))?;
        let mut child = Command::new(python)
            .args(["-I", "-m", "gnomon_oracle"])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(log)
            .spawn()?;
        let (jobs, replies) = (child.stdin.take(), child.stdout.take().ok_or(MitsubaError::Missing)?);
        let replies = BufReader::new(replies);
        let mut process = Self { child, jobs, replies, folder, asked: 0, version: String::new() };
        match process.reply()? {
            Reply::Hello { oracle, version, variant } => process.version = format!("{oracle} {version} {variant}"),
            other => return Err(MitsubaError::Answer(format!("it began with {other:?}"))),
        }
        Ok(process)
    }

    /// Sends a job, waits for its answer and removes both files.
    pub(super) fn ask(&mut self, job: Writer) -> Result<Reader, MitsubaError> {
        self.asked += 1;
        let path = self.folder.path().join(format!("{}.job", self.asked));
        std::fs::write(&path, job.finish().map_err(MitsubaError::Answer)?)?;
        let pipe = self.jobs.as_mut().ok_or(MitsubaError::Missing)?;
        let sent = writeln!(pipe, "{}", path.display()).and_then(|()| pipe.flush());
        // A process that is gone says why in its log, which `reply` reads.
        let reply = self.reply()?;
        sent?;
        match reply {
            Reply::Done { ok } => {
                let bytes = std::fs::read(&ok)?;
                std::fs::remove_file(&path)?;
                std::fs::remove_file(&ok)?;
                Reader::new(bytes).map_err(MitsubaError::Answer)
            }
            Reply::Failed { error } => Err(MitsubaError::Answer(error)),
            Reply::Hello { .. } => Err(MitsubaError::Answer("it began anew".to_owned())),
        }
    }

    fn reply(&mut self) -> Result<Reply, MitsubaError> {
        let mut line = String::new();
        self.replies.read_line(&mut line)?;
        if line.is_empty() {
            let log = std::fs::read_to_string(self.folder.path().join(LOG)).unwrap_or_default();
            let last = log.lines().rfind(|line| !line.trim().is_empty()).unwrap_or("it said nothing");
            return Err(MitsubaError::Answer(format!("the process ended: {last}")));
        }
        serde_json::from_str(&line).map_err(|error| MitsubaError::Answer(format!("{error}: {line}")))
    }
}

const LOG: &str = "log";

impl Drop for Process {
    fn drop(&mut self) {
        drop(self.jobs.take());
        // It may be in the middle of a long job that nobody waits for; nothing of it is kept.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The Python that has Mitsuba: in the folder that the user names, or else beside the program or its sources.
pub(super) fn installed() -> Option<PathBuf> {
    if let Some(folder) = env::var_os(FOLDER_VARIABLE) {
        return python_in(Path::new(&folder));
    }
    let program = env::current_exe().ok();
    let above = program.iter().flat_map(|program| program.ancestors().skip(1)).map(|folder| folder.join("oracle"));
    above.chain([Path::new(env!("CARGO_MANIFEST_DIR")).join("oracle")]).find_map(|folder| python_in(&folder))
}

/// Set-up writes the lock's copy last, so its presence means that the rest is whole.
fn python_in(folder: &Path) -> Option<PathBuf> {
    let python = folder.join(".venv/bin/python");
    let is_whole = folder.join(".venv/installed-requirements.txt").is_file();
    (is_whole && python.is_file()).then_some(python)
}
