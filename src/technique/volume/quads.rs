//! Every edge of every caster as degenerate quads, of which the vertex shader unfolds those at the silhouette.
//!
//! M. McGuire, "Efficient Shadow Volume Rendering", GPU Gems, 2004: each vertex knows both triangles at its edge, and all
//! corners of a face that is not wanted fall into one point. The same buffers serve any light. Which triangles cast is
//! decided from the same numbers for every face, so that the volumes are closed whatever rounding does; with f32 it may
//! differ from the CPU's choice only for triangles that the light sees edge-on. Formulas: docs/volume.md#extrusion.

use super::assembly::{Faces, far, near, quad};
use super::casting::CastingObject;
use crate::inspect::{Welded, is_collapsed};
use crate::scene::Scene;
use bytemuck::{Pod, Zeroable};

/// One triangle that may be drawn: `Face` of `shaders/volume/quads.wgsl`.
///
/// Its weight is the sum over its two casters of `towards` where they face the light and `away` where they are turned
/// away from it. It is drawn if the weight's size exceeds `copy`, the other way round if the weight is negative.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub(super) struct Face {
    corners: [u32; 3],
    copy: i32,
    casters: [u32; 2],
    towards: [i32; 2],
    away: [i32; 2],
    padding: [u32; 2],
}

/// A caster's plane: `Caster` of `shaders/volume/quads.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub(super) struct Caster {
    normal_in_world: [f32; 3],
    /// Index of a corner among the volume vertices.
    corner: u32,
}

/// What may be drawn of some objects: faces wound outward, and front caps wound inward.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Quads {
    pub(super) outward: Vec<Face>,
    pub(super) inward: Vec<Face>,
}

/// One run of a triangle along an edge: lower and higher welded index, +1 from the lower to the higher, triangle id.
type EdgeRun = (u32, u32, i32, u32);

/// The casters of a scene, by triangle id.
pub(super) fn casters(scene: &Scene, welded: &Welded) -> Vec<Caster> {
    let caster = |(triangle, corners): (u32, &[u32; 3])| {
        let [a, b, c] = scene.triangle_in_world(triangle);
        let normal = (b - a).cross(c - a).normalize_or_zero();
        let corner = near(welded.index_of_vertex[corners[0] as usize]);
        Caster { normal_in_world: normal.as_vec3().to_array(), corner }
    };
    (0..).zip(&scene.triangles).map(caster).collect()
}

impl Quads {
    /// All that may be drawn of some objects; `wanted` says which caps.
    pub(super) fn new<'o>(
        scene: &Scene,
        welded: &Welded,
        objects: impl Iterator<Item = &'o CastingObject>,
        per_triangle: bool,
        wanted: &Faces,
    ) -> Self {
        let mut quads = Self::default();
        for object in objects {
            let casts_away = i32::from(!object.light_facing_only);
            let corners =
                |triangle: u32| scene.triangles[triangle as usize].map(|v| welded.index_of_vertex[v as usize]);
            let casting = scene.meshes[object.mesh].triangles.clone();
            let casting: Vec<u32> = casting.filter(|triangle| !is_collapsed(corners(*triangle))).collect();
            for runs in edge_runs(&casting, corners).chunk_by(|one, other| (one.0, one.1) == (other.0, other.1)) {
                quads.sides(runs, per_triangle, casts_away);
            }
            for &triangle in &casting {
                let [a, b, c] = corners(triangle);
                if wanted.has_back_caps {
                    quads.outward.push(Face::of_one([a, c, b].map(far), triangle, 1, -casts_away));
                }
                if wanted.has_front_caps {
                    quads.outward.push(Face::of_one([a, b, c].map(near), triangle, 1, 0));
                    quads.inward.extend((casts_away == 1).then(|| Face::of_one([a, b, c].map(near), triangle, 0, 1)));
                }
            }
        }
        quads
    }

    /// The quads under one edge: of both its triangles together, or of each alone where there are not two.
    fn sides(&mut self, runs: &[EdgeRun], per_triangle: bool, casts_away: i32) {
        match *runs {
            [(low, high, first, one), (_, _, second, other)] if !per_triangle => {
                // Opposite runs that cast on one side only never add up to two.
                let copies = if first != second && casts_away == 0 { 1 } else { 2 };
                let faces = (0..copies).flat_map(|copy| quad(low, high).map(|corners| (copy, corners)));
                self.outward.extend(faces.map(|(copy, corners)| Face {
                    copy,
                    casters: [one, other],
                    towards: [first, second],
                    away: [-first * casts_away, -second * casts_away],
                    ..Face::of_one(corners, one, 0, 0)
                }));
            }
            _ => self.outward.extend(runs.iter().flat_map(|&(low, high, run, triangle)| {
                quad(low, high).map(|corners| Face::of_one(corners, triangle, run, -run * casts_away))
            })),
        }
    }
}

impl Face {
    /// A face that depends on one triangle.
    fn of_one(corners: [u32; 3], triangle: u32, towards: i32, away: i32) -> Self {
        Self { corners, copy: 0, casters: [triangle; 2], towards: [towards, 0], away: [away, 0], padding: [0; 2] }
    }
}

fn edge_runs(triangles: &[u32], corners: impl Fn(u32) -> [u32; 3]) -> Vec<EdgeRun> {
    let of_triangle = |&triangle: &u32| {
        let [a, b, c] = corners(triangle);
        [(a, b), (b, c), (c, a)]
            .map(|(from, to)| (from.min(to), from.max(to), if from < to { 1 } else { -1 }, triangle))
    };
    let mut runs: Vec<EdgeRun> = triangles.iter().flat_map(of_triangle).collect();
    runs.sort_unstable();
    runs
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::layout::{rust_layout, wgsl_layout};
    use crate::inspect::fixtures::{cube, scene_of, torus};
    use crate::inspect::{edges_of, weld};
    use crate::technique::Spec;
    use crate::technique::volume::casting::{Facing, casting_objects, facing};
    use crate::technique::volume::pipelines::shader_modules;
    use crate::technique::volume::settings::Settings;
    use glam::DVec3;

    #[test]
    fn faces_lie_where_the_shader_reads_them() {
        let modules = shader_modules();
        let (_, files) = modules.iter().find(|(label, _)| label == "volume quads").unwrap();
        let face = rust_layout!(Face { corners, copy, casters, towards, away, padding });
        assert_eq!(wgsl_layout(files, "Face"), face);
        assert_eq!(wgsl_layout(files, "Caster"), rust_layout!(Caster { normal_in_world, corner }));
    }

    /// What the shader unfolds, corners in the order in which it draws them.
    fn unfolded(scene: &Scene, faces: &[Face]) -> Vec<[u32; 3]> {
        let light = scene.lights[0].homogeneous();
        let weight = |face: &Face| -> i32 {
            let of = |k: usize| match facing(scene, face.casters[k], light) {
                Facing::Towards => face.towards[k],
                Facing::Away => face.away[k],
                Facing::EdgeOn => 0,
            };
            of(0) + of(1)
        };
        let drawn = faces.iter().filter(|face| weight(face).abs() > face.copy);
        drawn.map(|face| if weight(face) < 0 { swapped(face.corners) } else { face.corners }).collect()
    }

    fn swapped([a, b, c]: [u32; 3]) -> [u32; 3] {
        [a, c, b]
    }

    #[test]
    fn what_unfolds_is_a_closed_volume_around_every_caster() {
        let mut open = torus(12, 6);
        open.triangles.truncate(100);
        let scene = scene_of(&[cube(DVec3::new(0.2, -3.0, 0.1)), open]);
        let welded = weld(&scene.positions);
        for typed in ["volume", "volume:shape=per-triangle", "volume:caster_sides=light-facing"] {
            let settings = Settings::of(&Spec::parse(typed).unwrap());
            let objects = casting_objects(&scene, &scene.lights[0], &welded, &settings);
            let wanted = Faces { has_front_caps: true, has_back_caps: true, ..Faces::default() };
            let quads = Quads::new(&scene, &welded, objects.iter(), settings.per_triangle, &wanted);
            let inward = unfolded(&scene, &quads.inward).into_iter().map(swapped);
            let surface: Vec<[u32; 3]> = unfolded(&scene, &quads.outward).into_iter().chain(inward).collect();
            assert!(!surface.is_empty() && edges_of(&surface).iter().all(|edge| edge.is_balanced()), "{typed}");
            let used: usize = objects.iter().map(|object| object.used.len()).sum();
            let caps = surface.iter().filter(|corners| corners.iter().all(|corner| corner % 2 == 0)).count();
            assert_eq!(caps, used, "{typed}");
        }
    }
}
