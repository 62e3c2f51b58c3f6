//! The truth: what fraction of a light every asked pixel really sees, worked out by exact ray casting.
//!
//! [`exact()`] asks the ray core; [`cross_check()`] has the brute-force twin decide some of the pixels again;
//! [`mitsuba`] asks another program about every ray.

#[cfg(test)]
mod area_tests;
mod cross_check;
mod entry;
mod exact;
mod key;
pub mod mitsuba;
#[cfg(test)]
mod tests;

pub use cross_check::{Disagreement, cross_check};
pub use entry::{EntryError, decode, encode};
pub use exact::{ExactTruth, exact, of_area, of_points, of_receiver};
pub use key::TruthKey;

use crate::receiver::{PixelClass, Receiver, Receivers};

/// The receiver of pixel `index`, if the question is put to it.
fn asked(receivers: &Receivers, classes: &[PixelClass], index: usize) -> Option<Receiver> {
    receivers.pixels[index].filter(|_| classes[index] == PixelClass::Asked)
}
