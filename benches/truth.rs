//! How fast the exact ray core is: shadow rays of a point light on the kitchen (or on a generated scene of as many
//! triangles where the kitchen was not fetched), in one run with obvhs's own single-precision any-hit query and its
//! bundled triangle test. Rates vary from machine to machine; the ratio is what counts.

#![allow(clippy::print_stdout, reason = "a bench prints its table")]

#[path = "../tests/support/mod.rs"]
mod support;

use glam::{DVec3, Vec3, Vec3A};
use gnomon::cast::{Casters, Occlusion};
use gnomon::scene::{Scene, Segment};
use obvhs::BvhBuildParams;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2_from_tris;
use obvhs::ray::Ray;
use obvhs::triangle::Triangle;
use std::hint::black_box;
use std::time::{Duration, Instant};
use support::placed;
use support::testing::{Random, Shape, scene_of};

const KITCHEN: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/kitchen/kitchen.obj");
/// Width and height of the picture whose pixels are the receivers.
const PIXELS: u32 = 512;
/// Each query is timed this often, in turn, and its best time counts.
const ROUNDS: u32 = 9;
/// The single-precision query starts this share of the extent off the surface; without it it hits its own triangle.
const OFFSET: f64 = 1e-5;

/// One shadow ray: exact, and as obvhs takes it.
struct ShadowRay {
    own: u32,
    segment: Segment,
    single: Ray,
}

fn main() {
    let (name, shape) = match load(KITCHEN) {
        Ok(shape) => ("kitchen", shape),
        Err(_) => ("60 000 generated triangles", generated()),
    };
    let scene = scene_of(&[shape], Vec3::ZERO);
    let start = Instant::now();
    let casters = Casters::new(&scene);
    println!("{name}: {} triangles, prepared in {:.0} ms", scene.triangles.len(), start.elapsed().as_secs_f64() * 1e3);

    let rays = shadow_rays(&scene, &casters);
    let (bvh, triangles) = single_precision(&scene);
    let exact = |ray: &ShadowRay| casters.any_hit(&ray.segment, Some(ray.own)).is_some();
    let radius_m = 1e-15 * scene.extent_m();
    let truth = |ray: &ShadowRay| casters.occlusion(&ray.segment, Some(ray.own), radius_m) == Occlusion::Blocked;
    let single = |ray: &ShadowRay| !bvh.ray_traverse_miss(ray.single, |r, id| triangles[id].intersect(r));

    let mut best = [Duration::MAX; 3];
    for _ in 0..ROUNDS {
        let times = [time(&rays, exact), time(&rays, truth), time(&rays, single)];
        best = std::array::from_fn(|i| best[i].min(times[i]));
    }
    let rate = best.map(|time| rays.len() as f64 / time.as_secs_f64() / 1e6);
    let differing = rays.iter().filter(|ray| exact(ray) != single(ray)).count();
    let blocked = rays.iter().filter(|ray| exact(ray)).count();
    println!("{} shadow rays, {blocked} blocked; single precision decides {differing} otherwise", rays.len());
    println!("{:<42} {:>7.2} Mray/s {:>6}", "obvhs ray_traverse_miss, single precision", rate[2], "1.00");
    println!("{:<42} {:>7.2} Mray/s {:>6.2}", "Casters::any_hit, exact", rate[0], rate[0] / rate[2]);
    println!("{:<42} {:>7.2} Mray/s {:>6.2}", "Casters::occlusion, exact and robust", rate[1], rate[1] / rate[2]);
}

fn time(rays: &[ShadowRay], blocked: impl Fn(&ShadowRay) -> bool) -> Duration {
    let start = Instant::now();
    black_box(rays.iter().filter(|ray| blocked(ray)).count());
    start.elapsed()
}

fn load(path: &str) -> Result<Shape, tobj::LoadError> {
    let (models, _) = tobj::load_obj(path, &tobj::LoadOptions { triangulate: true, ..Default::default() })?;
    let corners: Vec<[Vec3; 3]> = models.iter().flat_map(|model| triangles_of(&model.mesh)).collect();
    Ok(Shape::soup(&corners))
}

fn triangles_of(mesh: &tobj::Mesh) -> impl Iterator<Item = [Vec3; 3]> {
    let position = |v: u32| DVec3::from_slice(&mesh.positions[3 * v as usize..]).as_vec3();
    mesh.indices.as_chunks::<3>().0.iter().map(move |corners| corners.map(position))
}

/// Spheres scattered in a room over a floor.
fn generated() -> Shape {
    let mut random = Random(7);
    let sphere = Shape::icosphere(3);
    let spheres = (0..47).map(|_| placed(&sphere, 0.1 + 0.2 * random.unit(), 2.0 * random.in_cube()));
    let floor = Shape::grid(1, 1, |i, j| Vec3::new(6.0 * i as f32 - 3.0, -2.5, 6.0 * j as f32 - 3.0));
    let corners = |shape: Shape| shape.triangles.into_iter().map(move |t| t.map(|v| shape.positions[v as usize]));
    Shape::soup(&spheres.chain([floor]).flat_map(corners).collect::<Vec<_>>())
}

/// The shadow rays of a picture of the scene from inside its box, lit from under its ceiling.
fn shadow_rays(scene: &Scene, casters: &Casters) -> Vec<ShadowRay> {
    let (bounds, extent_m) = (scene.bounds(), scene.extent_m());
    let at = |share: DVec3| bounds.min + share * (bounds.max - bounds.min);
    let (eye, light) = (at(DVec3::new(0.8, 0.7, 0.8)), at(DVec3::new(0.5, 0.9, 0.45)));
    let forward = (bounds.centre() - eye).normalize();
    let right = forward.cross(DVec3::Y).normalize();
    let up = right.cross(forward);
    let centre = |i: u32| (f64::from(i) + 0.5) / f64::from(PIXELS) * 2.0 - 1.0;
    let pixels = (0..PIXELS).flat_map(|y| (0..PIXELS).map(move |x| (x, y)));
    let receivers = pixels.filter_map(|(x, y)| {
        let to = eye + (forward + centre(x) * right - centre(y) * up) * (4.0 * extent_m);
        let hit = casters.nearest_hit(&Segment { from: eye, to }, None)?;
        Some((hit.triangle, eye + hit.t * (to - eye)))
    });
    let facing = receivers.filter_map(|(own, from)| {
        let normal = scene.triangle_normal(own).normalize();
        let normal = if normal.dot(eye - from) < 0.0 { -normal } else { normal };
        (normal.dot(light - from) > 0.0).then(|| (own, from, from + OFFSET * extent_m * normal))
    });
    facing
        .map(|(own, from, beside)| ShadowRay {
            own,
            segment: Segment { from, to: light },
            single: single_ray(beside, light),
        })
        .collect()
}

fn single_ray(from: DVec3, to: DVec3) -> Ray {
    let along = to - from;
    Ray::new(from.as_vec3a(), along.normalize().as_vec3a(), 0.0, along.length() as f32)
}

/// What obvhs makes of the scene, triangles in the order of its leaves.
fn single_precision(scene: &Scene) -> (Bvh2, Vec<Triangle>) {
    let corners = (0..scene.triangles.len() as u32).map(|t| scene.triangle_in_world(t).map(|v| v.as_vec3a()));
    let triangles: Vec<_> = corners.map(|[v0, v1, v2]: [Vec3A; 3]| Triangle { v0, v1, v2 }).collect();
    let bvh = build_bvh2_from_tris(&triangles, BvhBuildParams::medium_build(), &mut Duration::default());
    let ordered = bvh.primitive_indices.iter().map(|&i| triangles[i as usize]).collect();
    (bvh, ordered)
}
