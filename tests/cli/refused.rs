//! What cannot be done: one clear message, the right exit code, nothing left behind.

use crate::support::{SCENE, gnomon_in, gnomon_with, scene_in_temp, tree, typed, write_scene};
use std::{fs, path::Path};

/// Asserts that a call in a folder is refused with exit code 2, says all the words, and changes nothing.
fn assert_refused(folder: &Path, line: &str, words: &[&str]) {
    let before = tree(folder);
    let call = gnomon_in(folder, &line.split_whitespace().collect::<Vec<_>>());
    let call = call.returns(2).complains(words);
    assert_eq!(call.stdout, "", "{line}");
    assert_eq!(tree(folder), before, "{line}");
}

#[test]
fn usage_mistakes_name_what_would_be_right() {
    let folder = scene_in_temp();
    let refused = |line: &str, words: &[&str]| assert_refused(folder.path(), line, words);
    refused("", &["Usage: gnomon <COMMAND>"]);
    refused("chekc scene", &["'chekc'", "'check'"]);
    refused("check", &["<SCENE>"]);
    refused("check scene --sise 3x3", &["'--sise'", "'--size'"]);
    refused("check scene --size 0x0", &["'0x0'", "1024x768"]);
    refused("check scene --size 64", &["'64'", "1024x768"]);
    refused("check scene --size 70000x1", &["70000 x 1", "1 to 65536"]);
    refused("check scene --jitter -1", &["-1"]);
    refused("check scene --format csv", &["--out"]);
    refused("check scene --out out --format xlsx", &["'xlsx'", "json, csv, markdown, junit"]);
    refused("check scene --out out --format cvs", &["did you mean 'csv'?"]);
    refused("list techniqes", &["'techniqes'", "techniques"]);
}

#[test]
fn techniques_are_spelled_right_or_corrected() {
    let folder = scene_in_temp();
    for command in ["check scene", "inspect scene", "diagnose scene", "mask scene --light sun -o x.png"] {
        let refused =
            |spec: &str, words: &[&str]| assert_refused(folder.path(), &format!("{command} -t {spec}"), words);
        refused("mpa", &["'mpa'", "did you mean 'map'?", "gnomon list techniques"]);
        refused("map:sise=64", &["'sise'", "did you mean 'size'?"]);
        refused("map:size=0", &["'size'", "from 1 to 16384", "'0'"]);
        refused("map:size=16385", &["from 1 to 16384"]);
        refused("map:filter=pcf-bxo3", &["'filter'", "pcf-box1..32"]);
        refused("map:size", &["key=value"]);
        refused("map:size=1,size=2", &["twice"]);
    }
}

#[test]
fn scenes_that_are_not_there_or_not_right_are_told_with_their_place() {
    let folder = scene_in_temp();
    let refused = |line: &str, words: &[&str]| assert_refused(folder.path(), line, words);
    refused("check nowhere --out out", &["nowhere: No such file", "a scene is a folder that holds scene.toml"]);
    let bad = |name: &str, from: &str, to: &str| {
        assert!(SCENE.contains(from));
        write_scene(folder.path(), name, &SCENE.replacen(from, to, 1));
    };
    bad("malformed", "[camera]", "[camera");
    bad("key", "target", "tarjet");
    bad("kind", "\"point\"", "\"pint\"");
    bad("budget", "[[light]]", "[[budget]]\ntechnique = \"mpa:size=3\"\nmean_abs = 0.1\n[[light]]");
    bad("mesh", "model.obj", "modle.obj");
    for (name, words) in [
        ("malformed", ["malformed/scene.toml:3:", ""]),
        ("key", ["key/scene.toml:5:", "did you mean `target`?"]),
        ("kind", ["kind/scene.toml:10:", "`point`"]),
        ("budget", ["budget/scene.toml: [[budget]] technique = \"mpa:size=3\"", "did you mean 'map'?"]),
        ("mesh", ["mesh/scene.toml:7: cannot read `modle.obj`", "paths are relative to"]),
    ] {
        refused(&format!("check {name} --out out"), &words);
        // The mistake in the last scene is told before the first is rendered.
        refused(&format!("check scene {name} --out out"), &words);
    }
    let twice = gnomon_in(folder.path(), &["check", "nowhere"]).stderr.matches("No such file").count();
    assert_eq!(twice, 1, "a cause is told once");
}

#[test]
fn lights_are_named_right_or_listed() {
    let folder = scene_in_temp();
    let refused = |line: &str, words: &[&str]| assert_refused(folder.path(), line, words);
    for command in ["check scene --out out", "render scene -o x.png", "truth scene -o x.png", "inspect scene"] {
        refused(&format!("{command} --light lmap"), &["no light 'lmap'", "did you mean 'lamp'?", "lamp, sun"]);
    }
    fs::write(folder.path().join("m.png"), "").unwrap();
    let several = ["several lights", "--light lamp or --light sun"];
    refused("truth scene -o x.png", &several);
    refused("mask scene -t map:size=8 -o x.png", &several);
    refused("explain scene -t map:size=8 --pixel 1,1", &several);
}

#[test]
fn sizes_and_pixels_stay_within_bounds() {
    let folder = scene_in_temp();
    let refused = |line: &str, words: &[&str]| assert_refused(folder.path(), line, words);
    // No adapter draws a picture this wide.
    refused("check scene --size 65536x1 -t map:size=8 --out out", &["65536", "the limit of"]);
    refused("truth scene --light sun --size 65536x1 -o out/x.png", &["65536", "the limit of"]);
    refused("truth scene --light sun --size 16000x16000 -o out/x.png", &["256000000", "the limit of"]);
    refused("explain scene -t map:size=8 --light sun --pixel 64,0", &["pixel 64,0", "outside", "64 x 48"]);
    refused("explain scene -t map:size=8 --light sun --pixel 1x1", &["'1x1'", "512,400"]);
    refused("explain scene -t map:size=8 --light sun --pixel -1,0", &["-1"]);
}

#[test]
fn a_technique_that_does_not_apply_cannot_be_drawn() {
    let folder = scene_in_temp();
    let words = ["'map' cannot answer for light 'lamp'", "the receivers span 317 degrees", "one frustum holds 170"];
    for (command, output) in [("render", "-o x.png"), ("mask", "-o x.png"), ("explain", "--pixel 1,1")] {
        let pipe = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/pipe");
        let line = format!("{command} {} -t map --size 16x12 {output}", pipe.display());
        assert_refused(folder.path(), &line, &words);
    }
}

#[test]
fn results_go_where_files_can_be_written_and_into_formats_we_know() {
    let folder = scene_in_temp();
    fs::write(folder.path().join("file"), "").unwrap();
    let refused = |line: &str, words: &[&str]| assert_refused(folder.path(), line, words);
    refused("check scene --out file", &["file: files cannot be written there"]);
    refused("check scene --out file/out", &["file/out: files cannot be written there"]);
    refused("truth scene --light sun -o file/x.png", &["file: files cannot be written there"]);
    refused("truth scene --light sun -o x.jpg", &["x.jpg", ".png or .exr"]);
    refused("truth scene --light sun -o x", &["x: ", ".png or .exr"]);
    refused("render scene -o x.bmp", &["x.bmp", ".png or .exr"]);
    fs::create_dir(folder.path().join("folder.png")).unwrap();
    refused("render scene -o folder.png", &["folder.png: is a folder"]);
    refused("scaffold nowhere.obj", &["nowhere.obj: No such file"]);
}

#[test]
fn only_masks_of_the_right_size_are_judged() {
    let folder = scene_in_temp();
    let path = folder.path();
    gnomon_in(path, &["truth", "scene", "--light", "sun", "--size", "32x24", "-o", "small.png"]).returns(0);
    gnomon_in(path, &["truth", "scene", "--light", "sun", "-o", "whole.png"]).returns(0);
    let whole = fs::read(path.join("whole.png")).unwrap();
    fs::write(path.join("cut.png"), &whole[..whole.len() / 2]).unwrap();
    fs::write(path.join("text.png"), "not a picture").unwrap();
    image::RgbImage::from_pixel(64, 48, image::Rgb([9, 200, 9])).save(path.join("green.png")).unwrap();
    let refused =
        |file: &str, words: &[&str]| assert_refused(path, &format!("judge scene --light sun {file} --out out"), words);
    refused("nowhere.png", &["nowhere.png: cannot be read"]);
    refused("small.png", &["small.png: ", "32 x 24", "64 x 48", "--size 32x24"]);
    refused("cut.png", &["cut.png: the PNG cannot be used"]);
    refused("text.png", &["text.png: ", "neither a PNG nor an OpenEXR file"]);
    refused("green.png", &["green.png: ", "pixel (0, 0) is no mask"]);
    gnomon_in(path, &["judge", "scene", "--light", "sun", "whole.png"]).returns(0);
    gnomon_in(path, &["judge", "scene", "--light", "sun", "small.png", "--size", "32x24"]).returns(0);
}

#[test]
fn no_adapter_is_exit_code_3_with_the_command_that_installs_one() {
    let install = "apt-get install -y --no-install-recommends mesa-vulkan-drivers";
    let driverless = [("VK_DRIVER_FILES", "/nonexistent"), ("WGPU_BACKEND", "vulkan")];
    let wish = [("GNOMON_ADAPTER", "nonexistent")];
    for (variables, remedy) in [(&driverless[..], install), (&wish, "name one of these")] {
        for args in [&["check", "scenes/triangle"][..], &["doctor"], &["truth", "scenes/contact", "-o", "no/x.png"]] {
            gnomon_with(variables, args).returns(3).complains(&["no usable graphics adapter", remedy]);
        }
    }
    gnomon_with(&wish, &["doctor"]).complains(&["GNOMON_ADAPTER=nonexistent", "found: "]);
    gnomon_with(&[("WGPU_BACKEND", "vulcan")], &["doctor"]).returns(3).complains(&["WGPU_BACKEND=vulcan"]);
    assert!(!Path::new(env!("CARGO_MANIFEST_DIR")).join("no").exists());
    // What needs no adapter works without.
    gnomon_with(&driverless, &["list", "techniques"]).returns(0);
    assert!(typed("doctor").stderr.is_empty(), "with an adapter nothing is wrong");
}
