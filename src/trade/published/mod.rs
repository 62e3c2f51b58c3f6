//! Published experiments on shadow techniques, repeated: not their milliseconds, which belong to their machines, but their
//! shapes, and with the error of every answer, which the publications never had.
//!
//! A ratio holds if it lies within a factor of [`TOLERANCE`] of the published one, an ordering if it is the same.

mod lab;
mod light;
mod quality;
mod size;

pub use lab::{Lab, LabError};

use crate::scene::Scene;

/// How far a ratio may be from the published one, as a factor.
pub const TOLERANCE: f64 = 2.0;

/// One line of an experiment.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// What was measured.
    pub what: String,
    /// The published figure, or what was published in words.
    pub published: String,
    /// The same figure here.
    pub here: String,
    /// How wrong the answers were.
    pub error: String,
    /// Whether the published conclusion holds here; `None` for a figure that only belongs to one.
    pub holds: Option<bool>,
}

/// A published experiment and what came of it here.
#[derive(Debug, Clone, PartialEq)]
pub struct Experiment {
    /// Its name.
    pub title: &'static str,
    /// Who published it.
    pub source: &'static str,
    /// Its lines.
    pub rows: Vec<Row>,
}

/// Runs one experiment; the scenes are those that [`SCENES`] names, in its order.
type Run = fn(&Lab<'_>, &[Scene]) -> Result<Experiment, LabError>;

/// The scenes that experiments need, as folders' names.
pub const SCENES: [&str; 5] = ["torus", "polygons-14", "polygons-32", "polygons-69", "pipe"];

/// Every experiment, in order.
pub const EXPERIMENTS: [Run; 6] = [
    size::frame_cost,
    size::volumes_and_maps,
    light::distance,
    light::field_of_view,
    quality::filters,
    quality::techniques,
];

/// Whether a ratio is like the published one.
fn is_like(published: f64, here: f64) -> bool {
    here <= published * TOLERANCE && here >= published / TOLERANCE
}

/// A ratio as people write it.
fn times(ratio: f64) -> String {
    if ratio >= 10.0 { format!("{ratio:.1}") } else { format!("{ratio:.2}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ratio_is_like_another_within_a_factor_of_two() {
        assert!(is_like(4.0, 2.0) && is_like(4.0, 8.0) && is_like(1.0, 1.0));
        assert!(!is_like(4.0, 1.9) && !is_like(4.0, 8.1));
        assert_eq!([times(1.0), times(3.125), times(12.04)], ["1.00", "3.12", "12.0"]);
    }
}
