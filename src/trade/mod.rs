//! The trade of accuracy for cost: many configurations measured, the ones nothing beats, and the cheapest that will do.

pub mod advise;
pub mod front;
pub mod grid;
pub mod plot;
pub mod published;
pub mod record;

pub use front::{Point, front};
pub use grid::{GridError, specs_of_grids};
pub use record::{Header, Record, Recovered};
