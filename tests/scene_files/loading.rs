//! What loads, and as what.

use crate::texts::*;
use glam::{DVec3, UVec2, Vec3};
use gnomon::scene::{
    Falloff, Far, LightKind, LoadOptions, Scene, SceneFile, emission_normal, file::MeshEntry, load, scene_file_for_obj,
};
use std::fs;
use tempfile::TempDir;

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
[[light]]
kind = "sun"
direction = [0, -2, 0]
angular_diameter_deg = 10
samples = 9
[[light]]
kind = "sun"
direction = [1, -1, 0]
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
    let LightKind::Sun { towards_light, angular_radius_rad, samples } = scene.lights[4].kind else { panic!() };
    assert_eq!((towards_light, angular_radius_rad, samples), (Vec3::Y, 5.0_f64.to_radians(), 9));
    let LightKind::Sun { angular_radius_rad, .. } = scene.lights[5].kind else { panic!() };
    assert_eq!((angular_radius_rad, &*scene.lights[5].name), (0.2665_f64.to_radians(), "sun-2"), "as the true sun's");
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
