//! Techniques.
mod cost;
pub use cost::{Cost, GpuTime, PassTime};
