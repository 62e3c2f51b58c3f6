//! How near and how far geometry reaches inside a window: triangles clipped to the window's four sides.
//!
//! I. Sutherland, G. Hodgman, "Reentrant Polygon Clipping", 1974.

use super::{Shape, Window};
use glam::{DMat4, DVec3};

/// Smallest and largest distance along the view of the part of some triangles that lies inside the window; `None` if
/// nothing does.
pub(super) fn depth_range(
    triangles: impl Iterator<Item = [DVec3; 3]>,
    view_from_world: &DMat4,
    window: Window,
    shape: Shape,
) -> Option<(f64, f64)> {
    // A point is inside where every one of these is >= 0; q is the distance for perspective rays and 1 for parallel.
    let sides: [&dyn Fn(DVec3, f64) -> f64; 4] =
        [&|p, q| p.x - window.min.x * q, &|p, q| window.max.x * q - p.x, &|p, q| p.y - window.min.y * q, &|p, q| {
            window.max.y * q - p.y
        }];
    let q = |p: DVec3| if shape == Shape::Parallel { 1.0 } else { -p.z };
    let mut polygon = Vec::with_capacity(8);
    let mut clipped = Vec::with_capacity(8);
    let mut range: Option<(f64, f64)> = None;
    for triangle in triangles {
        polygon.clear();
        polygon.extend(triangle.map(|corner| view_from_world.transform_point3(corner)));
        for side in sides {
            clipped.clear();
            for (i, &to) in polygon.iter().enumerate() {
                let from = polygon[(i + polygon.len() - 1) % polygon.len()];
                let (inside_from, inside_to) = (side(from, q(from)), side(to, q(to)));
                if (inside_from >= 0.0) != (inside_to >= 0.0) {
                    clipped.push(from.lerp(to, inside_from / (inside_from - inside_to)));
                }
                if inside_to >= 0.0 {
                    clipped.push(to);
                }
            }
            std::mem::swap(&mut polygon, &mut clipped);
        }
        for distance in polygon.iter().map(|corner| -corner.z) {
            let (near, far) = range.unwrap_or((distance, distance));
            range = Some((near.min(distance), far.max(distance)));
        }
    }
    range
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A floor triangle far larger than the window: only its part inside counts.
    const SLOPE: [DVec3; 3] =
        [DVec3::new(-100.0, -10.0, -10.0), DVec3::new(100.0, -10.0, -10.0), DVec3::new(0.0, 90.0, -110.0)];

    #[test]
    fn only_the_part_inside_the_window_counts() {
        let parallel = depth_range([SLOPE].into_iter(), &DMat4::IDENTITY, Window::square(1.0), Shape::Parallel);
        let (near, far) = parallel.unwrap();
        assert!((near - 19.0).abs() < 1e-12 && (far - 21.0).abs() < 1e-12, "{near} {far}");
        // The plane is z = -(y + 20): a ray with tangent t meets it at distance 20 / (1 - t).
        let perspective = depth_range([SLOPE].into_iter(), &DMat4::IDENTITY, Window::square(0.5), Shape::Perspective);
        let (near, far) = perspective.unwrap();
        assert!((near - 20.0 / 1.5).abs() < 1e-12 && (far - 40.0).abs() < 1e-12, "{near} {far}");
    }

    #[test]
    fn geometry_behind_or_beside_does_not_count() {
        let behind = SLOPE.map(|corner| -corner);
        assert_eq!(depth_range([behind].into_iter(), &DMat4::IDENTITY, Window::square(0.5), Shape::Perspective), None);
        let beside = SLOPE.map(|corner| corner + DVec3::X * 1000.0);
        assert_eq!(depth_range([beside].into_iter(), &DMat4::IDENTITY, Window::square(0.5), Shape::Parallel), None);
    }
}
