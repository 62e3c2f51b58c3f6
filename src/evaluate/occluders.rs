//! What blocks the light at every pixel: for people who look at one, not for the verdict.

use super::{Question, View};
use crate::receiver::{PixelClass, Receiver};
use rayon::prelude::*;

/// The nearest triangle between each asked pixel's receiver and the light; `None` where there is none and where nobody
/// asked. One entry per pixel, row by row from the top.
#[must_use]
pub fn occluders(view: &View<'_>, question: &Question<'_>) -> Vec<Option<u32>> {
    let radius_m = view.scene.bounds().radius();
    let blocker = |receiver: &Receiver| {
        let segment = question.light.segment_from(receiver.point_in_world, radius_m);
        view.casters.nearest_hit(&segment, Some(receiver.triangle)).map(|hit| hit.triangle)
    };
    let pixels = view.receivers.pixels.par_iter().zip(&question.classes);
    pixels
        .map(|(receiver, class)| receiver.as_ref().filter(|_| *class == PixelClass::Asked).and_then(blocker))
        .collect()
}
