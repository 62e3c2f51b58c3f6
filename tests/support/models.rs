//! Scenes of which each shows one cause of error and almost nothing else.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

use super::scenes::scene_of_texts;
use glam::{DVec3, Vec3};
use gnomon::scene::Scene;
use std::fmt::Write;

/// A plate that hovers flat over a floor in a sun of some elevation, seen from straight above by a camera of some field
/// of view.
pub(crate) fn plate(elevation_deg: f64, fov_y_deg: f64) -> Scene {
    let elevation = elevation_deg.to_radians();
    let scene = format!(
        "about = \"a plate over a floor\"\nsize = [256, 192]\n\
         [camera]\neye = [1.2, 12, 0.9]\ntarget = [1.2, 0, 0.9]\nup = [0, 0, -1]\nfov_y_deg = {fov_y_deg}\n\
         [[mesh]]\nfile = \"model.obj\"\n\
         [[light]]\nname = \"sun\"\nkind = \"directional\"\ndirection = [{}, {}, {}]\n",
        0.8 * elevation.cos(),
        -elevation.sin(),
        0.6 * elevation.cos()
    );
    let model = "o Floor\nv -9 0 -9\nv -9 0 9\nv 9 0 9\nv 9 0 -9\nf 1 2 3 4\n\
                 o Plate\nv -0.93 0.4 -0.47\nv -0.41 0.4 0.98\nv 1.12 0.4 0.51\nv 0.57 0.4 -1.03\nf 5 6 7 8\n";
    scene_of_texts(&scene, model)
}

/// A sheet with 24 waves, each of 24 facets, under a sun that reaches all of it.
pub(crate) fn corrugated_sheet() -> Scene {
    const WAVES: u32 = 24;
    const STEPS: u32 = 24 * WAVES;
    let mut model = String::from("o Sheet\n");
    for i in 0..=STEPS {
        let x = 2.0 * f64::from(i) / f64::from(STEPS) - 1.0;
        let y = 0.03 * (std::f64::consts::PI * f64::from(WAVES) * x).cos();
        writeln!(model, "v {x} {y} -1\nv {x} {y} 1").unwrap();
    }
    for i in 0..STEPS {
        let first = 2 * i + 1;
        writeln!(model, "f {} {} {} {}", first, first + 1, first + 3, first + 2).unwrap();
    }
    let scene = "about = \"a corrugated sheet\"\nsize = [256, 192]\n\
                 [camera]\neye = [0, 3, 0]\ntarget = [0, 0, 0]\nup = [0, 0, -1]\nfov_y_deg = 30\n\
                 [[mesh]]\nfile = \"model.obj\"\n\
                 [[light]]\nname = \"sun\"\nkind = \"directional\"\ndirection = [0, -1, 0]\n";
    scene_of_texts(scene, &model)
}

/// A box's eight corners and six sides, wound outwards.
pub(crate) fn cuboid(model: &mut String, name: &str, centre: Vec3, half: Vec3, first: &mut u32) {
    writeln!(model, "o {name}").unwrap();
    for corner in 0..8 {
        let sign = |bit: u32| if corner >> bit & 1 == 0 { -1.0 } else { 1.0 };
        let at = centre + half * Vec3::new(sign(0), sign(1), sign(2));
        writeln!(model, "v {} {} {}", at.x, at.y, at.z).unwrap();
    }
    for side in [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]] {
        let [a, b, c, d] = side.map(|corner| corner + *first);
        writeln!(model, "f {a} {b} {c} {d}").unwrap();
    }
    *first += 8;
}

/// A lamp in a closed room with a small box in each of the six directions; the camera is in a corner.
pub(crate) fn closed_room(corner: f32) -> Scene {
    let (mut model, mut first) = (String::new(), 1);
    cuboid(&mut model, "Room", Vec3::new(0.1, 0.2, -0.1), Vec3::splat(3.0), &mut first);
    for (i, axis) in [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z].into_iter().enumerate() {
        cuboid(&mut model, &format!("Box{i}"), 1.2 * axis + Vec3::splat(0.13), Vec3::splat(0.21), &mut first);
    }
    let scene = format!(
        "about = \"a closed room\"\nsize = [160, 120]\n\
         [camera]\neye = [{0}, {0}, {0}]\ntarget = [0, 0, 0]\nfov_y_deg = 110\n\
         [[mesh]]\nfile = \"model.obj\"\n\
         [[light]]\nname = \"lamp\"\nkind = \"point\"\nposition = [0, 0, 0]\nintensity = [9, 9, 9]\n",
        2.6 * corner
    );
    scene_of_texts(&scene, &model)
}

/// A lamp in a closed room with boxes on the diagonals between the axes, so that their shadows cross the seams of maps
/// that are laid out along the axes.
pub(crate) fn boxes_on_diagonals() -> Scene {
    let (mut model, mut first) = (String::new(), 1);
    cuboid(&mut model, "Room", Vec3::new(0.8, -0.5, -0.6), Vec3::splat(3.0), &mut first);
    let mut i = 0;
    for a in [-1.0, 0.0, 1.0_f32] {
        for b in [-1.0, 1.0_f32] {
            for at in [Vec3::new(a, b, 1.0), Vec3::new(b, -1.0, a), Vec3::new(-1.0, a, b)] {
                cuboid(&mut model, &format!("Box{i}"), at, Vec3::new(0.11, 0.13, 0.12), &mut first);
                i += 1;
            }
        }
    }
    let scene = "about = \"boxes across seams\"\nsize = [240, 180]\n\
         [camera]\neye = [2.7, -1.4, -2.6]\ntarget = [-2, 0.5, 1.5]\nfov_y_deg = 100\n\
         [[mesh]]\nfile = \"model.obj\"\n\
         [[light]]\nname = \"lamp\"\nkind = \"point\"\nposition = [0, 0, 0]\nintensity = [9, 9, 9]\n";
    scene_of_texts(scene, &model)
}

/// A sphere of facets around the light, which lights all of it; the camera inside looks at a corner of the cube.
pub(crate) fn inside_a_sphere() -> Scene {
    const AROUND: usize = 48;
    let mut model = String::from("o Sphere\n");
    for ring in 0..=AROUND / 2 {
        let height = std::f64::consts::TAU * ring as f64 / AROUND as f64;
        for i in 0..AROUND {
            let turn = std::f64::consts::TAU * i as f64 / AROUND as f64;
            let at = 2.0 * DVec3::new(height.sin() * turn.cos(), height.cos(), height.sin() * turn.sin());
            writeln!(model, "v {} {} {}", at.x, at.y, at.z).unwrap();
        }
    }
    for ring in 0..AROUND / 2 {
        for i in 0..AROUND {
            let [a, b] = [i, (i + 1) % AROUND].map(|i| ring * AROUND + i + 1);
            writeln!(model, "f {a} {b} {} {}", b + AROUND, a + AROUND).unwrap();
        }
    }
    let scene = "about = \"a sphere around a lamp\"\nsize = [160, 120]\n\
         [camera]\neye = [-0.9, -0.9, -0.9]\ntarget = [0, 0, 0]\nfov_y_deg = 120\n\
         [[mesh]]\nfile = \"model.obj\"\n\
         [[light]]\nname = \"lamp\"\nkind = \"point\"\nposition = [0, 0, 0]\nintensity = [9, 9, 9]\n";
    scene_of_texts(scene, &model)
}
