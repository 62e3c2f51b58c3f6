//! What a technique's run cost: time on this adapter, and counted work that does not depend on the machine.

use crate::gpu::{PassRecord, WorkCounts};
use serde::{Deserialize, Serialize};

/// Cost of one run.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Cost {
    /// GPU time of all passes together; `None` where the adapter has no timestamps.
    pub gpu_ms: Option<GpuTime>,
    /// GPU time of the scene's G-buffer, timed in the same rounds: times taken at different moments compare as multiples of
    /// it. `None` without timestamps.
    pub gbuffer_ms: Option<f64>,
    /// GPU time of each pass, in order.
    pub passes: Vec<PassTime>,
    /// CPU time of the preparation (fits, silhouettes, buffers) without that of pipelines, which are built once per device,
    /// milliseconds; `None` if nobody measured it.
    pub prepare_ms: Option<f64>,
    /// Bytes of maps and buffers the technique allocates on the GPU.
    pub bytes: u64,
    /// Vertex shader invocations; `None` without pipeline statistics.
    pub vertices: Option<u64>,
    /// Primitives that reached the clipper; `None` without pipeline statistics.
    pub primitives: Option<u64>,
    /// Fragment shader invocations; `None` without pipeline statistics.
    pub fragments: Option<u64>,
    /// Texels that the lookups read at most, every receiver together; `None` without pipeline statistics.
    pub texel_reads: Option<u64>,
}

impl Cost {
    /// What some passes, run once, did. Nothing is timed yet.
    #[must_use]
    pub(crate) fn counted(passes: &[PassRecord], bytes: u64, prepare_ms: f64) -> Self {
        let work: Option<WorkCounts> =
            passes.iter().map(|pass| pass.work).try_fold(WorkCounts::default(), |sum, work| Some(sum + work?));
        Self {
            bytes,
            prepare_ms: Some(prepare_ms),
            vertices: work.map(|work| work.vertices),
            primitives: work.map(|work| work.primitives),
            fragments: work.map(|work| work.fragments),
            texel_reads: work.map(|work| work.texel_reads),
            ..Self::default()
        }
    }

    /// GPU time as a multiple of the G-buffer's; `None` without timestamps.
    #[must_use]
    pub fn gbuffers(&self) -> Option<f64> {
        Some(self.gpu_ms?.median / self.gbuffer_ms.filter(|ms| *ms > 0.0)?)
    }

    /// One figure for ranking that does not depend on the machine: shader invocations, texels read, and the 32-bit words of
    /// maps and buffers, each of which is written at least once a frame (cleared, if nothing else). `None` without
    /// pipeline statistics.
    #[must_use]
    pub fn work(&self) -> Option<u64> {
        /// Bytes of one word.
        const WORD: u64 = 4;
        Some(self.vertices? + self.fragments? + self.texel_reads? + self.bytes / WORD)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_is_summed_over_passes_or_unknown() {
        let work = Some(WorkCounts { vertices: 3, primitives: 1, fragments: 7, texel_reads: 5 });
        let pass = |work| PassRecord { name: "a", ms: None, work };
        let cost = Cost::counted(&[pass(work), pass(work)], 64, 1.5);
        assert_eq!((cost.vertices, cost.primitives, cost.fragments), (Some(6), Some(2), Some(14)));
        assert_eq!((cost.texel_reads, cost.work(), cost.prepare_ms), (Some(10), Some(6 + 14 + 10 + 16), Some(1.5)));
        assert_eq!(Cost::counted(&[pass(work), pass(None)], 64, 0.0).work(), None);
    }
}
