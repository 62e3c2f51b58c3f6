//! The terminal: text out, progress bars for what takes longer than two seconds, Ctrl-C.

use crate::watch::Watch;
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
                std::process::exit(super::exit::INTERRUPTED.into());
            }
            complain("interrupted: finishing what is begun; once more ends at once");
        })
        .context("catching Ctrl-C")?;
        Ok(Self { interrupted, work: Mutex::new(None) })
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
        if work.bar.is_hidden() && work.began.elapsed() > PATIENCE {
            let (done, total) = (work.bar.position(), work.bar.length().unwrap_or(0));
            work.bar = ProgressBar::new(total).with_position(done).with_elapsed(work.began.elapsed());
            work.bar.set_message(work.what.clone());
            if let Ok(style) = ProgressStyle::with_template("{msg} {wide_bar} {percent}% {eta} left") {
                work.bar.set_style(style);
            }
        }
    }

    fn interrupted(&self) -> bool {
        self.interrupted.load(Ordering::SeqCst)
    }
}

/// Prints a result. A reader that has gone away (`gnomon list | head`) ends the process quietly.
pub(super) fn say(text: &str) {
    if let Err(error) = writeln!(std::io::stdout().lock(), "{text}")
        && error.kind() == ErrorKind::BrokenPipe
    {
        std::process::exit(super::exit::OK.into());
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
