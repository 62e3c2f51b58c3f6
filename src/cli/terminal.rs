//! The terminal: text out, progress bars for what takes longer than two seconds, Ctrl-C.

use super::exit;
use crate::watch::{Interrupted, Watch};
use anyhow::Context;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::{ErrorKind, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Work shorter than this shows no bar.
const PATIENCE: Duration = Duration::from_secs(2);

/// Progress and interrupt of this process.
pub(super) struct Terminal {
    interrupted: Arc<AtomicBool>,
    work: Mutex<Option<Work>>,
}

struct Work {
    bar: ProgressBar,
    what: String,
    began: Instant,
}

impl Terminal {
    /// Catches Ctrl-C: the first asks work to stop and keeps what is done, the second ends the process at once.
    pub(super) fn new() -> anyhow::Result<Self> {
        let interrupted = Arc::new(AtomicBool::new(false));
        let flag = Arc::clone(&interrupted);
        ctrlc::set_handler(move || {
            if flag.swap(true, Ordering::SeqCst) {
                std::process::exit(exit::INTERRUPTED.into());
            }
            complain("interrupted: finishing what is begun; once more ends at once");
        })
        .context("catching Ctrl-C")?;
        survive_file_size_limit()?;
        Ok(Self { interrupted, work: Mutex::new(None) })
    }

    /// An error once the user asked to stop: for work that does not watch by itself.
    pub(super) fn proceed(&self) -> Result<(), Interrupted> {
        if self.interrupted() { Err(Interrupted) } else { Ok(()) }
    }

    /// Takes the bar away.
    pub(super) fn finish(&self) {
        if let Some(work) = self.work.lock().unwrap_or_else(PoisonError::into_inner).take() {
            work.bar.finish_and_clear();
        }
    }
}

impl Watch for Terminal {
    fn start(&self, what: &str, total: u64) {
        self.finish();
        let work = Work { bar: ProgressBar::hidden(), what: what.to_owned(), began: Instant::now() };
        work.bar.set_length(total);
        *self.work.lock().unwrap_or_else(PoisonError::into_inner) = Some(work);
    }

    fn advance(&self, units: u64) {
        let mut guard = self.work.lock().unwrap_or_else(PoisonError::into_inner);
        let Some(work) = guard.as_mut() else { return };
        work.bar.inc(units);
        if Some(work.bar.position()) >= work.bar.length() {
            // What is done leaves the screen to the results.
            work.bar.finish_and_clear();
            *guard = None;
            return;
        }
        if work.bar.is_hidden() && work.began.elapsed() > PATIENCE {
            let (done, total) = (work.bar.position(), work.bar.length().unwrap_or(0));
            work.bar = ProgressBar::new(total).with_position(done).with_elapsed(work.began.elapsed());
            if let Ok(style) = ProgressStyle::with_template("{msg} {wide_bar} {percent}% {eta} left") {
                work.bar.set_style(style);
            }
            work.bar.set_message(work.what.clone());
        }
    }

    fn interrupted(&self) -> bool {
        self.interrupted.load(Ordering::SeqCst)
    }
}

/// Beyond a limit on file sizes (`ulimit -f`) the system ends a process unless it handles a signal; handled, the write
/// fails with an error like any other, which can be told and cleaned up after.
#[cfg(unix)]
fn survive_file_size_limit() -> anyhow::Result<()> {
    let noted = Arc::new(AtomicBool::new(false));
    signal_hook::flag::register(signal_hook::consts::SIGXFSZ, noted).context("catching the file size limit")?;
    Ok(())
}

#[cfg(not(unix))]
fn survive_file_size_limit() -> anyhow::Result<()> {
    Ok(())
}

/// Prints a result. A reader that has gone away (`gnomon list | head`) ends the process quietly.
pub(super) fn say(text: &str) {
    say_or_end(text, exit::OK);
}

/// Prints the last result of a command; if its reader has gone away, the process ends quietly with `code`.
pub(super) fn say_or_end(text: &str, code: u8) {
    match writeln!(std::io::stdout().lock(), "{text}") {
        Ok(()) => {}
        Err(error) if error.kind() == ErrorKind::BrokenPipe => std::process::exit(code.into()),
        Err(error) => {
            complain(&format!("error: standard output cannot be written: {error}"));
            std::process::exit(exit::USAGE.into());
        }
    }
}

/// Prints a warning or an error.
pub(super) fn complain(text: &str) {
    // Without a standard error there is nobody to tell.
    let _ = writeln!(std::io::stderr().lock(), "{text}");
}

/// Columns of the terminal, or of a comfortable page where there is none.
pub(super) fn width() -> u16 {
    /// Wide enough for the widest table.
    const PAGE: u16 = 120;
    let columns = console::Term::stdout().size_checked().map(|(_, columns)| columns);
    columns.unwrap_or(PAGE)
}
