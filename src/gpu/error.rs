//! What can go wrong on a device, as values.

/// The command that gives a machine without a graphics driver a software one.
pub const INSTALL_HINT: &str = "apt-get update && apt-get install -y --no-install-recommends mesa-vulkan-drivers   (with sudo if you are not root)";

/// A failure of the graphics stack.
#[derive(Debug, thiserror::Error)]
pub enum GpuError {
    /// No adapter answered, or none matched what the user asked for.
    #[error("no usable graphics adapter: {why}\n  found: {found}\n  {remedy}")]
    NoAdapter {
        /// What was looked for.
        why: String,
        /// The adapters that did answer.
        found: String,
        /// What to do about it.
        remedy: String,
    },
    /// The adapter refused to open a device.
    #[error("the adapter {adapter} gave no device: {why}")]
    NoDevice {
        /// Its name.
        adapter: String,
        /// The driver's words.
        why: String,
    },
    /// The device ran out of memory.
    #[error("out of GPU memory during {during}")]
    OutOfMemory {
        /// Which work.
        during: String,
    },
    /// wgpu's validation refused something: a bug of gnomon or of a driver.
    #[error("invalid GPU work during {during}: {why}")]
    Invalid {
        /// Which work.
        during: String,
        /// wgpu's words.
        why: String,
    },
    /// The device was lost.
    #[error("the GPU device was lost during {during}: {why}")]
    Lost {
        /// Which work.
        during: String,
        /// The driver's words.
        why: String,
    },
    /// Something is larger than the adapter or gnomon can hold.
    #[error("{what} of {asked} exceeds the limit of {limit} here")]
    TooLarge {
        /// What is too large, with its unit.
        what: String,
        /// The size asked for.
        asked: u64,
        /// The limit.
        limit: u64,
    },
}
