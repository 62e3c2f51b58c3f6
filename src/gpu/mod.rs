//! The only place with raw wgpu set-up: adapter and device, geometry buffers, the G-buffer, counted and timed passes,
//! readback. Everything that can fail on a device comes out as a [`GpuError`].

mod adapter;
mod build;
mod context;
mod error;
mod gbuffer;
mod geometry;
#[cfg(test)]
pub(crate) mod layout;
mod pipelines;
mod readback;
mod recorder;
pub mod shader;
mod snapping;

pub use adapter::{AdapterSummary, LimitsSummary, describe_adapters};
pub(crate) use build::Drawing;
pub use context::Gpu;
pub use error::{GpuError, INSTALL_HINT};
pub use gbuffer::{GBuffer, GBufferPass};
pub(crate) use geometry::CORNER_LAYOUT;
pub use geometry::Geometry;
pub use recorder::{PassRecord, Recorder, WorkCounts};
