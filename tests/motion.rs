//! Shimmering: a map's staircase flips where the true edge does not, the less the finer it is; a map that keeps to the
//! world flips at no point of it, however the camera moves; a technique without texels flips nowhere.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests fail by panicking")]

mod support;

use gnomon::evaluate::{Flips, Followed, View, flips};
use gnomon::technique::Spec;
use gnomon::watch::Unwatched;
use support::scenes::{ask, gpu, shipped};

const STEPS: u32 = 3;

/// The flips of each specification on `torus` under its sun.
fn of_torus<const N: usize>(specs: [&str; N]) -> [Flips; N] {
    let (gpu, scene) = (gpu(), shipped("torus", [200, 150]));
    let view = View::new(&gpu, &scene).unwrap();
    let question = ask(&view, "sun");
    specs.map(|typed| {
        let found = flips(&view, &question, &Spec::parse(typed).unwrap(), STEPS, &Unwatched).unwrap();
        println!("{typed}: camera {:?}, light {:?}", found.of_camera, found.of_light);
        assert_eq!([found.of_camera.len(), found.of_light.len()], [STEPS as usize; 2]);
        found
    })
}

fn sum(counts: &[u64]) -> u64 {
    counts.iter().sum()
}

#[test]
fn texels_that_swim_shimmer_and_exact_edges_do_not() {
    let [coarse, fine, exact, volume] =
        of_torus(["map:size=128,fit=receivers", "map:size=4096,fit=receivers", "irregular", "volume"]);
    assert_eq!(
        [coarse.followed, exact.followed, volume.followed],
        [Followed::Points, Followed::Points, Followed::Pixels]
    );
    // No texels, nothing to flip: at most a pixel that f32 decides.
    for exact in [exact, volume] {
        assert!(sum(&exact.of_camera) <= 2 && sum(&exact.of_light) <= 2, "{exact:?}");
    }
    assert!(sum(&coarse.of_light) > 20 && sum(&coarse.of_camera) > 20, "{coarse:?}");
    assert!(2 * sum(&fine.of_light) < sum(&coarse.of_light), "{fine:?} {coarse:?}");
    assert!(2 * sum(&fine.of_camera) < sum(&coarse.of_camera), "{fine:?} {coarse:?}");
}

/// The slices of the view are typed: by themselves they would follow the nearest receiver.
const SLICES: &str = "map:size=128,projection=cascaded,min_distance_m=1,max_distance_m=20";

#[test]
fn a_map_that_keeps_to_the_world_flips_at_no_point_of_it() {
    let one = format!("{SLICES},cascades=1");
    let (stable, tight) = (format!("{one},cascade_fit=sphere"), format!("{one},cascade_fit=box"));
    let [whole_scene, stable, tight] = of_torus(["map:size=128", &stable, &tight]);
    assert_eq!(whole_scene.of_camera, vec![0; STEPS as usize]);
    assert_eq!(sum(&stable.of_camera), 0, "{stable:?}");
    // Control: a window that follows the camera by less than a texel.
    assert!(sum(&tight.of_camera) > 20, "{tight:?}");
    // The light's own steps turn every grid.
    assert!(sum(&whole_scene.of_light) > 20 && sum(&stable.of_light) > 20, "{whole_scene:?} {stable:?}");
}
