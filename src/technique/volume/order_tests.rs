//! Draw order: a stencil that wraps does not know it, one that stops at its ends does.

use super::eye::Eye;
use super::passes::VolumePasses;
use super::settings::Settings;
use super::volumes::Volumes;
use crate::cast::Casters;
use crate::cast::testing::Random;
use crate::gpu::{GBufferPass, Geometry, Gpu};
use crate::inspect::fixtures::{cube, scene_of, torus};
use crate::inspect::neighbours;
use crate::receiver::{Asked, Receivers};
use crate::scene::{LightKind, Scene};
use crate::technique::volume::target::Target;
use crate::technique::{Job, Spec};
use glam::{DVec3, UVec2, Vec3};

/// Fisher and Yates' shuffle of whole triangles.
fn shuffle(corners: &mut [u32], random: &mut Random) {
    let (triangles, _) = corners.as_chunks_mut::<3>();
    for last in (1..triangles.len()).rev() {
        let other = (random.unit() * (last + 1) as f64) as usize;
        triangles.swap(last, other);
    }
}

/// A torus over a cube, lit from above.
fn scene() -> Scene {
    let mut ring = torus(24, 12);
    ring.positions.iter_mut().for_each(|position| *position += DVec3::Y);
    let mut scene = scene_of(&[ring, cube(DVec3::new(-0.5, -2.0, -0.5))]);
    let position = Vec3::new(0.6, 5.0, 1.2);
    scene.lights[0].kind = LightKind::Point { position, aim: Vec3::ZERO, attenuation: [1.0, 0.0, 0.0] };
    scene.image_size = UVec2::new(120, 90);
    scene
}

/// The stencils that a specification leaves with its faces in their own order and in some shuffled ones.
fn stencils(gpu: &Gpu, scene: &Scene, typed: &str) -> Vec<Vec<u8>> {
    const ORDERS: u64 = 4;
    let geometry = Geometry::upload(gpu, scene).unwrap();
    let gbuffer = GBufferPass::new(gpu, scene).unwrap();
    gbuffer.run(gpu, &geometry).unwrap();
    let receivers = Receivers::new(scene, &gbuffer.read(gpu).unwrap().triangles);
    let light = &scene.lights[0];
    let classes = receivers.classify(scene, light);
    let (casters, adjacency) = (Casters::new(scene), neighbours(scene));
    let job = Job {
        gpu,
        scene,
        geometry: &geometry,
        casters: &casters,
        adjacency: &adjacency,
        light,
        receivers: &receivers,
        classes: &classes,
        fitted_to: Asked { receivers: &receivers, classes: &classes },
    };
    let settings = Settings::of(&Spec::parse(typed).unwrap());
    let eye = Eye::new(scene, &settings).unwrap();
    let target = Target::everywhere(&job).unwrap();
    let stencil = |seed: u64| {
        let mut volumes = Volumes::new(scene, light, &settings, &eye);
        if seed > 0 {
            let mut random = Random(seed);
            for faces in [&mut volumes.behind, &mut volumes.before] {
                let lists =
                    [&mut faces.sides, &mut faces.back_caps, &mut faces.front_caps, &mut faces.inward_front_caps];
                lists.into_iter().for_each(|list| shuffle(list, &mut random));
            }
        }
        let passes = VolumePasses::new(&job, &settings, &eye, &volumes, &target, 0).unwrap();
        passes.run(gpu, &target.receivers).unwrap();
        passes.stencil(gpu).unwrap()
    };
    (0..=ORDERS).map(stencil).collect()
}

#[test]
fn a_wrapping_stencil_is_the_same_in_any_order_and_a_clamping_one_is_not() {
    let gpu = Gpu::open().unwrap();
    let scene = scene();
    for count in ["z-fail", "z-pass"] {
        let typed = format!("volume:shape=per-triangle,count={count}");
        let two_sided = stencils(&gpu, &scene, &typed);
        assert!(two_sided[0].iter().any(|count| *count > 1));
        assert!(two_sided.iter().all(|stencil| *stencil == two_sided[0]), "{count}");
        let two_pass = stencils(&gpu, &scene, &format!("{typed},faces=two-pass"));
        assert!(two_pass.iter().all(|stencil| *stencil == two_sided[0]), "{count} two-pass");
        // Control: where a volume may be left before it is entered, stopping at 0 leaves one too many.
        let stopping = stencils(&gpu, &scene, &format!("{typed},stencil_ops=clamp"));
        let more = |stencil: &Vec<u8>| stencil.iter().zip(&two_sided[0]).any(|(stops, wraps)| stops > wraps);
        assert!(stopping.iter().any(more), "{count}");
        assert!(stopping.iter().all(|stencil| stencil.iter().zip(&two_sided[0]).all(|(stops, wraps)| stops >= wraps)));
    }
}
