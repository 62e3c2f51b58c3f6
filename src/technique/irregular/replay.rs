//! An irregular z-buffer replayed: exact → coverage → the f32 test, which is the GPU's answer.

use super::prepared::PreparedIrregular;
use super::segment_test::{Bounded, Decision, edge_sides, plane_side};
use crate::cause::{Cause, Replay, Stage};
use crate::mask::{Mask, Truth};
use crate::truth;
use rayon::prelude::*;

/// Stages in order, each with the cause that owns its change.
const STAGES: [(&str, Cause); 2] = [("coverage", Cause::ClippingFrustum), ("f32 test", Cause::Precision)];

/// Replays some pixels; `answer` is what the last run gave.
pub(super) fn replay(irregular: &PreparedIrregular<'_>, answer: &Mask, pixels: &[u32]) -> Replay {
    let of_pixel = |pixel: &u32| Some((*pixel, replay_pixel(irregular, answer, *pixel)?));
    let replayed: Vec<(u32, (f64, [f64; STAGES.len()]))> = pixels.par_iter().filter_map(of_pixel).collect();
    let stage = |(index, (name, cause)): (usize, (&'static str, Cause))| Stage {
        name,
        values: replayed.iter().map(|(_, (_, values))| values[index]).collect(),
        causes: vec![cause; replayed.len()],
    };
    Replay {
        pixels: replayed.iter().map(|(pixel, _)| *pixel).collect(),
        exact: replayed.iter().map(|(_, (exact, _))| *exact).collect(),
        stages: STAGES.into_iter().enumerate().map(stage).collect(),
    }
}

/// The exact answer at a pixel and what each stage makes of it.
fn replay_pixel(irregular: &PreparedIrregular<'_>, answer: &Mask, pixel: u32) -> Option<(f64, [f64; STAGES.len()])> {
    let job = &irregular.job;
    let receiver = irregular.receiver(pixel)?;
    let answered = f64::from(answer.pixels.get(pixel as usize).copied().flatten()?.get());
    let (eye, radius_m) = (job.scene.camera.eye.as_dvec3(), job.scene.bounds().radius());
    let exact = match truth::of_receiver(job.casters, job.light, &receiver, eye, radius_m) {
        Truth::Known(visibility) => f64::from(visibility.get()),
        // Of an area light's centre alone, which nobody asked about: either answer is right.
        Truth::Undecided => answered,
    };
    // The grids are fitted to the receivers: one without a cell would be a bug of the fit, and lit.
    let coverage = irregular.grids.cell_of(receiver.point_in_world).map_or(1.0, |_| exact);
    Some((exact, [coverage, answered]))
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
