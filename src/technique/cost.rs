//! What a technique's run cost: time on this adapter, and counted work that does not depend on the machine.

use serde::{Deserialize, Serialize};

/// Cost of one run.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Cost {
    /// GPU time of all passes together; `None` where the adapter has no timestamps.
    pub gpu_ms: Option<GpuTime>,
    /// GPU time of each pass, in order.
    pub passes: Vec<PassTime>,
    /// CPU time of the preparation (fits, silhouettes, buffers, pipelines), milliseconds; `None` if nobody measured it.
    pub prepare_ms: Option<f64>,
    /// Bytes of maps and buffers the technique allocates on the GPU.
    pub bytes: u64,
    /// Vertex shader invocations; `None` without pipeline statistics.
    pub vertices: Option<u64>,
    /// Primitives that reached the clipper; `None` without pipeline statistics.
    pub primitives: Option<u64>,
    /// Fragment shader invocations; `None` without pipeline statistics.
    pub fragments: Option<u64>,
}

impl Cost {
    /// One figure for ranking that does not depend on the machine: shader invocations, and the 32-bit words of maps and
    /// buffers, each of which is written at least once a frame (cleared, if nothing else). `None` without pipeline
    /// statistics.
    #[must_use]
    pub fn work(&self) -> Option<u64> {
        /// Bytes of one word.
        const WORD: u64 = 4;
        Some(self.vertices? + self.fragments? + self.bytes / WORD)
    }
}

/// Spread of GPU time over the timed runs, milliseconds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct GpuTime {
    /// The middle run.
    pub median: f64,
    /// The fastest run.
    pub min: f64,
    /// The slowest run.
    pub max: f64,
    /// How many runs were timed, warm-up excluded.
    pub runs: u32,
}

/// GPU time of one pass.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PassTime {
    /// The pass's name, e.g. `map`.
    pub name: String,
    /// Median, milliseconds.
    pub ms: f64,
    /// The fastest run, milliseconds.
    pub ms_min: f64,
    /// The slowest run, milliseconds.
    pub ms_max: f64,
}
