//! Where meshes end up: mirrored, moved and scaled.

use crate::texts::*;
use glam::{DVec3, Vec3};
use gnomon::scene::{LoadOptions, Placement};

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
