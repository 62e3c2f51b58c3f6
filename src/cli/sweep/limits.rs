//! What one row of a sweep may take.

use super::rows::RowError;
use crate::evaluate::{EvaluateError, Question, View};
use crate::technique::Spec;
use crate::watch::Watch;
use std::time::{Duration, Instant};

/// Limits on a row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct RowLimits {
    /// Time, checked between steps: no step on the GPU is cut short.
    pub(super) seconds: f64,
    /// GPU memory of maps and buffers; `None` for as much as there is.
    pub(super) megabytes: Option<f64>,
}

/// Bytes of a megabyte.
const MEGABYTE: f64 = 1e6;

impl RowLimits {
    /// Whether a configuration keeps to the memory limit: it is made ready once to see.
    pub(super) fn admit(&self, view: &View<'_>, question: &Question<'_>, spec: &Spec) -> Result<(), RowError> {
        let Some(limit) = self.megabytes else { return Ok(()) };
        let prepared = spec.technique().prepare(spec, view.job(question.light, &question.classes));
        let megabytes = prepared.map_err(EvaluateError::from)?.bytes() as f64 / MEGABYTE;
        if megabytes > limit { Err(RowError::Memory { megabytes, limit }) } else { Ok(()) }
    }
}

/// The terminal's watch, which also stops a row that takes too long. It shows no progress of its own: the sweep does.
pub(super) struct RowWatch<'w> {
    outer: &'w dyn Watch,
    began: Instant,
    seconds: f64,
}

impl<'w> RowWatch<'w> {
    /// The row begins.
    pub(super) fn new(outer: &'w dyn Watch, seconds: f64) -> Self {
        Self { outer, began: Instant::now(), seconds }
    }

    fn is_late(&self) -> bool {
        self.began.elapsed() > Duration::try_from_secs_f64(self.seconds).unwrap_or(Duration::MAX)
    }

    /// An error as the row has to tell it: an interrupt that nobody but the limit asked for is the limit's.
    pub(super) fn told(&self, error: EvaluateError) -> RowError {
        if self.is_late() && !self.outer.interrupted() && error.is_interrupt() {
            RowError::Time { seconds: self.seconds }
        } else {
            error.into()
        }
    }
}

impl Watch for RowWatch<'_> {
    fn start(&self, _what: &str, _total: u64) {}
    fn advance(&self, _units: u64) {}
    fn interrupted(&self) -> bool {
        self.outer.interrupted() || self.is_late()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::watch::{Interrupted, Unwatched};

    #[test]
    fn a_late_row_says_that_it_was_late() {
        let (late, early) = (RowWatch::new(&Unwatched, 0.0), RowWatch::new(&Unwatched, 1e9));
        assert!(late.interrupted() && !early.interrupted());
        assert_eq!(late.told(Interrupted.into()).to_string(), "took longer than 0 s");
        assert_eq!(early.told(Interrupted.into()).to_string(), "interrupted");
        assert!(!RowWatch::new(&Unwatched, f64::INFINITY).interrupted());
    }
}
