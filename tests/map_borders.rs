//! What lies beside a map, before its near plane, and on the other side of its casters.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]

mod support;

use glam::DVec3;
use gnomon::cause::Cause;
use gnomon::technique::map::{Lookup, Settings};
use support::models::plate;
use support::scenes::{shadowed, shipped};
use support::shot::{Shot, named, parsed};

const CLIPPED: [Cause; 3] = [Cause::ClippingFrustum, Cause::ClippingNear, Cause::ClippingFar];

/// MA-2: the border is an explicit answer, never what an address mode happens to give.
#[test]
fn beside_the_map_the_border_answers() {
    let scene = plate(60.0, 45.0);
    let shot = Shot::new(&scene, "sun");
    let typed = |border: &str| format!("map:size=200,width_m=2,border={border}");
    let settings = Settings::of(&parsed(&typed("lit")));
    let views = settings.projection.fit(&scene, shot.question.light, &settings, &[]).unwrap();
    let lookup = Lookup::new(views, &settings, shot.question.light);
    let outside: Vec<u32> = shot
        .asked()
        .into_iter()
        .filter(|pixel| {
            let receiver = shot.view.receivers.pixels[*pixel as usize].unwrap();
            lookup.project(receiver.point_in_world).is_err()
        })
        .collect();
    assert!(outside.len() > 10_000, "{}", outside.len());
    let answers = |border: &str| {
        let mask = shot.evaluate(&typed(border)).mask;
        let lit = outside.iter().filter(|pixel| mask.pixels[**pixel as usize].unwrap().get() > 0.5).count();
        (lit, outside.len() - lit)
    };
    assert_eq!(answers("lit"), (outside.len(), 0));
    assert_eq!(answers("shadow"), (0, outside.len()));
    // The plate's shadow touches the map's border and is drawn out from there.
    let (lit, dark) = answers("clamp-edge");
    assert!(lit > 1000 && dark > 1000, "{lit} {dark}");
    for border in ["shadow", "clamp-edge"] {
        let evaluation = shot.evaluate(&typed(border));
        let clipped = named(&evaluation, &CLIPPED);
        let wrong_outside = outside.iter().filter(|pixel| evaluation.verdict.is_wrong(**pixel as usize)).count();
        assert!(clipped.len() >= wrong_outside && wrong_outside > 1000, "{border}: {} {wrong_outside}", clipped.len());
    }
}

/// MA-7: a caster before the near plane is lost, unless the plane goes before it or it is drawn at the plane.
#[test]
fn a_caster_before_the_near_plane_is_lost_or_drawn_at_it() {
    let scene = plate(60.0, 45.0);
    let shot = Shot::new(&scene, "sun");
    let extended = shot.evaluate("map:size=300");
    // Just beyond the plate, as the fit measures it: from as far behind the scene's centre as the scene's radius.
    let bounds = scene.bounds();
    let towards_light = shot.question.light.homogeneous().truncate();
    let corners = scene.meshes[1].triangles.clone().flat_map(|triangle| scene.triangle_in_world(triangle));
    let distance_m = |corner: DVec3| bounds.radius() - towards_light.dot(corner - bounds.centre());
    let near_m = 1e-3 + corners.map(distance_m).fold(0.0, f64::max);
    let lost = shot.evaluate(&format!("map:size=300,near_m={near_m}"));
    let in_shadow = shadowed(&shot.question.truth.mask);
    assert_eq!(named(&lost, &[Cause::ClippingNear]).len(), in_shadow, "the whole shadow");
    let clamped = shot.evaluate(&format!("map:size=300,near_m={near_m},near_mode=depth-clamp"));
    // What of the floor lies before the plane is not in the map either way.
    assert!(2 * named(&clamped, &CLIPPED).len() < in_shadow);
    let fitted = shot.evaluate("map:size=300,near_mode=depth-clamp");
    let differences = extended.mask.pixels.iter().zip(&fitted.mask.pixels).filter(|(a, b)| a != b).count();
    assert_eq!(differences, 0, "extended and clamped answer alike");
    let by_fragments = shot.evaluate("map:size=300,near_mode=fragment-clamp");
    assert!(by_fragments.mask == fitted.mask, "whoever clamps");
}

/// What the light reaches has no sample of its own when only the other sides are drawn.
#[test]
fn back_faces_alone_leave_no_acne() {
    let scene = shipped("torus", [160, 120]);
    let shot = Shot::new(&scene, "lamp");
    let acne = |typed: &str| named(&shot.evaluate(typed), &[Cause::Acne, Cause::Curvature]).len();
    assert!(acne("map:bias=none") > 1000);
    assert!(acne("map:bias=none,caster_sides=light-facing") > 1000);
    let away = acne("map:bias=none,caster_sides=away-facing");
    assert!(away < 20, "{away}");
    // A sheet has no far side: its shadow is gone, and the model is to blame.
    let scene = plate(60.0, 45.0);
    let shot = Shot::new(&scene, "sun");
    let evaluation = shot.evaluate("map:caster_sides=away-facing");
    assert_eq!(named(&evaluation, &[Cause::TechniqueModel]).len(), shadowed(&shot.question.truth.mask));
}
