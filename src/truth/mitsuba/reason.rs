//! Why Mitsuba and the exact truth disagree about a ray: how far the ray would have to move for the other verdict to be
//! right, and whether f32 can tell that distance from none.

use crate::cast::{Casters, Hit};
use crate::scene::{Scene, Segment};
use glam::DVec3;

/// What f32 may be off by, in units of the scene's largest coordinate: the ray's start and its direction are each
/// rounded by half of 2⁻²³ a coordinate, and Embree's own test adds as much again. What lies closer to the receiver is a
/// contact; that twin is `CONTACT` in `oracle/gnomon_oracle/rays.py`.
const F32_ERROR: f64 = 16.0 / 16_777_216.0;

/// The reason of a disagreement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Reason {
    /// The blocker lies so close to the receiver that Mitsuba takes it for the receiver's own surface.
    Contact {
        /// From the receiver to the blocker, metres.
        distance_m: f64,
    },
    /// The ray passes the deciding triangle's border within what f32 rounds away.
    Edge {
        /// How far the ray would have to move, metres.
        distance_m: f64,
    },
    /// Neither: one of the two oracles is wrong.
    Unexplained {
        /// How far the ray would have to move, metres.
        distance_m: f64,
    },
}

impl Reason {
    /// As reports spell it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Contact { .. } => "contact",
            Self::Edge { .. } => "edge within f32 error",
            Self::Unexplained { .. } => "unexplained",
        }
    }

    /// The distance that decides, metres.
    #[must_use]
    pub fn distance_m(self) -> f64 {
        match self {
            Self::Contact { distance_m } | Self::Edge { distance_m } | Self::Unexplained { distance_m } => distance_m,
        }
    }
}

/// The reason, where Mitsuba met `met` first on the way of `segment` (receiver to light) and took it for a contact or
/// not. `unit_m` is the size that coordinates have at most.
pub(super) fn reason(
    scene: &Scene,
    casters: &Casters,
    segment: &Segment,
    own: u32,
    met: Option<u32>,
    is_contact: bool,
    unit_m: f64,
) -> Reason {
    if let Some(met) = met.filter(|_| is_contact) {
        let normal = scene.triangle_normal(met).normalize_or_zero();
        let above = segment.from - scene.triangle_in_world(met)[0];
        return Reason::Contact { distance_m: normal.dot(above).abs() };
    }
    let mut blockers: Vec<Hit> = Vec::new();
    casters.all_hits(segment, Some(own), &mut blockers);
    blockers.retain(|hit| !casters.continues(own, hit.triangle));
    let length_m = (segment.to - segment.from).length();
    if !blockers.is_empty() && blockers.iter().all(|hit| hit.t * length_m <= F32_ERROR * unit_m) {
        return Reason::Contact { distance_m: blockers.iter().map(|hit| hit.t * length_m).fold(0.0, f64::max) };
    }
    // Lit for Mitsuba: it missed every blocker. Blocked for Mitsuba alone: one triangle that it should have missed.
    let missed = blockers.iter().map(|hit| hit.triangle);
    let to_other_verdict = |triangle| distance_to_other_verdict(segment, scene.triangle_in_world(triangle));
    let distance_m = match (blockers.is_empty(), met) {
        (true, Some(met)) => to_other_verdict(met),
        (true, None) => f64::INFINITY,
        (false, _) => missed.map(to_other_verdict).fold(0.0, f64::max),
    };
    if distance_m <= F32_ERROR * unit_m { Reason::Edge { distance_m } } else { Reason::Unexplained { distance_m } }
}

/// How far a segment is from crossing a triangle, or from no longer crossing it: over an edge, or one end through the
/// plane.
fn distance_to_other_verdict(segment: &Segment, corners: [DVec3; 3]) -> f64 {
    let [a, b, c] = corners;
    let normal = (b - a).cross(c - a).normalize_or_zero();
    let over_plane = [segment.from, segment.to].map(|end| {
        let foot = end - normal * normal.dot(end - a);
        let edges = [(a, b), (b, c), (c, a)];
        let is_above = edges.iter().all(|(p, q)| (q - p).cross(foot - p).dot(normal) >= 0.0);
        if is_above { normal.dot(end - a).abs() } else { f64::INFINITY }
    });
    let over_edges = [(a, b), (b, c), (c, a)].map(|(p, q)| between(segment, p, q));
    over_plane.into_iter().chain(over_edges).fold(f64::INFINITY, f64::min)
}

/// The distance between two segments (C. Ericson, "Real-Time Collision Detection", 2005, 5.1.9).
fn between(segment: &Segment, p: DVec3, q: DVec3) -> f64 {
    let (d1, d2, r) = (segment.to - segment.from, q - p, segment.from - p);
    let (a, e, f) = (d1.length_squared(), d2.length_squared(), d2.dot(r));
    let (b, c) = (d1.dot(d2), d1.dot(r));
    let denominator = a * e - b * b;
    let share = |numerator: f64, denominator: f64| {
        if denominator > 0.0 { (numerator / denominator).clamp(0.0, 1.0) } else { 0.0 }
    };
    let mut s = share(b * f - c * e, denominator);
    let t = share(b * s + f, e);
    s = share(b * t - c, a);
    (segment.from + d1 * s).distance(p + d2 * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRIANGLE: [DVec3; 3] = [DVec3::ZERO, DVec3::X, DVec3::Y];

    fn down(x: f64, y: f64, from: f64, to: f64) -> Segment {
        Segment { from: DVec3::new(x, y, from), to: DVec3::new(x, y, to) }
    }

    #[test]
    fn the_distance_is_that_to_the_nearest_border_or_end() {
        for (segment, expected) in [
            (down(0.25, 0.01, 1.0, -1.0), 0.01),
            (down(0.25, -0.02, 1.0, -1.0), 0.02),
            (down(0.25, 0.25, 1.0, 0.003), 0.003),
            (down(0.25, 0.25, 1.0, -0.003), 0.003),
            (down(-3.0, -4.0, 1.0, -1.0), 5.0),
        ] {
            let distance = distance_to_other_verdict(&segment, TRIANGLE);
            assert!((distance - expected).abs() < 1e-12, "{segment:?}: {distance}");
        }
    }
}
