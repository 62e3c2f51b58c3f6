//! Reports to test exporters with.

use super::*;
use crate::cause::Cause;
use crate::evaluate::{Flips, Followed};
use crate::mask::{Mask, Truth, TruthMask, Visibility};
use crate::receiver::PixelClass;
use crate::technique::{BiasAt, Cost, EffectiveBias, GpuTime, InView, PassTime};
use crate::verdict::{CauseShare, Ledger, Verdict, WRONG_ABOVE_HARD, judge, seams};
use glam::UVec2;

/// Names that break whoever does not escape them.
pub(crate) const HOSTILE: &str = "a\"b'<script>alert(1)</script>&amp;,;|`\n\x1b[31m\u{1}]]>";

/// A row of so many lit pixels: falsely shadowed, right, and undecided ones.
pub(crate) fn verdict_with(wrong: u32, right: u32, undecided: u32) -> Verdict {
    let size = UVec2::new(wrong + right + undecided, 1);
    let truth = |x| if x < wrong + right { Truth::Known(Visibility::LIT) } else { Truth::Undecided };
    let answer = |x| if x < wrong { Visibility::SHADOW } else { Visibility::LIT };
    let truth = TruthMask { size, pixels: (0..size.x).map(|x| Some(truth(x))).collect() };
    let mask = Mask { size, pixels: (0..size.x).map(|x| Some(answer(x))).collect() };
    judge(&vec![PixelClass::Asked; size.x as usize], &truth, &mask, WRONG_ABOVE_HARD).unwrap()
}

pub(crate) fn question(scene: &str, typed: &str) -> Question {
    Question {
        scene: scene.to_owned(),
        light: "lamp".to_owned(),
        typed: typed.to_owned(),
        technique: format!("{typed},bias=closed-form"),
        command: format!("gnomon check scenes/{scene} -t {typed}"),
        image: UVec2::new(64, 48),
        wrong_above: WRONG_ABOVE_HARD,
    }
}

const BIAS: BiasAt = BiasAt {
    along_light_depth: 0.001,
    along_light_m: 0.04,
    along_normal_m: 0.0,
    acne_free_m: 0.02,
    contact_gap_m: 0.03,
    texel_m: 0.04,
};

/// A judged run with every figure filled in.
pub(crate) fn full_run(scene: &str) -> Run {
    let verdict = verdict_with(3, 4, 1);
    let mut ledger = Ledger::default();
    ledger.causes.insert(Cause::Acne, CauseShare { pixels: 2, merely_differing: 1, sum: -2.1 });
    ledger.causes.insert(Cause::EdgeAliasing, CauseShare { pixels: 1, merely_differing: 0, sum: -0.9 });
    let mut run = Run::judged(question(scene, "map:size=512"), &verdict).explained_by(&ledger);
    run.cost = Some(Cost {
        gpu_ms: Some(GpuTime { median: 1.25, min: 1.1, max: 0.1 + 0.2, runs: 9 }),
        gbuffer_ms: Some(0.5),
        passes: vec![PassTime { name: "map".to_owned(), ms: 0.75, ms_min: 0.5, ms_max: 1.0 }],
        prepare_ms: Some(3.5),
        bytes: 1 << 20,
        vertices: Some(300),
        primitives: Some(100),
        fragments: Some(262_144),
        texel_reads: Some(196_608),
    });
    run.truth = Some(TruthSource {
        oracle: "exact".to_owned(),
        rays: 7,
        ms: 0.3,
        disagreements: Disagreements { mitsuba: None, brute: Some(0) },
        mitsuba: None,
    });
    run.budget = Some(BudgetOutcome::of(&verdict, Some(0.001), None));
    run.jitter = Jitter::of(&[0.25, 0.5]);
    run.motion = Motion::of(&Flips { of_camera: vec![1, 3], of_light: vec![0, 2], followed: Followed::Points });
    let places = [0, 0, 1, 1, 1, 1, 1, 1].map(|view| Some(InView { view, seam_texels: Some(3.0 * view as f64) }));
    let names = ["near", "far"].map(str::to_owned);
    run.seams = Some(seams(&names, &places, &verdict.signed_error, WRONG_ABOVE_HARD));
    run.bias = EffectiveBias::of("map", &[BIAS]).map(|bias| vec![bias]);
    run
}

/// A judged, an unsupported and a failed run.
pub(crate) fn report() -> Report {
    report_of("kitchen")
}

pub(crate) fn report_of(scene: &str) -> Report {
    let adapter = Adapter {
        name: "llvmpipe".to_owned(),
        backend: "vulkan".to_owned(),
        driver: "Mesa 22.3.6".to_owned(),
        features: vec!["timestamp-query".to_owned()],
        software: true,
    };
    let runs = vec![
        full_run(scene),
        Run::unsupported(question(scene, "volume:count=z-pass"), "open mesh, 12 edges".to_owned()),
        Run::failed(question(scene, "map:size=16384"), "device lost".to_owned()),
    ];
    Report::new(adapter, runs)
}
