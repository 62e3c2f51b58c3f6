//! From an evaluation to the report's model.

use crate::evaluate::Question;
use crate::gpu::Gpu;
use crate::report::model;
use crate::scene::{Light, Scene};
use crate::technique::Spec;
use crate::verdict::WRONG_ABOVE_HARD;
use glam::UVec2;
use std::path::Path;

/// What a run asks.
pub(super) fn question(scene: &Scene, light: &Light, spec: &Spec, command: String) -> model::Question {
    model::Question {
        scene: scene.name.clone(),
        light: light.name.clone(),
        typed: spec.typed.clone(),
        technique: spec.to_string(),
        command,
        image: scene.image_size,
        wrong_above: WRONG_ABOVE_HARD,
    }
}

/// The command that repeats one run.
pub(super) fn command(scene: &Path, light: &Light, spec: &Spec, size: UVec2, jitter: u32) -> String {
    let jitter = if jitter > 0 { format!(" --jitter {jitter}") } else { String::new() };
    format!(
        "gnomon check {} -t {} --light {} --size {}x{}{jitter}",
        quoted(&scene.to_string_lossy()),
        quoted(&spec.short()),
        quoted(&light.name),
        size.x,
        size.y
    )
}

/// A word as a POSIX shell takes it.
pub(super) fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./:=,+".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
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

#[cfg(test)]
mod tests {
    use super::quoted;

    #[test]
    fn words_survive_the_shell() {
        assert_eq!(quoted("map:size=64,filter=pcf-box3"), "map:size=64,filter=pcf-box3");
        assert_eq!(quoted("my scene; rm x"), "'my scene; rm x'");
        assert_eq!(quoted("it's"), "'it'\\''s'");
        assert_eq!(quoted(""), "''");
    }
}
