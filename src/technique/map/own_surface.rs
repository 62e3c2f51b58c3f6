//! Whether what a texel holds is the receiver's own surface: the question that tells self-shadowing from the edge of
//! another surface's shadow.
//!
//! A texel samples a surface at its centre. That sample belongs to the receiver's surface where one can walk from one to
//! the other along the section that the plane of the two light rays cuts out of the surface: through triangles that
//! touch and that, as the light sees them, lie on the line between the two. How finely a surface is tessellated then
//! makes no difference.

use super::lookup::Tap;
use super::prepared::PreparedMap;
use super::projection::View;
use crate::receiver::Receiver;
use glam::{DVec2, DVec3};

/// How far the way may run on beyond either end, texels: a surface that folds over turns back behind its outline.
const OVERSHOOT_TEXELS: f64 = 0.5;
/// Triangles a way may enter. A texel that covers more of a section is too coarse to speak of one surface.
const LONGEST_WAY: usize = 1024;

/// Whether the surface leads from the receiver to `triangle`, which `tap` reads.
pub(super) fn is_own_surface(map: &PreparedMap<'_>, receiver: &Receiver, tap: &Tap, triangle: u32) -> bool {
    let job = &map.job;
    if job.casters.same_surface(triangle, receiver.triangle) || job.adjacency.shares_vertex(triangle, receiver.triangle)
    {
        return true;
    }
    let (from, to) = (tap.placed.position_in_texels, tap.texel.as_dvec2() + 0.5);
    let overshoot = OVERSHOOT_TEXELS * (to - from).normalize_or_zero();
    let line = [from - overshoot, to + overshoot];
    let is_on_the_way = |between: u32| {
        in_texels(&map.lookup.views[tap.placed.view], job.scene.triangle_in_world(between))
            .is_some_and(|corners| meets(corners, line))
    };
    job.adjacency.leads(receiver.triangle, triangle, LONGEST_WAY, is_on_the_way)
}

/// A triangle in texel coordinates; `None` if a corner is behind the light.
fn in_texels(view: &View, corners: [DVec3; 3]) -> Option<[DVec2; 3]> {
    let in_map = corners.map(|corner| view.project(corner));
    in_map.iter().all(|at| at.q > 0.0).then(|| in_map.map(|at| at.uv * view.texels.as_dvec2()))
}

/// Whether a triangle and a line between two points have a point in common: no axis separates them, neither a coordinate
/// axis nor the normal of a side or of the line.
fn meets([a, b, c]: [DVec2; 3], [from, to]: [DVec2; 2]) -> bool {
    let (min, max) = (from.min(to), from.max(to));
    if a.max(b).max(c).cmplt(min).any() || a.min(b).min(c).cmpgt(max).any() {
        return false;
    }
    let side = |start: DVec2, end: DVec2, p: DVec2| (end - start).perp_dot(p - start);
    let turn = side(a, b, c).signum();
    let is_beyond = |start: DVec2, end: DVec2| [from, to].iter().all(|p| turn * side(start, end, *p) < 0.0);
    let sides = [a, b, c].map(|corner| side(from, to, corner));
    let is_aside = sides.iter().all(|side| *side < 0.0) || sides.iter().all(|side| *side > 0.0);
    !(is_aside || is_beyond(a, b) || is_beyond(b, c) || is_beyond(c, a))
}

#[cfg(test)]
mod tests {
    use super::*;

    const LINE: [DVec2; 2] = [DVec2::ZERO, DVec2::new(1.0, 0.5)];

    fn meets_either_way_round(corners: [[f64; 2]; 3]) -> bool {
        let [a, b, c] = corners.map(DVec2::from_array);
        let meets_it = meets([a, b, c], LINE);
        assert_eq!(meets_it, meets([a, c, b], LINE));
        meets_it
    }

    #[test]
    fn triangles_on_around_and_across_the_line_meet_it() {
        assert!(meets_either_way_round([[0.4, 0.0], [0.6, 0.0], [0.5, 1.0]]), "across");
        assert!(meets_either_way_round([[-9.0, -9.0], [9.0, -9.0], [0.0, 9.0]]), "around");
        assert!(meets_either_way_round([[0.9, 0.0], [2.0, 0.0], [0.9, 2.0]]), "over an end");
        assert!(meets_either_way_round([[1.0, 0.5], [2.0, 0.5], [2.0, 1.0]]), "at an end");
        assert!(meets_either_way_round([[0.5, 0.25], [0.5, -1.0], [1.0, -1.0]]), "touching with a corner");
    }

    #[test]
    fn triangles_beside_the_line_do_not_though_their_boxes_may() {
        assert!(!meets_either_way_round([[0.6, 0.1], [0.8, 0.1], [0.8, 0.3]]), "below");
        assert!(!meets_either_way_round([[0.1, 0.2], [0.1, 0.4], [0.5, 0.4]]), "above");
        assert!(!meets_either_way_round([[1.1, 0.0], [2.0, 0.0], [2.0, 1.0]]), "behind an end");
        assert!(!meets_either_way_round([[0.9, 0.6], [1.3, 0.4], [1.3, 0.9]]), "past an end's corner");
    }
}
