//! The pixels of runs, collected for the formats that show them.

use super::pictures::footprints;
use crate::evaluate::{Evaluation, Question, View, occluders};
use crate::report::export::ExportError;
use crate::report::html::{Imagery, QuestionImages, RunImages};

/// Collects nothing unless a format asks for it.
pub(super) struct Collector {
    imagery: Imagery,
    wanted: bool,
}

impl Collector {
    /// Nothing yet.
    pub(super) fn new(wanted: bool) -> Self {
        Self { imagery: Imagery::default(), wanted }
    }

    /// What was collected.
    pub(super) fn imagery(&self) -> &Imagery {
        &self.imagery
    }

    /// A question, to which the runs that follow belong.
    pub(super) fn ask(&mut self, view: &View<'_>, question: &Question<'_>) -> Result<(), ExportError> {
        if !self.wanted {
            return Ok(());
        }
        self.imagery.ask(&QuestionImages {
            classes: &question.classes,
            truth: &question.truth.mask,
            receivers: &view.receivers,
            occluders: &occluders(view, question),
            meshes: &view.scene.meshes,
        })
    }

    /// The next run of the report, with the command that explains a pixel of it; `None` for one without an answer.
    pub(super) fn add(
        &mut self,
        question: &Question<'_>,
        answer: Option<(&Evaluation<'_>, &str)>,
    ) -> Result<(), ExportError> {
        let Some((evaluation, explain)) = answer.filter(|_| self.wanted) else {
            self.imagery.no_answer();
            return Ok(());
        };
        let m: Vec<Option<f64>> =
            footprints(question, evaluation).iter().map(|footprint| footprint.map(|footprint| footprint.m)).collect();
        let Evaluation { mask, ledger, replay, .. } = evaluation;
        self.imagery.answer(&RunImages { explain, mask, ledger, replay, m: &m })
    }
}
