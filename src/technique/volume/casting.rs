//! Which triangles cast, object by object.
//!
//! A sum of the volumes of any set of triangles is a closed volume, so a stencil counts whatever is put in. With all
//! triangles of an object that the light does not see edge-on, the count is zero exactly in the light, for any soup.
//! Half of them are enough for an object that is closed: with light and receivers outside it, every ray that enters it
//! through a face turned away from the light leaves through one that is turned towards it.

use super::settings::{CasterSides, Settings};
use super::winding::winding_number;
use crate::inspect::{Welded, edges_of};
use crate::scene::{Light, Mesh, Scene};
use glam::{DVec3, DVec4};

/// Winding numbers nearer to zero than this are zero; others belong to points inside a mesh or on it.
const OUTSIDE: f64 = 0.25;

/// The casting part of one mesh.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct CastingObject {
    /// Index of the mesh in the scene.
    pub(super) mesh: usize,
    /// Triangles in use, by id.
    pub(super) used: Vec<u32>,
    /// The same as welded indices, counter-clockwise as seen from the light.
    pub(super) towards_light: Vec<[u32; 3]>,
    /// Triangles turned away from the light, used or not, as welded indices in their own order.
    pub(super) turned_away: Vec<[u32; 3]>,
    /// True if only triangles that face the light are in use.
    pub(super) light_facing_only: bool,
    /// Edges at which the mesh is not closed.
    pub(super) open_edges: Vec<OpenEdge>,
    /// Centre of a sphere around the used triangles.
    pub(super) centre_in_world: DVec3,
    /// Its radius, metres.
    pub(super) radius_m: f64,
}

/// An edge whose faces do not cancel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct OpenEdge {
    /// Its place among the object's edges in the order of their welded vertices, from 0.
    pub(super) id: usize,
    /// Welded indices of its ends.
    pub(super) ends: [u32; 2],
}

impl CastingObject {
    /// Whether triangles that would be needed to close its volumes are missing.
    pub(super) fn is_open_and_one_sided(&self) -> bool {
        self.light_facing_only && !self.open_edges.is_empty()
    }
}

/// Every object that casts.
pub(super) fn casting_objects(
    scene: &Scene,
    light: &Light,
    welded: &Welded,
    settings: &Settings,
) -> Vec<CastingObject> {
    let casting = scene.meshes.iter().enumerate().filter(|(_, mesh)| mesh.casts);
    casting.map(|(index, mesh)| object(scene, light, welded, settings, index, mesh)).collect()
}

fn object(
    scene: &Scene,
    light: &Light,
    welded: &Welded,
    settings: &Settings,
    index: usize,
    mesh: &Mesh,
) -> CastingObject {
    let homogeneous = light.homogeneous();
    let corners = |triangle: u32| scene.triangles[triangle as usize].map(|v| welded.index_of_vertex[v as usize]);
    let faces: Vec<[u32; 3]> = mesh.triangles.clone().map(corners).collect();
    let open = edges_of(&faces).into_iter().enumerate().filter(|(_, edge)| !edge.is_balanced());
    let open_edges: Vec<OpenEdge> = open.map(|(id, edge)| OpenEdge { id, ends: [edge.low, edge.high] }).collect();
    let light_facing_only = match settings.caster_sides {
        CasterSides::LightFacing => true,
        CasterSides::All => false,
        CasterSides::Auto => {
            !settings.per_triangle && open_edges.is_empty() && sees_it_from_outside(scene, mesh, homogeneous)
        }
    };
    let (mut used, mut towards_light, mut turned_away) = (Vec::new(), Vec::new(), Vec::new());
    for triangle in mesh.triangles.clone() {
        let [a, b, c] = corners(triangle);
        match facing(scene, triangle, homogeneous) {
            Facing::Towards => {
                used.push(triangle);
                towards_light.push([a, b, c]);
            }
            Facing::Away => {
                turned_away.push([a, b, c]);
                if !light_facing_only {
                    used.push(triangle);
                    towards_light.push([a, c, b]);
                }
            }
            Facing::EdgeOn => {}
        }
    }
    let (centre_in_world, radius_m) = sphere_around(scene, &used);
    CastingObject {
        mesh: index,
        used,
        towards_light,
        turned_away,
        light_facing_only,
        open_edges,
        centre_in_world,
        radius_m,
    }
}

/// How the light sees a triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Facing {
    /// Its counter-clockwise side.
    Towards,
    /// Its other side.
    Away,
    /// Neither.
    EdgeOn,
}

/// How a homogeneous light sees a triangle. A triangle with a corner at the light is edge-on, whatever rounding says.
pub(super) fn facing(scene: &Scene, triangle: u32, light: DVec4) -> Facing {
    let side = scene.facing(triangle, light);
    let touches = || light.w != 0.0 && scene.triangle_in_world(triangle).contains(&light.truncate());
    if side == 0.0 || touches() {
        Facing::EdgeOn
    } else if side > 0.0 {
        Facing::Towards
    } else {
        Facing::Away
    }
}

/// Whether a closed mesh has the light outside, and the eye where no face is met from its back alone. What the eye sees
/// is on its side of all faces, so the receivers are where the eye is.
fn sees_it_from_outside(scene: &Scene, mesh: &Mesh, light: DVec4) -> bool {
    let around =
        |point: DVec3| winding_number(mesh.triangles.clone().map(|triangle| scene.triangle_in_world(triangle)), point);
    let light_is_outside = light.w == 0.0 || around(light.truncate()).abs() < OUTSIDE;
    light_is_outside && around(scene.camera.eye.as_dvec3()) > -OUTSIDE
}

fn sphere_around(scene: &Scene, triangles: &[u32]) -> (DVec3, f64) {
    let corners = || triangles.iter().flat_map(|&triangle| scene.triangle_in_world(triangle));
    let centre = crate::scene::Bounds::of(corners()).map_or(DVec3::ZERO, |bounds| bounds.centre());
    (centre, corners().map(|corner| corner.distance(centre)).fold(0.0, f64::max))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inspect::fixtures::{Shape, cube, scene_of};
    use crate::inspect::weld;
    use crate::scene::LightKind;
    use crate::technique::Spec;
    use glam::Vec3;

    fn objects(shapes: &[Shape], light: Vec3, typed: &str) -> Vec<CastingObject> {
        let mut scene = scene_of(shapes);
        scene.lights[0].kind = LightKind::Point { position: light, aim: Vec3::ZERO, attenuation: [1.0, 0.0, 0.0] };
        let settings = Settings::of(&Spec::parse(typed).unwrap());
        casting_objects(&scene, &scene.lights[0], &weld(&scene.positions), &settings)
    }

    fn open_cube() -> Shape {
        let mut shape = cube(DVec3::ZERO);
        shape.triangles.truncate(10);
        shape
    }

    #[test]
    fn closed_objects_need_one_side_and_open_ones_both() {
        let above = Vec3::new(0.3, 5.0, 0.4);
        let objects = objects(&[cube(DVec3::ZERO), open_cube()], above, "volume");
        assert!(objects[0].light_facing_only && !objects[1].light_facing_only);
        assert_eq!((objects[0].used.len(), objects[1].used.len()), (2, 10));
        assert_eq!((objects[0].open_edges.len(), objects[1].open_edges.len()), (0, 4));
    }

    #[test]
    fn a_light_inside_needs_all_triangles() {
        let inside = Vec3::splat(0.4);
        assert_eq!(objects(&[cube(DVec3::ZERO)], inside, "volume")[0].used.len(), 12);
        assert_eq!(objects(&[cube(DVec3::ZERO)], inside, "volume:caster_sides=light-facing")[0].used.len(), 0);
        let inverted = objects(&[cube(DVec3::ZERO).inverted()], inside, "volume");
        assert!(!inverted[0].light_facing_only);
    }

    #[test]
    fn a_triangle_with_a_corner_at_the_light_casts_nothing() {
        let at_a_corner = objects(&[cube(DVec3::ZERO)], Vec3::ZERO, "volume:caster_sides=all");
        assert_eq!(at_a_corner[0].used.len(), 6);
    }

    #[test]
    fn every_used_triangle_turns_towards_the_light() {
        let light = DVec3::new(0.3, 5.0, 0.4);
        let scene = scene_of(&[open_cube()]);
        for object in objects(&[open_cube()], light.as_vec3(), "volume") {
            let welded = weld(&scene.positions).positions(&scene.positions);
            for corners in object.towards_light {
                let [a, b, c] = corners.map(|v| welded[v as usize]);
                assert!((b - a).cross(c - a).dot(light - a) > 0.0);
            }
        }
    }
}
