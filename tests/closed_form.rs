//! The truth against a shadow worked out by hand: one triangle over a level floor, lit by a point light and by the sun,
//! at scales from 10⁻⁶ to 10⁶ and a million metres away. The expectation comes from the rounded scene by projection and
//! edge functions; it shares nothing with the ray core.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

mod support;

use glam::{DVec3, UVec2};
use gnomon::cast::Casters;
use gnomon::evaluate::View;
use gnomon::mask::{Truth, Visibility};
use gnomon::receiver::{PixelClass, Receiver, Receivers};
use gnomon::scene::{Light, Placement, Scene};
use gnomon::truth;
use gnomon::watch::Unwatched;
use support::outline::{
    Outline, all_edges, blocker, floor_height, mesh, on_floor, onto_floor, pixels_near, shadow_on_floor,
};
use support::scenes::{ask, gpu, placed};

const SIZE: [u32; 2] = [320, 240];
const LIGHTS: [&str; 2] = ["lamp", "sun"];
const SCALES: [f64; 5] = [1e-6, 1e-3, 1.0, 1e3, 1e6];
const FAR_AWAY: DVec3 = DVec3::new(1e6, -1e6, 1e6);
/// The outline itself is rounded: this close to it, as a share of the scene's extent, either answer is right.
const EDGE_BAND: f64 = 1e-9;
/// Rasterisers snap vertices to a grid of 1/256 pixel and rounding a scene at another scale moves them less still:
/// nothing farther than this from an edge may change.
const RASTER_BAND_PX: f64 = 1.0 / 128.0;

fn placements() -> impl Iterator<Item = Placement> {
    let scaled = |scale| [DVec3::ZERO, FAR_AWAY].map(|translate| Placement { scale, translate });
    SCALES.into_iter().flat_map(scaled)
}

/// Whether a receiver must be in shadow; `None` where it is too close to the edge to tell.
///
/// The blocker itself is always lit where it is asked: the floor lies on the far side from the light.
fn expected(scene: &Scene, shadow: &Outline, receiver: &Receiver) -> Option<bool> {
    if !mesh(scene, "Floor").triangles.contains(&receiver.triangle) {
        return Some(false);
    }
    let point = on_floor(receiver.point_in_world);
    (shadow.distance(point) > EDGE_BAND * scene.extent_m()).then(|| shadow.contains(point))
}

fn truth_of(in_shadow: bool) -> Option<Truth> {
    Some(Truth::Known(if in_shadow { Visibility::SHADOW } else { Visibility::LIT }))
}

/// Asked pixels that must be lit, that must be in shadow, that are too close to tell, and that the truth gets wrong.
#[derive(Debug, Default)]
struct Tally {
    lit: u32,
    shadowed: u32,
    too_close: u32,
    wrong: Vec<usize>,
}

fn tally(view: &View<'_>, light: &str, shadow: &Outline) -> Tally {
    let question = ask(view, light);
    let mut tally = Tally::default();
    for (pixel, receiver) in view.receivers.pixels.iter().enumerate() {
        let Some(receiver) = receiver.filter(|_| question.classes[pixel] == PixelClass::Asked) else { continue };
        match expected(view.scene, shadow, &receiver) {
            None => tally.too_close += 1,
            Some(in_shadow) => {
                *if in_shadow { &mut tally.shadowed } else { &mut tally.lit } += 1;
                if question.truth.mask.pixels[pixel] != truth_of(in_shadow) {
                    tally.wrong.push(pixel);
                }
            }
        }
    }
    tally
}

#[test]
fn the_truth_is_the_analytic_shadow_at_every_scale() {
    let gpu = gpu();
    for placement in placements() {
        let scene = placed("triangle", SIZE, placement);
        let view = View::new(&gpu, &scene).unwrap();
        for name in LIGHTS {
            let light = scene.light(name).unwrap();
            let tally = tally(&view, name, &shadow_on_floor(&scene, light, blocker(&scene)));
            assert!(tally.wrong.is_empty(), "{placement:?} {name}: {tally:?}");
            assert!(tally.lit > 20_000 && tally.shadowed > 1_000, "{placement:?} {name}: {tally:?}");
            assert!(tally.too_close <= 2, "{placement:?} {name}: {tally:?}");
        }
    }
}

#[test]
fn another_blocker_is_not_this_shadow() {
    let gpu = gpu();
    let scene = placed("triangle", SIZE, Placement::default());
    let view = View::new(&gpu, &scene).unwrap();
    for name in LIGHTS {
        let [a, b, c] = blocker(&scene);
        let moved = [a, b, c + DVec3::new(0.0, 0.01 * scene.extent_m(), 0.0)];
        let tally = tally(&view, name, &shadow_on_floor(&scene, scene.light(name).unwrap(), moved));
        assert!(tally.wrong.len() > 10, "{name}: {tally:?}");
    }
}

/// The triangle of the floor that holds a point.
fn floor_triangle_at(scene: &Scene, point: DVec3) -> u32 {
    let holds = |t: &u32| Outline::new(scene.triangle_in_world(*t).map(on_floor)).contains(on_floor(point));
    mesh(scene, "Floor").triangles.clone().find(holds).unwrap()
}

/// Receivers on the floor next to the outline, `beside` × the extent inside and outside it in turn.
fn receivers_beside(scene: &Scene, light: &Light, beside: f64) -> (Receivers, Vec<bool>) {
    const PER_EDGE: u32 = 500;
    let corners = blocker(scene).map(|corner| onto_floor(scene, light, corner));
    let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
    let mut pixels = Vec::new();
    let mut in_shadow = Vec::new();
    for (edge, i) in (0..3).flat_map(|edge| (0..PER_EDGE).map(move |i| (edge, i))) {
        let (from, to) = (corners[edge], corners[(edge + 1) % 3]);
        let normal = (to - from).cross(DVec3::Y).normalize();
        let outward = normal * normal.dot(from - middle).signum();
        let sign = if i % 2 == 0 { 1.0 } else { -1.0 };
        let on_edge = from.lerp(to, 0.01 + 0.98 * f64::from(i) / f64::from(PER_EDGE));
        let mut point_in_world = on_edge + sign * beside * scene.extent_m() * outward;
        point_in_world.y = floor_height(scene);
        let triangle = floor_triangle_at(scene, point_in_world);
        pixels.push(Some(Receiver { triangle, point_in_world, normal_in_world: DVec3::Y }));
        in_shadow.push(sign < 0.0);
    }
    (Receivers { size: UVec2::new(PER_EDGE, 3), pixels }, in_shadow)
}

#[test]
fn the_truth_changes_sides_within_the_band_around_the_analytic_edge() {
    for placement in placements() {
        let scene = placed("triangle", SIZE, placement);
        let casters = Casters::new(&scene);
        for name in LIGHTS {
            let light = scene.light(name).unwrap();
            let (receivers, in_shadow) = receivers_beside(&scene, light, EDGE_BAND);
            let truth = |receivers: &Receivers| {
                let classes = vec![PixelClass::Asked; receivers.pixels.len()];
                truth::exact(&scene, &casters, light, receivers, &classes, &Unwatched).unwrap().mask.pixels
            };
            let expected: Vec<Option<Truth>> = in_shadow.into_iter().map(truth_of).collect();
            assert!(truth(&receivers) == expected, "{placement:?} {name}");
            // Control: on the other side of the edge every answer is the other one.
            let (mirrored, _) = receivers_beside(&scene, light, -EDGE_BAND);
            assert!(truth(&mirrored).iter().zip(&expected).all(|(a, b)| a != b), "{placement:?} {name}");
        }
    }
}

/// What one pixel came to, whatever the scale.
type Kind = (PixelClass, Option<Truth>);

fn kinds(view: &View<'_>, light: &str) -> Vec<Kind> {
    let question = ask(view, light);
    question.classes.iter().copied().zip(question.truth.mask.pixels).collect()
}

#[test]
fn every_scale_counts_the_same_pixels() {
    let gpu = gpu();
    for name in LIGHTS {
        let reference = placed("triangle", SIZE, Placement::default());
        let light = reference.light(name).unwrap();
        let corners = blocker(&reference).map(|corner| onto_floor(&reference, light, corner));
        let outline = (0..3).map(|i| [corners[i], corners[(i + 1) % 3]]);
        let edges: Vec<[DVec3; 2]> = all_edges(&reference).into_iter().chain(outline).collect();
        let near_edge = pixels_near(&reference, &edges, RASTER_BAND_PX);
        let at_edges = near_edge.iter().filter(|near| **near).count();
        assert!(at_edges * 100 < near_edge.len(), "{at_edges} pixels are left out");
        let expected = kinds(&View::new(&gpu, &reference).unwrap(), name);
        let differing = |kinds: &[Kind]| {
            let pairs = expected.iter().zip(kinds).zip(&near_edge);
            pairs.filter(|((a, b), near)| a != b && !**near).count()
        };
        for placement in placements() {
            let scene = placed("triangle", SIZE, placement);
            assert_eq!(differing(&kinds(&View::new(&gpu, &scene).unwrap(), name)), 0, "{placement:?} {name}");
        }
        // Control: seen from a hundredth of the extent aside, other pixels are in shadow.
        let mut beside = reference.clone();
        beside.camera.eye.x += 0.01 * reference.extent_m() as f32;
        assert!(differing(&kinds(&View::new(&gpu, &beside).unwrap(), name)) > 20);
    }
}
