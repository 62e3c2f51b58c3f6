//! The volumes of one light: which objects are counted on which side of the surface, and the faces that takes.

use super::assembly::{Faces, Plan, VolumeVertex};
use super::casting::{CastingObject, casting_objects};
use super::extrude::{Reach, extrude};
use super::eye::Eye;
use super::near_projection::clip_from_caster;
use super::pyramid::Pyramid;
use super::quads::{Caster, Quads, casters};
use super::settings::{Caps, Count, Extrude, Length, Settings};
use super::states::Side;
use crate::inspect::weld;
use crate::scene::{Light, Scene};
use glam::{DVec3, DVec4, Mat4};

/// A finite volume's automatic length in extents of the scene: no shadow within it is longer.
const AUTOMATIC_EXTENTS: f64 = 2.0;

/// Everything that is drawn.
#[derive(Debug, Clone)]
pub(super) struct Volumes {
    /// Every casting object.
    pub(super) objects: Vec<CastingObject>,
    /// Where each object's faces are counted, in the same order.
    pub(super) sides: Vec<Side>,
    /// How far they reach.
    pub(super) reach: Reach,
    /// Vertices of sides and back caps.
    pub(super) vertices: Vec<VolumeVertex>,
    /// Faces counted behind the surface.
    pub(super) behind: Faces,
    /// Faces counted before it.
    pub(super) before: Faces,
    /// With zp-plus: the projection of casters onto the near plane, and their corners.
    pub(super) near_casters: Option<(Mat4, Vec<u32>)>,
    /// Homogeneous light.
    light: DVec4,
    /// True if vertices are moved by the vertex shader.
    extrudes_on_gpu: bool,
    /// Casters as the vertex shader asks about them; empty unless it unfolds quads.
    pub(super) casters: Vec<Caster>,
    /// What it unfolds, counted behind the surface and before it.
    pub(super) quads: Option<[Quads; 2]>,
    /// True where zp-plus fell back to counting behind, because the light lies in the near plane.
    pub(super) fell_back: bool,
}

impl Volumes {
    /// Where a volume vertex is drawn: homogeneous, rebased world.
    pub(super) fn position(&self, index: u32) -> DVec4 {
        let [x, y, z, w] = self.vertices[index as usize].map(f64::from);
        let is_unmoved = self.extrudes_on_gpu && w == 0.0 && index + 1 < self.vertices.len() as u32;
        if is_unmoved {
            extrude(DVec3::new(x, y, z).as_vec3(), self.light, self.reach).as_dvec4()
        } else {
            DVec4::new(x, y, z, w)
        }
    }

    /// Finds silhouettes, classifies objects and assembles their volumes.
    pub(super) fn new(scene: &Scene, light: &Light, settings: &Settings, eye: &Eye) -> Self {
        let welded = weld(&scene.positions);
        let objects = casting_objects(scene, light, &welded, settings);
        let homogeneous = light.homogeneous();
        let reach = match settings.reach {
            None => Reach::Infinite,
            Some(Length::Auto) => Reach::Metres(AUTOMATIC_EXTENTS * scene.extent_m().max(f64::from(f32::MIN_POSITIVE))),
            Some(Length::Metres(length_m)) => Reach::Metres(length_m),
        };
        let near_matrix =
            clip_from_caster(&eye.clip_from_world.as_dmat4(), scene.camera.near_m, eye.near_plane(), homogeneous);
        let fell_back = settings.count == Count::ZpPlus && near_matrix.is_none();
        let pyramid = Pyramid::new(eye.near_rectangle(), eye.near_plane(), homogeneous);
        let side = |object: &CastingObject| match settings.count {
            Count::ZFail => Side::Behind,
            Count::ZPass => Side::Before,
            Count::ZpPlus if fell_back => Side::Behind,
            Count::ZpPlus => Side::Before,
            Count::Mixed if pyramid.excludes(object.centre_in_world, object.radius_m) => Side::Before,
            Count::Mixed => Side::Behind,
        };
        let sides: Vec<Side> = objects.iter().map(side).collect();
        let plan = Plan::of(light, reach, settings);
        let faces = |wanted: Side| {
            let chosen = objects.iter().zip(&sides).filter(|(_, side)| **side == wanted).map(|(object, _)| object);
            let mut faces = plan.faces(scene, chosen, welded.count);
            let (front, back) = caps(settings.caps, wanted, reach);
            faces.has_front_caps = front;
            faces.has_back_caps = back && !plan.ends_in_a_point();
            if !front {
                faces.front_caps.clear();
                faces.inward_front_caps.clear();
            }
            if !back {
                faces.back_caps.clear();
            }
            faces
        };
        let (behind, before) = (faces(Side::Behind), faces(Side::Before));
        let quads = |wanted: Side, faces: &Faces| {
            let chosen = objects.iter().zip(&sides).filter(|(_, side)| **side == wanted).map(|(object, _)| object);
            Quads::new(scene, &welded, chosen, settings.per_triangle, faces)
        };
        let unfolds = settings.extrude == Extrude::DegenerateQuads;
        let quads = unfolds.then(|| [quads(Side::Behind, &behind), quads(Side::Before, &before)]);
        let casters = if unfolds { casters(scene, &welded) } else { Vec::new() };
        let corners = |object: &CastingObject| -> Vec<u32> {
            object.used.iter().flat_map(|triangle| [3 * triangle, 3 * triangle + 1, 3 * triangle + 2]).collect()
        };
        let near_casters = near_matrix
            .filter(|_| settings.count == Count::ZpPlus)
            .map(|matrix| (matrix, objects.iter().flat_map(corners).collect()));
        let vertices = plan.vertices(&welded.positions(&scene.positions));
        Self {
            sides,
            reach,
            vertices,
            behind,
            before,
            near_casters,
            light: homogeneous,
            extrudes_on_gpu: settings.extrude != Extrude::Cpu,
            casters,
            quads,
            fell_back,
            objects,
        }
    }
}

/// Whether front and back caps are drawn. Counting before the surface needs no front caps, because the casters
/// themselves end the view there, and back caps only where volumes end at all.
fn caps(caps: Caps, side: Side, reach: Reach) -> (bool, bool) {
    match (caps, side) {
        (Caps::Only { front, back }, _) => (front, back),
        (Caps::Auto, Side::Behind) => (true, true),
        (Caps::Auto, Side::Before) => (false, reach != Reach::Infinite),
    }
}
