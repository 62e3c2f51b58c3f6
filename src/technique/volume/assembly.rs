//! Volumes as vertices and index lists: sides along silhouettes, front caps, back caps. All faces are wound outward.
//!
//! Front caps are no new geometry: they are the scene's own corners in their own order, so that their depth equals the
//! scene's bit for bit. Those of triangles turned away from the light are therefore wound inward; they are listed
//! apart, to be drawn with front and back exchanged. Formulas: docs/volume.md#assembly.

use super::casting::{CastingObject, Facing, facing};
use super::extrude::{Reach, extrude};
use super::settings::{Extrude, Settings};
use super::silhouette::{SilhouetteEdge, silhouette};
use crate::scene::{Light, Scene};
use glam::{DVec3, DVec4};

/// A vertex of sides and back caps: homogeneous, rebased world. Where the vertex shader extrudes, the unmoved position
/// with w = 1 for a vertex that stays and w = 0 for one that moves.
pub(super) type VolumeVertex = [f32; 4];

/// What to assemble.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plan {
    /// Homogeneous light.
    pub(super) light: DVec4,
    /// How far volumes reach.
    pub(super) reach: Reach,
    /// One volume per triangle.
    pub(super) per_triangle: bool,
    /// Leave the extrusion to the vertex shader.
    pub(super) extrudes_on_gpu: bool,
    /// Close volumes with the triangles turned away from the light.
    pub(super) away_facing_back_cap: bool,
}

/// Index lists of some objects' volumes, three indices per triangle.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Faces {
    /// Sides, into the volume vertices.
    pub(super) sides: Vec<u32>,
    /// Back caps, into the volume vertices.
    pub(super) back_caps: Vec<u32>,
    /// Front caps of triangles that face the light, into the scene's corners.
    pub(super) front_caps: Vec<u32>,
    /// Front caps of triangles turned away from it, into the scene's corners, wound inward.
    pub(super) inward_front_caps: Vec<u32>,
    /// Whether front caps are drawn at all.
    pub(super) has_front_caps: bool,
    /// Whether back caps are.
    pub(super) has_back_caps: bool,
    /// Silhouette edges, each as often as it has sides.
    pub(super) silhouette_edges: u64,
}

impl Plan {
    /// The plan that settings ask for.
    pub(super) fn of(light: &Light, reach: Reach, settings: &Settings) -> Self {
        Self {
            light: light.homogeneous(),
            reach,
            per_triangle: settings.per_triangle,
            extrudes_on_gpu: settings.extrude != Extrude::Cpu,
            away_facing_back_cap: settings.away_facing_back_cap,
        }
    }

    /// A directional light's infinite volumes meet in one point: no back cap.
    pub(super) fn ends_in_a_point(&self) -> bool {
        self.light.w == 0.0 && self.reach == Reach::Infinite
    }

    /// Two vertices for each welded position: as it is, and extruded; behind them the one far point that the volumes of
    /// a directional light may end in.
    pub(super) fn vertices(&self, positions: &[DVec3]) -> Vec<VolumeVertex> {
        let pair = |position: &DVec3| {
            let near = position.as_vec3();
            let far = if self.extrudes_on_gpu { near.extend(0.0) } else { extrude(near, self.light, self.reach) };
            [near.extend(1.0).to_array(), far.to_array()]
        };
        let point = (-self.light.truncate()).as_vec3().extend(0.0).to_array();
        positions.iter().flat_map(pair).chain([point]).collect()
    }

    /// The faces of some objects; `vertex_count` is the number of welded positions.
    pub(super) fn faces<'o>(
        &self,
        scene: &Scene,
        objects: impl Iterator<Item = &'o CastingObject>,
        vertex_count: u32,
    ) -> Faces {
        let mut faces = Faces::default();
        for object in objects {
            for edge in self.edges(object) {
                for _ in 0..edge.times {
                    self.side(edge, vertex_count, &mut faces.sides);
                }
                faces.silhouette_edges += u64::from(edge.times);
            }
            for &triangle in &object.used {
                let corners = [3 * triangle, 3 * triangle + 1, 3 * triangle + 2];
                match facing(scene, triangle, self.light) {
                    Facing::Towards => faces.front_caps.extend(corners),
                    Facing::Away | Facing::EdgeOn => faces.inward_front_caps.extend(corners),
                }
            }
            if !self.ends_in_a_point() {
                faces.back_caps.extend(self.back_cap(object).into_iter().flatten().map(far));
            }
        }
        faces
    }

    /// The silhouette of one object, or of each of its triangles.
    pub(super) fn edges(&self, object: &CastingObject) -> Vec<SilhouetteEdge> {
        if self.per_triangle {
            object.towards_light.iter().flat_map(|&triangle| silhouette(&[triangle])).collect()
        } else {
            silhouette(&object.towards_light)
        }
    }

    /// The images of the casting triangles seen from behind. The alternative, the images of all others as they are, has
    /// the same outline on a closed mesh but winds around a light inside it.
    fn back_cap(&self, object: &CastingObject) -> Vec<[u32; 3]> {
        if self.away_facing_back_cap && object.light_facing_only {
            object.turned_away.clone()
        } else {
            object.towards_light.iter().map(|&[a, b, c]| [a, c, b]).collect()
        }
    }

    /// The side under an edge: towards the light's far end, outward. Its diagonal runs from the lower index's near
    /// vertex to the higher one's far vertex, so that volumes that share an edge share their sides.
    fn side(&self, edge: SilhouetteEdge, vertex_count: u32, sides: &mut Vec<u32>) {
        let (from, to) = (edge.from, edge.to);
        if self.ends_in_a_point() && !self.extrudes_on_gpu {
            sides.extend([near(to), near(from), 2 * vertex_count]);
        } else {
            sides.extend(quad(from, to).as_flattened());
        }
    }
}

/// The quad under an edge as two triangles.
pub(super) fn quad(from: u32, to: u32) -> [[u32; 3]; 2] {
    if from < to {
        [[near(to), near(from), far(to)], [near(from), far(from), far(to)]]
    } else {
        [[near(to), near(from), far(from)], [near(to), far(from), far(to)]]
    }
}

/// Index of a welded position as it is.
pub(super) fn near(welded: u32) -> u32 {
    2 * welded
}

/// Index of a welded position extruded.
pub(super) fn far(welded: u32) -> u32 {
    2 * welded + 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inspect::fixtures::{cube, scene_of, torus};
    use crate::inspect::{edges_of, weld};
    use crate::technique::Spec;
    use crate::technique::volume::casting::casting_objects;
    use crate::technique::volume::settings::Settings;

    /// The closed surface of an object's volume, front caps turned to the light, in volume indices.
    fn surface(plan: &Plan, objects: &[CastingObject], faces: &Faces) -> Vec<[u32; 3]> {
        let lists = faces.sides.iter().chain(&faces.back_caps).copied().collect::<Vec<_>>();
        let front = objects.iter().flat_map(|object| &object.towards_light).map(|corners| corners.map(near));
        assert!(plan.ends_in_a_point() == faces.back_caps.is_empty());
        lists.as_chunks::<3>().0.iter().copied().chain(front).collect()
    }

    #[test]
    fn every_volume_is_closed() {
        let mut open = torus(12, 6);
        open.triangles.truncate(100);
        let scene = scene_of(&[cube(DVec3::new(0.2, -3.0, 0.1)), open]);
        let welded = weld(&scene.positions);
        for typed in ["volume", "volume:shape=per-triangle", "volume:caster_sides=light-facing"] {
            for light in [DVec4::new(0.4, 5.0, 0.3, 1.0), DVec4::new(0.1, 0.9, 0.2, 0.0)] {
                for reach in [Reach::Infinite, Reach::Metres(2.0)] {
                    let settings = Settings::of(&Spec::parse(typed).unwrap());
                    let kind = if light.w == 0.0 {
                        crate::scene::LightKind::Directional { towards_light: light.truncate().as_vec3() }
                    } else {
                        scene.lights[0].kind
                    };
                    let light_in_scene = Light { kind, ..scene.lights[0].clone() };
                    let light = light_in_scene.homogeneous();
                    let objects = casting_objects(&scene, &light_in_scene, &welded, &settings);
                    let plan = Plan {
                        light,
                        reach,
                        per_triangle: settings.per_triangle,
                        extrudes_on_gpu: false,
                        away_facing_back_cap: false,
                    };
                    let faces = plan.faces(&scene, objects.iter(), welded.count);
                    let surface = surface(&plan, &objects, &faces);
                    assert!(edges_of(&surface).iter().all(|edge| edge.is_balanced()), "{typed} {light} {reach:?}");
                    assert!(!edges_of(&surface[1..]).iter().all(|edge| edge.is_balanced()), "control");
                }
            }
        }
    }

    #[test]
    fn the_diagonal_does_not_depend_on_the_direction() {
        let plan = Plan {
            light: DVec4::W,
            reach: Reach::Infinite,
            per_triangle: true,
            extrudes_on_gpu: false,
            away_facing_back_cap: false,
        };
        let (mut there, mut back) = (Vec::new(), Vec::new());
        plan.side(SilhouetteEdge { from: 3, to: 7, times: 1 }, 9, &mut there);
        plan.side(SilhouetteEdge { from: 7, to: 3, times: 1 }, 9, &mut back);
        let sorted = |list: &[u32]| {
            let mut triangles: Vec<[u32; 3]> = list.as_chunks::<3>().0.to_vec();
            triangles.iter_mut().for_each(|triangle| triangle.sort_unstable());
            triangles.sort_unstable();
            triangles
        };
        assert_eq!(sorted(&there), sorted(&back));
        assert_eq!(there.len(), 6);
    }
}
