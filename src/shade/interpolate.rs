//! Corner attributes at a receiver's point: barycentric weights, and normals on the eye's side of the surface.

use crate::receiver::Receiver;
use crate::scene::Scene;
use glam::DVec3;

/// A receiver's triangle, prepared for interpolation.
pub(super) struct Facet {
    /// Where the corners are, rebased world.
    pub(super) corners: [DVec3; 3],
    /// The corners' unit normals, all turned to the eye's side together.
    pub(super) normals: [DVec3; 3],
    weights: [f64; 3],
    geometric_normal: DVec3,
}

impl Facet {
    /// Surfaces are two-sided: if the corner normals together point away from the eye's side, all are turned, so that
    /// the shading normal stays continuous within the triangle.
    pub(super) fn new(scene: &Scene, receiver: &Receiver) -> Self {
        let corners = scene.triangle_in_world(receiver.triangle);
        let geometric_normal = receiver.normal_in_world;
        let normals = scene.corner_normals[receiver.triangle as usize].map(|normal| normal.as_dvec3());
        let points_to_eye = normals.iter().sum::<DVec3>().dot(geometric_normal) >= 0.0;
        let normals = if points_to_eye { normals } else { normals.map(|normal| -normal) };
        Self { corners, normals, weights: barycentric(receiver.point_in_world, corners), geometric_normal }
    }

    /// The mean of three corner values, weighted by the point's place in the triangle.
    pub(super) fn interpolate(&self, values: [DVec3; 3]) -> DVec3 {
        self.weights.iter().zip(values).map(|(&weight, value)| weight * value).sum()
    }

    /// The interpolated unit normal; the geometric one where the corner normals cancel.
    pub(super) fn shading_normal(&self) -> DVec3 {
        self.interpolate(self.normals).normalize_or(self.geometric_normal)
    }
}

/// Barycentric weights of a point in the plane of a triangle: the areas opposite the corners. Equal weights if the
/// triangle has no area.
fn barycentric(point: DVec3, [a, b, c]: [DVec3; 3]) -> [f64; 3] {
    let normal = (b - a).cross(c - a);
    let whole = normal.length_squared();
    if whole == 0.0 {
        return [1.0 / 3.0; 3];
    }
    [(b, c), (c, a), (a, b)].map(|(from, to)| (from - point).cross(to - point).dot(normal) / whole)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inspect::fixtures::{Shape, scene_of};
    use glam::Vec3;

    /// A few roundings of numbers near one.
    const ROUNDING: f64 = 1e-12;

    const CORNERS: [DVec3; 3] = [DVec3::ZERO, DVec3::new(2.0, 0.0, 0.0), DVec3::new(0.0, 0.0, -4.0)];

    fn facet_with(corner_normals: [Vec3; 3], weights: DVec3, normal_in_world: DVec3) -> Facet {
        let mut scene = scene_of(&[Shape { positions: CORNERS.to_vec(), triangles: vec![[0, 1, 2]] }]);
        scene.corner_normals[0] = corner_normals;
        let point_in_world = weights.x * CORNERS[0] + weights.y * CORNERS[1] + weights.z * CORNERS[2];
        Facet::new(&scene, &Receiver { triangle: 0, point_in_world, normal_in_world })
    }

    #[test]
    fn weights_are_recovered_from_the_point() {
        for weights in [DVec3::X, DVec3::Y, DVec3::Z, DVec3::new(0.5, 0.2, 0.3)] {
            let facet = facet_with([Vec3::Y; 3], weights, DVec3::Y);
            assert!(DVec3::from(facet.weights).distance(weights) < ROUNDING);
            assert!(facet.interpolate([DVec3::X, DVec3::Y, DVec3::Z]).distance(weights) < ROUNDING);
        }
        assert_eq!(barycentric(DVec3::X, [DVec3::ZERO; 3]), [1.0 / 3.0; 3]);
    }

    #[test]
    fn the_shading_normal_is_interpolated_and_normalised() {
        let facet = facet_with([Vec3::X, Vec3::Y, Vec3::Y], DVec3::new(0.5, 0.25, 0.25), DVec3::Y);
        assert!(facet.shading_normal().distance(DVec3::new(1.0, 1.0, 0.0).normalize()) < ROUNDING);
    }

    #[test]
    fn seen_from_below_all_normals_turn_together() {
        let leaning = [Vec3::new(0.6, 0.8, 0.0), Vec3::Y, Vec3::new(-0.6, 0.8, 0.0)];
        let weights = DVec3::new(0.2, 0.5, 0.3);
        let (above, below) = (facet_with(leaning, weights, DVec3::Y), facet_with(leaning, weights, DVec3::NEG_Y));
        assert_eq!(below.shading_normal(), -above.shading_normal());
        assert!(above.shading_normal().y > 0.0);
    }

    #[test]
    fn cancelling_normals_fall_back_to_the_geometric_one() {
        let facet = facet_with([Vec3::X, Vec3::NEG_X, Vec3::Y], DVec3::new(0.5, 0.5, 0.0), DVec3::Y);
        assert_eq!(facet.shading_normal(), DVec3::Y);
    }
}
