//! Closed meshes must not leak: rays from inside, aimed exactly at vertices and at points on edges, along the axes,
//! with −0.0 in their direction, far from the origin and at scales from 10⁻⁶ to 10⁶. Random rays do not find leaks.

mod support;

use glam::DVec3;
use gnomon::cast::{Casters, brute};
use gnomon::scene::{Scene, Segment};
use parry3d_f64::query::{Ray, RayCast};
use parry3d_f64::shape::TriMesh;
use rayon::prelude::*;
use robust::{Coord3D, orient3d};
use support::testing::{Random, Shape, scene_of};
use support::{pick, placed, slivers, torus};

/// Rays per mesh and kind, over all placements.
const RAYS: usize = 100_000;
/// Scale and offset; with an offset the mesh is large enough that rounding its corners to f32 leaves it its shape.
const PLACEMENTS: [(f64, DVec3); 5] = [
    (1.0, DVec3::ZERO),
    (1e-6, DVec3::ZERO),
    (1e6, DVec3::ZERO),
    (10.0, DVec3::new(1e4, -1e4, 1e4)),
    (100.0, DVec3::new(-1e6, 1e6, 1e6)),
];
/// Rays end this many times as far from their start as the point they are aimed at; a power of two, so that the sum
/// is exact and the ray passes the point exactly.
const BEYOND: f64 = 64.0;
/// Starts lie this close to the middle of a mesh, before scaling: inside even the thinnest.
const JITTER: f64 = 0.01;

/// A closed mesh and a point well inside it.
struct Closed {
    name: &'static str,
    shape: Shape,
    inside: DVec3,
}

fn closed_meshes() -> [Closed; 4] {
    [
        Closed { name: "icosphere", shape: Shape::icosphere(1), inside: DVec3::ZERO },
        Closed { name: "torus", shape: torus(12, 8), inside: DVec3::X },
        Closed { name: "star", shape: Shape::star(2, &mut Random(3)), inside: DVec3::ZERO },
        Closed { name: "slivers", shape: slivers(60), inside: DVec3::ZERO },
    ]
}

/// A mesh somewhere, ready to be shot at.
struct Target {
    scene: Scene,
    casters: Casters,
    scale: f64,
    inside: DVec3,
}

impl Target {
    fn new(mesh: &Closed, (scale, offset): (f64, DVec3)) -> Self {
        let scene = scene_of(&[placed(&mesh.shape, scale, offset)], glam::Vec3::Y);
        Self { casters: Casters::new(&scene), scene, scale, inside: scale * mesh.inside + offset }
    }

    /// A start inside, on the f32 grid so that sums with corners are exact.
    fn start(&self, random: &mut Random) -> DVec3 {
        (self.inside + self.scale * JITTER * random.in_cube()).as_vec3().as_dvec3()
    }

    fn corners(&self, random: &mut Random) -> [DVec3; 3] {
        self.scene.triangle_in_world(pick(random, self.scene.triangles.len()) as u32)
    }
}

/// A ray of one kind, from inside unless it says otherwise; all must be blocked.
type Aim = fn(&Target, &mut Random) -> Segment;

fn through(from: DVec3, point: DVec3) -> Segment {
    Segment { from, to: BEYOND * point - (BEYOND - 1.0) * from }
}

fn at_vertex(target: &Target, random: &mut Random) -> Segment {
    through(target.start(random), target.corners(random)[0])
}

fn at_edge(target: &Target, random: &mut Random) -> Segment {
    let [a, b, _] = target.corners(random);
    through(target.start(random), a + (b - a) * (pick(random, 1025) as f64 / 1024.0))
}

/// Beside the edge by a rounding error, on either side.
fn near_edge(target: &Target, random: &mut Random) -> Segment {
    let [a, b, _] = target.corners(random);
    let from = target.inside + target.scale * JITTER * random.in_cube();
    let point = a.lerp(b, random.unit());
    Segment { from, to: from + (point - from) * (BEYOND * (1.0 + random.unit())) }
}

fn along_axis(target: &Target, random: &mut Random) -> Segment {
    let axis = DVec3::AXES[pick(random, 3)] * if random.unit() < 0.5 { 1.0 } else { -1.0 };
    // Every line through a corner meets the triangles around it, so this ray may come from outside.
    let through_corner = random.unit() < 0.5;
    let middle = if through_corner { target.corners(random)[1] } else { target.start(random) };
    let reach = axis * (BEYOND * target.scale);
    Segment { from: if through_corner { middle - reach } else { middle }, to: middle + reach }
}

/// Within a plane through the middle of the mesh, across which the direction is −0.0 where the plane is at 0.
fn with_negative_zero(target: &Target, random: &mut Random) -> Segment {
    let axis = pick(random, 3);
    let (mut from, mut along) = (target.start(random), random.in_cube());
    (from[axis], along[axis]) = (target.inside[axis], 0.0);
    let mut to = target.inside + BEYOND * target.scale * along.normalize();
    to[axis] = if from[axis] == 0.0 { -0.0 } else { from[axis] };
    Segment { from, to }
}

const AIMS: [(&str, Aim); 5] = [
    ("vertex", at_vertex),
    ("edge", at_edge),
    ("near edge", near_edge),
    ("axis", along_axis),
    ("negative zero", with_negative_zero),
];

/// `count` rays, the same at every run.
fn rays(target: &Target, aim: Aim, count: usize) -> impl ParallelIterator<Item = Segment> {
    (0..count as u64).into_par_iter().map(move |i| aim(target, &mut Random(i)))
}

#[test]
fn closed_meshes_do_not_leak_and_agree_with_brute_force() {
    for mesh in closed_meshes() {
        for placement in PLACEMENTS {
            let target = Target::new(&mesh, placement);
            for (kind, aim) in AIMS {
                let failures = rays(&target, aim, RAYS / PLACEMENTS.len()).filter(|segment| {
                    let exact = target.casters.any_hit(segment, None).is_some();
                    !exact || exact != brute::any_hit(&target.scene, segment, None).is_some()
                });
                assert_eq!(failures.count(), 0, "{} {kind} {placement:?}", mesh.name);
            }
        }
    }
}

#[test]
fn the_nearest_and_all_hits_agree_with_brute_force() {
    for mesh in closed_meshes() {
        for placement in PLACEMENTS {
            let target = Target::new(&mesh, placement);
            for (kind, aim) in AIMS {
                let differing = rays(&target, aim, 500).filter(|segment| {
                    let mut hits = Vec::new();
                    target.casters.all_hits(segment, None, &mut hits);
                    hits != brute::all_hits(&target.scene, segment, None)
                        || target.casters.nearest_hit(segment, None) != hits.first().copied()
                });
                assert_eq!(differing.count(), 0, "{} {kind} {placement:?}", mesh.name);
            }
        }
    }
}

/// parry computes in rounded f64, its own error: a verdict that is ours as soon as the ray moves this far, relative to the
/// mesh, is not held against it.
const PARRY_ERROR: f64 = 1e-9;

#[test]
fn any_hit_agrees_with_parry_outside_its_error() {
    let random: Aim = |target, random| {
        let mut point = || target.inside + 2.0 * target.scale * random.in_cube();
        Segment { from: point(), to: point() }
    };
    for mesh in closed_meshes() {
        for placement in PLACEMENTS {
            let target = Target::new(&mesh, placement);
            let vertices = target.scene.positions.iter().map(|p| p.as_dvec3().to_array().into()).collect();
            let parry = TriMesh::new(vertices, target.scene.triangles.clone()).unwrap();
            let blocked = |segment: &Segment| {
                let [origin, along] = [segment.from, segment.to - segment.from].map(|v| v.to_array().into());
                parry.intersects_local_ray(&Ray::new(origin, along), 1.0)
            };
            let agrees = |segment: &Segment, ours: bool| {
                let moves = DVec3::AXES.into_iter().flat_map(|axis| [axis, -axis]);
                let mut moved = moves.map(|axis| axis * PARRY_ERROR * target.scale);
                moved.any(|by| blocked(&Segment { from: segment.from + by, to: segment.to + by }) == ours)
            };
            for (kind, aim) in AIMS.into_iter().chain([("random", random)]) {
                let count = RAYS / PLACEMENTS.len() / 2;
                let ours = |segment: &Segment| target.casters.any_hit(segment, None).is_some();
                let differing: Vec<_> =
                    rays(&target, aim, count).filter(|segment| blocked(segment) != ours(segment)).collect();
                let wrong = differing.iter().filter(|segment| !agrees(segment, ours(segment)));
                assert_eq!(wrong.count(), 0, "{} {kind} {placement:?}", mesh.name);
                assert!(differing.len() < count / 10, "{} {kind} {placement:?}", mesh.name);
            }
        }
    }
}

#[test]
fn a_missing_triangle_leaks() {
    for mesh in closed_meshes() {
        let target = Target::new(&mesh, PLACEMENTS[0]);
        let hole = target.scene.triangle_in_world(0);
        let mut scene = target.scene.clone();
        scene.triangles.remove(0);
        scene.meshes[0].triangles.end -= 1;
        let open = Casters::new(&scene);
        let mut random = Random(11);
        let leaks = (0..1000).filter(|_| {
            let (u, v) = (0.5 * random.unit(), 0.5 * random.unit());
            let segment =
                through(target.start(&mut random), hole[0] + (hole[1] - hole[0]) * u + (hole[2] - hole[0]) * v);
            assert!(target.casters.any_hit(&segment, None).is_some());
            open.any_hit(&segment, None).is_none()
        });
        assert!(leaks.count() > 900, "{}", mesh.name);
    }
}

/// The definition of a crossing with the edges left out of the triangle, which is the mistake this file looks for.
fn crosses_strictly(segment: &Segment, [a, b, c]: [DVec3; 3]) -> bool {
    let side = |points: [DVec3; 4]| {
        let [a, b, c, d] = points.map(|v| Coord3D { x: v.x, y: v.y, z: v.z });
        orient3d(a, b, c, d)
    };
    let &Segment { from: p, to: q } = segment;
    let edges = [side([p, q, a, b]), side([p, q, b, c]), side([p, q, c, a])];
    side([a, b, c, p]) * side([a, b, c, q]) < 0.0
        && (edges.iter().all(|&edge| edge > 0.0) || edges.iter().all(|&edge| edge < 0.0))
}

#[test]
fn a_test_without_its_edges_leaks_on_these_rays() {
    for mesh in closed_meshes() {
        let target = Target::new(&mesh, PLACEMENTS[0]);
        let triangles: Vec<_> = target.scene.casting_triangles().map(|t| target.scene.triangle_in_world(t)).collect();
        for (kind, aim) in [AIMS[0], AIMS[1]] {
            let leaks = rays(&target, aim, 1000)
                .filter(|segment| !triangles.iter().any(|&corners| crosses_strictly(segment, corners)));
            // Most rays inside the torus are stopped by its own bend before they come to where they are aimed.
            assert!(leaks.count() > 50, "{} {kind}: the rays do not pass exactly where they are aimed", mesh.name);
        }
    }
}
