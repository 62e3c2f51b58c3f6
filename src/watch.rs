//! How long work tells of its progress and learns that it should stop, without knowing about terminals or signals.

/// Told of progress by long work, and asked by it whether to go on. Shared between threads.
pub trait Watch: Sync {
    /// A new piece of work of `total` units begins.
    fn start(&self, what: &str, total: u64);
    /// `units` more of the current piece are done.
    fn advance(&self, units: u64);
    /// True once the user asked to stop; work then returns [`Interrupted`] as soon as it can.
    fn interrupted(&self) -> bool;
}

/// A watch nobody looks at: for tests and for library users without a terminal.
#[derive(Debug, Clone, Copy, Default)]
pub struct Unwatched;

impl Watch for Unwatched {
    fn start(&self, _what: &str, _total: u64) {}
    fn advance(&self, _units: u64) {}
    fn interrupted(&self) -> bool {
        false
    }
}

/// Another watch's interrupt without its progress: for work that is a step of something larger.
#[derive(Clone, Copy)]
pub struct Quiet<'w>(pub &'w dyn Watch);

impl Watch for Quiet<'_> {
    fn start(&self, _what: &str, _total: u64) {}
    fn advance(&self, _units: u64) {}
    fn interrupted(&self) -> bool {
        self.0.interrupted()
    }
}

/// The user asked to stop before the work was done.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("interrupted")]
pub struct Interrupted;
