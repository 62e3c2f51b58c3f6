//! Planar shadows on the GPU against exact rays: exact on the plane, and every guard case with its predicted result and
//! cause.

mod planar_stage;
mod support;

use glam::{DVec3, UVec2, Vec3};
use gnomon::cause::Cause;
use gnomon::scene::Plane;
use gnomon::technique::{Spec, Unsupported};
use planar_stage::*;
use support::testing::Shape;

const LAMP: Vec3 = Vec3::new(0.5, 4.0, 0.3);
/// The projections by M, the default first.
const MATRICES: [&str; 3] = ["planar", "planar:projection=homogeneous", "planar:projection=divided"];
/// Pixels whose centres the rasteriser's snapped edges pass on the wrong side: a few per shadow outline.
const SNAPPED_PX: u64 = 8;

/// A torus in the air, a cube that straddles the plane, one above the lamp and one below the plane.
fn guarded_casters() -> [Shape; 4] {
    [
        torus_at(DVec3::new(-0.6, 1.5, 0.0), 0.7),
        cube(Vec3::new(1.8, 0.0, 0.4), 0.3),
        cube(Vec3::new(0.9, 5.2, 0.8), 0.3),
        cube(Vec3::new(-0.3, -1.0, 1.6), 0.4),
    ]
}

const CAMERAS: [(Vec3, Vec3); 3] = [
    (Vec3::new(1.2, 4.5, 6.0), Vec3::new(0.1, 0.3, 0.0)),
    (Vec3::new(-5.0, 2.0, 3.0), Vec3::new(0.0, 0.0, 0.2)),
    (Vec3::new(0.3, 3.6, -2.5), Vec3::new(0.0, 0.0, -0.1)),
];

fn is_on_floor(point: DVec3) -> bool {
    point.y.abs() < 1e-9
}

#[test]
fn clipped_shadows_are_exact_on_the_plane_whatever_stands_around() {
    for (eye, target) in CAMERAS {
        let mut scene = stage(&guarded_casters(), LAMP);
        look(&mut scene, eye, target);
        let clipped = outcome(&scene, "planar");
        let off_plane = clipped.count(|_, point, truth| !is_on_floor(point) && truth < 0.5);
        let shadowed = clipped.count(|_, point, truth| is_on_floor(point) && truth < 0.5);
        assert!(shadowed > 100, "there is something to get wrong: {shadowed}");
        assert_eq!(clipped.wrong_by(Cause::PlanarModel), off_plane, "what stands in a shadow stays lit");
        let on_plane = clipped.verdict.pixels.wrong - off_plane;
        assert_eq!(clipped.wrong_by(Cause::Precision), on_plane);
        assert!(on_plane <= SNAPPED_PX, "{on_plane}");
        let off_edge = clipped
            .ledger
            .wrong
            .iter()
            .filter(|(pixel, cause)| *cause == Cause::Precision && !at_edge(&clipped.truth, *pixel));
        assert_eq!(off_edge.count(), 0);
        assert!(clipped.answers().all(|(point, value)| is_on_floor(point) || value == 1.0));
    }
}

#[test]
fn what_the_naive_matrices_draw_too_much_has_its_cause() {
    let scene = stage(&guarded_casters(), LAMP);
    let behind = outcome(&scene, "planar:projection=homogeneous");
    assert!(behind.wrong_by(Cause::FalseShadowBehindPlane) > 50);
    assert_eq!(behind.wrong_by(Cause::AntiShadow), 0, "w clips what lies beyond the light");
    let both = outcome(&scene, "planar:projection=divided");
    assert_eq!(both.wrong_by(Cause::FalseShadowBehindPlane), behind.wrong_by(Cause::FalseShadowBehindPlane));
    assert!(both.wrong_by(Cause::AntiShadow) > 50);
}

/// One caster in each forbidden place: who draws what it should not, and why.
#[test]
fn each_guard_case_alone() {
    let below = stage(&[cube(Vec3::new(0.0, -1.0, 0.5), 0.4)], LAMP);
    let above = stage(&[cube(Vec3::new(0.9, 5.2, 0.8), 0.3)], LAMP);
    let [clipped, homogeneous, divided] = MATRICES;
    for (scene, spec, cause) in [
        (&below, homogeneous, Some(Cause::FalseShadowBehindPlane)),
        (&below, divided, Some(Cause::FalseShadowBehindPlane)),
        (&below, clipped, None),
        (&above, homogeneous, None),
        (&above, divided, Some(Cause::AntiShadow)),
        (&above, clipped, None),
    ] {
        let result = outcome(scene, spec);
        let (wrong, owned) = cause.map_or((0, 0), |cause| result.wrong_and_by(cause));
        assert_eq!(wrong, owned, "{spec}");
        assert_eq!(wrong > 50, cause.is_some(), "{spec}: {wrong}");
        assert_eq!(result.verdict.pixels.wrong, wrong, "{spec}");
    }
}

#[test]
fn a_caster_through_the_lights_height_breaks_divided_triangles_only() {
    // Its corners are on both sides of the light, none at its height.
    let sheet = quad(Vec3::new(-1.5, 3.2, -1.0), Vec3::new(0.0, 0.0, 2.0), Vec3::new(0.6, 1.4, 0.0));
    let scene = stage(&[sheet], LAMP);
    for spec in &MATRICES[..2] {
        let result = outcome(&scene, spec);
        assert_eq!(result.wrong_by(Cause::AntiShadow), 0, "{spec}");
        assert!(result.verdict.pixels.wrong <= SNAPPED_PX, "{spec}: {:?}", result.ledger.causes);
    }
    assert!(outcome(&scene, MATRICES[2]).wrong_by(Cause::AntiShadow) > 50);
    // A corner exactly at the light's height has w = 0.
    let scene = stage(&[quad(Vec3::new(-1.5, 4.0, -1.0), Vec3::new(0.0, 0.0, 2.0), Vec3::new(0.6, -1.4, 0.0))], LAMP);
    for spec in MATRICES {
        outcome(&scene, spec);
    }
    assert!(outcome(&scene, MATRICES[0]).verdict.pixels.wrong <= SNAPPED_PX);
}

#[test]
fn kappa_clips_what_is_just_below_the_light() {
    let height = 4.0 * (1.0 - 2e-5);
    let scene = stage(&[quad(Vec3::new(0.4999, height, 0.2999), Vec3::Z * 2e-4, Vec3::X * 2e-4)], LAMP);
    let coarse = outcome(&scene, "planar:kappa=0.001");
    let fine = outcome(&scene, "planar:kappa=1e-9");
    assert!(fine.verdict.pixels.wrong <= SNAPPED_PX * 4, "{:?}", fine.ledger.causes);
    // The near plane is at 1 cm and the picture several metres away, so kappa counts for less than its share.
    let mut near = scene;
    near.camera.near_m = 1.0;
    let clipped = outcome(&near, "planar:kappa=0.001");
    assert!(coarse.wrong_by(Cause::ClippingFar) < clipped.wrong_by(Cause::ClippingFar));
    assert!(clipped.wrong_by(Cause::ClippingFar) > 50);
}

#[test]
fn a_light_in_the_plane_is_refused_and_one_just_above_is_not() {
    let mut scene = stage(&[cube(Vec3::new(0.0, 1.0, 0.0), 0.4)], LAMP);
    light_at(&mut scene, Vec3::new(1.0, 0.0, 0.5));
    assert_eq!(refusal(&scene, "planar"), Unsupported::LightInPlane { plane: 1 });
    sun(&mut scene, Vec3::X);
    assert_eq!(refusal(&scene, "planar"), Unsupported::LightInPlane { plane: 1 });
    light_at(&mut scene, Vec3::new(1.0, 1e-6, 0.5));
    for spec in MATRICES {
        let grazing = outcome(&scene, spec);
        assert!(grazing.answers().all(|(point, value)| is_on_floor(point) || value == 1.0), "{spec}");
    }
    // Seen from above, a floor lit from below is asked nothing.
    light_at(&mut scene, Vec3::new(1.0, -3.0, 0.5));
    let below = outcome(&scene, "planar");
    assert_eq!(below.count(|_, point, _| is_on_floor(point)), 0);
}

#[test]
fn typed_refusals_say_what_is_missing() {
    let mut scene = stage(&[cube(Vec3::new(0.0, 1.0, 0.0), 0.4)], LAMP);
    scene.planes[0].point.y = -0.5;
    let Unsupported::NonPlanarReceiver { max_distance_m } = refusal(&scene, "planar") else { panic!() };
    assert!((max_distance_m - 0.5).abs() < 1e-6, "{max_distance_m}");
    scene.planes.clear();
    assert_eq!(refusal(&scene, "planar"), Unsupported::NoPlane);
    let scene = stage(&[cube(Vec3::new(0.0, 1.0, 0.0), 0.4)], LAMP);
    assert!(refusal(&scene, "planar:planes=only2").to_string().contains("1 planes"));
    assert!(refusal(&scene, "planar:placement=depth-offset").to_string().contains("projection=homogeneous"));
}

#[test]
fn blended_layers_multiply_and_the_stencil_lets_one_through() {
    let solid = cube(Vec3::new(0.0, 1.6, 0.0), 0.4);
    let sheet = quad(Vec3::new(-0.25, 2.3, -0.25), Vec3::Z * 0.5, Vec3::X * 0.5);
    let scene = stage(&[solid, sheet], LAMP);
    let stencil = outcome(&scene, "planar:overlap=stencil");
    assert!(stencil.answers().all(|(_, value)| value == 0.0 || value == 1.0));
    let blend = outcome(&scene, "planar:overlap=blend,darkening=0.5");
    let layers = |value: f32| blend.answers().filter(|(_, answer)| *answer == value).count();
    let shadowed = stencil.answers().filter(|(_, value)| *value == 0.0).count();
    assert!(layers(0.25) > 100, "front and back of the closed cube");
    assert!(layers(0.125) > 10, "and the sheet above it");
    assert_eq!(layers(0.5) + layers(0.25) + layers(0.125), shadowed);
    assert!(layers(0.5) <= 2 * SNAPPED_PX as usize, "one layer only where an edge is seen through a pixel's centre");
    // What is missing to full shadow is the model's, and only that.
    let missing = blend.ledger.causes[&Cause::TechniqueModel].sum;
    let expected = 0.25 * layers(0.25) as f64 + 0.125 * layers(0.125) as f64 + 0.5 * layers(0.5) as f64;
    assert!((missing - expected).abs() < SNAPPED_PX as f64 * 0.5, "{missing} {expected}");
    let full = outcome(&scene, "planar:overlap=blend,darkening=1");
    assert_eq!(full.mask, stencil.mask);
}

/// A floor and two walls that meet, and a torus before them.
fn corner() -> gnomon::scene::Scene {
    let (x, y, z) = (Vec3::X * 4.0, Vec3::Y * 4.0, Vec3::Z * 4.0);
    let walls = [quad(Vec3::ZERO, z, x), quad(Vec3::ZERO, y, z), quad(Vec3::ZERO, x, y)];
    let mut scene = stage_on(&[torus_at(DVec3::new(1.1, 0.9, 1.2), 0.6)], &walls, Vec3::new(2.4, 2.2, 2.3));
    look(&mut scene, Vec3::new(6.5, 2.4, 3.4), Vec3::new(0.6, 0.8, 0.6));
    scene.planes = [Vec3::Y, Vec3::X, Vec3::Z].map(|normal| Plane { point: Vec3::ZERO, normal }).to_vec();
    scene
}

#[test]
fn three_planes_shadow_a_room_corner_and_one_misses_the_walls() {
    let scene = corner();
    let torus_triangles = scene.meshes[0].triangles.end;
    let all = outcome(&scene, "planar");
    let on_torus = all.count(|triangle, _, truth| triangle < torus_triangles && truth < 0.5);
    assert_eq!(all.wrong_by(Cause::PlanarModel), on_torus, "self-shadow");
    assert!(all.verdict.pixels.wrong - on_torus <= 3 * SNAPPED_PX, "{:?}", all.ledger.causes);
    let floor_only = outcome(&scene, "planar:planes=only1");
    let on_walls =
        all.count(|triangle, point, truth| triangle >= torus_triangles && truth < 0.5 && !is_on_floor(point));
    assert!(on_walls > 100, "{on_walls}");
    assert_eq!(floor_only.wrong_by(Cause::PlanarModel), on_torus + on_walls);
    let [all, one] = [all, floor_only].map(|outcome| outcome.cost.primitives.unwrap_or_default());
    assert_eq!(all - one, 2 * u64::from(torus_triangles), "two more planes draw every caster twice more");
}

#[test]
fn a_stand_in_with_the_same_outline_has_the_same_shadow() {
    let (corner, u, v) = (Vec3::new(-1.0, 1.2, -0.7), Vec3::new(0.3, 0.1, 1.4), Vec3::new(1.7, 0.4, 0.2));
    let low = quad(corner, u, v);
    let mut fan = low.clone();
    fan.positions.push(corner + 0.5 * (u + v));
    fan.triangles = vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
    let [low, fan] = [low, fan].map(|shape| outcome(&stage(&[shape], LAMP), "planar"));
    let floor_only = |outcome: &Outcome| {
        outcome.answers().filter(|(point, _)| is_on_floor(*point)).map(|(_, value)| value).collect::<Vec<_>>()
    };
    assert_eq!(floor_only(&low), floor_only(&fan));
    assert!(floor_only(&low).contains(&0.0));
}

#[test]
fn a_box_on_the_floor_leaves_no_gap_at_its_foot() {
    let scene = stage(&[cuboid(Vec3::new(0.0, 0.5, 0.0), Vec3::new(0.6, 0.5, 0.4))], Vec3::new(2.0, 3.0, -2.0));
    let standing = outcome(&scene, "planar");
    assert!(standing.verdict.pixels.wrong <= SNAPPED_PX, "{:?}", standing.ledger.causes);
    assert_eq!(standing.wrong_off_edges(), 0);
}

#[test]
fn shear_is_exact_under_a_sun_and_a_model_error_under_a_lamp() {
    let mut scene = stage(&[torus_at(DVec3::new(0.0, 1.5, 0.0), 0.8)], LAMP);
    let lamp = outcome(&scene, "planar:projection=shear");
    assert!(lamp.wrong_by(Cause::PlanarModel) > 100);
    assert!(lamp.verdict.pixels.wrong - lamp.wrong_by(Cause::PlanarModel) <= SNAPPED_PX, "{:?}", lamp.ledger.causes);
    sun(&mut scene, Vec3::new(0.3, 1.0, 0.2));
    let [exact, shear] = ["planar", "planar:projection=shear"].map(|spec| outcome(&scene, spec));
    assert_eq!(exact.wrong_by(Cause::PlanarModel), shear.wrong_by(Cause::PlanarModel), "self-shadow only");
    // Below the plane and above the light, shear draws on: it has no w.
    let scene = stage(&guarded_casters(), LAMP);
    let unguarded = outcome(&scene, "planar:projection=shear");
    assert!(unguarded.wrong_by(Cause::FalseShadowBehindPlane) > 10, "{:?}", unguarded.ledger.causes);
    assert!(unguarded.wrong_by(Cause::AntiShadow) > 10, "{:?}", unguarded.ledger.causes);
}

#[test]
fn without_a_mask_shadows_leave_the_receiver() {
    // The plane's floor ends before its shadow does; the ground below shows it in the air.
    let ground = quad(Vec3::new(-6.0, -1.0, -6.0), Vec3::Z * 12.0, Vec3::X * 12.0);
    let scene = stage_on(&[cube(Vec3::new(0.0, 1.5, 0.0), 0.5)], &[floor(0.7), ground], Vec3::new(2.0, 4.0, -0.6));
    let unmasked = outcome(&scene, "planar:projection=homogeneous,placement=depth-offset,offset_constant=500");
    assert!(unmasked.wrong_by(Cause::ClippingFrustum) > 30, "{:?}", unmasked.ledger.causes);
    let masked = outcome(&scene, "planar");
    assert_eq!(masked.wrong_by(Cause::ClippingFrustum), 0);
    assert!(masked.wrong_by(Cause::PlanarModel) > 30, "the ground's own shadow is missing");
}

#[test]
fn z_fighting_is_precision_and_an_offset_ends_it() {
    let scene = stage(&[cube(Vec3::new(0.0, 1.0, 0.0), 0.5)], LAMP);
    let wrong = |offset: i32| {
        let spec = format!("planar:projection=homogeneous,placement=depth-offset,offset_constant={offset}");
        outcome(&scene, &spec).wrong_and_by(Cause::Precision)
    };
    let (fighting, lifted, sunk) = (wrong(0), wrong(200), wrong(-200));
    assert_eq!((fighting.0, lifted.0, sunk.0), (fighting.1, lifted.1, sunk.1));
    assert!(lifted.0 <= SNAPPED_PX, "{lifted:?}");
    let shadowed = outcome(&scene, "planar").count(|_, point, truth| is_on_floor(point) && truth < 0.5);
    assert!(fighting.0 > shadowed / 10, "{fighting:?} of {shadowed}");
    assert!(sunk.0 > shadowed - SNAPPED_PX, "all of it is below the floor: {sunk:?} of {shadowed}");
}

#[test]
fn every_combination_runs_and_is_explained() {
    let scene = stage(&guarded_casters(), LAMP);
    for projection in ["clipped", "homogeneous", "divided", "shear"] {
        for overlap in ["stencil", "blend"] {
            for placement in ["receiver-mask", "depth-offset"] {
                let spec = format!("planar:projection={projection},overlap={overlap},placement={placement}");
                if (projection, placement) != ("clipped", "depth-offset") {
                    outcome(&scene, &spec);
                }
            }
        }
    }
}

#[test]
fn more_planes_than_a_stencil_holds() {
    let mut scene = stage(&[cube(Vec3::new(0.0, 1.0, 0.0), 0.5)], LAMP);
    scene.image_size = UVec2::new(77, 53);
    let one = outcome(&scene, "planar");
    let floor = scene.planes[0];
    scene.planes = (1..300).map(|i| Plane { point: Vec3::NEG_Y * i as f32, normal: Vec3::Y }).collect();
    scene.planes.push(floor);
    assert_eq!(outcome(&scene, "planar").mask, one.mask);
    assert_eq!(outcome(&scene, "planar:planes=only300").mask, one.mask);
}

#[test]
fn a_normal_given_upside_down_is_the_same_plane() {
    let mut scene = stage(&guarded_casters(), LAMP);
    let upright = outcome(&scene, "planar").mask;
    scene.planes[0].normal = Vec3::NEG_Y;
    assert_eq!(outcome(&scene, "planar").mask, upright);
}

#[test]
fn extremes_give_answers() {
    let casters = guarded_casters();
    let mut far_light = stage(&casters[..2], Vec3::new(2e5, 1e6, 1e5));
    far_light.camera.near_m = 0.01;
    let far = outcome(&far_light, "planar");
    assert!(far.verdict.pixels.wrong - far.wrong_by(Cause::PlanarModel) <= 3 * SNAPPED_PX, "{:?}", far.ledger.causes);
    let mut in_plane = stage(&casters, LAMP);
    look(&mut in_plane, Vec3::new(0.0, 0.0, 7.0), Vec3::ZERO);
    let mut behind = stage(&casters, LAMP);
    look(&mut behind, Vec3::new(0.0, 2.0, 5.0), Vec3::new(0.0, 6.0, 5.1));
    let mut single = stage(&casters, LAMP);
    single.image_size = UVec2::ONE;
    let mut finite = stage(&casters, LAMP);
    finite.camera.far = gnomon::scene::Far::Finite(30.0);
    let bare = stage(&[], LAMP);
    for scene in [in_plane, behind, single, finite, bare] {
        for spec in MATRICES {
            outcome(&scene, spec);
        }
    }
}

#[test]
fn scale_changes_nothing() {
    let counts = |scale: f32| {
        let mut scene = stage(&guarded_casters(), LAMP * scale);
        scene.positions.iter_mut().for_each(|position| *position *= scale);
        scene.camera.eye *= scale;
        scene.camera.target *= scale;
        scene.camera.near_m *= f64::from(scale);
        let result = outcome(&scene, "planar");
        (result.verdict.pixels.asked, result.wrong_by(Cause::PlanarModel), result.verdict.pixels.wrong)
    };
    let unit = counts(1.0);
    // Powers of two scale every f32 without rounding.
    for scale in [1.0 / 1024.0, 16.0, 16384.0] {
        let scaled = counts(scale);
        assert_eq!((scaled.0, scaled.1), (unit.0, unit.1), "{scale}");
        assert!(scaled.2.abs_diff(unit.2) <= SNAPPED_PX);
    }
}

#[test]
fn the_checks_notice_a_shadow_in_the_wrong_place() {
    let caster = [cube(Vec3::new(0.0, 1.0, 0.0), 0.5)];
    let right = outcome(&stage(&caster, LAMP), "planar");
    assert_eq!(right.wrong_off_edges(), 0);
    // The same picture judged by the truth of a lamp 30 cm away, and by one shifted by two pixels.
    let elsewhere = outcome(&stage(&caster, LAMP + Vec3::X * 0.3), "planar");
    for mask in [&elsewhere.mask, &shifted(&right.mask, 2)] {
        let wrong = wrong_pixels(&right, mask);
        assert!(wrong.len() as u64 > SNAPPED_PX, "{}", wrong.len());
        assert!(wrong.iter().any(|pixel| !at_edge(&right.truth, *pixel)));
    }
    assert!(wrong_pixels(&right, &right.mask).len() as u64 <= SNAPPED_PX);
}

#[test]
fn parameters_are_declared_once_and_read_back() {
    let spec = Spec::parse("planar:planes=only3,kappa=1e-7,projection=shear").unwrap();
    assert_eq!(spec.short(), "planar:projection=shear,planes=only3,kappa=0.0000001");
    assert!(Spec::parse("planar:planes=only0").is_err());
    assert!(Spec::parse("planar:offset_constant=1001").is_err());
}
