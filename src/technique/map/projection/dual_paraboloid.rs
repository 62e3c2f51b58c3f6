//! `dual-paraboloid`: the two halves of all directions from a light, each as a paraboloid mirror shows it.
//!
//! S. Brabec, T. Annen, H.-P. Seidel, "Shadow Mapping for Hemispherical and Omnidirectional Light Sources", 2002. Two
//! views instead of a cube's six. Assumes casters whose edges are short as seen from the light: the rasteriser draws
//! straight lines between corners where the mirror shows arcs, so casters are cut until no edge spans more than
//! `max_edge_deg`. Known failures: what remains of that error, worst at the seam between the halves. Formulas:
//! docs/map.md#dual-paraboloid.

use super::drawn::Drawn;
use super::fit::look;
use super::paraboloid::{Paraboloid, least_cosine, rim_texels};
use super::pieces::Cut;
use super::{LightFrustum, Projection, Shape, Shares, View, Window, cube};
use crate::gpu::shader::{Wgsl, wgsl};
use crate::scene::{Light, LightKind, Mesh, Scene, distance_to_triangle};
use crate::technique::Unsupported;
use crate::technique::map::settings::{DepthMetric, Settings};
use glam::{DMat3, DMat4, DVec3, UVec2, Vec4};
use std::sync::Arc;

/// Up to two views.
#[derive(Debug)]
pub(super) struct DualParaboloid;

/// Far plane beyond the farthest receiver by this share of its distance.
const FAR_SLACK: f64 = 1e-3;
/// Near plane before the nearest caster by this share of its distance, where it is fitted to that.
const NEAR_SLACK: f64 = 1e-2;

impl Projection for DualParaboloid {
    fn name(&self) -> &'static str {
        "dual-paraboloid"
    }

    fn shader(&self) -> Wgsl {
        wgsl!("map/projection/dual_paraboloid.wgsl")
    }

    fn layout(&self) -> Wgsl {
        wgsl!("map/paraboloid.wgsl")
    }

    fn has_linear_depth(&self) -> bool {
        true
    }

    fn is_unwarped(&self) -> bool {
        true
    }

    fn shares_depth(&self) -> bool {
        true
    }

    fn has_rasterised_depth(&self) -> bool {
        false
    }

    fn supports(&self, _: &Scene, light: &Light, _: &Settings) -> Result<(), Unsupported> {
        cube::position(light).map(|_| ())
    }

    fn fit(
        &self,
        scene: &Scene,
        light: &Light,
        settings: &Settings,
        _visible: &[DVec3],
    ) -> Result<Vec<View>, Unsupported> {
        let position = cube::position(light)?;
        let receivers: Vec<[DVec3; 3]> =
            receiving_triangles(scene).map(|corners| corners.map(|c| c - position)).collect();
        let farthest_m = receivers.iter().flatten().map(|corner| corner.length()).fold(f64::MIN_POSITIVE, f64::max);
        let fitted = (nearest_m(scene, position, settings), (1.0 + FAR_SLACK) * farthest_m.min(light.range_m));
        let (near_m, far_m) = settings.fit.planes_m(fitted)?;
        let texels = UVec2::splat(settings.size);
        let cut = Cut::around(scene, position, settings.knobs.max_edge_rad)?;
        let front = axis(light, settings, position);
        let halves = [("front", front), ("back", -front)].into_iter().filter(|(_, axis)| {
            // A triangle whose corners all lie behind the seam lies behind it with all of itself.
            receivers.iter().flatten().any(|corner| corner.dot(*axis) > 0.0)
        });
        let half = |(name, axis): (&str, DVec3)| {
            let light_view_from_world = look(position, axis);
            let frustum = LightFrustum {
                light_view_from_world,
                window: Window::square(1.0),
                near_m: near_m.max(far_m * f64::from(f32::EPSILON)),
                far_m,
                shape: Shape::Perspective,
                reversed: settings.reversed,
                depth_metric: DepthMetric::Projected,
                texels,
            };
            // Its matrix shows 90 degrees of the hemisphere to people; what is drawn goes by the rows.
            let view = frustum.view(name);
            let drawn = Drawn::new(cut.within(axis, least_cosine(texels)), settings.knobs.max_edge_rad);
            let selector = axis.extend(-axis.dot(position)).as_vec4();
            let rows = rows(&light_view_from_world, near_m, far_m, settings.reversed);
            let view =
                View { layout: &Paraboloid, rows, selector, near_far: format!("{near_m:.6} m, {far_m:.6} m"), ..view };
            let window = window_text(axis, &drawn, drawn.chord_error_texels(&view, position));
            View { window, drawn: Some(Arc::new(drawn)), ..view }
        };
        let views: Vec<View> = halves.map(half).collect();
        Ok(if views.is_empty() { vec![half(("front", front))] } else { views })
    }

    fn select(&self, views: &[View], point_in_world: DVec3) -> Shares {
        let before = views[0].selector.as_dvec4().dot(point_in_world.extend(1.0));
        Shares::one(usize::from(before < 0.0 && views.len() > 1))
    }

    fn seam_texels(&self, views: &[View], view: usize, point_in_world: DVec3) -> Option<f64> {
        let from_rim = rim_texels(&views[view], point_in_world);
        (views.len() > 1).then_some(from_rim)
    }
}

/// Depth is linear, so a near plane at the light wastes nothing; where blockers are searched, however, no farther than
/// from one at the nearest caster.
fn nearest_m(scene: &Scene, position: DVec3, settings: &Settings) -> f64 {
    if !settings.filter.softens() {
        return 0.0;
    }
    let casters = scene.meshes.iter().filter(|mesh| mesh.casts).flat_map(|mesh| mesh.triangles.clone());
    let distances_m = casters.map(|triangle| distance_to_triangle(position, scene.triangle_in_world(triangle)));
    (1.0 - NEAR_SLACK) * distances_m.reduce(f64::min).unwrap_or(0.0)
}

fn receiving_triangles(scene: &Scene) -> impl Iterator<Item = [DVec3; 3]> + '_ {
    let receiving = |mesh: &&Mesh| mesh.receives;
    let triangles = scene.meshes.iter().filter(receiving).flat_map(|mesh| mesh.triangles.clone());
    triangles.map(|triangle| scene.triangle_in_world(triangle))
}

/// The rows that the layout reads.
fn rows(light_view_from_world: &DMat4, near_m: f64, far_m: f64, reversed: bool) -> super::Rows {
    let (first_m, last_m) = if reversed { (far_m, near_m) } else { (near_m, far_m) };
    let row = |i: usize| light_view_from_world.row(i);
    let constant = |value: f64| Vec4::new(0.0, 0.0, 0.0, value as f32);
    super::Rows {
        u: row(0).as_vec4(),
        v: row(1).as_vec4(),
        q: (-row(2)).as_vec4(),
        depth: constant(-first_m),
        depth_q: constant(last_m - first_m),
    }
}

/// The axis of the front half: where the light aims, or straight down; turned by the phase.
fn axis(light: &Light, settings: &Settings, position: DVec3) -> DVec3 {
    let aim = match light.kind {
        LightKind::Spot { axis, .. } => Some(axis.as_dvec3()),
        LightKind::Point { aim, .. } | LightKind::Rectangle { aim, .. } | LightKind::Sphere { aim, .. } => {
            Some(aim.as_dvec3() - position)
        }
        LightKind::Directional { .. } | LightKind::Sun { .. } => None,
    };
    let aim = aim.filter(|_| !settings.knobs.looks_down).and_then(DVec3::try_normalize).unwrap_or(DVec3::NEG_Y);
    // A texel at the middle of the disc spans four over the map's size.
    let phase = settings.fit.phase_texels * 4.0 / f64::from(settings.size);
    DMat3::from_rotation_y(phase.x) * DMat3::from_rotation_x(phase.y) * aim
}

/// What people should know about it.
fn window_text(axis: DVec3, drawn: &Drawn, chord_error_texels: f64) -> String {
    let note = if chord_error_texels > 0.5 { ", too much: more than half a texel" } else { "" };
    format!(
        "hemisphere around ({:.3}, {:.3}, {:.3}), {} pieces, edges off by up to {chord_error_texels:.3} texels{note}",
        axis.x,
        axis.y,
        axis.z,
        drawn.pieces.len()
    )
}
