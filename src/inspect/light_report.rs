//! What one light's depth has to span, and how wide a single frustum from it would be.

use super::frustum::{DepthRange, Frustum};
use crate::scene::{Light, LightKind, Scene, distance_to_triangle};
use glam::DVec3;
use serde::Serialize;

/// One light as its shadow techniques meet it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LightReport {
    /// The light's name.
    pub name: String,
    /// Its kind as scene files spell it.
    pub kind: &'static str,
    /// Distances of all that casts. Point: straight from the light. Spot: along its axis, inside the square frustum
    /// around its cone. Directional: along its direction from the geometry nearest to the light, so that the nearest
    /// of casters and receivers is at 0.
    pub casters: Option<DepthRange>,
    /// Distances of all that receives, measured the same way.
    pub receivers: Option<DepthRange>,
    /// Of a point light: the half angle of the cone about its aim that holds every receiver, radians. Exact below
    /// π/2; from there on a lower bound, and no single frustum holds them. `None` if the light is at its own aim.
    pub receivers_half_angle_rad: Option<f64>,
}

impl LightReport {
    /// Looks at the scene from one of its lights.
    #[must_use]
    pub fn new(scene: &Scene, light: &Light) -> Self {
        let casting = || triangles(scene, true, false);
        let receiving = || triangles(scene, false, true);
        let (casters, receivers) = match light.kind {
            LightKind::Point { position, .. }
            | LightKind::Rectangle { position, .. }
            | LightKind::Sphere { position, .. } => {
                let from = position.as_dvec3();
                (straight(from, casting()), straight(from, receiving()))
            }
            LightKind::Spot { position, axis, outer_rad, .. } => {
                let frustum = Frustum::around_cone(position.as_dvec3(), axis.as_dvec3(), outer_rad);
                (frustum.depth_range(casting()), frustum.depth_range(receiving()))
            }
            LightKind::Directional { towards_light } | LightKind::Sun { towards_light, .. } => {
                let along = -towards_light.as_dvec3().normalize();
                let start = triangles(scene, true, true).flatten().map(|p| p.dot(along)).fold(f64::INFINITY, f64::min);
                (parallel(along, start, casting()), parallel(along, start, receiving()))
            }
        };
        let receivers_half_angle_rad = half_angle_about_aim(light, receiving());
        Self { name: light.name.clone(), kind: light.kind_name(), casters, receivers, receivers_half_angle_rad }
    }
}

/// Triangles of meshes that cast, receive, or do either.
fn triangles(scene: &Scene, casting: bool, receiving: bool) -> impl Iterator<Item = [DVec3; 3]> {
    let chosen = scene.meshes.iter().filter(move |mesh| mesh.casts && casting || mesh.receives && receiving);
    chosen.flat_map(|mesh| mesh.triangles.clone()).map(|id| scene.triangle_in_world(id))
}

/// Straight distances from a point: to the nearest point of any triangle, and to the farthest corner.
fn straight(from: DVec3, triangles: impl Iterator<Item = [DVec3; 3]>) -> Option<DepthRange> {
    let ends = |triangle: [DVec3; 3]| {
        let corners = triangle.map(|corner| corner.distance(from));
        [distance_to_triangle(from, triangle), corners[0].max(corners[1]).max(corners[2])]
    };
    DepthRange::of(triangles.flat_map(ends))
}

/// Distances along a direction from the plane `start`.
fn parallel(along: DVec3, start: f64, triangles: impl Iterator<Item = [DVec3; 3]>) -> Option<DepthRange> {
    DepthRange::of(triangles.flatten().map(|corner| corner.dot(along) - start))
}

fn half_angle_about_aim(light: &Light, receiving: impl Iterator<Item = [DVec3; 3]>) -> Option<f64> {
    let (LightKind::Point { position, aim, .. }
    | LightKind::Rectangle { position, aim, .. }
    | LightKind::Sphere { position, aim, .. }) = light.kind
    else {
        return None;
    };
    let from = position.as_dvec3();
    let axis = (aim.as_dvec3() - from).try_normalize()?;
    receiving.flatten().map(|corner| axis.angle_between(corner - from)).reduce(f64::max)
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{cube, scene_of};
    use super::*;
    use crate::scene::Falloff;
    use glam::Vec3;
    use std::f64::consts::FRAC_PI_2;

    /// A few roundings of numbers of this size.
    const ROUNDING: f64 = 1e-7;

    fn assert_near(actual: Option<f64>, expected: f64) {
        assert!(actual.is_some_and(|actual| (actual - expected).abs() < ROUNDING), "{actual:?} is not {expected}");
    }

    fn assert_range(actual: Option<DepthRange>, nearest: f64, farthest: f64) {
        assert_near(actual.map(|range| range.nearest_m), nearest);
        assert_near(actual.map(|range| range.farthest_m), farthest);
    }

    fn light(kind: LightKind) -> Light {
        Light { name: "l".into(), kind, intensity: Vec3::ONE, range_m: f64::INFINITY }
    }

    fn point(position: Vec3, aim: Vec3) -> Light {
        light(LightKind::Point { position, aim, attenuation: [1.0, 0.0, 0.0] })
    }

    /// A cube around the origin that casts, and one that only receives, three metres to the right.
    fn scene() -> Scene {
        let mut scene = scene_of(&[cube(DVec3::splat(-0.5)), cube(DVec3::new(2.5, -0.5, -0.5))]);
        scene.meshes[0].receives = false;
        scene.meshes[1].casts = false;
        scene
    }

    #[test]
    fn a_point_light_measures_straight_distances() {
        let report = LightReport::new(&scene(), &point(Vec3::new(0.0, 2.0, 0.0), Vec3::ZERO));
        assert_range(report.casters, 1.5, (0.5_f64 + 2.5 * 2.5).sqrt());
        assert_range(report.receivers, (2.5_f64 * 2.5 + 1.5 * 1.5).sqrt(), (3.5_f64 * 3.5 + 2.5 * 2.5 + 0.25).sqrt());
    }

    #[test]
    fn a_directional_light_starts_at_the_nearest_geometry() {
        let report = LightReport::new(&scene(), &light(LightKind::Directional { towards_light: Vec3::NEG_X }));
        assert_range(report.casters, 0.0, 1.0);
        assert_range(report.receivers, 3.0, 4.0);
        assert_eq!(report.receivers_half_angle_rad, None);
    }

    #[test]
    fn a_spot_sees_only_what_is_in_its_frustum() {
        let spot = |axis| {
            let (outer_rad, falloff, attenuation) = (0.3, Falloff::Hard, [1.0, 0.0, 0.0]);
            light(LightKind::Spot { position: Vec3::new(0.0, 4.0, 0.0), axis, outer_rad, falloff, attenuation })
        };
        let down = LightReport::new(&scene(), &spot(Vec3::NEG_Y));
        assert_range(down.casters, 3.5, 4.5);
        assert_eq!(down.receivers, None);
        assert_eq!(LightReport::new(&scene(), &spot(Vec3::Y)).casters, None);
    }

    #[test]
    fn the_cone_about_the_aim_holds_every_receiver() {
        let aimed = LightReport::new(&scene(), &point(Vec3::ZERO, Vec3::X));
        assert_near(aimed.receivers_half_angle_rad, (0.5_f64.sqrt() / 2.5).atan());
        let away = LightReport::new(&scene(), &point(Vec3::ZERO, Vec3::NEG_X));
        assert!(away.receivers_half_angle_rad.is_some_and(|angle| angle > FRAC_PI_2));
        assert_eq!(LightReport::new(&scene(), &point(Vec3::X, Vec3::X)).receivers_half_angle_rad, None);
    }
}
