//! Casters cut into pieces that are small as seen from a light: rasterisers draw straight edges, and where a layout bends
//! edges only short ones come out where they should.
//!
//! An edge that spans more than the limit is split where its angle halves, whatever triangle it is seen from, so pieces
//! of neighbours meet without gaps. The longest edge goes first: M. Rivara, "Algorithms for Refining Triangular Grids
//! Suitable for Adaptive and Multigrid Techniques", 1984.

use crate::scene::{Mesh, Scene};
use crate::technique::Unsupported;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// More pieces than this are refused: 72 bytes each on the device.
const MOST_PIECES: usize = 1 << 22;
/// A piece that reaches farther beyond a hemisphere's rim than this, as the cosine of the angle to its axis, is clipped
/// at the rim: at −1 it has no place in the map.
const DEEPEST: f64 = -0.5;

/// A triangle that is drawn in place of a caster or of a part of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::technique::map) struct Piece {
    pub(in crate::technique::map) corners_in_world: [Vec3; 3],
    /// Triangle id of the caster.
    pub(in crate::technique::map) caster: u32,
}

/// All casters around a light, cut, relative to it.
pub(super) struct Cut {
    light: DVec3,
    pieces: Vec<(u32, [DVec3; 3])>,
}

impl Cut {
    /// Cuts every caster until no edge spans more than `longest_rad` as seen from `light`; 0 leaves them whole.
    pub(super) fn around(scene: &Scene, light: DVec3, longest_rad: f64) -> Result<Self, Unsupported> {
        let casting = |mesh: &&Mesh| mesh.casts;
        let casters: Vec<u32> = scene.meshes.iter().filter(casting).flat_map(|mesh| mesh.triangles.clone()).collect();
        let cut = |caster: &u32| -> Option<Vec<(u32, [DVec3; 3])>> {
            let seen = scene.triangle_in_world(*caster).map(|corner| corner - light);
            Some(pieces_of(seen, longest_rad)?.into_iter().map(|piece| (*caster, piece)).collect())
        };
        let pieces: Option<Vec<_>> = casters.par_iter().map(cut).collect();
        let pieces = pieces.map(|pieces| pieces.concat()).filter(|pieces| pieces.len() <= MOST_PIECES);
        let why = || format!("casters in pieces of {:.3} degrees are too many", longest_rad.to_degrees());
        pieces.map(|pieces| Self { light, pieces }).ok_or_else(|| Unsupported::Degenerate { why: why() })
    }

    /// The pieces that reach into the hemisphere around an axis or, beyond its rim, to where the cosine of the angle to
    /// the axis is `least_cosine`.
    pub(super) fn within(&self, axis: DVec3, least_cosine: f64) -> Vec<Piece> {
        let cosine = |corner: &DVec3| corner.dot(axis) / corner.length();
        let mut held = Vec::new();
        for (caster, corners) in &self.pieces {
            let cosines = corners.each_ref().map(cosine);
            if cosines.iter().all(|cosine| *cosine < least_cosine) {
                continue;
            }
            let mut hold = |corners: [DVec3; 3]| {
                let corners_in_world = corners.map(|corner| (corner + self.light).as_vec3());
                held.push(Piece { corners_in_world, caster: *caster });
            };
            if cosines.iter().all(|cosine| *cosine > DEEPEST) {
                hold(*corners);
            } else {
                let polygon = before(corners, axis);
                for i in 2..polygon.len() {
                    hold([polygon[0], polygon[i - 1], polygon[i]]);
                }
            }
        }
        held
    }
}

/// A triangle, seen from the origin, in pieces without long edges; `None` if they are too many.
fn pieces_of(triangle: [DVec3; 3], longest_rad: f64) -> Option<Vec<[DVec3; 3]>> {
    let (mut pieces, mut whole) = (Vec::new(), vec![triangle]);
    while let Some([a, b, c]) = whole.pop() {
        if pieces.len() + whole.len() > MOST_PIECES {
            return None;
        }
        let turned = [[a, b, c], [b, c, a], [c, a, b]].map(|corners| (corners[0].angle_between(corners[1]), corners));
        let [first, second, third] = turned;
        let longer = |x: (f64, [DVec3; 3]), y: (f64, [DVec3; 3])| if y.0 > x.0 { y } else { x };
        let (angle_rad, [a, b, c]) = longer(longer(first, second), third);
        if longest_rad > 0.0 && angle_rad > longest_rad {
            let middle = halfway(a, b);
            whole.extend([[a, middle, c], [middle, b, c]]);
        } else {
            pieces.push([a, b, c]);
        }
    }
    Some(pieces)
}

/// Where the bisector of two directions meets the line between their ends; the same for either order.
pub(super) fn halfway(a: DVec3, b: DVec3) -> DVec3 {
    (a * b.length() + b * a.length()) / (a.length() + b.length())
}

/// The part of a triangle before the plane through the origin across an axis.
fn before(corners: &[DVec3; 3], axis: DVec3) -> Vec<DVec3> {
    let mut polygon = Vec::with_capacity(4);
    for (i, &to) in corners.iter().enumerate() {
        let from = corners[(i + 2) % 3];
        let (at_from, at_to) = (from.dot(axis), to.dot(axis));
        if (at_from >= 0.0) != (at_to >= 0.0) {
            polygon.push(from.lerp(to, at_from / (at_from - at_to)));
        }
        if at_to >= 0.0 {
            polygon.push(to);
        }
    }
    polygon
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRIANGLE: [DVec3; 3] =
        [DVec3::new(-9.0, -1.0, -7.0), DVec3::new(9.0, -1.0, -7.0), DVec3::new(1.0, -1.0, 9.0)];

    fn area(corners: &[DVec3; 3]) -> f64 {
        0.5 * (corners[1] - corners[0]).cross(corners[2] - corners[0]).length()
    }

    #[test]
    fn pieces_fill_their_triangle_and_have_short_edges() {
        for limit_deg in [40.0_f64, 7.0, 2.0] {
            let limit = limit_deg.to_radians();
            let pieces = pieces_of(TRIANGLE, limit).unwrap();
            let filled: f64 = pieces.iter().map(area).sum();
            assert!((filled / area(&TRIANGLE) - 1.0).abs() < 1e-12);
            for [a, b, c] in &pieces {
                let angles = [(a, b), (b, c), (c, a)].map(|(from, to)| from.angle_between(*to));
                assert!(angles.iter().all(|angle| *angle <= limit));
                assert!((*b - *a).cross(*c - *a).y < 0.0, "turned over");
            }
        }
        assert_eq!(pieces_of(TRIANGLE, 0.0).unwrap().len(), 1);
        assert_eq!(pieces_of(TRIANGLE, 1e-5), None, "too many");
    }

    #[test]
    fn neighbours_are_cut_alike_along_their_common_edge() {
        let [a, b, c] = TRIANGLE;
        let on_edge = |triangle: [DVec3; 3]| {
            let pieces = pieces_of(triangle, 0.05).unwrap();
            let is_on = |p: &DVec3| (*p - a).cross(b - a).length() < 1e-9 * (b - a).length_squared();
            let mut points: Vec<DVec3> = pieces.iter().flatten().filter(|p| is_on(p)).copied().collect();
            points.sort_by(|p, q| p.x.total_cmp(&q.x));
            points.dedup();
            points
        };
        let across = DVec3::new(0.0, 4.0, -9.0);
        assert!(on_edge([a, b, c]).len() > 20);
        assert_eq!(on_edge([a, b, c]), on_edge([b, a, across]));
    }

    #[test]
    fn a_hemisphere_holds_what_reaches_into_it() {
        let cut = |longest_rad: f64| Cut {
            light: DVec3::ZERO,
            pieces: pieces_of(TRIANGLE, longest_rad).unwrap().into_iter().map(|piece| (5, piece)).collect(),
        };
        assert_eq!(cut(0.0).within(DVec3::Y, -1e-3), [], "all of it is below");
        assert_eq!(cut(0.0).within(DVec3::NEG_Y, -1e-3).len(), 1);
        // The half of a whole triangle that lies beyond the rim is clipped off.
        let halves = cut(0.0).within(DVec3::X, -1e-3);
        assert!(halves.iter().flat_map(|piece| piece.corners_in_world).all(|corner| corner.x > -1e-6), "{halves:?}");
        assert!(halves.iter().all(|piece| piece.caster == 5));
        // Small pieces stay whole, and reach over the rim.
        let pieces = cut(0.05).within(DVec3::X, -1e-3);
        assert!(pieces.iter().flat_map(|piece| piece.corners_in_world).any(|corner| corner.x < -1e-3));
    }
}
