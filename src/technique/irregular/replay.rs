//! An irregular z-buffer replayed: exact → coverage → the f32 test, which is the GPU's answer. Where that differs although
//! no test is within its error bound, the replay does not put it on f32: `technique-model` then says that shader and twin
//! disagree, and tests fail.

use super::prepared::PreparedIrregular;
use super::segment_test::{Bounded, Decision, edge_sides, plane_side};
use crate::cause::{Cause, Replay, Stage};
use crate::mask::{Mask, Truth};
use crate::truth;
use rayon::prelude::*;

/// Values and causes of one pixel's stages.
struct Replayed {
    pixel: u32,
    exact: f64,
    coverage: f64,
    answered: f64,
    cause: Cause,
}

/// Replays some pixels; `answer` is what the last run gave.
pub(super) fn replay(irregular: &PreparedIrregular<'_>, answer: &Mask, pixels: &[u32]) -> Replay {
    let replayed: Vec<Replayed> =
        pixels.par_iter().filter_map(|pixel| replay_pixel(irregular, answer, *pixel)).collect();
    let stage = |name, value: fn(&Replayed) -> f64, cause: fn(&Replayed) -> Cause| Stage {
        name,
        values: replayed.iter().map(value).collect(),
        causes: replayed.iter().map(cause).collect(),
    };
    Replay {
        pixels: replayed.iter().map(|replayed| replayed.pixel).collect(),
        exact: replayed.iter().map(|replayed| replayed.exact).collect(),
        stages: vec![
            stage("coverage", |r| r.coverage, |_| Cause::ClippingFrustum),
            stage("f32 test", |r| r.answered, |r| r.cause),
        ],
    }
}

fn replay_pixel(irregular: &PreparedIrregular<'_>, answer: &Mask, pixel: u32) -> Option<Replayed> {
    let job = &irregular.job;
    let receiver = irregular.receiver(pixel)?;
    let answered = f64::from(answer.pixels.get(pixel as usize).copied().flatten()?.get());
    let (eye, radius_m) = (job.scene.camera.eye.as_dvec3(), job.scene.bounds().radius());
    let exact = match truth::of_receiver(job.casters, job.light, &receiver, eye, radius_m) {
        Truth::Known(visibility) => f64::from(visibility.get()),
        Truth::Undecided => return None,
    };
    // The grids are fitted to the receivers: one without a cell would be a bug of the fit, and lit.
    let coverage = irregular.grids.cell_of(receiver.point_in_world).map_or(1.0, |_| exact);
    let cause = if irregular.is_in_doubt(pixel) { Cause::Precision } else { Cause::TechniqueModel };
    Some(Replayed { pixel, exact, coverage, answered, cause })
}

/// The cell of one pixel's receiver, and every triangle that blocks it or nearly does, with its deciding numbers in
/// units of their error bounds.
pub(super) fn lookup_facts(irregular: &PreparedIrregular<'_>, pixel: u32) -> Vec<(String, String)> {
    /// More triangles than this are only counted.
    const LISTED: usize = 8;
    let Some(receiver) = irregular.receiver(pixel) else { return Vec::new() };
    let scene = irregular.job.scene;
    let mut facts = Vec::new();
    if let Some((face, cell)) = irregular.grids.cell_of(receiver.point_in_world) {
        facts.push(("cell".to_owned(), format!("({}, {}) of grid {face}", cell.x, cell.y)));
    }
    let near: Vec<(u32, Decision)> =
        irregular.decisions(&receiver).filter(|(_, decision)| *decision != Decision::Clear).collect();
    for &(triangle, decision) in near.iter().take(LISTED) {
        let corners = scene.triangle_in_world(triangle);
        let edges = edge_sides(receiver.point_in_world, irregular.job.light.homogeneous(), corners);
        let in_bounds = |bounded: Bounded| format!("{:.3e}", bounded.value / bounded.error);
        let [ab, bc, ca] = edges.map(in_bounds);
        let plane = in_bounds(plane_side(receiver.point_in_world, corners));
        let says = if decision == Decision::Blocked { "blocks" } else { "is within rounding" };
        let mesh = &scene.mesh_of(triangle).name;
        let value = format!("{says}; plane {plane}, edges {ab}, {bc}, {ca} error bounds");
        facts.push((format!("triangle {triangle} of {mesh}"), value));
    }
    if near.len() > LISTED {
        facts.push(("further triangles".to_owned(), (near.len() - LISTED).to_string()));
    }
    facts
}
