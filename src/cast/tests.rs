//! Properties of the ray core on random soups, and the inputs at the edge of what is legal.

use super::testing::{Random, Shape, scene_of};
use super::*;
use crate::scene::Scene;
use glam::{DVec3, Vec3};
use proptest::prelude::*;

/// Coordinates from a small lattice make touching, coplanar, degenerate and coinciding triangles common; those in
/// between make slivers.
fn coordinate() -> impl Strategy<Value = f32> {
    prop_oneof![
        3 => (-2i8..=2).prop_map(f32::from),
        1 => Just(-0.0f32),
        1 => -2.0f32..2.0,
        1 => (-2i8..=2).prop_map(|x| f32::from(x).next_up()),
    ]
}

fn corner() -> impl Strategy<Value = Vec3> {
    prop::array::uniform3(coordinate()).prop_map(Vec3::from)
}

fn soup() -> impl Strategy<Value = Scene> {
    prop::collection::vec(prop::array::uniform3(corner()), 0..24).prop_map(|mut corners| {
        let twins: Vec<_> = corners.iter().step_by(5).map(|&[a, b, c]| [c, a, b]).collect();
        corners.extend(twins);
        scene_of(&[Shape::soup(&corners)], Vec3::Y)
    })
}

fn segment() -> impl Strategy<Value = Segment> {
    (corner(), corner()).prop_map(|(from, to)| Segment { from: from.as_dvec3(), to: to.as_dvec3() })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn agrees_with_brute_force_on_any_soup(scene in soup(), segments in prop::collection::vec(segment(), 32)) {
        let casters = Casters::new(&scene);
        for (i, segment) in segments.iter().enumerate() {
            let own = scene.triangles.len().checked_sub(1 + i).map(|own| own as u32);
            let mut hits = Vec::new();
            casters.all_hits(segment, own, &mut hits);
            prop_assert_eq!(&hits, &brute::all_hits(&scene, segment, own));
            prop_assert_eq!(casters.nearest_hit(segment, own), brute::nearest_hit(&scene, segment, own));
            prop_assert_eq!(casters.nearest_hit(segment, own), hits.first().copied());
            let any = casters.any_hit(segment, own);
            prop_assert_eq!(any.is_some(), brute::any_hit(&scene, segment, own).is_some());
            prop_assert_eq!(any.is_some(), !hits.is_empty());
            prop_assert!(any.is_none_or(|any| hits.iter().any(|hit| hit.triangle == any)));
        }
    }

    #[test]
    fn one_more_caster_never_lights_a_point(
        scene in soup(), more in prop::array::uniform3(corner()), segments in prop::collection::vec(segment(), 32)
    ) {
        let mut fuller = scene.clone();
        let first = fuller.positions.len() as u32;
        fuller.positions.extend(more);
        fuller.triangles.push([first, first + 1, first + 2]);
        fuller.meshes[0].triangles.end += 1;
        let (casters, fuller) = (Casters::new(&scene), Casters::new(&fuller));
        for segment in &segments {
            prop_assert!(casters.any_hit(segment, None).is_none() || fuller.any_hit(segment, None).is_some());
        }
    }
}

/// The unit triangle in the plane z = 0.
const TRIANGLE: [Vec3; 3] = [Vec3::ZERO, Vec3::X, Vec3::Y];
const THROUGH: Segment = Segment { from: DVec3::new(0.25, 0.25, 1.0), to: DVec3::new(0.25, 0.25, -1.0) };

#[test]
fn a_scene_without_casters_blocks_nothing() {
    let mut silent = scene_of(&[Shape::soup(&[TRIANGLE])], Vec3::Y);
    silent.meshes[0].casts = false;
    for scene in [scene_of(&[], Vec3::Y), silent] {
        let casters = Casters::new(&scene);
        assert_eq!(casters.any_hit(&THROUGH, None), None);
        assert_eq!(casters.nearest_hit(&THROUGH, None), None);
        assert_eq!(casters.occlusion(&THROUGH, None, 1e-9), Occlusion::Clear);
        assert_eq!(casters.triangle_count(), 0);
    }
}

#[test]
fn a_hundred_thousand_identical_triangles_are_one() {
    let casters = Casters::new(&scene_of(&[Shape::soup(&vec![TRIANGLE; 100_000])], Vec3::Y));
    let mut hits = Vec::new();
    casters.all_hits(&THROUGH, None, &mut hits);
    assert_eq!(hits, [Hit { triangle: 0, t: 0.5 }]);
    assert_eq!(casters.any_hit(&THROUGH, Some(77_777)), None);
    assert!(casters.same_surface(3, 99_999));
    assert_eq!(casters.triangle_count(), 100_000);
}

#[test]
fn the_own_triangle_is_left_out_even_when_it_does_not_cast_itself() {
    let beside = TRIANGLE.map(|corner| corner + Vec3::X);
    let [a, b, c] = TRIANGLE;
    let mut scene = scene_of(&[Shape::soup(&[[b, a, c], beside]), Shape::soup(&[TRIANGLE])], Vec3::Y);
    scene.meshes[0].casts = false;
    let casters = Casters::new(&scene);
    assert_eq!(casters.any_hit(&THROUGH, None), Some(2));
    assert_eq!(casters.any_hit(&THROUGH, Some(1)), Some(2));
    assert_eq!(casters.any_hit(&THROUGH, Some(0)), None);
    assert!(!casters.same_surface(1, 2));
}

#[test]
fn a_segment_without_length_hits_nothing() {
    let casters = Casters::new(&scene_of(&[Shape::soup(&[TRIANGLE])], Vec3::Y));
    for point in [DVec3::ZERO, DVec3::new(0.25, 0.25, 0.0), DVec3::splat(1e30)] {
        let segment = Segment { from: point, to: point };
        assert_eq!(casters.any_hit(&segment, None), None);
        assert_eq!(casters.occlusion(&segment, None, 1e-9), Occlusion::Clear);
    }
}

#[test]
fn triangles_of_every_representable_size_are_hit() {
    for exponent in (-120..=120).step_by(8) {
        let size = 2f32.powi(exponent);
        let casters = Casters::new(&scene_of(&[Shape::soup(&[TRIANGLE.map(|corner| corner * size)])], Vec3::Y));
        for reach in [1e-30, 1.0, 1e30] {
            let scaled = |p: DVec3| DVec3::new(p.x, p.y, p.z * reach) * f64::from(size);
            let segment = Segment { from: scaled(THROUGH.from), to: scaled(THROUGH.to) };
            assert_eq!(casters.any_hit(&segment, None), Some(0), "{size} {reach}");
        }
    }
}

#[test]
fn the_identity_of_the_casters_tells_scenes_apart() {
    let scene = scene_of(&[Shape::icosphere(1)], Vec3::Y);
    let casters = Casters::new(&scene);
    let changed = |change: fn(&mut Scene)| {
        let mut scene = scene.clone();
        change(&mut scene);
        Casters::new(&scene).content_hash()
    };
    assert_eq!(changed(|_| {}), casters.content_hash());
    assert_ne!(changed(|scene| scene.positions[5].x = scene.positions[5].x.next_up()), casters.content_hash());
    assert_ne!(changed(|scene| scene.meshes[0].triangles.end -= 1), casters.content_hash());
    assert_ne!(changed(|scene| scene.meshes[0].casts = false), casters.content_hash());
    assert_eq!(casters.bounds(), scene.bounds());
}

#[test]
fn the_hash_is_the_published_fnv_1a() {
    // Zero bytes leave the exclusive or without effect, so only the multiplications remain.
    let zeros = scene_of(&[Shape::soup(&[[Vec3::ZERO; 3]])], Vec3::Y);
    let expected = (0..36).fold(0xcbf2_9ce4_8422_2325u64, |hash, _| hash.wrapping_mul(0x0000_0100_0000_01b3));
    assert_eq!(Casters::new(&zeros).content_hash(), expected);
    let negative = scene_of(&[Shape::soup(&[[Vec3::new(-0.0, 0.0, -0.0); 3]])], Vec3::Y);
    assert_eq!(Casters::new(&negative).content_hash(), expected);
}

mod occlusion {
    use super::*;

    /// A rounding error as receivers have it in a scene of this size.
    const RADIUS_M: f64 = 1e-14;

    /// A floor of two triangles from −1 to 1, ids 0 and 1, and whatever else is given.
    fn on_floor(others: &[[Vec3; 3]]) -> Casters {
        let floor = Shape::grid(1, 1, |i, j| Vec3::new(2.0 * i as f32 - 1.0, 0.0, 2.0 * j as f32 - 1.0));
        Casters::new(&scene_of(&[floor, Shape::soup(others)], Vec3::Y))
    }

    fn from_floor(x: f64, z: f64) -> Segment {
        Segment { from: DVec3::new(x, 0.0, z), to: DVec3::new(0.1, 2.0, 0.3) }
    }

    #[test]
    fn a_floor_does_not_make_itself_doubtful() {
        let casters = on_floor(&[]);
        let mut random = Random(1);
        for _ in 0..10_000 {
            let at = random.in_cube();
            let own = u32::from(at.x + at.z > 0.0);
            assert_eq!(casters.occlusion(&from_floor(at.x, at.z), Some(own), RADIUS_M), Occlusion::Clear, "{at}");
        }
    }

    #[test]
    fn a_receiver_on_the_seam_of_a_flat_floor_is_lit() {
        let casters = on_floor(&[]);
        for i in -999..=999 {
            let x = f64::from(i) / 1000.0;
            for own in [0, 1] {
                assert_eq!(casters.occlusion(&from_floor(x, -x), Some(own), RADIUS_M), Occlusion::Clear, "{x}");
            }
        }
        // The same seam in another surface, which shares corners with the floor, is not the floor's.
        let corner = |x: f32, z: f32| Vec3::new(x, 0.0, z);
        let other = on_floor(&[[corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0)]]);
        assert_eq!(other.occlusion(&from_floor(0.5, -0.5), Some(0), RADIUS_M), Occlusion::Doubtful);
    }

    #[test]
    fn a_surface_through_the_receiver_makes_it_doubtful_and_one_beside_it_does_not() {
        let above = |y: f32| on_floor(&[[Vec3::new(-0.9, y, -0.8), Vec3::new(0.7, y, -0.6), Vec3::new(0.1, y, 0.9)]]);
        let own = Some(0);
        assert_eq!(above(0.0).occlusion(&from_floor(-0.2, -0.1), own, RADIUS_M), Occlusion::Doubtful);
        assert_eq!(above(0.0).occlusion(&from_floor(-0.95, -0.1), own, RADIUS_M), Occlusion::Clear);
        assert_eq!(above(1e-12).occlusion(&from_floor(-0.2, -0.1), own, RADIUS_M), Occlusion::Blocked);
        assert_eq!(above(-1e-12).occlusion(&from_floor(-0.2, -0.1), own, RADIUS_M), Occlusion::Clear);
        assert_eq!(above(1e-12).occlusion(&from_floor(-0.2, -0.1), own, 1e-11), Occlusion::Doubtful);
    }

    #[test]
    fn doubt_is_as_wide_as_the_rounding_error() {
        // A blocker halfway up whose edge x = 0.5 casts its shadow's edge on x = 0.9.
        let casters = on_floor(&[[Vec3::new(0.5, 1.0, -9.0), Vec3::new(0.5, 1.0, 9.0), Vec3::new(9.0, 1.0, 0.0)]]);
        let at = |x: f64| casters.occlusion(&from_floor_to_centre(x), Some(1), RADIUS_M);
        assert_eq!(at(1.0), Occlusion::Doubtful);
        assert_eq!(at(1.0 + 0.5 * RADIUS_M), Occlusion::Doubtful);
        assert_eq!(at(1.0 + 3.0 * RADIUS_M), Occlusion::Blocked);
        assert_eq!(at(1.0 - 3.0 * RADIUS_M), Occlusion::Clear);
    }

    /// The edge x = 0.5 at half height lies between x = 1 on the floor and the light over the origin.
    fn from_floor_to_centre(x: f64) -> Segment {
        Segment { from: DVec3::new(x, 0.0, 0.0), to: DVec3::new(0.0, 2.0, 0.0) }
    }

    #[test]
    fn a_certain_blocker_settles_a_receiver_that_another_surface_touches() {
        let roof = [Vec3::new(-5.0, 1.0, -5.0), Vec3::new(5.0, 1.0, -5.0), Vec3::new(0.0, 1.0, 5.0)];
        let touching = [Vec3::new(-0.9, 0.0, -0.8), Vec3::new(0.7, 0.0, -0.6), Vec3::new(0.1, 0.0, 0.9)];
        let casters = on_floor(&[roof, touching]);
        assert_eq!(casters.occlusion(&from_floor(-0.2, -0.1), Some(0), RADIUS_M), Occlusion::Blocked);
    }

    #[test]
    fn where_nothing_is_doubtful_the_verdict_is_that_of_any_hit() {
        let mut random = Random(2);
        let casters = Casters::new(&scene_of(&[Shape::star(2, &mut random)], Vec3::Y));
        for _ in 0..10_000 {
            let segment = Segment { from: 3.0 * random.in_cube(), to: 3.0 * random.in_cube() };
            let blocked = casters.any_hit(&segment, None).is_some();
            let expected = if blocked { Occlusion::Blocked } else { Occlusion::Clear };
            assert_eq!(casters.occlusion(&segment, None, RADIUS_M), expected);
        }
    }
}
