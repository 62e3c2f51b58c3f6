//! From an evaluation to the report's model.

use crate::evaluate::Question;
use crate::gpu::Gpu;
use crate::report::model;
use crate::scene::{Light, Scene};
use crate::technique::Spec;
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
    model::TruthSource {
        oracle: "exact".to_owned(),
        rays: question.truth.rays,
        ms: question.truth.ms,
        disagreements: model::Disagreements { mitsuba: None, brute: Some(question.brute_disagreements.len() as u64) },
    }
}
