//! The other commands, each doing what it is for.

use crate::support::{MODEL, gnomon_in, runs, scene_in_temp, tree, typed};
use serde_json::Value;
use std::fs;
use tempfile::TempDir;

#[test]
fn render_draws_the_scene_with_exact_shadows_or_a_techniques() {
    let folder = scene_in_temp();
    let draw = |args: &[&str]| {
        gnomon_in(folder.path(), &[&["render", "scene"], args].concat()).returns(0).says(&["wrote "]);
        image::open(folder.path().join(args.last().unwrap())).unwrap()
    };
    let exact = draw(&["-o", "exact.png"]);
    assert_eq!((exact.width(), exact.height()), (64, 48));
    let coarse = draw(&["-t", "map:size=8,bias=none", "-o", "coarse.png"]);
    assert!(exact != coarse, "a map of 8 texels shows");
    let one_light = draw(&["--light", "sun", "-o", "sun.png"]);
    assert!(exact != one_light, "the lamp lights something");
    assert_eq!(draw(&["--size", "32x24", "-o", "small.exr"]).width(), 32);
}

#[test]
fn the_truth_judged_is_right_and_a_mask_is_as_wrong_as_check_says() {
    let folder = scene_in_temp();
    let run = |args: &[&str]| gnomon_in(folder.path(), &[args, &["scene", "--light", "lamp"]].concat());
    let technique = "map:size=48,bias=none";
    let judged = |file: &str| {
        let args = ["judge", "scene", file, "--light", "lamp", "--out", "judged"];
        gnomon_in(folder.path(), &args).returns(0).says(&["scene / lamp"]);
        runs(&folder.path().join("judged"))[0]["pixels"].clone()
    };
    run(&["check", "-t", technique, "--out", "checked"]).returns(0);
    let checked: Value = runs(&folder.path().join("checked"))[0]["pixels"].clone();
    assert!(checked["wrong"].as_u64().unwrap() > 10, "{checked}");
    for format in ["png", "exr"] {
        run(&["truth", "-o", &format!("truth.{format}")]).returns(0);
        run(&["mask", "-t", technique, "-o", &format!("mask.{format}")]).returns(0);
        let truth = judged(&format!("truth.{format}"));
        assert_eq!((&truth["wrong"], &truth["differing"]), (&0.into(), &0.into()));
        assert_eq!(judged(&format!("mask.{format}")), checked, "{format}");
    }
    assert_eq!(tree(&folder.path().join("judged")), ["report.json", "scene.lamp.0.error.png"]);
}

#[test]
fn masks_hold_visibility_and_what_was_asked() {
    let folder = scene_in_temp();
    gnomon_in(folder.path(), &["truth", "scene", "--light", "sun", "-o", "t.png"]).returns(0);
    let mask = image::open(folder.path().join("t.png")).unwrap().into_luma_alpha8();
    assert_eq!((mask.width(), mask.height()), (64, 48));
    let has = |grey: u8, alpha: u8| mask.pixels().any(|pixel| pixel.0 == [grey, alpha]);
    assert!(has(0, 255) && has(255, 255) && has(0, 0), "shadow, light and what nobody asked");
    assert_eq!(mask.get_pixel(0, 0).0[1], 0, "the sky is not asked");
}

#[test]
fn inspect_tells_what_a_scene_requires_and_what_to_expect() {
    let call = typed("inspect scenes/pipe --size 32x24").returns(0);
    call.says(&["Pipe", "closed", "camera near, far", "infinite", "not applicable: the receivers span"]);
    let call = typed("inspect scenes/torus -t map:size=512 --light sun --size 32x24").returns(0);
    let call = call.says(&["light 'sun' (directional)", "light near, far", "texel in pixels, m min", "terminator"]);
    assert_eq!(call.after("next step:"), "gnomon check scenes/torus --light sun --size 32x24 -t map:size=512");
}

#[test]
fn explain_tells_wrong_pixels_from_right_ones_and_from_the_background() {
    let explain = |pixel: &str| {
        typed(&format!("explain scenes/torus -t map:size=64,bias=none --light lamp --size 64x48 --pixel {pixel}"))
            .returns(0)
    };
    explain("0,0").says(&["background"]);
    // The rim of the torus below its hole, and the floor in front of it.
    let wrong = typed("diagnose scenes/torus -t map:size=64,bias=none --light lamp --size 64x48").returns(0);
    let pixel = wrong.after("e.g. at").split_whitespace().next().unwrap().to_owned();
    let call = explain(&pixel).says(&[
        "receiver ",
        "occluder ",
        "truth ",
        "stages ",
        "texel ",
        "verdict: wrong by -1.0000: acne:",
    ]);
    assert!(call.after("next step:").starts_with("gnomon diagnose scenes/torus -t map:size=64,bias=none --light lamp"));
    explain("32,46").says(&["verdict: right"]);
}

#[test]
fn diagnose_tries_fixes_and_names_the_best() {
    let call = typed("diagnose scenes/torus -t map:size=64,bias=none --light lamp --size 64x48").returns(0);
    let call = call.says(&[
        "acne: ",
        "tried bias none → closed-form: acne ",
        " → 0 px",
        "biases compared:",
        "best fix tried: ",
    ]);
    assert!(call.after("look closer:").contains("--size 64x48 --pixel "), "a pixel belongs to a size");
    assert_eq!(call.after("next step:").split(" -t ").next(), Some("gnomon check scenes/torus"));
    typed("diagnose scenes/pipe -t map --size 16x12").returns(0).says(&["not applicable: "]);
}

#[test]
fn scaffold_writes_the_scene_that_check_would_use_and_never_overwrites() {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("model.obj"), MODEL).unwrap();
    gnomon_in(folder.path(), &["scaffold", "model.obj"]).returns(0).says(&["wrote ", "next step: gnomon check ."]);
    let written = fs::read_to_string(folder.path().join("scene.toml")).unwrap();
    assert!(written.contains("model.obj"), "{written}");
    gnomon_in(folder.path(), &["check", ".", "-t", "map:size=8", "--size", "16x12"]).returns(0);
    gnomon_in(folder.path(), &["scaffold", "model.obj"]).returns(2).complains(&["scene.toml", "already"]);
    assert_eq!(fs::read_to_string(folder.path().join("scene.toml")).unwrap(), written);
}

/// The table of docs/matrix.md is what the techniques say; a page with any other line would not hold it.
#[test]
fn the_matrix_of_the_documentation_is_the_one_printed() {
    let page = fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/docs/matrix.md")).unwrap();
    let printed = typed("list --matrix").returns(0).stdout;
    assert!(printed.contains("| `map` | yes |"), "{printed}");
    assert!(page.ends_with(&printed), "docs/matrix.md is not what `gnomon list --matrix` prints:\n{printed}");
    assert!(!page.ends_with(&printed.replacen("yes", "no", 1)));
}

#[test]
fn lists_name_scenes_and_every_parameter() {
    typed("list scenes").returns(0).says(&["scenes/triangle", "lamp, sun", "14 triangles"]);
    let call = typed("list techniques").returns(0);
    let call = call.says(&["map: ", "L. Williams", "size [texels]", "1..16384", "pcf-box1..32", "closed-form"]);
    assert!(call.stdout.lines().all(|line| line == line.trim_end() && line.chars().count() <= 120), "{}", call.stdout);
    let folder = scene_in_temp();
    gnomon_in(folder.path(), &["list", "scenes", "--folder", "."]).returns(0).says(&["a tetrahedron over a floor"]);
    gnomon_in(folder.path(), &["list", "scenes", "--folder", "scene"])
        .returns(2)
        .complains(&["no folder in it", "--folder"]);
}

#[test]
fn doctor_names_the_adapter_and_its_limits() {
    typed("doctor").returns(0).says(&[
        "gnomon ",
        "adapter 0",
        "in use",
        "GNOMON_ADAPTER",
        "largest map",
        "oracle exact",
        "oracle mitsuba",
    ]);
}

#[test]
fn what_techniques_work_with_is_drawn() {
    let folder = scene_in_temp();
    let draw = |file: &str, args: &[&str]| {
        let scene = ["render", "scene", "--light", "lamp", "-o", file];
        gnomon_in(folder.path(), &[&scene, args].concat()).returns(0);
        fs::read(folder.path().join(file)).unwrap()
    };
    let mut pictures: Vec<Vec<u8>> = ["volumes", "silhouette", "stencil", "depth-map", "frustum"]
        .map(|show| draw(&format!("{show}.png"), &["--show", show]))
        .to_vec();
    pictures
        .extend(["ambient-lit", "black", "darkening"].map(|name| draw(&format!("{name}.png"), &["--pipeline", name])));
    pictures.sort();
    pictures.dedup();
    assert_eq!(pictures.len(), 8, "eight different pictures");
    let refused = ["render", "scene", "--light", "lamp", "--show", "stencil", "-t", "map", "-o", "x.png"];
    gnomon_in(folder.path(), &refused).returns(2).complains(&["needs a volume technique"]);
}
