//! What the page knows of every pixel: what was asked and what is true, once per question, and a technique's answer, causes
//! and stages, once per run.

use super::plane::Plane;
use crate::cause::{Replay, Stage};
use crate::mask::{Mask, Truth, TruthMask, Visibility};
use crate::receiver::{PixelClass, Receivers};
use crate::report::export::ExportError;
use crate::report::format::significant;
use crate::scene::Mesh;
use crate::verdict::Ledger;
use glam::UVec2;
use serde::Serialize;
use std::io;

/// The pixels of a report: those of its questions, and those of the runs that gave an answer.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Imagery {
    pub(super) questions: Vec<QuestionPixels>,
    /// One per run of the report, in its order.
    pub(super) runs: Vec<Option<RunPixels>>,
}

/// What is asked and what is true, for every pixel of one light's question. The page's classes are those of [`PixelClass`]
/// and `undecided`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct QuestionPixels {
    size: [u32; 2],
    class: Plane,
    truth: Plane,
    /// Triangle id + 1; 0 for none.
    receiver: Plane,
    /// The nearest blocker's triangle id + 1; 0 for none.
    occluder: Plane,
    /// The last triangle id + 1 of each mesh, ascending, and the mesh's name.
    meshes: Vec<(u32, String)>,
}

/// One run's answer and what is known of its errors.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct RunPixels {
    question: usize,
    /// The command that explains a pixel, but for which.
    explain: String,
    technique: Plane,
    /// Place in [`Cause::ALL`](crate::cause::Cause::ALL) + 1; 0 for none.
    cause: Plane,
    /// Image pixels per texel, to three significant digits; `None` for a technique without texels.
    m: Option<Plane>,
    /// Pixels (`y * width + x`) whose stages are known, ascending.
    replayed: Plane,
    exact: Plane,
    stages: Vec<StagePixels>,
}

/// One stage of the replayed pixels.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct StagePixels {
    name: &'static str,
    value: Plane,
    /// Place in [`Cause::ALL`](crate::cause::Cause::ALL).
    cause: Plane,
}

/// What a question's pixels are made from; lists have one entry per pixel, row by row from the top.
#[derive(Debug, Clone, Copy)]
pub struct QuestionImages<'a> {
    /// What each pixel is asked.
    pub classes: &'a [PixelClass],
    /// The exact answer.
    pub truth: &'a TruthMask,
    /// The point behind each pixel.
    pub receivers: &'a Receivers,
    /// The triangle that blocks the light; `None` where nothing does or nobody asked.
    pub occluders: &'a [Option<u32>],
    /// The scene's meshes.
    pub meshes: &'a [Mesh],
}

/// What a run's pixels are made from; lists have one entry per pixel, row by row from the top.
#[derive(Debug, Clone, Copy)]
pub struct RunImages<'a> {
    /// The command that explains a pixel, without `--pixel`.
    pub explain: &'a str,
    /// The technique's answer.
    pub mask: &'a Mask,
    /// Its causes.
    pub ledger: &'a Ledger,
    /// Its stages.
    pub replay: &'a Replay,
    /// Image pixels per texel; `None` where no texel is looked up.
    pub m: &'a [Option<f64>],
}

impl Imagery {
    /// Adds a question, to which the runs that follow belong.
    ///
    /// # Errors
    /// What the compression reports.
    pub fn ask(&mut self, images: &QuestionImages<'_>) -> Result<(), ExportError> {
        self.questions.push(QuestionPixels::new(images).map_err(ExportError::Packing)?);
        Ok(())
    }

    /// Adds the run of the report that comes next, an answer to the latest question.
    ///
    /// # Errors
    /// What the compression reports.
    pub fn answer(&mut self, images: &RunImages<'_>) -> Result<(), ExportError> {
        let question = self.questions.len().saturating_sub(1);
        self.runs.push(Some(RunPixels::new(question, images).map_err(ExportError::Packing)?));
        Ok(())
    }

    /// Adds the run of the report that comes next, which has no answer.
    pub fn no_answer(&mut self) {
        self.runs.push(None);
    }
}

impl QuestionPixels {
    fn new(images: &QuestionImages<'_>) -> io::Result<Self> {
        let QuestionImages { classes, truth, receivers, occluders, meshes } = *images;
        let UVec2 { x, y } = truth.size;
        let class: Vec<u8> =
            classes.iter().zip(&truth.pixels).map(|(class, truth)| class_number(*class, *truth)).collect();
        let id = |id: Option<u32>| id.map_or(0, |id| id + 1);
        let receivers: Vec<u32> = receivers.pixels.iter().map(|r| id(r.map(|r| r.triangle))).collect();
        let occluders: Vec<u32> = occluders.iter().map(|triangle| id(*triangle)).collect();
        Ok(Self {
            size: [x, y],
            class: Plane::of_bytes(&class)?,
            truth: Plane::of_values(&truth.pixels.iter().map(known).collect::<Vec<f64>>())?,
            receiver: Plane::of_ids(&receivers)?,
            occluder: Plane::of_ids(&occluders)?,
            meshes: meshes.iter().map(|mesh| (mesh.triangles.end, mesh.name.clone())).collect(),
        })
    }
}

impl RunPixels {
    fn new(question: usize, images: &RunImages<'_>) -> io::Result<Self> {
        let RunImages { explain, mask, ledger, replay, m } = *images;
        let visibility = |answer: &Option<Visibility>| answer.map_or(f64::NAN, |answer| answer.get().into());
        let three_digits = |m: &Option<f64>| m.and_then(|m| significant(m).parse().ok()).unwrap_or(f64::NAN);
        let mut cause = vec![0; mask.pixels.len()];
        for (pixel, named) in ledger.wrong.iter().chain(&ledger.merely_differing) {
            cause[*pixel as usize] = *named as u8 + 1;
        }
        let stage = |stage: &Stage| {
            let causes: Vec<u8> = stage.causes.iter().map(|cause| *cause as u8).collect();
            Ok(StagePixels {
                name: stage.name,
                value: Plane::of_values(&stage.values)?,
                cause: Plane::of_bytes(&causes)?,
            })
        };
        Ok(Self {
            question,
            explain: explain.to_owned(),
            technique: Plane::of_values(&mask.pixels.iter().map(visibility).collect::<Vec<f64>>())?,
            cause: Plane::of_bytes(&cause)?,
            m: if m.iter().any(Option::is_some) {
                Some(Plane::of_values(&m.iter().map(three_digits).collect::<Vec<f64>>())?)
            } else {
                None
            },
            replayed: Plane::of_ids(&replay.pixels)?,
            exact: Plane::of_values(&replay.exact)?,
            stages: replay.stages.iter().map(stage).collect::<io::Result<_>>()?,
        })
    }
}

/// The numbers the page knows classes by.
fn class_number(class: PixelClass, truth: Option<Truth>) -> u8 {
    match (class, truth) {
        (PixelClass::Background, _) => 0,
        (PixelClass::FacingAway, _) => 1,
        (PixelClass::NotLit, _) => 2,
        (PixelClass::Asked, Some(Truth::Known(_))) => 4,
        (PixelClass::Asked, _) => 3,
    }
}

fn known(truth: &Option<Truth>) -> f64 {
    match truth {
        Some(Truth::Known(visibility)) => visibility.get().into(),
        _ => f64::NAN,
    }
}
