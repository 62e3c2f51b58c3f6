//! Filters of the map family, on one triangle over a level floor: they err within their kernels, average comparisons as
//! their f64 twins do, and need the bias that is predicted for their width.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

mod support;

use gnomon::cause::Cause;
use gnomon::evaluate::{Evaluation, View};
use std::collections::BTreeSet;
use support::outline::{MappedOutline, band_texels};
use support::scenes::{ask, explained, gpu, judged, shipped};

const SIZE: [u32; 2] = [320, 240];
const LIGHTS: [&str; 2] = ["lamp", "sun"];

/// Filters and the width of their kernels in texels: which centres they read, and how much bias they need.
const WIDE: [(&str, f64); 7] = [
    ("pcf-box5", 5.0),
    ("pcf-bilinear1", 2.0),
    ("pcf-bilinear4", 5.0),
    ("pcf-poisson16", 5.0),
    ("pcf-poisson64", 5.0),
    ("pcf-poisson16,turn=per-pixel,poisson_radius_texels=3.5", 8.0),
    ("pcf-hardware2", 3.0),
];

#[test]
fn every_filter_errs_within_its_kernel() {
    let (gpu, scene) = (gpu(), shipped("triangle", SIZE));
    let view = View::new(&gpu, &scene).unwrap();
    for light in LIGHTS {
        let question = ask(&view, light);
        for (filter, width) in WIDE {
            let typed = format!("map:size=512,filter={filter}");
            let evaluation = judged(&view, &question, &typed);
            let mapped = MappedOutline::new(&scene, question.light, &typed);
            let errors = evaluation.verdict.signed_error.iter().zip(&view.receivers.pixels);
            let off = errors.filter(|(error, _)| error.is_some_and(|error| error != 0.0));
            let farthest = off.map(|(_, at)| mapped.texels_from_edge(at.unwrap().point_in_world)).fold(0.0, f64::max);
            assert!(farthest <= band_texels(width), "{light} {typed}: {farthest}");
            assert!(farthest > band_texels(1.0), "{light} {typed}: the wider band is needed");
        }
    }
}

#[test]
fn one_tap_is_nearest_bit_for_bit() {
    let (gpu, scene) = (gpu(), shipped("triangle", SIZE));
    let view = View::new(&gpu, &scene).unwrap();
    for light in LIGHTS {
        let question = ask(&view, light);
        let mask = |filter: &str| judged(&view, &question, &format!("map:size=256,filter={filter}")).mask;
        assert!(mask("pcf-box1") == mask("nearest") && mask("pcf-poisson1") == mask("nearest"), "{light}");
        assert!(mask("pcf-bilinear1") != mask("nearest") && mask("pcf-poisson2") != mask("nearest"), "{light}");
    }
}

/// A kernel of some width needs that many half texels of the receiver's slope, and the rasteriser's factor 1 is twice
/// one half: with a factor of its width every filter is clear of acne, with one that suits `nearest` it is not.
#[test]
fn a_wide_kernel_needs_the_predicted_bias() {
    let (gpu, scene) = (gpu(), shipped("triangle", SIZE));
    let view = View::new(&gpu, &scene).unwrap();
    for light in LIGHTS {
        let question = ask(&view, light);
        let acne = |evaluation: &Evaluation<'_>| evaluation.ledger.causes.contains_key(&Cause::Acne);
        for (filter, width) in WIDE {
            let with = |bias: &str| explained(&view, &question, &format!("map:size=256,filter={filter},{bias}"));
            assert!(!acne(&with("bias=closed-form")), "{light} {filter}");
            assert!(!acne(&with(&format!("bias=slope,bias_slope={width}"))), "{light} {filter}");
            assert!(acne(&with("bias=slope,bias_slope=0.5")), "{light} {filter}");
        }
    }
}

/// FI-1: the values that n × n comparisons can have, and no others.
#[test]
fn a_box_answers_in_shares_of_its_texels() {
    let (gpu, scene) = (gpu(), shipped("triangle", SIZE));
    let view = View::new(&gpu, &scene).unwrap();
    let question = ask(&view, "lamp");
    let values = |filter: &str| -> BTreeSet<u32> {
        let mask = judged(&view, &question, &format!("map:size=128,filter={filter}")).mask;
        mask.pixels.iter().flatten().map(|visibility| visibility.get().to_bits()).collect()
    };
    for n in [1_u32, 2, 3, 4] {
        let shares: BTreeSet<u32> = (0..=n * n).map(|lit| (lit as f32 / (n * n) as f32).to_bits()).collect();
        let found = values(&format!("pcf-box{n}"));
        assert!(found.is_subset(&shares) && found.len() > n as usize, "{n}: {found:?}");
    }
    // 5 of 9 in shadow.
    assert!(values("pcf-box3").contains(&(4.0_f32 / 9.0).to_bits()));
    assert!(values("pcf-bilinear2").len() > 100, "a bilinear kernel is continuous");
}

/// FI-2: the sampler's weights are those worked out by hand, within what drivers round them to.
#[test]
fn the_sampler_weighs_as_the_shader_does() {
    /// Fixed-point weights of 8 bits along each axis.
    const WEIGHT_STEP: f32 = 1.0 / 256.0;
    let (gpu, scene) = (gpu(), shipped("triangle", SIZE));
    let view = View::new(&gpu, &scene).unwrap();
    for light in LIGHTS {
        let question = ask(&view, light);
        for n in [1, 3] {
            for convention in ["reversed", "forward"] {
                let mask = |filter: &str| {
                    let typed = format!("map:size=256,filter={filter}{n},depth_convention={convention}");
                    judged(&view, &question, &typed).mask
                };
                let (by_hand, sampled) = (mask("pcf-bilinear"), mask("pcf-hardware"));
                let pairs = by_hand.pixels.iter().zip(&sampled.pixels).filter_map(|(a, b)| (*a).zip(*b));
                let farthest = pairs.map(|(a, b)| (a.get() - b.get()).abs()).fold(0.0, f32::max);
                assert!(farthest <= 2.0 * WEIGHT_STEP, "{light} {n} {convention}: {farthest}");
            }
        }
    }
}

/// FI-6: a shortcut that holds all of the kernel changes nothing; one over fewer texels would.
#[test]
fn masked_kernels_answer_as_whole_ones_bit_for_bit() {
    let (gpu, scene) = (gpu(), shipped("torus", SIZE));
    let view = View::new(&gpu, &scene).unwrap();
    for light in LIGHTS {
        let question = ask(&view, light);
        for (n, options) in [(5, "size=300"), (4, "size=512,depth_convention=forward"), (9, "size=200,bias=slope")] {
            let mask = |filter: &str| judged(&view, &question, &format!("map:{options},filter={filter}")).mask;
            let whole = mask(&format!("pcf-box{n}"));
            for level in 0..=4 {
                assert!(mask(&format!("pcf-edge-masked{n},mask_level={level}")) == whole, "{light} {n} {level}");
            }
            assert!(mask(&format!("pcf-edge-masked{}", n - 1)) != whole, "{light} {n}");
        }
    }
}

/// FI-8: turned patterns repeat with their seed, and stay within the disc that is typed.
#[test]
fn turned_patterns_repeat_with_their_seed() {
    let (gpu, scene) = (gpu(), shipped("triangle", SIZE));
    let view = View::new(&gpu, &scene).unwrap();
    let question = ask(&view, "sun");
    let mask = |options: &str| judged(&view, &question, &format!("map:size=256,filter=pcf-poisson8,{options}")).mask;
    assert!(mask("turn=per-pixel,seed=4") == mask("turn=per-pixel,seed=4"));
    assert!(mask("turn=per-pixel,seed=4") != mask("turn=per-pixel,seed=5"));
    assert!(mask("turn=none,seed=4") == mask("turn=none,seed=5") && mask("turn=none") != mask("turn=per-pixel"));
    let soft = |radius: &str| {
        let mask = mask(&format!("turn=per-pixel,poisson_radius_texels={radius}"));
        mask.pixels.iter().flatten().filter(|v| v.get() > 0.0 && v.get() < 1.0).count()
    };
    let [narrow, wide] = ["1", "8"].map(soft);
    assert!(wide > 5 * narrow, "{narrow} {wide}");
}

/// FI-7: the penumbra of a kernel is as wide as the kernel, whatever the light's is; that is what its errors are for.
#[test]
fn against_an_area_light_the_width_of_a_kernel_is_its_error() {
    let (gpu, scene) = (gpu(), shipped("area", SIZE));
    let view = View::new(&gpu, &scene).unwrap();
    let question = ask(&view, "panel");
    let wrong = |filter: &str| {
        let evaluation = explained(&view, &question, &format!("map:size=512,filter={filter}"));
        let by_width = evaluation.ledger.causes.get(&Cause::FilterWidth).map_or(0.0, |share| share.sum.abs());
        (evaluation.verdict.pixels.wrong, by_width)
    };
    let [narrow, wide, fitting] = ["pcf-box3", "pcf-box16", "pcss"].map(wrong);
    assert!(fitting.0 * 4 < narrow.0.min(wide.0), "{fitting:?} {narrow:?} {wide:?}");
    assert!(wide.1 > 0.0 && narrow.1 > 0.0);
}
