//! From an evaluation to the report's model.

use crate::evaluate::{Oracle, Question};
use crate::gpu::Gpu;
use crate::report::model;
use crate::scene::{Light, Scene};
use crate::technique::Spec;
use crate::truth::mitsuba::{ListedRay, MitsubaCheck, Reason, Verdict};
use crate::verdict::wrong_above;

/// What a run asks.
pub(super) fn question(scene: &Scene, light: &Light, spec: &Spec, command: String) -> model::Question {
    model::Question {
        scene: scene.name.clone(),
        light: light.name.clone(),
        typed: spec.typed.clone(),
        technique: spec.to_string(),
        command,
        image: scene.image_size,
        wrong_above: wrong_above(light),
    }
}

/// The adapter as reports name it.
pub(super) fn adapter(gpu: &Gpu) -> model::Adapter {
    let adapter = gpu.adapter();
    model::Adapter {
        name: adapter.name.clone(),
        backend: adapter.backend.clone(),
        driver: adapter.driver.clone(),
        features: adapter.features.clone(),
        software: adapter.is_software,
    }
}

/// Where the truth came from.
pub(super) fn truth_source(question: &Question<'_>) -> model::TruthSource {
    let oracle = match question.oracle {
        Oracle::Exact => "exact",
        Oracle::Mitsuba => "mitsuba",
    };
    let brute = Some(question.brute_disagreements.len() as u64);
    let width = question.truth.mask.size.x;
    model::TruthSource {
        oracle: oracle.to_owned(),
        rays: question.truth.rays,
        ms: question.truth.ms,
        disagreements: model::Disagreements { mitsuba: question.mitsuba.as_ref().map(disagreeing_pixels), brute },
        mitsuba: question.mitsuba.as_ref().map(|check| mitsuba_figures(check, width)),
    }
}

fn disagreeing_pixels(check: &MitsubaCheck) -> u64 {
    let rays: Vec<_> = check.disagreements().collect();
    // They come pixel by pixel.
    rays.chunk_by(|a, b| a.pixel == b.pixel).count() as u64
}

fn mitsuba_figures(check: &MitsubaCheck, width: u32) -> model::MitsubaFigures {
    let place = |pixel: u32| [pixel % width, pixel / width];
    let row = |ray: &ListedRay| model::RayRow {
        pixel: place(ray.pixel),
        point: ray.point,
        from: ray.segment.from.to_array(),
        to: ray.segment.to.to_array(),
        blocked: ray.blocked,
        mitsuba: match ray.mitsuba {
            Verdict::Blocked => "blocked".into(),
            Verdict::Clear => "lit".into(),
            Verdict::Contact => "contact".into(),
        },
        confirmed: ray.confirmed,
        reason: ray.reason.name().into(),
        distance_m: ray.reason.distance_m(),
    };
    let estimate = check.estimate.as_ref().map(|estimate| model::EstimateFigures {
        draws: estimate.draws,
        alpha: estimate.alpha,
        discrepancy: estimate.discrepancy,
        accepted: estimate.tested - estimate.rejected.len() as u64,
        rejected: estimate.rejected.iter().copied().map(place).collect(),
    });
    model::MitsubaFigures {
        version: check.version.clone(),
        rays: check.rays,
        disagreements: check.disagreements().count() as u64,
        contacts: check.contacts() as u64,
        ms: check.ms,
        listed: check.listed.iter().map(row).collect(),
        estimate,
    }
}

/// What people are told of Mitsuba's answers, in one line; `None` if it was not asked.
pub(super) fn mitsuba_line(question: &Question<'_>) -> Option<String> {
    let check = question.mitsuba.as_ref()?;
    let differing = check.disagreements().count();
    let unexplained = check.disagreements().filter(|ray| matches!(ray.reason, Reason::Unexplained { .. })).count();
    let reasons = match (differing, unexplained) {
        (0, _) => String::new(),
        (_, 0) => ", each within f32 error of an edge".to_owned(),
        (_, unexplained) => format!(", {unexplained} of them UNEXPLAINED"),
    };
    let estimate = check.estimate.as_ref().map_or_else(String::new, |estimate| {
        let rejected = estimate.rejected.len();
        format!("; its own estimate of the light's share rejects {rejected} of {} pixels", estimate.tested)
    });
    Some(format!(
        "light '{}': {} differs from the exact truth on {differing} of {} rays{reasons}, and cannot tell on {}{estimate}",
        question.light.name,
        check.version,
        check.rays,
        check.contacts()
    ))
}
