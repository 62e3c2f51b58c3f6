//! Which flattened casters lie over a point of a plane: all of them on the line through the light, cast exactly, or for
//! corners that are flattened one by one, the flattened triangles themselves.

use super::prepared::PreparedPlanar;
use super::settings::Projection;
use super::shadow_plane::Side;
use crate::scene::Segment;
use glam::DVec3;

/// One flattened triangle over a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Layer {
    /// Its id.
    pub(super) triangle: u32,
    /// Where it was before it was flattened.
    pub(super) side: Side,
}

/// The layers that a perfect projection of this kind would draw: casters between plane and light.
pub(super) fn ideal(planar: &PreparedPlanar<'_>, plane: usize, point: DVec3) -> Vec<Layer> {
    match planar.settings.projection {
        Projection::Shear => {
            flattened(planar, plane, point).into_iter().filter(|layer| layer.side == Side::Between).collect()
        }
        _ => layers(planar, plane, &between(planar, plane, point), Side::Between),
    }
}

/// The layers that the projection does draw.
pub(super) fn drawn(planar: &PreparedPlanar<'_>, plane: usize, point: DVec3) -> Vec<Layer> {
    match planar.settings.projection {
        Projection::Clipped => before_far_plane(planar, plane, point),
        Projection::Homogeneous => {
            let mut drawn = layers(planar, plane, &between(planar, plane, point), Side::Between);
            drawn.extend(layers(planar, plane, &behind(planar, plane, point), Side::Behind));
            drawn
        }
        Projection::Divided | Projection::Shear => flattened(planar, plane, point),
    }
}

fn layers(planar: &PreparedPlanar<'_>, plane: usize, segment: &Segment, side: Side) -> Vec<Layer> {
    hits(planar, plane, segment).into_iter().map(|(triangle, _)| Layer { triangle, side }).collect()
}

/// Casters between plane and light, without those so close below the light that z ≤ w clips them: with z = κ n s and
/// w = (d − s Lw) × view depth.
fn before_far_plane(planar: &PreparedPlanar<'_>, plane: usize, point: DVec3) -> Vec<Layer> {
    let shadow = &planar.planes[plane];
    let camera = &planar.job.scene.camera;
    let view_depth_m = -camera.view_from_world().transform_point3(point).z;
    let between = between(planar, plane, point);
    let is_kept = |height_m: f64| {
        let w = (shadow.light_height() - height_m * shadow.light.w) * view_depth_m;
        planar.settings.kappa * camera.near_m * height_m <= w
    };
    hits(planar, plane, &between)
        .into_iter()
        .filter(|(_, t)| is_kept(shadow.height_m(between.from.lerp(between.to, *t))))
        .map(|(triangle, _)| Layer { triangle, side: Side::Between })
        .collect()
}

/// Casters that a segment crosses, and where; what lies on the plane is none of its casters.
fn hits(planar: &PreparedPlanar<'_>, plane: usize, segment: &Segment) -> Vec<(u32, f64)> {
    let (scene, shadow) = (planar.job.scene, &planar.planes[plane]);
    let mut hits = Vec::new();
    planar.job.casters.all_hits(segment, None, &mut hits);
    let is_caster = |triangle| !planar.members.lies_on(scene, shadow, triangle);
    hits.into_iter().filter(|hit| is_caster(hit.triangle)).map(|hit| (hit.triangle, hit.t)).collect()
}

/// The open segment from a point of the plane to the light.
fn between(planar: &PreparedPlanar<'_>, plane: usize, point: DVec3) -> Segment {
    let light = planar.planes[plane].light;
    let to = if light.w == 0.0 { point + light.truncate() * beyond_all_m(planar, point) } else { light.truncate() };
    Segment { from: point, to }
}

/// From a point of the plane away from the light, to beyond all geometry.
fn behind(planar: &PreparedPlanar<'_>, plane: usize, point: DVec3) -> Segment {
    let light = planar.planes[plane].light;
    let towards_light = (light.truncate() - point * light.w).normalize_or_zero();
    Segment { from: point, to: point - towards_light * beyond_all_m(planar, point) }
}

/// A distance from a point at which there is no geometry, metres.
fn beyond_all_m(planar: &PreparedPlanar<'_>, point: DVec3) -> f64 {
    let bounds = planar.job.scene.bounds();
    2.0 * ((point - bounds.centre()).length() + bounds.radius())
}

fn flattened(planar: &PreparedPlanar<'_>, plane: usize, point: DVec3) -> Vec<Layer> {
    let (scene, shadow, projection) = (planar.job.scene, &planar.planes[plane], planar.settings.projection);
    let over = planar.flat_casters(plane).over(point);
    let layer =
        |hit: super::flatten::FlatHit| Layer { triangle: hit.triangle, side: hit.side(scene, shadow, projection) };
    over.into_iter().map(layer).collect()
}
