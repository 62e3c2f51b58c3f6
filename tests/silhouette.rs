//! Silhouette maps: straight edges are followed between texel centres, far better than by a map of the same size and
//! better than by one of sixteen times the texels; what corners agree on is a map's answer.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests fail by panicking")]

mod support;

use gnomon::evaluate::View;
use support::scenes::{ask, gpu, judged, shipped};

const SIZE: [u32; 2] = [400, 300];
/// Scenes whose shadow edges are images of mesh edges.
const STRAIGHT: [(&str, &str); 4] =
    [("triangle", "lamp"), ("triangle", "sun"), ("polygons-14", "lamp"), ("polygons-69", "lamp")];

#[test]
fn fewer_pixels_are_wrong_than_in_a_map_of_sixteen_times_the_texels() {
    let gpu = gpu();
    for (name, light) in STRAIGHT {
        let scene = shipped(name, SIZE);
        let view = View::new(&gpu, &scene).unwrap();
        let question = ask(&view, light);
        let wrong = |typed: &str| judged(&view, &question, typed).verdict.pixels.wrong;
        let [outlined, same, larger] = ["silhouette:size=256", "map:size=256", "map:size=1024"].map(wrong);
        println!("{name} {light}: silhouette {outlined}, map of that size {same}, of four times {larger}");
        assert!(outlined < larger, "{name} {light}: {outlined} against {larger}");
        assert!(10 * outlined <= same, "{name} {light}: {outlined} against {same}");
    }
}

#[test]
fn sizes_light_kinds_and_odd_pictures_are_answered() {
    let gpu = gpu();
    for size in [[1, 1], [101, 37]] {
        let scene = shipped("torus", size);
        let view = View::new(&gpu, &scene).unwrap();
        for light in ["lamp", "sun"] {
            let question = ask(&view, light);
            for typed in ["silhouette:size=1", "silhouette:size=2", "silhouette:size=101,depth_convention=forward"] {
                let pixels = judged(&view, &question, typed).verdict.pixels;
                assert_eq!(pixels.total, u64::from(size[0] * size[1]), "{typed}");
            }
        }
    }
}

/// Either depth convention, and depth of 24 bits, choose the same corners but where rounding decides.
#[test]
fn the_depth_convention_matters_little() {
    let (gpu, scene) = (gpu(), shipped("polygons-69", SIZE));
    let view = View::new(&gpu, &scene).unwrap();
    let question = ask(&view, "lamp");
    let mask = |typed: &str| judged(&view, &question, typed).mask;
    let (reversed, forward) = (mask("silhouette"), mask("silhouette:depth_convention=forward"));
    let differing =
        |other: &gnomon::mask::Mask| reversed.pixels.iter().zip(&other.pixels).filter(|(a, b)| a != b).count();
    assert!(differing(&forward) < 60, "{}", differing(&forward));
    assert!(differing(&mask("silhouette:size=64")) > 200, "another grid is another answer");
}
