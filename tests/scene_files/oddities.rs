//! What is odd, and loads.

use crate::texts::*;
use glam::{UVec2, Vec3};

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
