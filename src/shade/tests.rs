//! The lighting model as a whole, against closed forms.

use super::*;
use crate::inspect::fixtures::{Shape, point_light, scene_of, torus};
use crate::scene::LightingMode;
use std::f64::consts::PI;

/// Results are f32: relative tolerance of exact formulas.
const ROUNDING: f32 = 1e-6;

/// A floor of two triangles, 8 × 8 m, seen from above the scene's camera at (0, 0, 5) and lit by its lamp at (0, 5, 0).
fn floor() -> Scene {
    let corner = |x, z| DVec3::new(x, 0.0, z);
    let positions = vec![corner(-4.0, 4.0), corner(4.0, 4.0), corner(4.0, -4.0), corner(-4.0, -4.0)];
    scene_of(&[Shape { positions, triangles: vec![[0, 1, 2], [0, 2, 3]] }])
}

fn on_floor(x: f64, z: f64) -> Option<Receiver> {
    let triangle = u32::from(x + z < 0.0);
    Some(Receiver { triangle, point_in_world: DVec3::new(x, 0.0, z), normal_in_world: DVec3::Y })
}

fn row(pixels: Vec<Option<Receiver>>) -> Receivers {
    Receivers { size: UVec2::new(pixels.len() as u32, 1), pixels }
}

fn mask(values: &[Option<f32>]) -> Mask {
    let pixels = values.iter().map(|value| value.and_then(Visibility::new)).collect();
    Mask { size: UVec2::new(values.len() as u32, 1), pixels }
}

fn assert_near(actual: Vec3, expected: Vec3) {
    let scale = expected.abs().max_element().max(1e-3);
    assert!((actual - expected).abs().max_element() <= ROUNDING * scale, "{actual} is not {expected}");
}

#[test]
fn lambert_is_albedo_over_pi_times_intensity_times_cosine_over_square_distance() {
    let scene = floor();
    let picture = shade(
        &scene,
        &row(vec![on_floor(3.0, 1.0), None]),
        &[(&scene.lights[0], &mask(&[None; 2]))],
        Pipeline::AmbientLit,
    );
    let square = 9.0 + 1.0 + 25.0;
    let expected = 0.5 / PI * 10.0 * (5.0 / f64::sqrt(square)) / square;
    assert_near(picture.linear_rgb[0], DVec3::splat(expected).as_vec3());
    assert_eq!(picture.linear_rgb[1], BACKGROUND);
}

#[test]
fn classic_mode_has_neither_pi_nor_square() {
    let mut scene = floor();
    scene.mode = LightingMode::Classic;
    let picture =
        shade(&scene, &row(vec![on_floor(0.0, 0.0)]), &[(&scene.lights[0], &mask(&[None]))], Pipeline::AmbientLit);
    assert_near(picture.linear_rgb[0], Vec3::splat(0.5 * 10.0));
}

#[test]
fn visibility_scales_its_own_light_and_nothing_else() {
    let mut scene = floor();
    scene.ambient = Vec3::new(0.3, 0.2, 0.1);
    scene.materials[0].emission = Vec3::new(0.0, 0.5, 0.0);
    scene.materials[0].specular = Vec3::splat(0.4);
    let other = point_light(Vec3::new(2.0, 3.0, 1.0));
    let receivers = row(vec![on_floor(0.5, 1.0)]);
    let with = |lamp: Option<f32>, second: Option<f32>| {
        let masks = (mask(&[lamp]), mask(&[second]));
        shade(&scene, &receivers, &[(&scene.lights[0], &masks.0), (&other, &masks.1)], Pipeline::AmbientLit).linear_rgb
            [0]
    };
    let unlit = Vec3::new(0.03, 0.52, 0.01);
    assert_near(with(Some(0.0), Some(0.0)), unlit);
    let only = |light| shade(&scene, &receivers, &[(light, &mask(&[Some(1.0)]))], Pipeline::AmbientLit).linear_rgb[0];
    assert_near(with(Some(0.0), Some(1.0)), only(&other));
    assert_near(with(Some(1.0), Some(0.0)), only(&scene.lights[0]));
    assert_near(with(Some(1.0), Some(0.25)) - only(&scene.lights[0]), 0.25 * (only(&other) - unlit));
    assert_eq!(with(None, None), with(Some(1.0), Some(1.0)));
    // Control: the two lights can be told apart.
    assert!(with(Some(0.0), Some(1.0)).distance(with(Some(1.0), Some(0.0))) > 0.01);
}

#[test]
fn a_mesh_that_does_not_receive_ignores_the_mask() {
    let mut scene = floor();
    let receivers = row(vec![on_floor(0.0, 0.0)]);
    let shadowed = |scene: &Scene| {
        shade(scene, &receivers, &[(&scene.lights[0], &mask(&[Some(0.0)]))], Pipeline::AmbientLit).linear_rgb[0]
    };
    assert_eq!(shadowed(&scene), Vec3::ZERO);
    scene.meshes[0].receives = false;
    assert!(shadowed(&scene).x > 0.05);
}

#[test]
fn flat_shading_uses_the_face_normal_whatever_the_corners_say() {
    let mut scene = floor();
    let receivers = row(vec![on_floor(1.0, 2.0)]);
    let lit = |scene: &Scene| {
        shade(scene, &receivers, &[(&scene.lights[0], &mask(&[None]))], Pipeline::AmbientLit).linear_rgb[0]
    };
    let expected = lit(&scene);
    scene.corner_normals = vec![[Vec3::new(0.6, 0.8, 0.0); 3]; 2];
    assert!(lit(&scene).distance(expected) > 1e-3, "the leaning normals show with Phong shading");
    scene.shading = Shading::Flat;
    assert_eq!(lit(&scene), expected);
}

/// Brightest pixel of a line of points across the floor below the lamp, and of the floor's corners.
fn brightest_inside_and_at_corners(scene: &Scene) -> (f32, f32) {
    let brightest = |pixels: Vec<Option<Receiver>>| {
        let masks = mask(&vec![None; pixels.len()]);
        let picture = shade(scene, &row(pixels), &[(&scene.lights[0], &masks)], Pipeline::AmbientLit);
        picture.linear_rgb.iter().map(|colour| colour.x).fold(0.0, f32::max)
    };
    let inside = (-7..=7).flat_map(|x| (-7..=7).map(move |z| on_floor(f64::from(x) / 2.0, f64::from(z) / 2.0)));
    let corners = [(-4.0, 4.0), (4.0, 4.0), (4.0, -4.0), (-4.0, -4.0)].map(|(x, z)| on_floor(x, z));
    (brightest(inside.collect()), brightest(corners.to_vec()))
}

#[test]
fn gouraud_has_its_extrema_at_vertices_and_phong_has_not() {
    let mut scene = floor();
    let (inside, corners) = brightest_inside_and_at_corners(&scene);
    assert!(inside > 2.0 * corners, "the lamp hangs over the middle");
    scene.shading = Shading::Gouraud;
    let (inside, corners) = brightest_inside_and_at_corners(&scene);
    assert!(inside <= corners * (1.0 + ROUNDING));
}

#[test]
fn gouraud_at_a_corner_is_the_corner_lit() {
    let mut scene = floor();
    let receivers = row(vec![on_floor(4.0, 4.0)]);
    let lit = |scene: &Scene| {
        shade(scene, &receivers, &[(&scene.lights[0], &mask(&[None]))], Pipeline::AmbientLit).linear_rgb[0]
    };
    let phong = lit(&scene);
    scene.shading = Shading::Gouraud;
    assert_near(lit(&scene), phong);
}

#[test]
fn on_a_smooth_torus_the_terminator_band_is_bounded_by_the_normals_angle() {
    let mut scene = scene_of(&[torus(12, 8)]);
    let smooth = |p: Vec3| {
        let ring = Vec3::new(p.x, 0.0, p.z).normalize();
        (p - ring).normalize()
    };
    scene.corner_normals = scene.triangles.iter().map(|t| t.map(|v| smooth(scene.positions[v as usize]))).collect();
    let centre = |id: u32| {
        let normal_in_world = scene.triangle_normal(id).normalize();
        let point_in_world = scene.triangle_in_world(id).iter().sum::<DVec3>() / 3.0;
        Some(Receiver { triangle: id, point_in_world, normal_in_world })
    };
    let receivers = row((0..scene.triangles.len() as u32).map(centre).collect());
    let light = &point_light(Vec3::new(3.0, 4.0, 1.0));
    let band = terminator(&scene, &receivers, light);
    assert!(band.contains(&true));
    for receiver in receivers.pixels.iter().flatten().zip(&band).filter_map(|(receiver, &on)| on.then_some(receiver)) {
        let facet = Facet::new(&scene, receiver);
        let largest = facet.normals.iter().map(|n| n.angle_between(receiver.normal_in_world)).fold(0.0, f64::max);
        let towards = incident(light, scene.mode, receiver.point_in_world).unwrap().towards_light;
        assert!(facet.shading_normal().dot(towards) <= largest.sin());
    }
}
