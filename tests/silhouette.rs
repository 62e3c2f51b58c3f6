//! Silhouette maps: straight edges are followed between texel centres, far better than by a map of the same size and
//! better than by one of sixteen times the texels; what corners agree on is a map's answer, and outlines that the light
//! does not see leave nothing.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests fail by panicking")]

mod support;

use glam::Vec3;
use gnomon::cause::Cause;
use gnomon::evaluate::View;
use gnomon::mask::Mask;
use gnomon::scene::Scene;
use support::scenes::{ask, explained, gpu, judged, scene_of_texts, shipped, with_triangles};

const SIZE: [u32; 2] = [400, 300];
/// Pixels that rounding may put on the other side of an edge in such a picture.
const MOST_BY_PRECISION: u64 = 8;
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

/// SI-1: where the four corners agree, the point between them is of no consequence.
#[test]
fn agreeing_corners_answer_as_a_map_does() {
    let gpu = gpu();
    for (name, light) in [("torus", "sun"), ("polygons-69", "lamp"), ("room", "spot")] {
        let scene = shipped(name, SIZE);
        let view = View::new(&gpu, &scene).unwrap();
        let question = ask(&view, light);
        let answers = |typed: &str| judged(&view, &question, typed).mask.pixels;
        let outlined = answers("silhouette:size=255");
        // The same four texels, compared with the same bias; neither 0 nor 1 where they disagree.
        let agreeing = |map: &str| -> Vec<bool> {
            let pairs = outlined.iter().zip(answers(map)).filter_map(|(outlined, map)| outlined.zip(map));
            pairs.filter(|(_, map)| [0.0, 1.0].contains(&map.get())).map(|(outlined, map)| outlined == map).collect()
        };
        let same = agreeing("map:size=256,filter=pcf-box2");
        assert!(same.iter().all(|is_same| *is_same), "{name} {light}");
        assert!(2 * same.len() > outlined.iter().flatten().count(), "{name} {light}: {}", same.len());
        // Control: compared with another bias.
        assert!(
            !agreeing("map:size=256,filter=pcf-box2,bias=none").into_iter().all(|is_same| is_same),
            "{name} {light}"
        );
    }
}

/// What the device draws and answers is what its twin says, also in the smallest grids.
#[test]
fn every_error_is_explained() {
    let gpu = gpu();
    for (name, light) in [("torus", "lamp"), ("polygons-69", "lamp")] {
        let scene = shipped(name, SIZE);
        let view = View::new(&gpu, &scene).unwrap();
        let question = ask(&view, light);
        for size in [1, 2, 4, 7, 256] {
            let evaluation = explained(&view, &question, &format!("silhouette:size={size}"));
            let by_precision = evaluation.ledger.causes.get(&Cause::Precision).map_or(0, |share| share.pixels);
            println!("{name} {size}: {by_precision} of {} by precision", evaluation.verdict.pixels.wrong);
            assert!(by_precision <= MOST_BY_PRECISION, "{name} {size}: {by_precision}");
        }
    }
}

/// Either depth convention and every format choose the same corners: outlines are where they are, and the bias clears a
/// receiver's surface by more than any of them rounds.
#[test]
fn how_depth_is_stored_does_not_matter() {
    let (gpu, scene) = (gpu(), shipped("polygons-69", SIZE));
    let view = View::new(&gpu, &scene).unwrap();
    let question = ask(&view, "lamp");
    let mask = |typed: &str| judged(&view, &question, typed).mask;
    let usual = mask("silhouette");
    let differing = |other: &Mask| usual.pixels.iter().zip(&other.pixels).filter(|(a, b)| a != b).count();
    for convention in ["reversed", "forward"] {
        for format in ["depth32float", "depth24plus", "depth16unorm"] {
            let typed = format!("silhouette:format={format},depth_convention={convention}");
            assert_eq!(differing(&mask(&typed)), 0, "{typed}");
        }
    }
    // Control: what does matter.
    for other in ["size=64", "size=255", "bias=none"] {
        assert!(differing(&mask(&format!("silhouette:{other}"))) > 20, "{other}");
    }
}

/// A roof whose shadow ends on a plate below it, over a floor.
const ROOF_AND_PLATE: (&str, &str) = (
    "about = \"a roof whose shadow ends on a plate\"
size = [400, 300]
[camera]
eye = [3.1, 2.6, 0.4]
target = [0.0, 1.0, 0.1]
fov_y_deg = 50.0
[[mesh]]
file = \"model.obj\"
[[light]]
name = \"sun\"
kind = \"directional\"
direction = [0.05, -1.0, 0.03]
intensity = [1.0, 1.0, 1.0]
",
    "o Floor\nv -3 0 -3\nv -3 0 3\nv 3 0 3\nv 3 0 -3\nf 1 2 3 4
o Plate\nv -2 1 -2\nv -2 1 2\nv 2 1 2\nv 2 1 -2\nf 5 6 7 8
o Roof\nv -2 3 -2\nv -2 3 2\nv 0.07 3 2\nv -0.12 3 -2\nf 9 10 11 12
",
);

/// Needles under the roof's rim: too thin for any texel centre to meet, so that a map knows them by their outline alone.
fn with_needles(scene: &Scene, height_m: f32) -> Scene {
    const WIDTH_M: f32 = 1e-5;
    let needle = |i: i32| {
        let along = 0.23 * i as f32 + 0.011;
        let start = Vec3::new(-0.6, height_m, along - 0.3);
        [start, start + WIDTH_M * Vec3::Z, Vec3::new(0.6, height_m, along + 0.2)]
    };
    with_triangles(scene, &(-5..=5).map(needle).collect::<Vec<_>>())
}

#[test]
fn hidden_outlines_leave_no_points() {
    let (gpu, scene) = (gpu(), scene_of_texts(ROOF_AND_PLATE.0, ROOF_AND_PLATE.1));
    let mask = |scene: &Scene| -> Mask {
        let view = View::new(&gpu, scene).unwrap();
        let question = ask(&view, "sun");
        judged(&view, &question, "silhouette:size=64").mask
    };
    let bare = mask(&scene);
    let changed = |height_m: f32| {
        let other = mask(&with_needles(&scene, height_m));
        bare.pixels.iter().zip(&other.pixels).filter(|(a, b)| a != b).count()
    };
    assert_eq!(changed(0.5), 0, "the plate hides what is under it from the light");
    // Control: the same needles between roof and plate bend the rim's shadow, which passes through the same cells.
    assert!(changed(1.5) > 50, "{}", changed(1.5));
}
