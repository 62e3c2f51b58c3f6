//! The command line as its user meets it: what each command prints, writes and returns, and what it says when it cannot.

#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail by panicking")]

mod check;
mod commands;
mod files;
mod help;
mod hostile;
#[cfg(unix)]
mod interrupted;
mod oracle;
mod refused;
mod specs;
mod support;
