//! Warnings about an eye or a light exactly on a surface: legal, but half of every answer there hangs on a convention.
//!
//! Exact: the signs come from adaptive-precision predicates (J. R. Shewchuk, "Adaptive Precision Floating-Point
//! Arithmetic and Fast Robust Geometric Predicates", 1997) on the rounded coordinates that technique and truth share.

use super::super::{LightKind, Scene};
use glam::{DVec2, DVec3};
use robust::{Coord, Coord3D, orient2d, orient3d};

/// One warning at most for the camera and for each light.
pub(super) fn warnings(scene: &Scene) -> Vec<String> {
    let eye = scene.camera.eye.as_dvec3();
    let eye = touched(scene, eye, &in_plane(scene, eye)).map(|touched| format!("the camera's eye {touched}"));
    let lights = scene.lights.iter().filter_map(|light| match light.kind {
        LightKind::Point { position, .. }
        | LightKind::Spot { position, .. }
        | LightKind::Rectangle { position, .. }
        | LightKind::Sphere { position, .. } => {
            let in_plane = in_plane(scene, position.as_dvec3());
            let contact = touched(scene, position.as_dvec3(), &in_plane).or_else(|| aligned(scene, &in_plane))?;
            Some(format!("light `{}` {contact}", light.name))
        }
        LightKind::Directional { .. } | LightKind::Sun { .. } => None,
    });
    eye.into_iter().chain(lights).collect()
}

/// Ids of the triangles whose plane holds the point.
fn in_plane(scene: &Scene, point: DVec3) -> Vec<u32> {
    (0..scene.triangles.len() as u32).filter(|&t| lies_in_plane(point, scene.triangle_in_world(t))).collect()
}

fn touched(scene: &Scene, point: DVec3, in_plane: &[u32]) -> Option<String> {
    let triangle = in_plane.iter().copied().find(|&t| lies_inside(point, scene.triangle_in_world(t)))?;
    Some(format!("lies exactly on triangle {triangle} of mesh `{}`", scene.mesh_of(triangle).name))
}

fn aligned(scene: &Scene, in_plane: &[u32]) -> Option<String> {
    let mesh = &scene.mesh_of(*in_plane.first()?).name;
    let count = in_plane.len();
    Some(format!("lies exactly in the plane of {count} triangles, the first of mesh `{mesh}`; they count as not lit"))
}

/// Whether the point is in the plane of a triangle that has one.
fn lies_in_plane(point: DVec3, [a, b, c]: [DVec3; 3]) -> bool {
    let coord = |p: DVec3| Coord3D { x: p.x, y: p.y, z: p.z };
    orient3d(coord(a), coord(b), coord(c), coord(point)) == 0.0 && (b - a).cross(c - a) != DVec3::ZERO
}

/// Whether a point of the triangle's plane is inside it or on its border.
fn lies_inside(point: DVec3, [a, b, c]: [DVec3; 3]) -> bool {
    // Seen along the axis nearest to the normal the triangle keeps its area.
    let drop_axis = (b - a).cross(c - a).abs().max_position();
    let flat = |p: DVec3| match drop_axis {
        0 => DVec2::new(p.y, p.z),
        1 => DVec2::new(p.z, p.x),
        _ => DVec2::new(p.x, p.y),
    };
    let coord = |p: DVec3| Coord { x: flat(p).x, y: flat(p).y };
    let sides = [(a, b), (b, c), (c, a)].map(|(from, to)| orient2d(coord(from), coord(to), coord(point)));
    sides.iter().all(|&side| side >= 0.0) || sides.iter().all(|&side| side <= 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRIANGLE: [DVec3; 3] = [DVec3::new(0.1, 0.7, 0.3), DVec3::new(5.3, 0.9, 0.1), DVec3::new(0.3, 1.1, 7.7)];

    #[test]
    fn corners_and_points_of_edges_are_inside() {
        for corner in TRIANGLE {
            assert!(lies_in_plane(corner, TRIANGLE) && lies_inside(corner, TRIANGLE));
        }
        let flat = TRIANGLE.map(|p| DVec3::new(p.x, 0.5, p.z));
        let on_edge = DVec3::new(1.0, 0.5, 1.0);
        assert!(lies_in_plane(on_edge, flat) && lies_inside(on_edge, flat));
        let outside = DVec3::new(-1.0, 0.5, 1.0);
        assert!(lies_in_plane(outside, flat) && !lies_inside(outside, flat));
    }

    #[test]
    fn one_ulp_off_is_off() {
        let above = DVec3::new(TRIANGLE[0].x, TRIANGLE[0].y.next_up(), TRIANGLE[0].z);
        assert!(!lies_in_plane(above, TRIANGLE));
        let no_plane = [TRIANGLE[0], TRIANGLE[1], TRIANGLE[1]];
        assert!(!lies_in_plane(TRIANGLE[0], no_plane));
    }
}
