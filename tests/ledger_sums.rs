//! The ledger adds up: on every shipped scene, for every light and every kind of map, the causes' contributions make
//! exactly the error that was measured.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout, reason = "tests")]

mod support;

use glam::UVec2;
use gnomon::cause::Replay;
use gnomon::verdict::{LedgerError, RESIDUE_ABOVE, ledger};
use support::ledger::assert_adds_up;
use support::scenes::shipped;
use support::shot::{Shot, shipped_scenes};

const SIZE: UVec2 = UVec2::new(80, 60);

/// Every axis, every format, filters of odd and even kernels, sizes far too small and of no power of two, every kind of
/// bias alone and together, and frusta that cut; volumes by what their stencils are given.
const SPECS: &[&str] = &[
    "map",
    "map:bias=none",
    "map:size=512,bias=constant",
    "map:bias=slope",
    "map:size=512,bias=slope,bias_constant_ulps=1000,bias_clamp=0.001",
    "map:size=512,filter=pcf-box2",
    "map:size=700,filter=pcf-box3,bias=none",
    "map:filter=pcf-box5,bias=slope",
    "map:size=256,filter=pcf-box8",
    "map:size=512,filter=pcf-bilinear",
    "map:size=300,filter=pcf-poisson",
    "map:depth_convention=forward,bias=slope",
    "map:size=512,format=depth16unorm,bias=none",
    "map:format=depth16unorm,depth_convention=forward,filter=pcf-box3",
    "map:size=512,format=depth24plus,bias=slope",
    "map:size=64",
    "map:size=1,bias=none",
    "map:size=101,bias_normal_texels=2",
    "map:size=256,bias=none,bias_normal_texels=1.5,filter=pcf-box4",
    "map:size=400,bias_depth_m=0.05",
    "map:size=300,bias=normal,filter=pcf-box3",
    "map:size=200,bias=receiver-plane,filter=pcf-bilinear3",
    "map:projection=cube,size=100,bias=receiver-plane,filter=pcf-box4,depth_convention=forward",
    "map:projection=cascaded,size=80,bias=normal,filter=pcf-box3,bias_depth_texels=0.5",
    "map:projection=trapezoidal,size=100,bias=receiver-plane,filter=pcf-poisson,bias_cap_texels=2",
    "silhouette:size=33,bias=receiver-plane",
    "map:size=200,filter=pcss,bias=receiver-plane",
    "map:size=300,bias=midpoint",
    "map:size=128,bias=midpoint,filter=pcf-box3,depth_convention=forward,format=depth16unorm,bias_slope=1",
    "map:projection=trapezoidal,size=128,bias=midpoint",
    "map:projection=dual-paraboloid,size=90,bias=midpoint,filter=pcf-box2",
    "map:projection=dual-paraboloid,size=90,bias=receiver-plane,filter=pcf-box3",
    "map:projection=cube,size=64,bias=midpoint,near_mode=fragment-clamp,filter=pcf-bilinear2",
    "map:fit=receivers,size=300",
    "map:fit=manual,filter=pcf-box3",
    "irregular",
    "silhouette",
    "silhouette:size=33,bias=none",
    "map:size=333,near_m=3,far_m=5,phase_u_texels=0.3",
    "map:near_m=0.7,near_mode=depth-clamp,filter=pcf-box3",
    "map:near_mode=fragment-clamp,bias=slope,depth_convention=forward",
    "map:near_mode=vertex-clamp,size=300,bias=slope,bias_constant_ulps=40",
    "map:near_m=2.5,near_mode=vertex-clamp,size=200,filter=pcf-box3,depth_convention=forward,bias=none",
    "map:projection=cube,size=64,near_m=1.5,near_mode=vertex-clamp,filter=pcf-bilinear2",
    "map:projection=cascaded,cascade_fit=box,size=100,near_mode=vertex-clamp,seam=clamp,filter=vsm3",
    "map:projection=perspective,size=150,near_mode=vertex-clamp,bias_normal_texels=1",
    "map:projection=adaptive,tile_texels=32,max_tiles=30,near_margin_m=0.05,near_mode=vertex-clamp",
    "map:size=500,caster_sides=away-facing,bias=none",
    "map:size=300,caster_sides=light-facing",
    "map:fit=manual,border=shadow,filter=pcf-box4",
    "map:fit=manual,border=clamp-edge,filter=pcf-box3,size=200",
    "map:projection=cube,size=128,filter=pcf-box5",
    "map:projection=cascaded,size=128,blend_texels=6,filter=pcf-box3",
    "map:projection=cascaded,cascade_fit=box,selection=by-projection,size=90,bias=slope,cascades=8,lambda=1",
    "map:projection=cascaded,cascades=3,splits_m=2/5,overlap_ratio=0.3,size=80,bias=slope,filter=pcf-box3",
    "map:projection=cascaded,cascade_fit=box,cascades=2,splits_m=4,overlap_ratio=0.5,blend_texels=3,size=70",
    "map:projection=cascaded,max_distance_m=4,size=60,border=shadow,caster_sides=away-facing",
    "map:projection=perspective,size=100",
    "map:projection=perspective,size=200,bias=slope,depth_convention=forward,virtual_back_m=0,filter=pcf-box4",
    "map:projection=trapezoidal,size=100,filter=pcf-box3,caster_sides=away-facing",
    "map:projection=trapezoidal,size=300,bias=slope,near_mode=depth-clamp,focus_fraction=0.7",
    "map:projection=light-space-perspective,size=100,bias=constant",
    "map:projection=light-space-perspective,size=90,near_mode=fragment-clamp,filter=pcf-box3,caster_sides=away-facing",
    "map:projection=light-space-perspective,size=64,n_opt_scale=0.2,filter=pcf-box2,depth_convention=forward",
    "map:projection=cube,size=64,seam=clamp,filter=pcf-box8,bias=slope",
    "map:projection=cube,size=3,bias=none,depth_convention=forward,phase_u_texels=0.4,filter=pcf-box16",
    "map:projection=dual-paraboloid,size=200,filter=pcf-box3",
    "map:projection=dual-paraboloid,size=101,max_edge_deg=0,bias=slope,caster_sides=away-facing",
    "map:projection=dual-paraboloid,size=60,max_edge_deg=9,bias=none,seam=clamp,filter=pcf-poisson,orientation=down",
    "map:projection=dual-paraboloid,size=3,near_m=1,near_mode=fragment-clamp,depth_convention=forward,filter=pcf-box5",
    "map:projection=adaptive,tile_texels=16,max_tiles=70,filter=pcf-box4",
    "map:projection=adaptive,tile_texels=33,max_tiles=20,edges_only=off,m_target=0.5,bias=slope,seam=clamp,filter=pcf-box3",
    "map:depth_metric=linear,size=300,bias=slope",
    "map:projection=cube,depth_metric=linear,depth_convention=forward,filter=pcf-box2,size=100",
    "map:projection=trapezoidal,depth_metric=linear,size=200,bias=slope",
    "map:size=256,filter=pcss",
    "map:projection=cube,size=128,filter=pcss16,search_taps=9,turn=per-pixel,depth_convention=forward,max_texels=30",
    "map:filter=pcss,size=200,bias=slope,min_texels=0,border=clamp-edge",
    "hybrid",
    "hybrid:size=16,widen_texels=1,map=(map:bias=slope),volume=(volume:count=mixed)",
    "hybrid:size=1,volume=(volume:extrude=gpu,scissor=on)",
    "hybrid:size=100,map=(map:projection=cube,bias=midpoint)",
    "map:size=300,filter=pcss16,bias=receiver-plane",
    "map:size=300,filter=pcf-hardware3,bias=slope",
    "map:filter=pcf-hardware,depth_convention=forward,size=200,format=depth16unorm,border=clamp-edge",
    "map:projection=cube,size=90,filter=pcf-hardware2",
    "map:size=200,filter=pcf-edge-masked4,bias=receiver-plane",
    "map:projection=cascaded,size=100,filter=pcf-edge-masked9,mask_level=4,depth_convention=forward",
    "map:size=300,filter=pcf-poisson9,turn=per-pixel,seed=3,poisson_radius_texels=5.5",
    "map:size=300,filter=vsm",
    "map:filter=vsm4,bleeding_cut=0.2,size=200,depth_convention=forward,border=shadow,fit=manual",
    "map:filter=esm5,size=256,moment_format=float16",
    "map:projection=trapezoidal,filter=evsm2,size=200,border=shadow",
    "map:filter=evsm,moment_format=float16,exponent=30,size=200",
    "map:filter=msm,size=300,bias=none",
    "map:filter=depth-mean6,size=150,moment_format=float16",
    "map:projection=cube,seam=clamp,filter=msm5,size=90",
    "map:projection=cascaded,seam=clamp,filter=vsm3,size=90,blend_texels=5",
    "map:projection=dual-paraboloid,seam=clamp,filter=vsm5,size=90",
    "map:projection=dual-paraboloid,seam=clamp,filter=evsm2,size=101,depth_convention=forward,moment_format=float16",
    "map:projection=adaptive,seam=clamp,filter=msm3,tile_texels=32,max_tiles=20,depth_convention=forward",
    "volume:extrude=degenerate-quads",
    "volume:range_mask=on",
    "volume:count=z-pass,range_mask=on,scissor=on",
    "volume:count=z-pass,stencil_init=eye-count",
    "volume:count=mixed,caster_sides=all,extrude=degenerate-quads,stencil_init=eye-count",
];

#[test]
fn the_contributions_of_all_causes_are_the_error_in_every_scene() {
    let mut evaluated = vec![0; SPECS.len()];
    for scene in shipped_scenes(SIZE) {
        for light in &scene.lights {
            let shot = Shot::new(&scene, &light.name);
            for (spec, evaluated) in SPECS.iter().zip(&mut evaluated) {
                let what = format!("{}, light '{}', {spec}", scene.name, light.name);
                // Cascades are for the sun, cubes for lamps, and a lamp among what is seen has no perspective map.
                let Some(evaluation) = shot.evaluate_if_supported(&shot.supported(spec)) else { continue };
                assert_adds_up(&what, &evaluation);
                *evaluated += 1;
            }
        }
    }
    println!("evaluations: {evaluated:?}");
    assert_eq!(evaluated.iter().max(), evaluated.first(), "the plain map answers for every light");
    assert!(evaluated[0] >= 14, "the scenes of the repository alone have 14 lights");
    assert!(evaluated.iter().all(|count| *count >= 4), "every specification suits some lights");
}

/// What answers for the extent of a light, on the scene that has such lights.
const SOFT_SPECS: &[&str] = &[
    "soft:samples=4,inner=(map:size=100,filter=pcf-box3,bias=slope)",
    "soft:samples=9,pattern=stratified,seed=3,inner=(volume)",
    "soft:samples=3,pattern=hammersley,inner=(irregular)",
    "soft:samples=4,pattern=grid-midpoint,inner=(map:size=100,filter=msm)",
    "map:size=500,filter=pcss64,search_taps=40,bias=none",
    "map:projection=cube,size=200,filter=pcss,depth_convention=forward",
    "map:projection=adaptive,filter=pcss16,tile_texels=32,turn=per-pixel",
    "map:projection=dual-paraboloid,size=300,filter=pcss,depth_convention=forward",
];

#[test]
fn so_they_are_for_lights_with_an_extent() {
    let scene = shipped("area", SIZE.to_array());
    for light in scene.lights.iter().filter(|light| light.is_area()) {
        let shot = Shot::new(&scene, &light.name);
        for spec in SOFT_SPECS {
            assert_adds_up(
                &format!("area, light '{}', {spec}", light.name),
                &shot.evaluate_spec(&shot.supported(spec)),
            );
        }
    }
}

#[test]
fn a_replay_that_ends_elsewhere_is_refused() {
    let scene = shipped("triangle", SIZE.to_array());
    let shot = Shot::new(&scene, "lamp");
    let evaluation = shot.evaluate("map:bias=none");
    let judged = |replay: &Replay| ledger(&evaluation.verdict, &shot.question.truth.mask, &evaluation.mask, replay);
    let mut tampered = evaluation.replay.clone();
    assert_eq!(judged(&tampered), Ok(evaluation.ledger.clone()));
    let last = tampered.stages.last_mut().expect("stages");
    last.values[0] = (last.values[0] - 1e3 * RESIDUE_ABOVE).abs();
    assert!(matches!(judged(&tampered), Err(LedgerError::Residue { .. })));
}
