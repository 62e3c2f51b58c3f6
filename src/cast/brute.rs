//! The slow twin of [`super::Casters`]: every casting triangle of the scene in turn, straight from the definition, with
//! neither tree nor fast test. It takes the scene itself, so it also checks what the casters were built from.

use super::{Hit, exact, weld};
use crate::scene::{Scene, Segment};

/// Some triangle that blocks `segment`, `own` and those in its place left out.
#[must_use]
pub fn any_hit(scene: &Scene, segment: &Segment, own: Option<u32>) -> Option<u32> {
    blockers(scene, segment, own).next()
}

/// The first blocker of `segment`; of several at the same `t` the one with the lowest id.
#[must_use]
pub fn nearest_hit(scene: &Scene, segment: &Segment, own: Option<u32>) -> Option<Hit> {
    all_hits(scene, segment, own).first().copied()
}

/// Every blocker of `segment` in order along it; of coinciding triangles the one with the lowest id.
#[must_use]
pub fn all_hits(scene: &Scene, segment: &Segment, own: Option<u32>) -> Vec<Hit> {
    let mut hits: Vec<Hit> = Vec::new();
    for triangle in blockers(scene, segment, own) {
        if !hits.iter().any(|known| coincide(scene, known.triangle, triangle)) {
            hits.push(Hit { triangle, t: exact::parameter(segment, &scene.triangle_in_world(triangle)) });
        }
    }
    hits.sort_by(Hit::order);
    hits
}

fn blockers(scene: &Scene, segment: &Segment, own: Option<u32>) -> impl Iterator<Item = u32> {
    scene
        .casting_triangles()
        .filter(|&triangle| exact::crosses(segment, &scene.triangle_in_world(triangle)))
        .filter(move |&triangle| !own.is_some_and(|own| coincide(scene, own, triangle)))
}

fn coincide(scene: &Scene, a: u32, b: u32) -> bool {
    weld::place(weld::corners(scene, a)) == weld::place(weld::corners(scene, b))
}
