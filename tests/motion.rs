//! Shimmering: a map's staircase flips pixels where the true edge does not, the less the finer it is; a technique without
//! texels flips none.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests fail by panicking")]

mod support;

use gnomon::evaluate::{Flips, flips};
use gnomon::technique::Spec;
use gnomon::watch::Unwatched;
use support::scenes::{gpu, shipped};

const STEPS: u32 = 3;

#[test]
fn texels_that_swim_shimmer_and_exact_edges_do_not() {
    let (gpu, scene) = (gpu(), shipped("torus", [200, 150]));
    let sun = scene.light("sun").unwrap();
    let of = |typed: &str| -> Flips {
        let found = flips(&gpu, &scene, sun, &Spec::parse(typed).unwrap(), STEPS, &Unwatched).unwrap();
        println!("{typed}: camera {:?}, light {:?}", found.of_camera, found.of_light);
        found
    };
    let sum = |counts: &[u64]| counts.iter().sum::<u64>();
    let (coarse, fine, exact) = (of("map:size=128"), of("map:size=4096"), of("irregular"));
    assert_eq!([coarse.of_camera.len(), coarse.of_light.len()], [STEPS as usize; 2]);
    // No texels, nothing to flip: at most a pixel that f32 decides.
    assert!(sum(&exact.of_camera) <= 2 && sum(&exact.of_light) <= 2, "{exact:?}");
    assert!(sum(&coarse.of_light) > 20 && sum(&coarse.of_camera) > 20, "{coarse:?}");
    assert!(2 * sum(&fine.of_light) < sum(&coarse.of_light), "{fine:?} {coarse:?}");
    assert!(2 * sum(&fine.of_camera) < sum(&coarse.of_camera), "{fine:?} {coarse:?}");
}
