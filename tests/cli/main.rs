//! The command line as its user meets it: what each command prints, writes and returns, and what it says when it cannot.

#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail by panicking")]

mod advise;
mod browser;
mod check;
mod commands;
mod compare;
mod files;
mod help;
mod hostile;
mod html;
#[cfg(unix)]
mod interrupted;
mod refused;
mod schema;
mod specs;
mod support;
mod sweep;
