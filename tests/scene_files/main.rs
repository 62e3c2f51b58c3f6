//! Scene files end to end: what loads, what is refused and with which words, and that nothing makes the loader panic.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "helpers of tests fail by panicking")]

mod loading;
mod mutations;
mod oddities;
mod placement;
mod refusals;
mod texts;
