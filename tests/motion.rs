//! Shimmering: a map that follows the camera flips where the truth does not; one that does not, and techniques without
//! texels, hardly do.

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
    let (fixed, following) = (of("map:size=128"), of("map:size=128,fit=receivers"));
    let exact = of("irregular");
    assert_eq!([fixed.of_camera.len(), fixed.of_light.len()], [STEPS as usize; 2]);
    // No texels, nothing to swim: at most a pixel that f32 decides.
    assert!(sum(&exact.of_camera) <= 2 && sum(&exact.of_light) <= 2, "{exact:?}");
    // Where the light moves, every map's texels do.
    assert!(sum(&fixed.of_light) > 20, "{fixed:?}");
    // Where the camera moves, only those of a map that follows it.
    assert!(sum(&following.of_camera) > sum(&fixed.of_camera), "{following:?} {fixed:?}");
    // A finer map shimmers less.
    assert!(2 * sum(&of("map:size=1024").of_light) < sum(&fixed.of_light));
}
