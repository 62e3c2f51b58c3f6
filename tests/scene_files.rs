//! Scene files end to end: what loads, what is refused and with which words, and that nothing makes the loader panic.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "helpers of tests fail by panicking")]

use glam::{DVec3, UVec2, Vec3};
use gnomon::scene::{
    Falloff, Far, LightKind, LoadOptions, Placement, Scene, SceneFile, emission_normal, file::MeshEntry, load,
    scene_file_for_obj,
};
use proptest::prelude::*;
use std::{fs, path::Path};
use tempfile::TempDir;

const SCENE: &str = r#"about = "a tetrahedron over a floor"
size = [64, 48]
[camera]
eye = [0, 3, 6]
target = [0, 0.5, 0]
[[mesh]]
file = "model.obj"
[[light]]
name = "lamp"
kind = "point"
position = [2, 5, 1]
"#;

/// A closed tetrahedron wound outward, and a floor of one quad.
const MODEL: &str = "\
o Tetra
v 1 0.5 1
v -1 0.5 1
v 0 0.5 -1
v 0 2 0
f 1 2 3
f 1 4 2
f 2 4 3
f 3 4 1
o Floor
v -4 0 -4
v -4 0 4
v 4 0 4
v 4 0 -4
f 5 6 7 8
";

/// A folder with `scene.toml` and `model.obj`.
fn folder(scene: &str, model: &str) -> TempDir {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("scene.toml"), scene).unwrap();
    fs::write(folder.path().join("model.obj"), model).unwrap();
    folder
}

fn load_texts(scene: &str, model: &str) -> Result<Scene, String> {
    load_folder(folder(scene, model).path(), &LoadOptions::default())
}

fn load_folder(folder: &Path, options: &LoadOptions) -> Result<Scene, String> {
    load(folder, options).map_err(|e| e.to_string().replace(&format!("{}/", folder.display()), ""))
}

/// `SCENE` with one line replaced, which must exist.
fn edited(from: &str, to: &str) -> String {
    assert!(SCENE.contains(from), "{from}");
    SCENE.replace(from, to)
}

fn refusal(scene: &str, model: &str) -> String {
    load_texts(scene, model).expect_err("must be refused")
}

fn assert_refused(scene: &str, model: &str, place: &str, words: &[&str]) {
    let message = refusal(scene, model);
    assert!(message.starts_with(place), "`{place}` does not start: {message}");
    for word in words {
        assert!(message.contains(word), "`{word}` is not in: {message}");
    }
}

/// Six times the signed volume: positive for outward windings.
fn signed_volume(scene: &Scene, mesh: usize) -> f64 {
    let corners = scene.meshes[mesh].triangles.clone().map(|t| scene.triangle_in_world(t));
    corners.map(|[a, b, c]| a.dot(b.cross(c))).sum()
}

#[test]
fn a_plain_scene_loads_with_its_defaults() {
    let folder = folder(SCENE, MODEL);
    let scene = load(folder.path(), &LoadOptions::default()).unwrap();
    let by_file = load(&folder.path().join("scene.toml"), &LoadOptions::default()).unwrap();
    assert_eq!(scene, by_file);
    assert_eq!(scene.name, folder.path().file_name().unwrap().to_string_lossy());
    assert_eq!(scene.image_size, UVec2::new(64, 48));
    assert_eq!(scene.origin_in_file, DVec3::ZERO, "a scene around the origin stays");
    assert_eq!((scene.triangles.len(), scene.positions.len(), scene.materials.len()), (6, 8, 1));
    assert_eq!(scene.meshes.iter().map(|m| m.name.as_str()).collect::<Vec<_>>(), ["Tetra", "Floor"]);
    assert_eq!(scene.meshes[1].triangles, 4..6);
    assert!(scene.meshes.iter().all(|m| m.casts && m.receives));
    assert_eq!(scene.corner_normals[4], [Vec3::Y; 3], "face normals where the file has none");
    assert_eq!(scene.camera.far, Far::Infinite);
    let LightKind::Point { aim, .. } = scene.lights[0].kind else { panic!("{:?}", scene.lights) };
    assert_eq!(aim, Vec3::new(0.0, 1.0, 0.0), "the receivers' centre");
    assert_eq!(scene.warnings, Vec::<String>::new());
    assert!(signed_volume(&scene, 0) > 0.0);
}

#[test]
fn the_near_plane_is_fitted_to_the_nearest_triangle() {
    let scene = load_texts(&edited("eye = [0, 3, 6]", "eye = [0, 0, 6]"), MODEL).unwrap();
    // Nearest is the floor, whose edge is at z = 4.
    assert!((scene.camera.near_m - 2e-3).abs() < 1e-12);
    let on_it = load_texts(&edited("eye = [0, 3, 6]", "eye = [0, 0, 0.1]"), MODEL).unwrap();
    assert!((on_it.camera.near_m - 8e-6).abs() < 1e-12, "1e-6 of the extent, 8 m");
    let in_a_box = load_texts(&edited("eye = [0, 3, 6]", "eye = [0, 0.6, 0.1]"), MODEL).unwrap();
    assert!(in_a_box.camera.near_m > 1e-5, "a box is no surface");
}

#[test]
fn lights_of_every_kind_are_built() {
    let more = r#"
[[light]]
kind = "directional"
direction = [0, -2, 0]
[[light]]
kind = "spot"
position = [0, 5, 0]
target = [0, 0, 0]
cone_deg = 60
inner_deg = 60
range = 9
[[light]]
kind = "spot"
position = [0, 5, 0]
falloff = "warn"
warn_power = 3
[[light]]
kind = "point"
position = [0, 1, 0]
"#;
    let scene = load_texts(&format!("{SCENE}{more}"), MODEL).unwrap();
    let names: Vec<_> = scene.lights.iter().map(|light| light.name.as_str()).collect();
    assert_eq!(names, ["lamp", "directional", "spot", "spot-2", "point"]);
    let LightKind::Directional { towards_light } = scene.lights[1].kind else { panic!() };
    assert_eq!(towards_light, Vec3::Y);
    assert!(towards_light.to_array().iter().all(|c| c.is_sign_positive()), "no negative zero: {towards_light}");
    let LightKind::Spot { axis, outer_rad, falloff, .. } = scene.lights[2].kind else { panic!() };
    assert_eq!((axis, falloff), (Vec3::NEG_Y, Falloff::Hard), "no band to fall off in");
    assert!((outer_rad - 30_f64.to_radians()).abs() < 1e-15);
    assert_eq!((scene.lights[2].range_m, scene.lights[0].range_m), (9.0, f64::INFINITY));
    let LightKind::Spot { falloff, .. } = scene.lights[3].kind else { panic!() };
    assert_eq!(falloff, Falloff::Warn { power: 3.0 });
    let LightKind::Point { position, aim, .. } = scene.lights[4].kind else { panic!() };
    assert!(aim.y < position.y && aim.x == position.x, "a light in the receivers' centre aims down");
}

#[test]
fn area_lights_face_their_target() {
    let more = r#"
[[light]]
kind = "rectangle"
position = [0, 5, 0]
target = [0, 0, 0]
width = 2
height = 1
[[light]]
kind = "rectangle"
position = [5, 1, 0]
target = [0, 1, 0]
width = 2
height = 1
samples = 7
[[light]]
kind = "sphere"
position = [0, 5, 0]
radius = 0.25
"#;
    let scene = load_texts(&format!("{SCENE}{more}"), MODEL).unwrap();
    for (index, forward) in [(1, DVec3::NEG_Y), (2, DVec3::NEG_X)] {
        let LightKind::Rectangle { half_width, half_height, .. } = scene.lights[index].kind else { panic!() };
        assert_eq!((half_width.length(), half_height.length()), (1.0, 0.5));
        assert_eq!(emission_normal(half_width, half_height), forward);
    }
    let LightKind::Rectangle { half_height, samples, .. } = scene.lights[2].kind else { panic!() };
    assert_eq!((half_height, samples), (Vec3::Y * 0.5, 7), "a rectangle that faces sideways stands upright");
    let LightKind::Sphere { radius_m, samples, .. } = scene.lights[3].kind else { panic!() };
    assert_eq!((radius_m, samples), (0.25, 64));
}

#[test]
fn files_that_are_not_there_say_what_to_do() {
    let folder = TempDir::new().unwrap();
    let message = |path: &Path| load(path, &LoadOptions::default()).unwrap_err().to_string();
    assert!(message(&folder.path().join("none")).contains("a scene is a folder that holds scene.toml"));
    assert!(message(folder.path()).contains("scene.toml: "));
    fs::write(folder.path().join("a.txt"), "").unwrap();
    assert!(message(&folder.path().join("a.txt")).contains("neither a folder nor a .toml or .obj file"));
    assert_refused(
        &edited("model.obj", "modle.obj"),
        MODEL,
        "scene.toml:7: cannot read `modle.obj`",
        &["paths are relative to"],
    );
    assert_refused(&edited("model.obj", ""), MODEL, "scene.toml:7: cannot read ``", &["this is no file"]);
}

#[test]
fn malformed_scene_files_name_line_and_key() {
    for (from, to, place, word) in [
        ("[camera]", "[camera", "scene.toml:3: ", "expected `]`"),
        ("size = [64, 48]", "size = 64", "scene.toml:2: ", "lists are written [x, y, z]"),
        ("size = [64, 48]", "size = [-1, 48]", "scene.toml:2: ", "-1"),
        ("eye =", "eyes =", "scene.toml:4: unknown key `eyes`", "did you mean `eye`?"),
        ("size =", "sise =", "scene.toml:2: unknown key `sise`", "did you mean `size`?"),
        ("file =", "flie =", "scene.toml:7: unknown key `flie`", "did you mean `file`?"),
        ("name =", "colour =", "scene.toml:9: unknown key `colour`", "known are name, kind, position"),
        ("[[light]]", "[[lihgt]]", "scene.toml:8: unknown key `lihgt`", "did you mean `light`?"),
        ("[[mesh]]", "[mesh]", "scene.toml:6: ", "repeated tables [[mesh]]"),
        ("eye = [0, 3, 6]\n", "", "scene.toml:3: missing field `eye`", "no default"),
        ("eye = [0, 3, 6]", "eye = [0, \"3\", 6]", "scene.toml:4: ", "expected f64"),
        ("eye = [0, 3, 6]", "eye = [0, 3]", "scene.toml:4: ", "3"),
        ("target =", "far = \"infinte\"\ntarget =", "scene.toml:5: unknown far `infinte`", "did you mean `infinite`?"),
        ("target =", "far = true\ntarget =", "scene.toml:5: ", "a number or \"infinite\""),
        ("kind = \"point\"", "kind = \"pont\"", "scene.toml:10: unknown kind `pont`", "did you mean `point`?"),
    ] {
        assert_refused(&edited(from, to), MODEL, place, &[word]);
    }
    let folder = folder(SCENE, MODEL);
    fs::write(folder.path().join("scene.toml"), b"about = \"x\"\n\xff").unwrap();
    let message = load_folder(folder.path(), &LoadOptions::default()).unwrap_err();
    assert_eq!(message, "scene.toml:2: not UTF-8 text: save the file as UTF-8");
}

#[test]
fn values_out_of_range_name_line_and_range() {
    for (from, to, place, word) in [
        ("a tetrahedron over a floor", "", "scene.toml:1: about", "one line"),
        ("size = [64, 48]", "size = [0, 48]", "scene.toml:2: size = 0 x 48", "1 to 65536"),
        ("size = [64, 48]", "size = [64, 65537]", "scene.toml:2: size = 64 x 65537", "1 to 65536"),
        ("size =", "shading = \"fong\"\nsize =", "scene.toml:2: unknown shading `fong`", "did you mean `phong`?"),
        ("size =", "mode = \"clasic\"\nsize =", "scene.toml:2: unknown mode", "did you mean `classic`?"),
        ("size =", "ambient = [0, -1, 0]\nsize =", "scene.toml:2: ambient", "at least 0"),
        ("eye = [0, 3, 6]", "eye = [0, nan, 6]", "scene.toml:4: camera.eye", "finite"),
        ("eye = [0, 3, 6]", "eye = [0, inf, 6]", "scene.toml:4: camera.eye", "finite"),
        ("eye = [0, 3, 6]", "eye = [0, 1e13, 6]", "scene.toml:4: camera.eye", "1e12 m"),
        ("eye = [0, 3, 6]", "eye = [0, 0.5, 0]", "scene.toml:4: camera.eye", "looks nowhere"),
        ("eye = [0, 3, 6]", "eye = [0, 0.5, 1e-60]", "scene.toml:4: camera.eye", "looks nowhere"),
        ("eye = [0, 3, 6]", "eye = [0, 3, 0]", "scene.toml:3: camera.up", "parallel to the view"),
        ("target =", "up = [0, 0, 0]\ntarget =", "scene.toml:5: camera.up", "must not be zero"),
        ("target =", "up = [0, 5, 12]\ntarget =", "scene.toml:5: camera.up", "parallel to the view"),
        ("target =", "fov_y_deg = 0\ntarget =", "scene.toml:5: camera.fov_y_deg = 0", "above 0 and below 180"),
        ("target =", "fov_y_deg = 180\ntarget =", "scene.toml:5: camera.fov_y_deg = 180", "above 0 and below 180"),
        ("target =", "near = 0\ntarget =", "scene.toml:5: camera.near = 0", "above 0"),
        ("target =", "near = 1\nfar = 1\ntarget =", "scene.toml:6: camera.far = 1", "beyond the near plane at 1 m"),
        ("target =", "far = inf\ntarget =", "scene.toml:5: camera.far = inf", "\"infinite\" or a number"),
        ("[[light]]", "scale = 0\n[[light]]", "scene.toml:8: mesh[0].scale", "must not be 0"),
        ("[[light]]", "scale = [1, 0, 1]\n[[light]]", "scene.toml:8: mesh[0].scale", "must not be 0"),
        ("[[light]]", "scale = nan\n[[light]]", "scene.toml:8: mesh[0].scale", "finite"),
        ("[[light]]", "scale = \"big\"\n[[light]]", "scene.toml:8: ", "a number or [x, y, z]"),
        ("[[light]]", "rotate_deg = [0, inf, 0]\n[[light]]", "scene.toml:8: mesh[0].rotate_deg", "finite"),
        ("[[light]]", "scale = 1e300\n[[light]]", "scene.toml:7: mesh[0].file", "scale it down"),
        ("[[light]]", "scale = 1e-13\n[[light]]", "scene.toml:6: mesh spans", "scale it up"),
        ("[[light]]", "translate = [1e13, 0, 0]\n[[light]]", "scene.toml:7: mesh[0].file", "move it"),
        ("[[light]]", "objects = []\n[[light]]", "scene.toml:8: mesh[0].objects", "at least one"),
        ("[[light]]", "objects = [\"Flor\"]\n[[light]]", "scene.toml:8: unknown OBJ object `Flor`", "mean `Floor`?"),
        ("\"lamp\"", "\"\"", "scene.toml:9: light[0].name", "must not be empty"),
        ("\"lamp\"", "\"a/b\"", "scene.toml:9: light[0].name", "hold none of"),
        ("\"point\"", "\"rectangle\"", "scene.toml:8: light[0].width is missing", "a rectangle light needs it"),
        ("\"point\"", "\"rectangle\"\nwidth = -1", "scene.toml:11: light[0].width = -1", "1e-30 to 1e12 metres"),
        ("\"point\"", "\"sphere\"\nradius = 0", "scene.toml:11: light[0].radius = 0", "1e-30 to 1e12 metres"),
        (
            "\"point\"",
            "\"sphere\"\nwidth = 1",
            "scene.toml:11: light[0].width",
            "takes position, target, range, radius",
        ),
        ("\"point\"", "\"sphere\"\nradius = 1\nsamples = 0", "scene.toml:12: light[0].samples = 0", "1 to 4096"),
        ("\"point\"", "\"directional\"", "scene.toml:11: light[0].position", "takes direction: remove it"),
        ("\"point\"", "\"point\"\ncone_deg = 10", "scene.toml:11: light[0].cone_deg", "means nothing for a point"),
        ("\"point\"", "\"spot\"\ncone_deg = 180", "scene.toml:11: light[0].cone_deg = 180", "below 180"),
        ("\"point\"", "\"spot\"\ninner_deg = 41", "scene.toml:11: light[0].inner_deg = 41", "to cone_deg = 40"),
        ("\"point\"", "\"spot\"\nwarn_power = 1", "scene.toml:11: light[0].warn_power", "falloff = \"warn\""),
        ("\"point\"", "\"spot\"\nfalloff = \"soft\"", "scene.toml:11: unknown falloff `soft`", "linear, hard, warn"),
        ("\"point\"", "\"spot\"\ntarget = [2, 5, 1]", "scene.toml:11: light[0].target", "aims nowhere"),
        ("\"point\"", "\"point\"\nrange = 0", "scene.toml:11: light[0].range = 0", "above 0"),
        ("\"point\"", "\"point\"\nintensity = [1, -1, 1]", "scene.toml:11: light[0].intensity", "at least 0"),
        ("\"point\"", "\"point\"\nattenuation = [1e99, 0, 0]", "scene.toml:11: light[0].attenuation", "fit into f32"),
        ("position = [2, 5, 1]\n", "", "scene.toml:8: light[0].position is missing", "a point light needs it"),
    ] {
        assert_refused(&edited(from, to), MODEL, place, &[word]);
    }
}

#[test]
fn entries_after_the_first_are_checked_too() {
    for (more, place, word) in [
        ("[[light]]\nname = \"lamp\"\nkind = \"spot\"", "scene.toml:13: light[1].name", "taken by an earlier light"),
        ("[[light]]\nkind = \"directional\"", "scene.toml:12: light[1].direction is missing", "needs it"),
        ("[[light]]\nkind = \"directional\"\ndirection = [0, 0, 0]", "scene.toml:14: light[1].direction", "zero"),
        ("[[plane]]\npoint = [0, 0, 0]\nnormal = [0, 0, 0]", "scene.toml:14: plane[0].normal", "must not be zero"),
        ("[[plane]]\npoint = [nan, 0, 0]\nnormal = [0, 1, 0]", "scene.toml:13: plane[0].point", "finite"),
        ("[[budget]]\ntechnique = \"map\"", "scene.toml:12: budget[0].wrong_fraction", "needs at least one"),
        ("[[budget]]\ntechnique = \" \"\nmean_abs = 0", "scene.toml:13: budget[0].technique", "is empty"),
        ("[[budget]]\ntechnique = \"map\"\nmean_abs = 1.5", "scene.toml:14: budget[0].mean_abs = 1.5", "from 0 to 1"),
        (
            "[[budget]]\ntechnique = \"map\"\nmean_abs = 0\nlight = \"lmap\"",
            "scene.toml:15: unknown light `lmap`",
            "did you mean `lamp`?",
        ),
    ] {
        assert_refused(&format!("{SCENE}{more}\n"), MODEL, place, &[word]);
    }
    for (table, end) in [("[[mesh]]", "[[light]]"), ("[[light]]", "")] {
        let start = SCENE.find(table).unwrap();
        let end = if end.is_empty() { SCENE.len() } else { SCENE.find(end).unwrap() };
        let without = format!("{}{}", &SCENE[..start], &SCENE[end..]);
        assert_refused(&without, MODEL, "scene.toml: ", &["at least one [[mesh]] and one [[light]]", table]);
    }
}

#[test]
fn size_and_placement_asked_for_are_checked() {
    let folder = folder(SCENE, MODEL);
    let with = |options: LoadOptions| load_folder(folder.path(), &options);
    let size = Some(UVec2::new(5, 7));
    assert_eq!(with(LoadOptions { size, ..LoadOptions::default() }).unwrap().image_size, UVec2::new(5, 7));
    let message = with(LoadOptions { size: Some(UVec2::new(0, 7)), ..LoadOptions::default() }).unwrap_err();
    assert!(message.contains("the size asked for = 0 x 7 pixels: each side must be 1 to 65536"), "{message}");
    for scale in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let placement = Placement { scale, ..Placement::default() };
        assert!(with(LoadOptions { placement, ..LoadOptions::default() }).unwrap_err().contains("above 0"));
    }
}

#[test]
fn broken_meshes_name_their_line() {
    for (from, to, place, word) in [
        ("v -1 0.5 1", "v -1 nan 1", "model.obj:3: ", "`nan` is not a finite number"),
        ("v -1 0.5 1", "v -1 inf 1", "model.obj:3: ", "`inf` is not a finite number"),
        ("f 5 6 7 8", "f 5 6 9", "model.obj:15: ", "there is no vertex 9: 8 are defined"),
        ("f 5 6 7 8", "f 5 6 0", "model.obj:15: ", "indices count from 1"),
        ("f 5 6 7 8", "f 5 6", "model.obj:15: ", "at least 3 corners"),
        ("f 5 6 7 8", "f 5 7 6 8", "model.obj:15: ", "concave or crosses itself; split it into triangles"),
        ("v 4 0 -4", "v -3 0 3", "model.obj:15: ", "concave or crosses itself"),
        ("v 4 0 -4", "v 4 3 -4", "model.obj:15: ", "not flat"),
    ] {
        assert!(MODEL.contains(from));
        assert_refused(SCENE, &MODEL.replace(from, to), place, &[word]);
    }
    let no_faces: String =
        MODEL.lines().filter(|line| !line.starts_with('f')).map(|line| format!("{line}\n")).collect();
    assert_refused(SCENE, &no_faces, "model.obj: ", &["no faces"]);
    assert_refused(SCENE, "", "model.obj: ", &["no faces"]);
    let one_point = "v 1 1 1\nf 1 1 1\n";
    assert_refused(SCENE, one_point, "scene.toml:6: mesh spans 0e0 m", &["scale it up"]);
}

#[test]
fn lines_and_mixed_normals_are_told_and_survived() {
    let model = MODEL.replace("f 5 6 7 8", "vn 0 2 0\nf 5//1 6//1 7//1\nf 5//1 7//1 8\nl 1 2\nl 2 3");
    let scene = load_texts(SCENE, &model).unwrap();
    assert_eq!(scene.triangles.len(), 6, "lines are no triangles");
    assert_eq!(scene.corner_normals[4], [Vec3::Y; 3]);
    assert_eq!(scene.corner_normals[5], [Vec3::Y; 3], "the face normal");
    let warnings = scene.warnings.join("\n");
    assert!(warnings.contains("model.obj:18: `l` records are ignored (2 in this file)"), "{warnings}");
    assert!(warnings.contains("model.obj: 5 of 6 faces have no normals"), "{warnings}");
}

#[test]
fn paths_stay_in_the_folder() {
    let outside = TempDir::new().unwrap();
    fs::write(outside.path().join("model.obj"), MODEL).unwrap();
    fs::write(outside.path().join("m.mtl"), "newmtl a\n").unwrap();
    let absolute = outside.path().join("model.obj").display().to_string();
    assert_refused(
        &edited("model.obj", &absolute),
        MODEL,
        &format!("scene.toml:7: `{absolute}` is an absolute path"),
        &["copy the file into"],
    );
    assert_refused(
        &edited("model.obj", "../model.obj"),
        MODEL,
        "scene.toml:7: `../model.obj` climbs out",
        &["with .."],
    );
    assert_refused(
        SCENE,
        &format!("mtllib ../m.mtl\n{MODEL}"),
        "model.obj:1: `../m.mtl` climbs out",
        &["copy the file"],
    );
    assert_refused(SCENE, &format!("mtllib /etc/passwd\n{MODEL}"), "model.obj:1: `/etc/passwd` is an absolute", &[]);
    #[cfg(unix)]
    {
        let folder = folder(&edited("model.obj", "link.obj"), &format!("mtllib inner.mtl\n{MODEL}"));
        let link = |to: &Path, name: &str| std::os::unix::fs::symlink(to, folder.path().join(name)).unwrap();
        link(&outside.path().join("model.obj"), "link.obj");
        let message = load_folder(folder.path(), &LoadOptions::default()).unwrap_err();
        assert!(message.starts_with("scene.toml:7: `link.obj` leads out of the scene's folder"), "{message}");
        // A link that stays inside is fine, for meshes and materials alike.
        fs::remove_file(folder.path().join("link.obj")).unwrap();
        link(&folder.path().join("model.obj"), "link.obj");
        fs::write(folder.path().join("real.mtl"), "newmtl a\n").unwrap();
        link(&folder.path().join("real.mtl"), "inner.mtl");
        assert_eq!(load_folder(folder.path(), &LoadOptions::default()).unwrap().materials.len(), 2);
    }
}

#[test]
fn materials_are_found_by_name_and_their_lack_is_told() {
    let model =
        "mtllib m.mtl\nmtllib none.mtl\nusemtl red\n".to_owned() + &MODEL.replace("o Floor", "o Floor\nusemtl blue");
    let folder = folder(SCENE, &model);
    fs::write(folder.path().join("m.mtl"), "newmtl other\nKd 0 1 0\nnewmtl red\nKd 1 0 0\nNi 1.5\n").unwrap();
    let scene = load_folder(folder.path(), &LoadOptions::default()).unwrap();
    assert_eq!(scene.materials.iter().map(|m| m.name.as_str()).collect::<Vec<_>>(), ["default", "other", "red"]);
    assert_eq!(scene.triangle_material, [2, 2, 2, 2, 0, 0]);
    let warnings = scene.warnings.join("\n");
    for told in [
        "m.mtl:5: material key `Ni`",
        "model.obj:2: cannot read `none.mtl`",
        "model.obj:14: no MTL file defines material `blue`",
    ] {
        assert!(warnings.contains(told), "{told}: {warnings}");
    }
    fs::write(folder.path().join("m.mtl"), "newmtl red\nKd 1 0\n").unwrap();
    let message = load_folder(folder.path(), &LoadOptions::default()).unwrap_err();
    assert_eq!(message, "m.mtl:2: a colour is three numbers, this one has 2");
}

#[test]
fn an_object_of_two_materials_is_one_mesh_and_equal_names_are_two() {
    let model = MODEL.replace("f 2 4 3", "usemtl b\nf 2 4 3").replace("o Floor", "o Tetra");
    let scene = load_texts(SCENE, &model).unwrap();
    assert_eq!(scene.meshes.iter().map(|m| m.triangles.clone()).collect::<Vec<_>>(), [0..4, 4..6]);
    assert!(scene.meshes.iter().all(|m| m.name == "Tetra"));
}

#[test]
fn objects_are_chosen_and_flagged() {
    let more = "objects = [\"Tetra\"]\ncasts = false\n[[mesh]]\nfile = \"model.obj\"\nobjects = [\"Floor\"]\nreceives = false\n";
    let scene = load_texts(&edited("[[light]]", &format!("{more}[[light]]")), MODEL).unwrap();
    let flags: Vec<_> = scene.meshes.iter().map(|m| (m.name.as_str(), m.casts, m.receives)).collect();
    assert_eq!(flags, [("Tetra", false, true), ("Floor", true, false)]);
}

#[test]
fn a_mirrored_mesh_keeps_its_outward_winding_and_normals() {
    let model = MODEL.replace("f 1 2 3", "vn 0 -1 0\nf 1//1 2//1 3//1");
    for scale in ["[-1, 2, 1]", "[1, -2, 3]", "-1", "[-1, -1, 1]"] {
        let text = format!("scale = {scale}\nrotate_deg = [10, 20, 30]\nobjects = [\"Tetra\"]\n[[light]]");
        let scene = load_texts(&edited("[[light]]", &text), &model).unwrap();
        assert!(signed_volume(&scene, 0) > 0.0, "{scale}");
        let face = scene.triangle_normal(0).normalize();
        assert!(face.distance(scene.corner_normals[0][0].as_dvec3()) < 1e-6, "{scale}: outward like its face");
    }
}

/// Vertices that survive f64 sums at 10⁶ m and the rounding to f32, in ulps of f32 at the scene's size.
const PLACED_ULPS: f32 = 1.0;

#[test]
fn translation_leaves_the_rebased_scene_unchanged() {
    // Heights that no f32 near 10⁶ can hold.
    let model = MODEL.replace("0.5", "0.3");
    let folder = folder(SCENE, &model);
    let plain = load_folder(folder.path(), &LoadOptions::default()).unwrap();
    let translate = DVec3::new(1e6, -1e6, 1e6);
    let placement = Placement { translate, ..Placement::default() };
    let far = load_folder(folder.path(), &LoadOptions { placement, ..LoadOptions::default() }).unwrap();
    assert_eq!(far.origin_in_file, translate);
    assert_eq!((&far.positions, &far.lights, far.camera), (&plain.positions, &plain.lights, plain.camera));

    // The same through the file's own numbers.
    let far_text = edited("[[light]]", "translate = [1e6, -1e6, 1e6]\n[[light]]")
        .replace("[0, 3, 6]", "[1000000, -999997, 1000006]")
        .replace("[0, 0.5, 0]", "[1000000, -999999.5, 1000000]")
        .replace("[2, 5, 1]", "[1000002, -999995, 1000001]");
    let far = load_texts(&far_text, &model).unwrap();
    let ulp = 8.0 * f32::EPSILON;
    for (a, b) in plain.positions.iter().zip(&far.positions) {
        assert!((a - b).abs().max_element() <= PLACED_ULPS * ulp, "{a} {b}");
    }
    assert_eq!((far.camera.eye, far.camera.target), (plain.camera.eye, plain.camera.target));
    // Rounding before rebasing would fail this test.
    let rounded_first = |p: Vec3| (p.as_dvec3() + translate).as_vec3().as_dvec3() - translate;
    let worst = plain.positions.iter().map(|&p| (rounded_first(p) - p.as_dvec3()).abs().max_element());
    assert!(worst.fold(0.0, f64::max) > 1e3 * f64::from(PLACED_ULPS * ulp));
}

#[test]
fn scale_multiplies_everything_but_intensity() {
    let folder = folder(&format!("{SCENE}range = 20\n[[plane]]\npoint = [0, 1, 0]\nnormal = [0, 3, 0]\n"), MODEL);
    let plain = load_folder(folder.path(), &LoadOptions::default()).unwrap();
    for scale in [1e-6, 1e-3, 0.5, 1e3, 1e6] {
        let placement = Placement { scale, ..Placement::default() };
        let scaled = load_folder(folder.path(), &LoadOptions { placement, ..LoadOptions::default() }).unwrap();
        let close = |a: f64, b: f64| (a - scale * b).abs() <= 1e-6 * scale * b.abs().max(1.0);
        for (a, b) in scaled.positions.iter().zip(&plain.positions) {
            assert!((0..3).all(|i| close(a[i].into(), b[i].into())), "{scale}: {a} {b}");
        }
        assert!(close(scaled.camera.near_m, plain.camera.near_m));
        assert!(close(scaled.camera.eye.y.into(), 3.0) && close(scaled.planes[0].point.y.into(), 1.0));
        assert!(close(scaled.lights[0].range_m, 20.0));
        assert_eq!(scaled.lights[0].intensity, plain.lights[0].intensity);
        assert_eq!(scaled.planes[0].normal, Vec3::Y);
    }
}

#[test]
fn legal_oddities_load_and_are_told() {
    let on_vertex = load_texts(&edited("[2, 5, 1]", "[0, 2, 0]"), MODEL).unwrap();
    assert!(on_vertex.warnings[0].contains("light `lamp` lies exactly on triangle 1 of mesh `Tetra`"));
    let in_plane = load_texts(&edited("[2, 5, 1]", "[9, 0, 9]"), MODEL).unwrap();
    assert!(in_plane.warnings[0].contains("in the plane of 2 triangles, the first of mesh `Floor`"));
    let on_floor = load_texts(&edited("[0, 3, 6]", "[3, 0, 3]"), MODEL).unwrap();
    assert!(on_floor.warnings[0].contains("the camera's eye lies exactly on triangle 4 of mesh `Floor`"));
    let beside = load_texts(&edited("[0, 3, 6]", "[3, 0.001, 3]"), MODEL).unwrap();
    assert_eq!(beside.warnings, Vec::<String>::new());

    let text = SCENE.replace('\n', "\r\n");
    let model = MODEL.replace('\n', "\r\n\r\n");
    assert_eq!(load_texts(&text, &model).unwrap().positions, load_texts(SCENE, MODEL).unwrap().positions);

    let negative_zero = load_texts(SCENE, &MODEL.replace("v 0 2 0", "v -0 2 -0.0")).unwrap();
    assert!(negative_zero.positions.iter().all(|p| p.to_array().iter().all(|c| c.to_bits() != (-0_f32).to_bits())));
    let nobody_asked = load_texts(&edited("[[light]]", "receives = false\n[[light]]"), MODEL).unwrap();
    assert!(nobody_asked.meshes.iter().all(|mesh| !mesh.receives));
    let one_pixel = load_texts(&edited("[64, 48]", "[1, 1]"), MODEL).unwrap();
    assert_eq!(one_pixel.image_size, UVec2::ONE);
}

#[test]
fn identical_and_degenerate_triangles_are_kept_and_counted() {
    const COUNT: usize = 100_000;
    let model = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n{}f 1 1 2\n", "f 1 2 3\n".repeat(COUNT));
    let scene = load_texts(SCENE, &model).unwrap();
    assert_eq!(scene.triangles.len(), COUNT + 1);
    assert_eq!(scene.corner_normals[COUNT], [Vec3::ZERO; 3]);
    let warnings = scene.warnings.join("\n");
    assert!(warnings.contains("1 triangles have no area"), "{warnings}");
    assert!(warnings.contains("99999 triangles have the same three corners"), "{warnings}");
}

#[test]
fn a_bare_obj_gets_a_scene_and_its_names_become_properties() {
    let model = MODEL.replace("o Floor", "o FloorNS") + "o ShadowPlane\nf 5 6 7\nf 5 7 8\n";
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("demo.obj");
    fs::write(&path, model).unwrap();
    let bare = load(&path, &LoadOptions::default()).unwrap();
    assert_eq!(bare.name, "demo");
    let flags: Vec<_> = bare.meshes.iter().map(|m| (m.name.as_str(), m.casts, m.receives)).collect();
    assert_eq!(flags, [("Tetra", true, true), ("FloorNS", false, true)]);
    assert_eq!((bare.planes[0].normal, bare.planes[0].point.y), (Vec3::Y, 0.0));
    let size = bare.image_size.as_dvec2();
    for corner in bare.bounds().corners() {
        let ndc = bare.camera.clip_from_world(bare.image_size).project_point3(corner);
        assert!(ndc.x.abs() < 1.0 && ndc.y.abs() < 1.0 && ndc.z > 0.0, "{corner} is outside the {size} picture");
    }

    let file = scene_file_for_obj(&path).unwrap();
    let text = file.to_toml().unwrap();
    assert!(text.contains("casts = false") && text.contains("[[plane]]") && text.contains("\"FloorNS\""), "{text}");
    assert_eq!(toml::from_str::<SceneFile>(&text).unwrap(), file);
    fs::write(folder.path().join("scene.toml"), text).unwrap();
    let written = load(folder.path(), &LoadOptions::default()).unwrap();
    assert_eq!(Scene { name: written.name.clone(), ..bare }, written);
}

#[test]
fn a_bare_obj_without_rules_is_one_entry() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("demo.OBJ");
    fs::write(&path, MODEL).unwrap();
    let file = scene_file_for_obj(&path).unwrap();
    let whole = MeshEntry { file: "demo.OBJ".into(), casts: Some(true), ..MeshEntry::default() };
    assert_eq!(file.mesh, [whole]);
    assert!(file.plane.is_empty());
    fs::write(&path, "o ShadowPlane1\nv 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n").unwrap();
    let message = load(&path, &LoadOptions::default()).unwrap_err().to_string();
    assert!(message.contains("every object is called ShadowPlane"), "{message}");
}

/// One byte of a text overwritten, removed or inserted, a few times over.
fn mutated(text: &'static str) -> impl Strategy<Value = Vec<u8>> {
    let edit = (
        any::<prop::sample::Index>(),
        0..3_u8,
        prop_oneof![any::<u8>(), prop::sample::select(b"0-.ef/#[]=\"\\\n ".to_vec())],
    );
    prop::collection::vec(edit, 1..6).prop_map(move |edits| {
        let mut bytes = text.as_bytes().to_vec();
        for (index, action, byte) in edits {
            let at = index.index(bytes.len());
            match action {
                0 => bytes[at] = byte,
                1 => drop(bytes.remove(at)),
                _ => bytes.insert(at, byte),
            }
        }
        bytes
    })
}

/// What must hold of any scene that loads.
fn is_valid(scene: &Scene) -> bool {
    let triangles = scene.triangles.len();
    scene.positions.iter().all(|p| p.is_finite())
        && scene.triangles.iter().flatten().all(|&i| (i as usize) < scene.positions.len())
        && scene.corner_normals.iter().flatten().all(|n| n.is_finite())
        && scene.triangle_material.iter().all(|&i| (i as usize) < scene.materials.len())
        && [scene.corner_normals.len(), scene.triangle_material.len()] == [triangles; 2]
        && scene.meshes.last().is_some_and(|mesh| mesh.triangles.end as usize == triangles)
        && scene.camera.clip_from_world(scene.image_size).is_finite()
}

fn load_bytes(scene: &[u8], model: &[u8], mtl: &[u8]) {
    let folder = folder("", "");
    fs::write(folder.path().join("scene.toml"), scene).unwrap();
    fs::write(folder.path().join("model.obj"), model).unwrap();
    fs::write(folder.path().join("m.mtl"), mtl).unwrap();
    match load(folder.path(), &LoadOptions::default()) {
        Ok(scene) => assert!(is_valid(&scene), "{scene:?}"),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

const FULL_SCENE: &str = r#"about = "x"
shading = "flat"
ambient = [0, 0, 0]
[camera]
eye = [0, 3, 6]
target = [0, 0.5, 0]
far = 100.0
[[mesh]]
file = "model.obj"
scale = [1, -2, 1]
rotate_deg = [10, 20, 30]
objects = ["T"]
[[light]]
kind = "spot"
position = [2, 5, 1]
inner_deg = 20
falloff = "linear"
[[plane]]
point = [0, 0, 0]
normal = [0, 1, 0]
[[budget]]
technique = "map"
light = "spot"
mean_abs = 0.5
"#;
const FULL_MODEL: &str = "mtllib m.mtl\no T\nusemtl a\nv 1 .5 1\nv -1 .5 1\nv 0 .5 -1\nv 0 2 0 1\nvt 0 0\nvn 0 1 0\n\
                          f 1/1/1 2/1/1 -2/-1/-1\nf 1 4 \\\n 2 # c\nl 1 2\ns off\ng h\nf 1//1 2//1 3//1 1//1\n";
const FULL_MTL: &str = "newmtl a\nKa 1 1 1\nKd .5 .5 .5\nKs 1 1 1\nNs 10\nd 1\nillum 2\n";

proptest! {
    #![proptest_config(ProptestConfig { cases: 128, ..ProptestConfig::default() })]

    #[test]
    fn mutated_files_never_panic(scene in mutated(FULL_SCENE), model in mutated(FULL_MODEL), mtl in mutated(FULL_MTL)) {
        load_bytes(&scene, FULL_MODEL.as_bytes(), FULL_MTL.as_bytes());
        load_bytes(FULL_SCENE.as_bytes(), &model, FULL_MTL.as_bytes());
        load_bytes(FULL_SCENE.as_bytes(), FULL_MODEL.as_bytes(), &mtl);
    }

    #[test]
    fn byte_soup_never_panics(soup in prop::collection::vec(any::<u8>(), 0..200)) {
        load_bytes(&soup, FULL_MODEL.as_bytes(), FULL_MTL.as_bytes());
        load_bytes(FULL_SCENE.as_bytes(), &soup, &soup);
    }
}

#[test]
fn the_files_the_mutations_start_from_are_valid() {
    let folder = folder(FULL_SCENE, FULL_MODEL);
    fs::write(folder.path().join("m.mtl"), FULL_MTL).unwrap();
    let scene = load(folder.path(), &LoadOptions::default()).unwrap();
    assert!(is_valid(&scene));
    let mut broken = scene.clone();
    broken.positions[0].x = f32::NAN;
    assert!(!is_valid(&broken));
    let mut broken = scene;
    broken.triangles[0][1] = 99;
    assert!(!is_valid(&broken));
}
