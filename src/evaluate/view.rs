//! What evaluations share: the scene on the device, its rays, its receivers; and the truth for one light.

use crate::cast::Casters;
use crate::gpu::{GBufferPass, Geometry, Gpu, GpuError};
use crate::inspect::{Adjacency, neighbours};
use crate::mask::Truth;
use crate::receiver::{Asked, PixelClass, Receivers};
use crate::scene::{Light, Scene};
use crate::technique::Job;
use crate::truth::mitsuba::MitsubaCheck;
use crate::truth::{self, Disagreement, ExactTruth, TruthKey};
use crate::watch::{Interrupted, Watch};

/// A scene seen from its camera: all that no light changes.
#[derive(Debug)]
pub struct View<'s> {
    /// The device.
    pub gpu: &'s Gpu,
    /// The scene.
    pub scene: &'s Scene,
    /// Its triangles on the device.
    pub geometry: Geometry,
    /// Its casters for rays.
    pub casters: Casters,
    /// Which triangles touch.
    pub adjacency: Adjacency,
    /// The point behind every pixel.
    pub receivers: Receivers,
    /// The pass that found them.
    pub gbuffer: GBufferPass,
}

/// The question about one light: which pixels are asked, and the exact answer.
#[derive(Debug)]
pub struct Question<'s> {
    /// The light.
    pub light: &'s Light,
    /// The class of every pixel.
    pub classes: Vec<PixelClass>,
    /// The exact answer.
    pub truth: ExactTruth,
    /// Sampled pixels on which brute force disagrees with it: none, or a bug.
    pub brute_disagreements: Vec<Disagreement>,
    /// What Mitsuba says, if it was asked.
    pub mitsuba: Option<MitsubaCheck>,
    /// Whose answers `truth` holds.
    pub oracle: Oracle,
}

/// Who answers for the truth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Oracle {
    /// The exact ray core.
    Exact,
    /// Mitsuba, where the exact ray core says the same.
    Mitsuba,
}

impl Question<'_> {
    /// With Mitsuba's answers in place of the exact ones. Where the two differ the pixel becomes undecided: replays
    /// start from the exact answer.
    #[must_use]
    pub fn answered_by(mut self, check: MitsubaCheck) -> Self {
        for (exact, theirs) in self.truth.mask.pixels.iter_mut().zip(&check.mask.pixels) {
            if exact.is_some() && exact != theirs {
                *exact = Some(Truth::Undecided);
            }
        }
        Self { mitsuba: Some(check), oracle: Oracle::Mitsuba, ..self }
    }
}

/// Keeps truths between calls of gnomon, as bytes by key.
pub trait TruthStore {
    /// The entry of a key, if there is one.
    fn get(&self, key: &TruthKey) -> Option<Vec<u8>>;
    /// Keeps an entry; failing to is no error.
    fn put(&self, key: &TruthKey, entry: &[u8]);
    /// Told that an entry cannot be used, and why.
    fn refuse(&self, key: &TruthKey, why: &str);
}

/// Asked pixels that brute force decides again for each question.
const CROSS_CHECKED: u32 = 256;
/// Triangle tests a cross-check may take altogether: about a tenth of a second.
const CROSS_CHECK_TESTS: usize = 8_000_000;

impl<'s> View<'s> {
    /// Uploads and rasterises a scene.
    ///
    /// # Errors
    /// What the device reported.
    pub fn new(gpu: &'s Gpu, scene: &'s Scene) -> Result<Self, GpuError> {
        let geometry = Geometry::upload(gpu, scene)?;
        let gbuffer = GBufferPass::new(gpu, scene)?;
        gbuffer.run(gpu, &geometry)?;
        Ok(Self {
            gpu,
            scene,
            geometry,
            casters: Casters::new(scene),
            adjacency: neighbours(scene),
            receivers: Receivers::new(scene, &gbuffer.read(gpu)?.triangles),
            gbuffer,
        })
    }

    /// Works out the truth for one light.
    ///
    /// # Errors
    /// [`Interrupted`] if the user asked to stop.
    pub fn ask(&self, light: &'s Light, watch: &dyn Watch) -> Result<Question<'s>, Interrupted> {
        let classes = self.receivers.classify(self.scene, light);
        let truth = truth::exact(self.scene, &self.casters, light, &self.receivers, &classes, watch)?;
        let affordable = CROSS_CHECK_TESTS / self.casters.triangle_count().max(1);
        let samples = CROSS_CHECKED.min(affordable as u32);
        let brute_disagreements =
            truth::cross_check(self.scene, light, &self.receivers, &classes, watch, &truth.mask, samples)?;
        Ok(Question { light, classes, truth, brute_disagreements, mitsuba: None, oracle: Oracle::Exact })
    }

    /// The same, taken from what earlier calls kept, if it is there and whole; else worked out and kept.
    ///
    /// # Errors
    /// [`Interrupted`] if the user asked to stop.
    pub fn ask_stored(
        &self,
        light: &'s Light,
        store: &dyn TruthStore,
        watch: &dyn Watch,
    ) -> Result<Question<'s>, Interrupted> {
        let key = self.truth_key(light);
        match store.get(&key).map(|entry| truth::decode(&key, &entry)) {
            Some(Ok((classes, truth))) => {
                // Only what brute force agreed with was kept.
                let brute_disagreements = Vec::new();
                return Ok(Question {
                    light,
                    classes,
                    truth,
                    brute_disagreements,
                    mitsuba: None,
                    oracle: Oracle::Exact,
                });
            }
            Some(Err(error)) => store.refuse(&key, &error.to_string()),
            None => {}
        }
        let question = self.ask(light, watch)?;
        if question.brute_disagreements.is_empty()
            && let Ok(entry) = truth::encode(&key, &question.classes, &question.truth)
        {
            store.put(&key, &entry);
        }
        Ok(question)
    }

    /// What the truth about a light depends on.
    #[must_use]
    pub fn truth_key(&self, light: &Light) -> TruthKey {
        let adapter = self.gpu.adapter();
        let adapter = format!("{} {} {}", adapter.name, adapter.backend, adapter.driver);
        TruthKey::new(self.scene, light, &self.receivers, &adapter)
    }

    /// What a technique is asked about a light, given the class of every pixel.
    #[must_use]
    pub fn job<'j>(&'j self, light: &'j Light, classes: &'j [PixelClass]) -> Job<'j> {
        Job {
            gpu: self.gpu,
            scene: self.scene,
            geometry: &self.geometry,
            casters: &self.casters,
            adjacency: &self.adjacency,
            light,
            receivers: &self.receivers,
            classes,
            fitted_to: Asked { receivers: &self.receivers, classes },
        }
    }
}
