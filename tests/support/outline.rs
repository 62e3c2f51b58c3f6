//! Shadows worked out by hand: a triangle's outline on the floor, in a shadow map and in the picture. Nothing here casts
//! a ray.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

use glam::{DVec2, DVec3};
use gnomon::scene::{Light, Mesh, Scene};
use gnomon::technique::Spec;
use gnomon::technique::map::{Lookup, Settings};
use std::f64::consts::SQRT_2;

/// A triangle, wound either way.
#[derive(Debug, Clone)]
pub(crate) struct Outline {
    corners: [DVec2; 3],
}

impl Outline {
    /// From its corners in order.
    pub(crate) fn new(corners: [DVec2; 3]) -> Self {
        Self { corners }
    }

    /// Its sides, from corner to corner.
    pub(crate) fn edges(&self) -> impl Iterator<Item = [DVec2; 2]> {
        (0..3).map(|i| [self.corners[i], self.corners[(i + 1) % 3]])
    }

    /// Whether a point is inside, by the signs of the edge functions.
    pub(crate) fn contains(&self, point: DVec2) -> bool {
        let sides: Vec<f64> = self.edges().map(|[a, b]| (b - a).perp_dot(point - a)).collect();
        sides.iter().all(|side| *side >= 0.0) || sides.iter().all(|side| *side <= 0.0)
    }

    /// Distance of a point to the nearest side.
    pub(crate) fn distance(&self, point: DVec2) -> f64 {
        self.edges().map(|edge| distance_to_segment(point, edge)).fold(f64::INFINITY, f64::min)
    }
}

fn distance_to_segment(point: DVec2, [a, b]: [DVec2; 2]) -> f64 {
    let along = b - a;
    let share = ((point - a).dot(along) / along.length_squared()).clamp(0.0, 1.0);
    point.distance(a + share * along)
}

/// The mesh of that name.
pub(crate) fn mesh<'s>(scene: &'s Scene, name: &str) -> &'s Mesh {
    scene.meshes.iter().find(|mesh| mesh.name == name).unwrap()
}

/// The corners of the blocker of `scenes/triangle`.
pub(crate) fn blocker(scene: &Scene) -> [DVec3; 3] {
    scene.triangle_in_world(mesh(scene, "Triangle").triangles.start)
}

/// Height of the mesh `Floor`, which must be level.
pub(crate) fn floor_height(scene: &Scene) -> f64 {
    let heights: Vec<f64> = mesh(scene, "Floor")
        .triangles
        .clone()
        .flat_map(|t| scene.triangle_in_world(t))
        .map(|corner| corner.y)
        .collect();
    assert!(heights.iter().all(|height| *height == heights[0]), "{heights:?}");
    heights[0]
}

/// Where the line from a light through a point meets the floor.
pub(crate) fn onto_floor(scene: &Scene, light: &Light, point: DVec3) -> DVec3 {
    let light = light.homogeneous();
    // Along the light's ray at the point: away from a position, or against the direction towards the light.
    let travel = point * light.w - light.truncate();
    point + travel * ((floor_height(scene) - point.y) / travel.y)
}

/// The shadow of a triangle on the floor, in (x, z).
pub(crate) fn shadow_on_floor(scene: &Scene, light: &Light, corners: [DVec3; 3]) -> Outline {
    Outline::new(corners.map(|corner| on_floor(onto_floor(scene, light, corner))))
}

/// (x, z) of a point.
pub(crate) fn on_floor(point: DVec3) -> DVec2 {
    DVec2::new(point.x, point.z)
}

/// A shadow map of `scenes/triangle`, and where the blocker's outline lies in it. Straight edges stay straight in a map.
#[derive(Debug)]
pub(crate) struct MappedOutline {
    pub(crate) lookup: Lookup,
    outline: Outline,
}

impl MappedOutline {
    /// For a `map` specification whose fit does not follow the camera.
    pub(crate) fn new(scene: &Scene, light: &Light, typed: &str) -> Self {
        let settings = Settings::of(&Spec::parse(typed).unwrap());
        let views = settings.projection.fit(scene, light, &settings, &[]).unwrap();
        let lookup = Lookup::new(views, &settings, light);
        let corners = blocker(scene).map(|corner| lookup.project(corner).unwrap().position_in_texels());
        Self { lookup, outline: Outline::new(corners) }
    }

    /// How many texels a point is from the edge of the blocker's shadow.
    pub(crate) fn texels_from_edge(&self, point_in_world: DVec3) -> f64 {
        self.outline.distance(self.lookup.project(point_in_world).unwrap().position_in_texels())
    }
}

/// How far from the true edge, in texels, a filter of `kernel` texels a side may err.
///
/// It reads texels whose centres lie at most half its width away along each axis. Vulkan lets rasterisers snap corners to
/// a grid of 1/16 texel, so by half of that along each axis; and f32 rounds a receiver's place in a map of 4096 texels by
/// less than a thousandth.
pub(crate) fn band_texels(kernel: f64) -> f64 {
    0.5 * SQRT_2 * kernel + SQRT_2 / 32.0 + 1e-3
}

/// Both ends of every side of every triangle of a scene.
pub(crate) fn all_edges(scene: &Scene) -> Vec<[DVec3; 2]> {
    let sides = |triangle: u32| {
        let [a, b, c] = scene.triangle_in_world(triangle);
        [[a, b], [b, c], [c, a]]
    };
    (0..scene.triangles.len() as u32).flat_map(sides).collect()
}

/// Whether each pixel's centre lies within `band_px` of one of these segments as the camera sees them.
pub(crate) fn pixels_near(scene: &Scene, segments: &[[DVec3; 2]], band_px: f64) -> Vec<bool> {
    let clip_from_world = scene.camera.clip_from_world(scene.image_size);
    let size = scene.image_size.as_dvec2();
    let seen = segments.iter().filter_map(|ends| {
        let [mut a, mut b] = ends.map(|end| clip_from_world * end.extend(1.0));
        if a.w > b.w {
            std::mem::swap(&mut a, &mut b);
        }
        let near = scene.camera.near_m;
        if a.w < near {
            a = a.lerp(b, (near - a.w) / (b.w - a.w));
        }
        let in_pixels = |p: glam::DVec4| 0.5 * (DVec2::new(p.x, -p.y) / p.w + 1.0) * size;
        (b.w > near).then(|| [a, b].map(in_pixels))
    });
    let seen: Vec<[DVec2; 2]> = seen.collect();
    let centres = (0..scene.image_size.y).flat_map(|y| (0..scene.image_size.x).map(move |x| (x, y)));
    let centres = centres.map(|(x, y)| DVec2::new(x.into(), y.into()) + 0.5);
    centres.map(|centre| seen.iter().any(|segment| distance_to_segment(centre, *segment) <= band_px)).collect()
}
