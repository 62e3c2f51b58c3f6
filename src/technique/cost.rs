//! What a technique's run cost: time on this adapter, and counted work that does not depend on the machine.

use serde::Serialize;

/// Cost of one run.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Cost {
    /// GPU time of all passes together; `None` where the adapter has no timestamps.
    pub gpu_ms: Option<GpuTime>,
    /// Median GPU time of each pass, in order.
    pub passes: Vec<PassTime>,
    /// Bytes of maps and buffers the technique allocates on the GPU.
    pub bytes: u64,
    /// Vertex shader invocations; `None` without pipeline statistics.
    pub vertices: Option<u64>,
    /// Primitives that reached the clipper; `None` without pipeline statistics.
    pub primitives: Option<u64>,
    /// Fragment shader invocations; `None` without pipeline statistics.
    pub fragments: Option<u64>,
}

/// Spread of GPU time over the timed runs, milliseconds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
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
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PassTime {
    /// The pass's name, e.g. `map`.
    pub name: String,
    /// Median, milliseconds.
    pub ms: f64,
}
