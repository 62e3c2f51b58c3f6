//! The report: what every exporter and viewer reads, and what report.json holds, field by field.
//!
//! Figures that do not apply are null: all of them for a technique that does not support the scene, GPU times without
//! timestamp queries, ratios over no pixel, causes of a mask whose technique is unknown. Every key is always there, in
//! the order of the fields. Same input and adapter give the same bytes but for times and the tool's version.

mod figures;
mod run;
#[cfg(test)]
pub(crate) mod tests;

pub use figures::{
    BudgetOutcome, CauseEntry, Disagreements, EstimateFigures, Jitter, MitsubaFigures, Motion, RayRow, Spread,
    TruthSource,
};
pub use run::{Question, Run, Status};

use serde::{Deserialize, Serialize};

/// The version of report.json's layout; it changes when a reader would have to.
pub const SCHEMA: u32 = 1;

/// Everything one call of gnomon found out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// Layout version, [`SCHEMA`].
    pub schema: u32,
    /// Who wrote it.
    pub tool: Tool,
    /// What rendered.
    pub adapter: Adapter,
    /// One per scene, light and technique, in the order of the command line.
    pub runs: Vec<Run>,
}

impl Report {
    /// The report of this version of gnomon.
    #[must_use]
    pub fn new(adapter: Adapter, runs: Vec<Run>) -> Self {
        let tool = Tool { name: env!("CARGO_PKG_NAME").to_owned(), version: env!("CARGO_PKG_VERSION").to_owned() };
        Self { schema: SCHEMA, tool, adapter, runs }
    }
}

/// The program that wrote a report.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Tool {
    /// Its name.
    pub name: String,
    /// Its version.
    pub version: String,
}

/// The graphics adapter that rendered.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Adapter {
    /// As the driver calls it.
    pub name: String,
    /// Graphics interface, e.g. `vulkan`.
    pub backend: String,
    /// Driver and its version.
    pub driver: String,
    /// Optional features that were in use, sorted.
    pub features: Vec<String>,
    /// Renders on the CPU: GPU times say nothing about a real adapter.
    pub software: bool,
}
