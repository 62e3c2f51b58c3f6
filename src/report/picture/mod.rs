//! Pictures: what a verdict looks like, as PNG bytes.
//!
//! Every picture is a sheet with a heading, one or more panels of the same image side by side, and a legend. Small images
//! are enlarged by a whole factor, so that a pixel stays a square; text grows with the sheet. PNGs are lossless 8-bit RGB
//! without metadata: same input, same bytes.

mod canvas;
mod cause_colours;
mod cause_map;
mod colour;
mod count_map;
mod depth_map;
mod error_map;
mod legend;
mod page;
mod palette;
mod sheet;
mod value_map;

pub use cause_colours::colour_of_cause;
pub use cause_map::{CauseMap, cause_map};
pub use count_map::{CountMap, count_map};
pub use depth_map::{DepthMap, depth_map};
pub use error_map::{ErrorMap, error_map};
pub(super) use page::page_colours;
pub use value_map::{ValueMap, value_map};

use glam::UVec2;

/// What a picture shows, for its heading.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Caption<'a> {
    /// The scene's folder name.
    pub scene: &'a str,
    /// The light's name.
    pub light: &'a str,
    /// The technique as somebody typed it.
    pub technique: &'a str,
}

/// Why a picture cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// Inputs of different pictures.
    #[error("the {what} has {found} pixels, but the picture is {} x {} pixels large", size.x, size.y)]
    Size {
        /// Which input.
        what: &'static str,
        /// Entries it has.
        found: usize,
        /// Width and height of the picture.
        size: UVec2,
    },
    /// A picture without pixels, or larger than memory can address.
    #[error("a picture of {} x {} pixels cannot be made", size.x, size.y)]
    Area {
        /// Width and height of the picture.
        size: UVec2,
    },
    /// PNG cannot hold it.
    #[error("the picture cannot be written as PNG")]
    Png(#[from] png::EncodingError),
}

/// Far beyond every adapter; keeps the arithmetic of layouts within 32 bits.
const LARGEST_SIDE_PX: u32 = 1 << 20;

/// Checks that every input has one entry per pixel of a picture with at least one.
fn check_sizes(size: UVec2, inputs: &[(&'static str, usize)]) -> Result<(), PictureError> {
    if size.x == 0 || size.y == 0 || size.max_element() > LARGEST_SIDE_PX {
        return Err(PictureError::Area { size });
    }
    let area = size.x as usize * size.y as usize;
    match inputs.iter().find(|&&(_, found)| found != area) {
        Some(&(what, found)) => Err(PictureError::Size { what, found, size }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests;
