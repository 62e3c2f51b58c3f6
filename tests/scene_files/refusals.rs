//! What is refused, and with which words.

use crate::texts::*;
use glam::UVec2;
use gnomon::scene::{LoadOptions, Placement, load};
use std::fs;
use std::path::Path;
use tempfile::TempDir;

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
        ("\"point\"", "\"sun\"", "scene.toml:11: light[0].position", "takes direction, angular_diameter_deg, samples"),
        (
            "\"point\"\nposition = [2, 5, 1]",
            "\"sun\"\ndirection = [0, -1, 0]\nangular_diameter_deg = 180",
            "scene.toml:12: light[0].angular_diameter_deg = 180",
            "above 0 and below 180",
        ),
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
