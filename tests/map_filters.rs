//! Filters of the map family, on one triangle over a level floor: they err within their kernels, average comparisons as
//! their f64 twins do, and need the bias that is predicted for their width.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

mod support;

use gnomon::cause::Cause;
use gnomon::evaluate::{Evaluation, View};
use support::outline::{MappedOutline, band_texels};
use support::scenes::{ask, explained, gpu, judged, shipped};

const SIZE: [u32; 2] = [320, 240];
const LIGHTS: [&str; 2] = ["lamp", "sun"];

/// Filters and the width of their kernels in texels: which centres they read, and how much bias they need.
const WIDE: [(&str, f64); 5] =
    [("pcf-box5", 5.0), ("pcf-bilinear1", 2.0), ("pcf-bilinear4", 5.0), ("pcf-poisson16", 5.0), ("pcf-poisson64", 5.0)];

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
