//! The lighting pipelines on the GPU against their f64 twin, and faults planted in their shaders.

use super::View;
use crate::gpu::Gpu;
use crate::mask::{Mask, Visibility};
use crate::receiver::PixelClass;
use crate::scene::{Falloff, Light, LightKind, LightingMode, LoadOptions, Scene, Shading, load};
use crate::shade::{BACKGROUND, Picture, Pipeline, shade};
use crate::technique::Spec;
use crate::technique::lighting::{light_up, shader_modules};
use glam::{UVec2, Vec3};
use std::path::Path;

const SIZE: UVec2 = UVec2::new(120, 90);
/// Roundings to halves, 2⁻¹¹ each: the base, and twice per light where darkness is blended.
const HALVES: f32 = 6.0 / 2048.0;
/// f32 positions, directions and powers of up to 1000, as a share of white.
const SINGLE: f32 = 2e-4;
/// Pixels that a cone's edge runs through within f32 rounding.
const AT_A_RIM: usize = 1;

const PIPELINES: [Pipeline; 3] = [Pipeline::AmbientLit, Pipeline::Black, Pipeline::Darkening { amount: 0.6 }];
const SHADINGS: [Shading; 4] = [Shading::Phong, Shading::BlinnPhong, Shading::Gouraud, Shading::Flat];

fn scene(name: &str) -> Scene {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name);
    load(&folder, &LoadOptions { size: Some(SIZE), ..LoadOptions::default() }).unwrap()
}

/// Shadows of every light by volumes; facets turned away are dark, and every seventh pixel is half lit.
fn masks(view: &View<'_>) -> Vec<Mask> {
    let of_light = |light: &Light| {
        let classes = view.receivers.classify(view.scene, light);
        let prepared = Spec::parse("volume").unwrap();
        let prepared = prepared.technique().prepare(&prepared, view.job(light, &classes)).unwrap();
        let mut mask = prepared.run().unwrap().mask;
        for (index, (pixel, class)) in mask.pixels.iter_mut().zip(&classes).enumerate() {
            match class {
                PixelClass::FacingAway => *pixel = Some(Visibility::SHADOW),
                PixelClass::Asked if index % 7 == 0 => *pixel = Visibility::new(0.5),
                _ => {}
            }
        }
        mask
    };
    view.scene.lights.iter().map(of_light).collect()
}

/// Pixels whose colours differ by more than rounding.
fn differing(one: &[Vec3], other: &Picture) -> usize {
    let differs = |(one, other): (&Vec3, &Vec3)| {
        let most = HALVES * one.max_element().max(other.max_element()) + SINGLE;
        let gap = (*one - *other).abs().max_element();
        gap.is_nan() || gap > most
    };
    one.iter().zip(&other.linear_rgb).filter(|pair| differs(*pair)).count()
}

fn lit<'l>(scene: &'l Scene, masks: &'l [Mask]) -> Vec<(&'l Light, &'l Mask)> {
    scene.lights.iter().zip(masks).collect()
}

/// The twin's picture of one scene against the device's of another.
fn compared(gpu: &Gpu, drawn: &Scene, twin: &Scene, masks: [&[Mask]; 2], pipeline: Pipeline) -> usize {
    let view = View::new(gpu, drawn).unwrap();
    let picture = light_up(gpu, drawn, &view.geometry, &lit(drawn, masks[0]), pipeline, BACKGROUND).unwrap();
    differing(&picture, &shade(twin, &view.receivers, &lit(twin, masks[1]), pipeline))
}

#[test]
fn every_pipeline_and_shading_model_is_its_twin() {
    let gpu = Gpu::open().unwrap();
    for name in ["torus", "room", "contact"] {
        let mut scene = scene(name);
        scene.materials.iter_mut().for_each(|material| {
            (material.specular, material.shininess) = (Vec3::splat(0.4), 40.0);
            material.emission = Vec3::new(0.01, 0.0, 0.02);
        });
        let masks = masks(&View::new(&gpu, &scene).unwrap());
        for shading in SHADINGS {
            for mode in [LightingMode::Physical, LightingMode::Classic] {
                (scene.shading, scene.mode) = (shading, mode);
                for pipeline in PIPELINES {
                    let off = compared(&gpu, &scene, &scene, [&masks, &masks], pipeline);
                    assert!(off <= AT_A_RIM, "{name} {shading:?} {mode:?} {pipeline:?}: {off}");
                }
            }
        }
    }
}

#[test]
fn every_cone_and_attenuation_is_its_twin() {
    let gpu = Gpu::open().unwrap();
    let mut scene = scene("room");
    let masks = masks(&View::new(&gpu, &scene).unwrap());
    let falloffs = [
        Falloff::Hard,
        Falloff::Linear { inner_rad: 0.2 },
        Falloff::Warn { power: 0.0 },
        Falloff::Warn { power: 12.0 },
    ];
    for new_falloff in falloffs {
        for (mode, range_m) in [(LightingMode::Physical, f64::INFINITY), (LightingMode::Classic, 3.5)] {
            scene.mode = mode;
            for light in &mut scene.lights {
                light.range_m = range_m;
                match &mut light.kind {
                    LightKind::Spot { falloff, attenuation, .. } => {
                        (*falloff, *attenuation) = (new_falloff, [0.2, 0.1, 0.05]);
                    }
                    LightKind::Point { attenuation, .. } => *attenuation = [0.0, 0.3, 0.2],
                    _ => {}
                }
            }
            let off = compared(&gpu, &scene, &scene, [&masks, &masks], Pipeline::AmbientLit);
            assert!(off <= 2 * AT_A_RIM, "{new_falloff:?} {mode:?}: {off}");
        }
    }
}

#[test]
fn wrong_pictures_are_told_from_right_ones() {
    let gpu = Gpu::open().unwrap();
    let mut scene = scene("torus");
    scene.materials.iter_mut().for_each(|m| (m.specular, m.shininess) = (Vec3::splat(0.4), 40.0));
    let masks = masks(&View::new(&gpu, &scene).unwrap());
    let mut blunter = scene.clone();
    blunter.materials.iter_mut().for_each(|material| material.shininess = 20.0);
    assert!(compared(&gpu, &scene, &blunter, [&masks, &masks], Pipeline::AmbientLit) > 50);
    // Darkness where the stencil is 0 instead of where it is not.
    let swapped = |visibility: Visibility| Visibility::new(1.0 - visibility.get());
    let inverted: Vec<Mask> = masks
        .iter()
        .map(|mask| Mask { pixels: mask.pixels.iter().map(|pixel| pixel.and_then(swapped)).collect(), ..mask.clone() })
        .collect();
    for pipeline in PIPELINES {
        assert!(compared(&gpu, &scene, &scene, [&masks, &inverted], pipeline) > 500, "{pipeline:?}");
    }
}

#[test]
fn a_fault_in_either_shader_is_noticed() {
    const FAULTS: [(&str, &str, &str); 3] = [
        ("lighting/surface.wgsl", "2.0 * cosine * normal", "1.9 * cosine * normal"),
        ("lighting/surface.wgsl", "part.own * own", "own"),
        ("lighting/shadow.wgsl", "visibility > shadow.most_seen", "visibility < shadow.most_seen"),
    ];
    let modules = shader_modules();
    let mut gpu = Gpu::open().unwrap();
    let mut scene = scene("torus");
    scene.materials.iter_mut().for_each(|m| (m.specular, m.shininess) = (Vec3::splat(0.4), 40.0));
    let masks = masks(&View::new(&gpu, &scene).unwrap());
    for (path, from, to) in FAULTS {
        assert!(modules.iter().flat_map(|(_, files)| files).any(|file| file.path == path && file.text.contains(from)));
        gpu.fault = Some((from, to));
        let off = PIPELINES.map(|pipeline| compared(&gpu, &scene, &scene, [&masks, &masks], pipeline));
        assert!(off.iter().any(|off| *off > 20), "{path}: {from:?} goes unnoticed: {off:?}");
    }
}
