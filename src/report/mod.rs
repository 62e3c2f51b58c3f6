//! Reports: what a verdict looks like as a file, a table and a picture.
//!
//! Everything here is a pure function from verdicts to bytes or text; who writes them where is the caller's business.
//! [`Report`] is the model that every exporter reads, and its JSON is the file everything else reads. Names of scenes,
//! lights and meshes come from files of strangers and are escaped by every writer.

pub mod compare;
mod details;
pub mod export;
mod format;
pub mod html;
pub mod mask_image;
pub mod model;
pub mod picture;
pub mod profile;
mod summary;
pub mod table;

pub use export::{EXPORTERS, ExportError, Exporter};
pub use model::Report;
