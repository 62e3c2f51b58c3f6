//! Whether a receiver is in shadow, and whether that would still be so if its position were rounded otherwise.
//!
//! The start of a shadow ray is a rounded point. The walk that looks for a blocker also notices whether any triangle's
//! decision could change while the start moves by its rounding error ([`Ray`] widens its bounds by it); that is
//! rare, and only then is the verdict worked out again from starts moved along the axes.

use super::Casters;
use super::exact;
use super::packed::Crossing;
use super::ray::Ray;
use crate::scene::Segment;
use glam::DVec3;
use std::ops::ControlFlow;

/// What a receiver sees of one point of a light.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Occlusion {
    /// Nothing blocks the segment.
    Clear,
    /// Something blocks the segment.
    Blocked,
    /// The verdict changes when the start moves by its own rounding error.
    Doubtful,
}

impl Casters {
    /// Whether `segment` is blocked by any but the `own` triangle and those in its place, and whether that is so from
    /// everywhere within `radius_m` of its start.
    ///
    /// The verdict is tried at the start and at √3·`radius_m` from it, both ways along each axis: the octahedron
    /// of those six points holds the whole ball, so a plane between light and shadow that cuts the ball leaves one of
    /// them on its other side. Another surface through the start itself is such a plane. What merely continues the
    /// own triangle in its own plane, beyond an edge or a corner at which the start lies, is not another surface.
    #[must_use]
    pub fn occlusion(&self, segment: &Segment, own: Option<u32>, radius_m: f64) -> Occlusion {
        let Some(ray) = Ray::new(segment, &self.bounds, radius_m) else { return Occlusion::Clear };
        let (mut blocked, mut unsure, mut continuation) = (false, false, Vec::new());
        self.each_candidate(&ray, own, |triangle, _| {
            match triangle.crossing(&ray) {
                Crossing::Missed => {}
                Crossing::Unsure { inside: false } if own.is_some_and(|own| self.continues(own, triangle.id)) => {
                    continuation.push(triangle.id);
                }
                Crossing::Unsure { .. } => unsure = true,
                Crossing::Crossed => {
                    blocked = true;
                    return ControlFlow::Break(());
                }
            }
            ControlFlow::Continue(())
        });
        match (blocked, unsure) {
            (true, _) => Occlusion::Blocked,
            (false, false) => Occlusion::Clear,
            (false, true) => self.occlusion_around(segment, own, &continuation, radius_m),
        }
    }

    /// Compares the exact verdicts at the start and around it.
    fn occlusion_around(&self, segment: &Segment, own: Option<u32>, continuation: &[u32], radius_m: f64) -> Occlusion {
        let blocked_from = |from: DVec3| self.blocked_by_others(&Segment { from, ..*segment }, own, continuation);
        let blocked = blocked_from(segment.from);
        let certain = DVec3::AXES.iter().all(|&axis| {
            let step = axis * (3.0f64.sqrt() * radius_m);
            blocked_from(segment.from + step) == blocked && blocked_from(segment.from - step) == blocked
        });
        match (certain, blocked) {
            (false, _) => Occlusion::Doubtful,
            (true, true) => Occlusion::Blocked,
            (true, false) => Occlusion::Clear,
        }
    }

    /// Whether anything but the own triangle and its continuation blocks `segment`.
    fn blocked_by_others(&self, segment: &Segment, own: Option<u32>, continuation: &[u32]) -> bool {
        let mut blocked = false;
        self.each_hit(segment, own, |triangle, _| {
            blocked = !continuation.contains(&triangle.id);
            if blocked { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        blocked
    }

    /// Whether a triangle shares a corner with the own one and lies in its plane, exactly: no segment that starts on the
    /// own triangle is blocked by it, though rounding may put the start on both.
    #[must_use]
    pub fn continues(&self, own: u32, triangle: u32) -> bool {
        let corners = |triangle: u32| self.corners_of[triangle as usize].map(|corner| corner.as_dvec3());
        let ([a, b, c], others) = (corners(own), corners(triangle));
        others.iter().any(|other| [a, b, c].contains(other))
            && others.iter().all(|&other| exact::side(a, b, c, other) == 0.0)
    }
}
