//! The map family where its errors can be predicted: one triangle over a level floor, and a fin on one. Wrong pixels lie
//! within half a texel of the shadow's edge, their number follows the texel's size, acne covers half the floor without
//! a bias, and too much of it detaches a contact by the predicted strip.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

mod support;

use glam::Vec3;
use gnomon::cause::Cause;
use gnomon::evaluate::{Evaluation, View, jittered};
use gnomon::mask::{Mask, Truth, Visibility};
use gnomon::receiver::Asked;
use gnomon::scene::{LoadOptions, Scene, load};
use gnomon::technique::map::Settings;
use gnomon::technique::{Job, Spec};
use gnomon::watch::Unwatched;
use std::collections::BTreeSet;
use std::fs;
use support::outline::{MappedOutline, band_texels, mesh};
use support::scenes::{ask, explained, folder_of, gpu, judged, shipped, written};

const SIZE: [u32; 2] = [320, 240];

/// `scenes/triangle` with a spot light beside its lamp and its sun.
fn three_lights(size: [u32; 2]) -> Scene {
    const SPOT: &str = r#"
[[light]]
name = "spot"
kind = "spot"
position = [0.9, 4.2, 0.9]
target = [0.0, 0.4, -0.4]
cone_deg = 80
"#;
    let read = |name: &str| fs::read_to_string(folder_of("triangle").join(name)).unwrap();
    let scene = read("scene.toml") + SPOT;
    let folder = written(&[
        ("scene.toml", &scene),
        ("triangle.obj", &read("triangle.obj")),
        ("triangle.mtl", &read("triangle.mtl")),
    ]);
    load(folder.path(), &LoadOptions { size: Some(size.into()), ..LoadOptions::default() }).unwrap()
}

const LIGHTS: [&str; 3] = ["lamp", "sun", "spot"];

/// Distances of all pixels with an error from the true edge, in texels of the map.
fn errors_in_texels(view: &View<'_>, light: &str, evaluation: &Evaluation<'_>, typed: &str) -> Vec<f64> {
    let mapped = MappedOutline::new(view.scene, view.scene.light(light).unwrap(), typed);
    let errors = evaluation.verdict.signed_error.iter().zip(&view.receivers.pixels);
    let off = errors.filter(|(error, _)| error.is_some_and(|error| error != 0.0));
    off.map(|(_, receiver)| mapped.texels_from_edge(receiver.unwrap().point_in_world)).collect()
}

fn farthest(distances: &[f64]) -> f64 {
    distances.iter().copied().fold(0.0, f64::max)
}

#[test]
fn every_light_filter_and_depth_convention_errs_within_its_kernel() {
    let gpu = gpu();
    let scene = three_lights(SIZE);
    let view = View::new(&gpu, &scene).unwrap();
    for light in LIGHTS {
        let question = ask(&view, light);
        for (filter, kernel) in [("nearest", 1.0), ("pcf-box2", 2.0), ("pcf-box3", 3.0)] {
            for convention in ["forward", "reversed"] {
                let typed = format!("map:size=512,filter={filter},depth_convention={convention}");
                let errors = errors_in_texels(&view, light, &judged(&view, &question, &typed), &typed);
                assert!(farthest(&errors) <= band_texels(kernel), "{light} {typed}: {}", farthest(&errors));
                assert!(errors.len() > 20, "{light} {typed}: nothing was put to the test");
                if kernel > 1.0 {
                    assert!(farthest(&errors) > band_texels(1.0), "{light} {typed}: the wider band is needed");
                }
            }
        }
    }
}

#[test]
fn a_fine_map_and_every_depth_format_err_within_half_a_texel() {
    let gpu = gpu();
    let scene = three_lights(SIZE);
    let view = View::new(&gpu, &scene).unwrap();
    for light in LIGHTS {
        let question = ask(&view, light);
        let formats = ["depth16unorm", "depth24plus", "depth32float"];
        for typed in
            formats.map(|format| format!("map:size=512,format={format}")).iter().chain(["map:size=4096".into()].iter())
        {
            let errors = errors_in_texels(&view, light, &judged(&view, &question, typed), typed);
            assert!(farthest(&errors) <= band_texels(1.0), "{light} {typed}: {}", farthest(&errors));
            assert!(!errors.is_empty(), "{light} {typed}: nothing was put to the test");
        }
    }
}

/// Wrong pixels are a share of the texels that the edge crosses: half the size, twice as many. A few dozen wrong pixels
/// and the curve's own start (1.7 from 16 to 32 texels, 2.07 from 128 on) leave a fifth of freedom.
const DOUBLING: std::ops::RangeInclusive<f64> = 1.6..=2.4;

#[test]
fn half_the_size_doubles_the_wrong_pixels() {
    const PHASES: u32 = 4;
    const SIZES: [u32; 4] = [64, 128, 256, 512];
    let gpu = gpu();
    let scene = three_lights(SIZE);
    let view = View::new(&gpu, &scene).unwrap();
    for light in LIGHTS {
        let question = ask(&view, light);
        let mean_wrong = SIZES.map(|size| {
            let spec = Spec::parse(&format!("map:size={size}")).unwrap();
            let phases = jittered(&view, &question, &spec, PHASES, &Unwatched).unwrap();
            phases.iter().map(|(_, fraction)| fraction).sum::<f64>() / f64::from(PHASES)
        });
        for pair in mean_wrong.windows(2) {
            assert!(DOUBLING.contains(&(pair[0] / pair[1])), "{light}: {mean_wrong:?}");
        }
        assert!(!DOUBLING.contains(&(mean_wrong[0] / mean_wrong[2])), "{light}: a quarter of the size is no half");
    }
}

/// Share of a lit tilted plane that shadows itself without bias: half of every texel is nearer to the light than its
/// centre. Pixels that sample texels in step shift it by less than this.
const HALF_TOLERANCE: f64 = 0.01;

#[test]
fn without_bias_half_of_the_lit_floor_is_in_shadow_and_slope_bias_clears_it() {
    let gpu = gpu();
    let scene = three_lights(SIZE);
    let view = View::new(&gpu, &scene).unwrap();
    for light in LIGHTS {
        let question = ask(&view, light);
        let lit = Some(Truth::Known(Visibility::LIT));
        let lit = question.truth.mask.pixels.iter().filter(|truth| **truth == lit).count() as f64;
        for size in [128, 512] {
            let without = explained(&view, &question, &format!("map:size={size},bias=none"));
            let share = without.verdict.pixels.false_shadow as f64 / lit;
            assert!((share - 0.5).abs() <= HALF_TOLERANCE, "{light} {size}: {share}");
            let acne = without.ledger.causes[&Cause::Acne].pixels as f64;
            assert!(acne >= 0.98 * without.verdict.pixels.false_shadow as f64, "{light} {size}: {acne}");
            let typed = format!("map:size={size},bias=slope");
            let with = explained(&view, &question, &typed);
            assert!(!with.ledger.causes.contains_key(&Cause::Acne), "{light} {size}: {:?}", with.ledger.causes);
            assert!(farthest(&errors_in_texels(&view, light, &with, &typed)) <= band_texels(1.0), "{light} {size}");
        }
    }
}

#[test]
fn too_much_bias_detaches_the_contact_by_the_predicted_strip() {
    const BIAS_M: f64 = 0.1;
    /// The blocker's own texel, that of the receiver, and the closed-form bias beside the one typed: 1.2 texels at 40°.
    const SLACK_TEXELS: f64 = 4.0;
    let gpu = gpu();
    let scene = shipped("contact", SIZE);
    let view = View::new(&gpu, &scene).unwrap();
    let question = ask(&view, "sun");
    let fin_front = scene.bounds_of(|mesh| mesh.name == "Fin").min.z;
    let towards_light = question.light.homogeneous().truncate();
    let typed = format!("map:size=1024,bias_depth_m={BIAS_M}");
    let detached = explained(&view, &question, &typed);
    let settings = Settings::of(&Spec::parse(&typed).unwrap());
    let views = settings.projection.fit(&scene, question.light, &settings, &[]).unwrap();
    let slack_m = SLACK_TEXELS * views[0].site(scene.bounds().centre()).texel_m().max_element();
    let (mut inside, mut lost_inside, mut lost_beyond) = (0, 0, 0);
    for (pixel, receiver) in view.receivers.pixels.iter().enumerate() {
        let in_shadow = question.truth.mask.pixels[pixel] == Some(Truth::Known(Visibility::SHADOW));
        let on_floor = |triangle| mesh(&scene, "Floor").triangles.contains(&triangle);
        let Some(receiver) = receiver.filter(|receiver| in_shadow && on_floor(receiver.triangle)) else { continue };
        // The fin's side towards the light is what the map stores: so far along the light it is from the receiver.
        let to_blocker_m = (fin_front - receiver.point_in_world.z) / towards_light.z;
        let lost = detached.verdict.is_wrong(pixel);
        inside += u32::from(to_blocker_m < BIAS_M - slack_m);
        lost_inside += u32::from(to_blocker_m < BIAS_M - slack_m && lost);
        lost_beyond += u32::from(
            to_blocker_m > BIAS_M + slack_m && detached.ledger.cause_of(pixel as u32) == Some(Cause::PeterPanning),
        );
    }
    assert!(inside > 200, "the strip covers {inside} pixels");
    assert_eq!((lost_inside, lost_beyond), (inside, 0), "of {inside}");
    let attached = explained(&view, &question, "map:size=1024");
    let peter_panning = |evaluation: &Evaluation<'_>| {
        evaluation.ledger.causes.get(&Cause::PeterPanning).map_or(0, |share| share.pixels)
    };
    assert!(peter_panning(&detached) >= inside.into());
    assert!(
        peter_panning(&attached) * 10 < inside.into(),
        "{} detached without being asked to",
        peter_panning(&attached)
    );
}

#[test]
fn odd_and_tiny_maps_and_pictures_are_answered_and_explained() {
    let gpu = gpu();
    let odd_pictures = [[1, 1], [101, 37], [1, 64]].map(|size| (size, vec![1, 2, 3, 33, 1001]));
    for (picture, maps) in odd_pictures {
        let scene = three_lights(picture);
        let view = View::new(&gpu, &scene).unwrap();
        for light in LIGHTS {
            let question = ask(&view, light);
            for map in &maps {
                let typed = format!("map:size={map}");
                let evaluation = explained(&view, &question, &typed);
                assert_eq!(evaluation.verdict.pixels.total, u64::from(picture[0] * picture[1]));
                // A texel of the smallest maps is so wide that the bias it needs swallows the blocker's height.
                if *map >= 33 {
                    let errors = errors_in_texels(&view, light, &evaluation, &typed);
                    assert!(farthest(&errors) <= band_texels(1.0), "{light} {picture:?} {typed}");
                }
            }
        }
    }
}

/// How many of `taps` equal comparisons each answer of a mask stands for, each number once.
fn levels(mask: &Mask, taps: u32) -> BTreeSet<u32> {
    /// A division of two small whole numbers in f32: WGSL allows 2.5 units in the last place.
    const DIVISION: f64 = 1e-6;
    let count_of = |visibility: &Visibility| {
        let lit = f64::from(visibility.get()) * f64::from(taps);
        assert!((lit - lit.round()).abs() <= DIVISION * f64::from(taps), "{lit} of {taps}");
        lit.round() as u32
    };
    mask.pixels.iter().flatten().map(count_of).collect()
}

#[test]
fn a_box_of_n_taps_a_side_has_the_levels_of_n_squared_comparisons() {
    let gpu = gpu();
    let scene = three_lights(SIZE);
    let view = View::new(&gpu, &scene).unwrap();
    for light in LIGHTS {
        let question = ask(&view, light);
        let mask = |filter: &str| judged(&view, &question, &format!("map:size=256,filter={filter}")).mask;
        assert!(mask("pcf-box1") == mask("nearest"), "{light}: one tap is nearest, bit for bit");
        assert!(mask("pcf-box2") != mask("nearest"), "{light}");
        for n in [2_u32, 3, 4, 5, 8] {
            let found = levels(&mask(&format!("pcf-box{n}")), n * n);
            assert!(found.len() > 2 && found.len() <= (n * n + 1) as usize, "{light} {n}: {found:?}");
        }
    }
}

#[test]
fn the_map_does_not_depend_on_the_camera() {
    let gpu = gpu();
    let scene = three_lights(SIZE);
    let mut elsewhere = scene.clone();
    elsewhere.camera.eye = Vec3::new(-2.0, 3.0, -3.0);
    let (view, other) = (View::new(&gpu, &scene).unwrap(), View::new(&gpu, &elsewhere).unwrap());
    let spec = Spec::parse("map:size=256").unwrap();
    for light in LIGHTS {
        let question = ask(&view, light);
        let answer = |job: Job<'_>| spec.technique().prepare(&spec, job).unwrap().run().unwrap().mask;
        let at_home = answer(view.job(question.light, &question.classes));
        // The same receivers, asked while the camera is elsewhere.
        let away = Job { receivers: &view.receivers, ..other.job(question.light, &question.classes) };
        assert!(answer(away) == at_home, "{light}");
    }
    // Control: a map fitted to what the camera sees does.
    let frustum = |view: &View<'_>, fit: &str| {
        let question = ask(view, "sun");
        let settings = Settings::of(&spec.with("fit", fit).unwrap());
        let visible = Asked { receivers: &view.receivers, classes: &question.classes }.points();
        settings.projection.fit(view.scene, question.light, &settings, &visible).unwrap()[0].rows
    };
    assert_eq!(frustum(&view, "scene"), frustum(&other, "scene"));
    assert_ne!(frustum(&view, "receivers"), frustum(&other, "receivers"));
}
