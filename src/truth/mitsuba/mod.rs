//! The second oracle: Mitsuba 3 (W. Jakob et al., "Mitsuba 3 renderer", 2022), which nobody here wrote, answers the same
//! shadow rays in f32. It runs in a process of its own; what is sent and what comes back: docs/oracle.md.
//!
//! It has to prove that it was given every casting triangle, and each ray on which it disagrees with the exact truth is
//! listed with the reason. Where its f32 could not have known better, the reason names the distance that it missed by.

mod blocks;
mod check;
mod estimate;
mod image;
mod process;
mod reason;

pub use check::{ListedRay, MitsubaCheck, Verdict};
pub use estimate::{Estimate, discrepancy};
pub use image::{Flip, Rendering};
pub use process::FOLDER_VARIABLE;
pub use reason::Reason;

use crate::cast::Casters;
use crate::scene::Scene;
use crate::watch::Interrupted;
use blocks::Writer;
use process::Process;
use serde_json::json;

/// Mitsuba, holding one scene's casting triangles.
#[derive(Debug)]
pub struct Mitsuba {
    process: Process,
    /// Scene ids of the casting triangles, in the order in which Mitsuba numbers them.
    triangles: Vec<u32>,
    /// The power of two in metres by which coordinates are divided.
    unit_m: f64,
}

/// Why Mitsuba has no answer.
#[derive(Debug, thiserror::Error)]
pub enum MitsubaError {
    /// It is not installed.
    #[error(
        "Mitsuba is not installed: run `make oracle` in gnomon's folder (or set {FOLDER_VARIABLE} to a folder that has it)"
    )]
    Missing,
    /// Its process or a file of the exchange failed.
    #[error("talking to Mitsuba")]
    Io(#[from] std::io::Error),
    /// It refused a job, or its answer makes no sense.
    #[error("Mitsuba gave no answer: {0}")]
    Answer(String),
    /// It does not hold the triangles that it was sent: whatever it says is about another scene.
    #[error("Mitsuba holds another scene, so its answers are void: {theirs}, not {ours}")]
    Void {
        /// What was sent.
        ours: String,
        /// What it holds.
        theirs: String,
    },
    /// The user asked to stop.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
}

impl Mitsuba {
    /// Whether it is installed.
    #[must_use]
    pub fn is_installed() -> bool {
        process::installed().is_some()
    }

    /// Starts it, hands it the casting triangles of `scene`, of which `casters` were made, and has it prove that it holds
    /// them.
    ///
    /// # Errors
    /// [`MitsubaError`].
    pub fn new(scene: &Scene, casters: &Casters) -> Result<Self, MitsubaError> {
        let mut process = Process::start()?;
        let triangles: Vec<u32> = scene.casting_triangles().collect();
        let unit_m = unit_m(scene);
        let corners = triangles.iter().flat_map(|t| scene.triangles[*t as usize]);
        let coordinates = corners.flat_map(|v| scene.positions[v as usize].to_array());
        let job = Writer::new(json!({"task": "geometry", "unit_m": unit_m}))
            .f32s("corners", coordinates, &[3, 3])
            .u32s("surface", triangles.iter().map(|t| casters.surface_of(*t)));
        let proof = process.ask(job)?;
        let theirs = Proof {
            triangles: proof.about("triangles").map_err(MitsubaError::Answer)?,
            min: proof.about("min").map_err(MitsubaError::Answer)?,
            max: proof.about("max").map_err(MitsubaError::Answer)?,
            hash: proof.about("hash").map_err(MitsubaError::Answer)?,
        };
        Proof::of(casters).require(&theirs)?;
        Ok(Self { process, triangles, unit_m })
    }

    /// What answers: version and variant.
    #[must_use]
    pub fn version(&self) -> &str {
        &self.process.version
    }
}

/// The smallest power of two that no coordinate exceeds: dividing by it rounds nothing.
fn unit_m(scene: &Scene) -> f64 {
    let bounds = scene.bounds();
    let largest = bounds.min.abs().max(bounds.max.abs()).max_element();
    2.0_f64.powi(largest.max(f64::from(f32::MIN_POSITIVE)).log2().ceil() as i32)
}

/// What tells one set of casting triangles from another.
#[derive(Debug, Clone, PartialEq)]
struct Proof {
    triangles: usize,
    min: [f64; 3],
    max: [f64; 3],
    hash: String,
}

impl Proof {
    fn of(casters: &Casters) -> Self {
        let bounds = casters.bounds();
        Self {
            triangles: casters.triangle_count(),
            min: bounds.min.to_array(),
            max: bounds.max.to_array(),
            hash: format!("{:016x}", casters.content_hash()),
        }
    }

    fn require(&self, theirs: &Self) -> Result<(), MitsubaError> {
        if self == theirs {
            return Ok(());
        }
        Err(MitsubaError::Void { ours: format!("{self:?}"), theirs: format!("{theirs:?}") })
    }
}
