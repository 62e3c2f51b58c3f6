//! Whatever stands in the files, nothing panics.

use crate::texts::*;
use gnomon::scene::{LoadOptions, Scene, load};
use proptest::prelude::*;
use std::fs;

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
