//! Projective textures against exact rays and against the shadow map with the same frustum; and that every shader of
//! both planar families is valid WGSL.

mod planar_stage;
mod support;

use glam::{DVec3, UVec2, Vec3};
use gnomon::cast::Casters;
use gnomon::cause::Cause;
use gnomon::gpu::shader::concatenated;
use gnomon::scene::{Scene, Segment};
use gnomon::technique::{planar, projective_texture};
use planar_stage::*;

const LAMP: Vec3 = Vec3::new(0.5, 4.0, 0.3);
const PICTURE: &str = "projective-texture:size=256";

/// A cube over a torus over the floor; the frustum holds all of it.
fn torus_stage() -> Scene {
    let casters = [torus_at(DVec3::new(0.0, 1.5, 0.0), 0.8), cube(Vec3::new(0.8, 2.4, 0.3), 0.2)];
    stage_on(&casters, &[floor(4.0)], LAMP)
}

/// Wrong pixels that texels or rounding, not the model, are to blame for.
fn sampled(outcome: &Outcome) -> u64 {
    [Cause::EdgeAliasing, Cause::PerspectiveAliasing, Cause::ProjectiveAliasing, Cause::Precision]
        .map(|cause| outcome.wrong_by(cause))
        .iter()
        .sum()
}

#[test]
fn behind_every_caster_it_answers_as_the_map_does() {
    for filter in ["nearest", "pcf-box3"] {
        let scene = torus_stage();
        let picture = outcome(&scene, &format!("{PICTURE},filter={filter}"));
        let map = outcome(&scene, &format!("map:size=256,bias=none,filter={filter}"));
        let differing = picture.mask.pixels.iter().zip(&map.mask.pixels).zip(&picture.receivers.pixels);
        let on_floor = differing.filter(|(_, receiver)| receiver.is_some_and(|r| r.point_in_world.y.abs() < 1e-9));
        let values: Vec<_> = on_floor.map(|(pair, _)| pair).collect();
        assert!(values.iter().any(|(picture, _)| picture.is_some_and(|value| value.get() < 0.5)));
        assert_eq!(values.iter().filter(|(picture, map)| picture != map).count(), 0, "{filter}");
    }
}

#[test]
fn casters_miss_all_shadow_on_themselves_and_each_other() {
    let scene = torus_stage();
    let caster_triangles = scene.meshes[1].triangles.end;
    let picture = outcome(&scene, PICTURE);
    let own = picture.count(|triangle, _, truth| triangle < caster_triangles && truth < 0.5);
    assert!(own > 30, "{own}");
    assert_eq!(picture.wrong_by(Cause::TechniqueModel), own);
    assert_eq!(picture.verdict.pixels.wrong, own + sampled(&picture));
    // Thrown on every mesh, the picture blackens all of the caster that the light sees, and nothing white is left on it.
    let all = outcome(&scene, &format!("{PICTURE},receivers=all"));
    let lit = all.count(|triangle, _, truth| triangle < caster_triangles && truth > 0.5);
    assert!(all.wrong_by(Cause::TechniqueModel).abs_diff(lit) <= sampled(&all) + 8, "{lit} {:?}", all.ledger.causes);
}

#[test]
fn what_stands_in_front_of_a_caster_is_darkened() {
    let caster = cube(Vec3::new(0.0, 0.8, 0.0), 0.5);
    let before = quad(Vec3::new(-0.9, 2.2, -0.9), Vec3::Z * 1.8, Vec3::X * 1.8);
    let scene = stage_on(&[caster], &[before, floor(4.0)], LAMP);
    let picture = outcome(&scene, PICTURE);
    // Exactly: lit receivers with a caster farther along their ray from the light.
    let casters = Casters::new(&scene);
    let light = LAMP.as_dvec3();
    let has_caster_behind = |point: DVec3| {
        let beyond = Segment { from: point, to: point + (point - light).normalize() * 20.0 };
        casters.any_hit(&beyond, None).is_some()
    };
    let caster_triangles = scene.meshes[0].triangles.end;
    let exact =
        picture.count(|triangle, point, truth| triangle >= caster_triangles && truth > 0.5 && has_caster_behind(point));
    assert!(exact > 30, "{exact}");
    assert!(
        picture.wrong_by(Cause::TechniqueModel).abs_diff(exact) <= sampled(&picture),
        "{exact} {:?}",
        picture.ledger.causes
    );
    assert_eq!(outcome(&scene, "map:size=256,bias=closed-form").wrong_by(Cause::TechniqueModel), 0);
}

#[test]
fn a_window_too_narrow_is_clipping() {
    let scene = torus_stage();
    let narrow = outcome(&scene, &format!("{PICTURE},fov_deg=20"));
    assert!(narrow.wrong_by(Cause::ClippingFrustum) > 50, "{:?}", narrow.ledger.causes);
    let late = outcome(&scene, &format!("{PICTURE},near_m=3.5"));
    assert!(late.wrong_by(Cause::ClippingNear) > 50, "{:?}", late.ledger.causes);
    let early = outcome(&scene, &format!("{PICTURE},near_m=0.1,far_m=2.1"));
    assert!(early.wrong_by(Cause::ClippingFar) > 50, "{:?}", early.ledger.causes);
}

#[test]
fn a_filter_softens_and_finer_texels_sharpen() {
    let scene = torus_stage();
    let wrong = |spec: &str| outcome(&scene, spec).verdict.pixels.wrong;
    let [coarse, fine] = [64, 1024].map(|size| wrong(&format!("projective-texture:size={size}")));
    assert!(fine < coarse, "{fine} {coarse}");
    let soft = outcome(&scene, "projective-texture:size=64,filter=pcf-box5");
    assert!(soft.ledger.causes[&Cause::FilterWidth].merely_differing > 100);
}

#[test]
fn extremes_give_answers() {
    let covering = stage_on(&[quad(Vec3::new(-4.5, 1.0, -4.5), Vec3::Z * 9.0, Vec3::X * 9.0)], &[floor(4.0)], LAMP);
    let mut lit_by_sun = torus_stage();
    sun(&mut lit_by_sun, Vec3::new(0.3, 1.0, 0.2));
    let mut single = torus_stage();
    single.image_size = UVec2::ONE;
    let bare = stage_on(&[], &[floor(4.0)], LAMP);
    for scene in [&covering, &lit_by_sun, &single, &bare] {
        for spec in ["projective-texture:size=1", "projective-texture:size=2,filter=pcf-box4", PICTURE] {
            outcome(scene, spec);
        }
    }
    assert_eq!(outcome(&bare, PICTURE).verdict.pixels.wrong, 0);
}

#[test]
fn footprints_are_those_of_the_map() {
    let scene = torus_stage();
    let [picture, map] = [PICTURE, "map:size=256"].map(|spec| footprint_at_centre(&scene, spec));
    assert!(picture.is_some());
    assert_eq!(picture, map);
}

#[test]
fn every_shader_of_the_families_is_valid() {
    let modules = planar::shader_modules().into_iter().chain(projective_texture::shader_modules());
    for (label, files) in modules {
        assert!(is_valid(&concatenated(&files)), "{label}");
    }
    assert!(!is_valid("fn broken() -> f32 { return 1u; }"));
}

fn is_valid(text: &str) -> bool {
    let Ok(module) = naga::front::wgsl::parse_str(text) else { return false };
    let mut validator =
        naga::valid::Validator::new(naga::valid::ValidationFlags::all(), naga::valid::Capabilities::all());
    validator.validate(&module).is_ok()
}
