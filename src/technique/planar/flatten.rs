//! Casters flattened corner by corner, for the projections that a matrix with w does not give: `divided` and `shear`.
//! The flattened triangles are a scene of their own. The GPU draws it; in the plane's own coordinates the ray core
//! tells which of its triangles lie over a point.

use super::membership::Membership;
use super::settings::Projection;
use super::shadow_plane::{ShadowPlane, Side};
use crate::cast::Casters;
use crate::scene::{Bounds, Scene, Segment};
use glam::{DVec2, DVec3};

/// Corners beyond this many extents of the scene, and at the light's height, have no image: their triangles are left
/// out. f32 holds no useful picture of them.
const FARTHEST_IMAGE: f64 = 1e9;

/// The flattened casters of one plane, in the plane's own coordinates.
#[derive(Debug)]
pub(super) struct FlatCasters {
    scene: Scene,
    casters: Casters,
    basis: [DVec3; 2],
}

/// The casters of a plane flattened onto it, in the world: the scene with three corners for each triangle, all in one
/// place for triangles that are not drawn.
pub(super) fn flattened(scene: &Scene, shadow: &ShadowPlane, members: &Membership, projection: Projection) -> Scene {
    let farthest_m = FARTHEST_IMAGE * scene.extent_m();
    // The foot of an object's middle stands for the object.
    let origins: Vec<DVec3> = scene
        .meshes
        .iter()
        .map(|mesh| Bounds::of(mesh.triangles.clone().flat_map(|t| scene.triangle_in_world(t))))
        .map(|bounds| bounds.map_or(DVec3::ZERO, |bounds| bounds.centre()))
        .collect();
    let image = |origin: DVec3, corner: DVec3| {
        let image = match projection {
            Projection::Shear => Some(shadow.sheared(corner, origin)),
            _ => shadow.divided(corner),
        };
        image.filter(|image| image.abs().max_element() <= farthest_m)
    };
    let corners_of = |triangle: u32| {
        let origin = origins[scene.mesh_index_of(triangle)];
        let images = scene.triangle_in_world(triangle).map(|corner| image(origin, corner));
        match images {
            [Some(a), Some(b), Some(c)] if !members.lies_on(scene, shadow, triangle) => [a, b, c],
            _ => [DVec3::ZERO; 3],
        }
    };
    let count = scene.triangles.len() as u32;
    with_corners(scene, (0..count).flat_map(corners_of))
}

/// The scene with other corners, three for each triangle.
fn with_corners(scene: &Scene, corners: impl Iterator<Item = DVec3>) -> Scene {
    Scene {
        positions: corners.map(|corner| corner.as_vec3()).collect(),
        triangles: (0..scene.triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
        ..scene.clone()
    }
}

/// A flattened triangle over a point of the plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct FlatHit {
    /// Its id.
    pub(super) triangle: u32,
    /// Weights of its corners at the point.
    pub(super) weights: DVec3,
}

impl FlatCasters {
    /// Prepares the flattened casters of a plane.
    pub(super) fn new(flat: &Scene, shadow: &ShadowPlane) -> Self {
        let tangent = shadow.normal().any_orthonormal_vector();
        let basis = [tangent, shadow.normal().cross(tangent)];
        let on_plane = |triangle| flat.triangle_in_world(triangle).map(|corner| in_basis(basis, corner).extend(0.0));
        let scene = with_corners(flat, (0..flat.triangles.len() as u32).flat_map(on_plane));
        Self { casters: Casters::new(&scene), scene, basis }
    }

    /// The flattened triangles over a point of the plane.
    pub(super) fn over(&self, point: DVec3) -> Vec<FlatHit> {
        let at = in_basis(self.basis, point);
        let mut hits = Vec::new();
        self.casters.all_hits(&Segment { from: at.extend(1.0), to: at.extend(-1.0) }, None, &mut hits);
        let weighed = |triangle: u32| {
            let corners = self.scene.triangle_in_world(triangle).map(DVec3::truncate);
            FlatHit { triangle, weights: weights(corners, at) }
        };
        hits.into_iter().map(|hit| weighed(hit.triangle)).collect()
    }
}

impl FlatHit {
    /// On which side of plane and light the flattened point was.
    pub(super) fn side(&self, scene: &Scene, shadow: &ShadowPlane, projection: Projection) -> Side {
        let heights = scene.triangle_in_world(self.triangle).map(|corner| shadow.height_m(corner));
        let weights = self.weights.to_array();
        if projection == Projection::Shear {
            return shadow.side(weights.iter().zip(heights).map(|(weight, height)| weight * height).sum());
        }
        // The image of a triangle that reaches beyond the light is a wrong one wherever it lies.
        if heights.iter().any(|height| shadow.side(*height) == Side::Beyond) {
            return Side::Beyond;
        }
        let shares = weights.iter().zip(heights).map(|(weight, height)| {
            let share = weight / (shadow.light_height() - height * shadow.light.w);
            (share, share * height)
        });
        let (total, weighted) = shares.fold((0.0, 0.0), |sum, share| (sum.0 + share.0, sum.1 + share.1));
        shadow.side(weighted / total)
    }
}

fn in_basis([u, v]: [DVec3; 2], point: DVec3) -> DVec2 {
    DVec2::new(u.dot(point), v.dot(point))
}

/// Barycentric weights of a point in a triangle of the plane.
fn weights([a, b, c]: [DVec2; 3], point: DVec2) -> DVec3 {
    let area = (b - a).perp_dot(c - a);
    let (of_b, of_c) = ((point - a).perp_dot(c - a) / area, (b - a).perp_dot(point - a) / area);
    DVec3::new(1.0 - of_b - of_c, of_b, of_c)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_are_those_of_the_corners() {
        let corners = [DVec2::new(1.0, 2.0), DVec2::new(4.0, 2.5), DVec2::new(2.0, 6.0)];
        let expected = DVec3::new(0.2, 0.5, 0.3);
        let point = expected.x * corners[0] + expected.y * corners[1] + expected.z * corners[2];
        assert!((weights(corners, point) - expected).length() < 1e-12);
    }
}
