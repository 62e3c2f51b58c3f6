//! Corners of casters moved to the near plane: exact for triangles on one side of it, and wrong as worked out on paper for
//! those that reach through it.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests fail by panicking")]

mod support;

use gnomon::cause::Cause;
use gnomon::evaluate::Evaluation;
use gnomon::scene::Scene;
use gnomon::technique::Unsupported;
use support::scenes::{scene_of_texts, shipped};
use support::shot::{Shot, named, parsed};

const SIZE: [u32; 2] = [200, 150];

/// A sheet that receives nothing, straight from one height at x = −3 to another at x = 3, over a table at y = 1 and a floor;
/// a sun right above, the camera between sheet and table.
fn sheet(from_y: f64, to_y: f64) -> Scene {
    let scene = "about = \"a sheet over a table\"\nsize = [240, 180]\n\
         [camera]\neye = [0.1, 2.2, 0.05]\ntarget = [0.1, 0, 0.049]\nup = [0, 0, -1]\nfov_y_deg = 120\n\
         [[mesh]]\nfile = \"model.obj\"\nobjects = [\"Floor\", \"Table\"]\n\
         [[mesh]]\nfile = \"model.obj\"\nobjects = [\"Sheet\"]\nreceives = false\n\
         [[light]]\nname = \"sun\"\nkind = \"directional\"\ndirection = [0, -1, 0]\n";
    let model = format!(
        "o Floor\nv -4 0 -4\nv -4 0 4\nv 4 0 4\nv 4 0 -4\nf 1 2 3 4\n\
         o Table\nv -2.5 1 -1\nv -2.5 1 1\nv 2.2 1 1\nv 2.2 1 -1\nf 5 6 7 8\n\
         o Sheet\nv -3 {from_y} -3\nv -3 {from_y} 3\nv 3 {to_y} 3\nv 3 {to_y} -3\nf 9 10 11 12\n"
    );
    scene_of_texts(scene, &model)
}

fn clipped(evaluation: &Evaluation<'_>) -> usize {
    named(evaluation, &[Cause::ClippingNear]).len()
}

/// A sheet from height a to b, its upper corners moved to height n, lies at n + s (b − n): the table at 1 is lit where that
/// is below it, s > (n − 1)/(n − b), though the sheet itself is above.
#[test]
fn the_table_is_lit_where_the_bent_sheet_lies_below_it() {
    /// Texels of 512² over 8 m.
    const TEXEL_M: f64 = 0.016;
    let (from_y, to_y, near_y) = (9.0, 0.4, 2.0);
    let scene = sheet(from_y, to_y);
    let shot = Shot::new(&scene, "sun");
    let bounds = scene.bounds();
    let near_m = bounds.centre().y + bounds.radius() - near_y;
    for convention in ["reversed", "forward"] {
        let typed = format!("map:size=512,near_m={near_m},near_mode=vertex-clamp,depth_convention={convention}");
        let evaluation = shot.evaluate(&typed);
        let lit_from = -3.0 + 6.0 * (near_y - 1.0) / (near_y - to_y);
        let (mut lit, mut dark) = (0, 0);
        for pixel in shot.asked() {
            let point = shot.view.receivers.pixels[pixel as usize].unwrap().point_in_world + scene.origin_in_file;
            if point.y < 0.99 || (point.x - lit_from).abs() < TEXEL_M || point.x > 2.2 - TEXEL_M {
                continue;
            }
            assert_eq!(evaluation.verdict.is_wrong(pixel as usize), point.x > lit_from, "{convention} {point}");
            *if point.x > lit_from { &mut lit } else { &mut dark } += 1;
        }
        assert!(lit > 2000 && dark > 5000, "{lit} {dark}");
        assert!(clipped(&evaluation) >= lit, "{} {lit}", clipped(&evaluation));
    }
}

/// What lies before the plane with all of itself is drawn flat on it: nothing is lost, and no bit differs from the other
/// ways of dealing with it.
#[test]
fn triangles_before_the_plane_are_exact() {
    let scene = sheet(5.0, 1.5);
    let shot = Shot::new(&scene, "sun");
    let of = |near_mode: &str| shot.evaluate(&format!("map:size=300,filter=pcf-box3,near_mode={near_mode}"));
    let pancaked = of("vertex-clamp");
    assert_eq!(clipped(&pancaked), 0);
    assert!(pancaked.mask == of("depth-clamp").mask && pancaked.mask == of("extend").mask);
    // Control: with corners on both sides.
    let scene = sheet(5.0, 0.5);
    assert!(clipped(&Shot::new(&scene, "sun").evaluate("map:size=300,near_mode=vertex-clamp")) > 1000);
}

/// MA-7's variant: extended and clamped by depth agree bit for bit where corners that are moved lose a shadow, and either
/// is among the remedies.
#[test]
fn the_other_ways_have_no_such_error_and_are_the_remedy() {
    let scene = shipped("sunshade", SIZE);
    let shot = Shot::new(&scene, "sun");
    for rest in ["", ",fit=receivers,depth_convention=forward", ",projection=adaptive", ",bias=slope"] {
        let of = |near_mode: &str| shot.evaluate(&format!("map:size=512,near_mode={near_mode}{rest}"));
        let (extended, clamped, pancaked) = (of("extend"), of("depth-clamp"), of("vertex-clamp"));
        assert!(extended.mask == clamped.mask, "{rest}");
        assert_eq!((clipped(&extended), clipped(&clamped)), (0, 0), "{rest}");
        let lost = clipped(&pancaked);
        assert!(lost > 300 && 100 * lost > 95 * pancaked.verdict.pixels.wrong as usize, "{rest}: {lost}");
        // Corners only move away from the light.
        assert!(pancaked.verdict.pixels.false_shadow <= extended.verdict.pixels.false_shadow, "{rest}");
    }
    let spec = parsed("map:near_mode=vertex-clamp");
    let remedies = spec.technique().remedies(&spec, Cause::ClippingNear);
    let short: Vec<String> = remedies.iter().map(gnomon::technique::Spec::short).collect();
    assert_eq!(short, ["map", "map:near_mode=depth-clamp"]);
}

/// A plane far enough before the receivers has every corner of the sheet behind it.
#[test]
fn a_margin_brings_the_shadow_back() {
    let scene = shipped("sunshade", SIZE);
    let shot = Shot::new(&scene, "sun");
    let lost = |margin_m: f64| {
        clipped(&shot.evaluate(&format!("map:size=300,near_mode=vertex-clamp,near_margin_m={margin_m}")))
    };
    let [none, some, enough] = [0.0, 0.6, 2.5].map(lost);
    assert!(none > some && some > 0 && enough == 0, "{none} {some} {enough}");
    // A stable cascade's plane lies at the sphere around its slice, here before the whole sheet.
    assert_eq!(clipped(&shot.evaluate("map:projection=cascaded,cascades=1,near_mode=vertex-clamp")), 0);
}

#[test]
fn depths_that_do_not_follow_corners_are_refused() {
    let gpu = support::scenes::gpu();
    let scene = shipped("torus", [64, 48]);
    let refusal = |typed: &str, light: &str| {
        let spec = parsed(&format!("map:near_mode=vertex-clamp,{typed}"));
        spec.technique().supports(&spec, &scene, scene.light(light).unwrap(), &gpu).err()
    };
    for (typed, light) in [
        ("projection=dual-paraboloid", "lamp"),
        ("projection=trapezoidal", "sun"),
        ("bias=midpoint", "sun"),
        ("depth_metric=linear", "lamp"),
        ("filter=vsm", "lamp"),
    ] {
        let refused = refusal(typed, light).unwrap();
        assert!(
            matches!(refused, Unsupported::Combination { .. }) && refused.to_string().contains("not the rasteriser's"),
            "{typed}: {refused}"
        );
    }
    for (typed, light) in [
        ("filter=vsm", "sun"),
        ("projection=cube", "lamp"),
        ("projection=cascaded,seam=clamp,filter=msm", "sun"),
        ("projection=perspective", "sun"),
        ("projection=light-space-perspective", "sun"),
        ("projection=adaptive", "lamp"),
    ] {
        assert_eq!(refusal(typed, light), None, "{typed}");
    }
}
