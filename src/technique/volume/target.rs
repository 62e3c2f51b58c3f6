//! Where volumes put their answers, and for which pixels they are counted: all of them, or those of a mask.

use crate::technique::{Job, ReceiverBuffer, TechniqueError};
use wgpu::Buffer;

/// See the module.
#[derive(Debug, Clone)]
pub(in crate::technique) struct Target {
    /// Who asks. Receivers off the mask keep the answers they have.
    pub(in crate::technique) receivers: ReceiverBuffer,
    /// A word per pixel, row by row, not 0 where volumes are counted; `None` for everywhere. Under a mask the stencil's
    /// highest bit is its flag, and seven bits count.
    pub(in crate::technique) mask: Option<Buffer>,
}

impl Target {
    /// All asked pixels of a job.
    pub(super) fn everywhere(job: &Job<'_>) -> Result<Self, TechniqueError> {
        Ok(Self { receivers: ReceiverBuffer::upload(job.gpu, job.receivers, job.classes)?, mask: None })
    }
}
