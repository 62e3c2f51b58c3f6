//! What the integration tests and benches share: the shapes, scenes and random numbers of the ray core's own tests, and
//! more shapes.

#![allow(dead_code, reason = "every test uses its own share")]

use glam::{DVec3, Vec3};
use gnomon::scene;
use std::f64::consts::TAU;
use testing::{Random, Shape};

pub(crate) mod files;
pub(crate) mod ledger;
pub(crate) mod models;
pub(crate) mod outline;
pub(crate) mod penumbra;
pub(crate) mod scenes;
pub(crate) mod shot;
#[path = "../../src/cast/testing.rs"]
pub(crate) mod testing;
pub(crate) mod texels;

/// A torus around the y axis with a tube of radius 0.4 around a circle of radius 1; closed, as its seams coincide.
pub(crate) fn torus(around: u32, tube: u32) -> Shape {
    Shape::grid(around, tube, |i, j| {
        let (a, t) = (turn(i % around, around), turn(j % tube, tube));
        let radius = 1.0 + 0.4 * t.cos();
        DVec3::new(radius * a.cos(), 0.4 * t.sin(), radius * a.sin()).as_vec3()
    })
}

/// A spindle of long thin triangles, closed: each is hundreds of times as long as wide.
pub(crate) fn slivers(count: u32) -> Shape {
    let ring = (0..count).map(|i| DVec3::new(turn(i, count).cos(), 0.0, turn(i, count).sin()));
    let positions = ring.map(|p| (0.05 * p).as_vec3()).chain([2.0 * Vec3::Y, -2.0 * Vec3::Y]).collect();
    let cone = |pole: u32| (0..count).map(move |i| [i, (i + 1) % count, pole]);
    Shape { positions, triangles: cone(count).chain(cone(count + 1)).collect() }
}

/// The shape scaled, then moved, in f64, and rounded once.
pub(crate) fn placed(shape: &Shape, scale: f64, offset: DVec3) -> Shape {
    let place = |p: &Vec3| (scale * p.as_dvec3() + offset).as_vec3();
    Shape { positions: shape.positions.iter().map(place).collect(), triangles: shape.triangles.clone() }
}

/// An index less than `count`.
pub(crate) fn pick(random: &mut Random, count: usize) -> usize {
    (random.next() % count as u64) as usize
}

fn turn(i: u32, count: u32) -> f64 {
    TAU * f64::from(i) / f64::from(count)
}
