//! Passes that are timed and counted: every pass a technique records goes through a [`Recorder`].

use super::{Gpu, GpuError};
use wgpu::{
    Buffer, BufferDescriptor, BufferUsages, CommandEncoder, ComputePass, ComputePassDescriptor,
    ComputePassTimestampWrites, Features, PipelineStatisticsTypes, QuerySet, QuerySetDescriptor, QueryType, RenderPass,
    RenderPassColorAttachment, RenderPassDepthStencilAttachment, RenderPassDescriptor, RenderPassTimestampWrites,
};

/// Most passes one recorder can take; far above what any technique needs.
const MAX_PASSES: u32 = 2048;

const STATISTICS: PipelineStatisticsTypes = PipelineStatisticsTypes::VERTEX_SHADER_INVOCATIONS
    .union(PipelineStatisticsTypes::CLIPPER_INVOCATIONS)
    .union(PipelineStatisticsTypes::FRAGMENT_SHADER_INVOCATIONS);
const STATISTICS_PER_PASS: usize = 3;

/// Work counted in one pass: by the device in a render pass, beforehand in a compute pass.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct WorkCounts {
    /// Vertex shader invocations.
    pub vertices: u64,
    /// Primitives that reached the clipper.
    pub primitives: u64,
    /// Fragment shader invocations.
    pub fragments: u64,
    /// Texels that a compute pass reads at most.
    pub texel_reads: u64,
}

impl std::ops::Add for WorkCounts {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            vertices: self.vertices + other.vertices,
            primitives: self.primitives + other.primitives,
            fragments: self.fragments + other.fragments,
            texel_reads: self.texel_reads + other.texel_reads,
        }
    }
}

/// What one pass cost.
#[derive(Debug, Clone, PartialEq)]
pub struct PassRecord {
    /// The pass's name.
    pub name: &'static str,
    /// GPU time; `None` where the adapter has no timestamps.
    pub ms: Option<f64>,
    /// Counted work; `None` where the adapter counts none.
    pub work: Option<WorkCounts>,
}

/// Records passes into one command buffer.
pub struct Recorder<'g> {
    gpu: &'g Gpu,
    encoder: CommandEncoder,
    timestamps: Option<QuerySet>,
    statistics: Option<QuerySet>,
    names: Vec<&'static str>,
    render_passes: Vec<usize>,
    /// Of each pass.
    texel_reads: Vec<u64>,
}

impl std::fmt::Debug for Recorder<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Recorder").field("names", &self.names).finish_non_exhaustive()
    }
}

impl<'g> Recorder<'g> {
    /// An empty command buffer.
    #[must_use]
    pub fn new(gpu: &'g Gpu) -> Self {
        let query_set = |feature: Features, ty: QueryType, count: u32| {
            gpu.has(feature).then(|| gpu.device.create_query_set(&QuerySetDescriptor { label: None, ty, count }))
        };
        Self {
            gpu,
            encoder: gpu.device.create_command_encoder(&Default::default()),
            timestamps: query_set(Features::TIMESTAMP_QUERY, QueryType::Timestamp, 2 * MAX_PASSES),
            statistics: query_set(
                Features::PIPELINE_STATISTICS_QUERY,
                QueryType::PipelineStatistics(STATISTICS),
                MAX_PASSES,
            ),
            names: Vec::new(),
            render_passes: Vec::new(),
            texel_reads: Vec::new(),
        }
    }

    /// A render pass.
    pub(crate) fn render(
        &mut self,
        name: &'static str,
        color: &[Option<RenderPassColorAttachment<'_>>],
        depth: Option<RenderPassDepthStencilAttachment<'_>>,
        draw: impl FnOnce(&mut RenderPass<'_>),
    ) {
        let query = self.names.len() as u32;
        let mut pass = self.encoder.begin_render_pass(&RenderPassDescriptor {
            label: Some(name),
            color_attachments: color,
            depth_stencil_attachment: depth,
            timestamp_writes: self.timestamps.as_ref().map(|query_set| RenderPassTimestampWrites {
                query_set,
                beginning_of_pass_write_index: Some(2 * query),
                end_of_pass_write_index: Some(2 * query + 1),
            }),
            ..RenderPassDescriptor::default()
        });
        if let Some(query_set) = &self.statistics {
            pass.begin_pipeline_statistics_query(query_set, self.render_passes.len() as u32);
        }
        draw(&mut pass);
        if self.statistics.is_some() {
            pass.end_pipeline_statistics_query();
        }
        drop(pass);
        self.render_passes.push(self.names.len());
        self.names.push(name);
        self.texel_reads.push(0);
    }

    /// A compute pass, and the texels that it reads at most.
    pub(crate) fn compute(
        &mut self,
        name: &'static str,
        texel_reads: u64,
        dispatch: impl FnOnce(&mut ComputePass<'_>),
    ) {
        let query = self.names.len() as u32;
        let mut pass = self.encoder.begin_compute_pass(&ComputePassDescriptor {
            label: Some(name),
            timestamp_writes: self.timestamps.as_ref().map(|query_set| ComputePassTimestampWrites {
                query_set,
                beginning_of_pass_write_index: Some(2 * query),
                end_of_pass_write_index: Some(2 * query + 1),
            }),
        });
        dispatch(&mut pass);
        drop(pass);
        self.names.push(name);
        self.texel_reads.push(texel_reads);
    }

    /// Submits everything, waits, and reads what each pass cost.
    ///
    /// # Errors
    /// Whatever the device reported.
    pub(crate) fn finish(mut self, during: &str) -> Result<Vec<PassRecord>, GpuError> {
        let passes = self.names.len();
        let stamps = self.resolve(self.timestamps.clone(), 2 * passes as u32, 1);
        let counts = self.resolve(self.statistics.clone(), self.render_passes.len() as u32, STATISTICS_PER_PASS);
        let Self { gpu, encoder, names, render_passes, texel_reads, .. } = self;
        gpu.scoped(during, || gpu.queue.submit([encoder.finish()]))?;
        let read = |buffer: Option<Buffer>| buffer.map(|b| gpu.read_buffer::<u64>(&b, during)).transpose();
        let stamps = read(stamps)?;
        let counts = read(counts)?;
        let ms_per_tick = f64::from(gpu.queue.get_timestamp_period()) * 1e-6;
        let mut records: Vec<PassRecord> = names
            .into_iter()
            .enumerate()
            .map(|(i, name)| PassRecord {
                name,
                ms: stamps.as_ref().map(|s| s[2 * i + 1].saturating_sub(s[2 * i]) as f64 * ms_per_tick),
                work: counts.as_ref().map(|_| WorkCounts { texel_reads: texel_reads[i], ..WorkCounts::default() }),
            })
            .collect();
        for (counted, pass) in counts.iter().flat_map(|c| c.chunks_exact(STATISTICS_PER_PASS)).zip(render_passes) {
            let [vertices, primitives, fragments] = [counted[0], counted[1], counted[2]];
            records[pass].work = Some(WorkCounts { vertices, primitives, fragments, texel_reads: 0 });
        }
        Ok(records)
    }

    /// Copies `queries` results of `values_per_query` u64 each into a buffer; `None` without queries.
    fn resolve(&mut self, set: Option<QuerySet>, queries: u32, values_per_query: usize) -> Option<Buffer> {
        let set = set.filter(|_| queries > 0)?;
        let buffer = self.gpu.device.create_buffer(&BufferDescriptor {
            label: Some("queries"),
            size: u64::from(queries) * (values_per_query * size_of::<u64>()) as u64,
            usage: BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        self.encoder.resolve_query_set(&set, 0..queries, &buffer, 0);
        Some(buffer)
    }
}
