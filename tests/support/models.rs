//! Scenes of which each shows one cause of error and almost nothing else.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

use super::scenes::scene_of_texts;
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
