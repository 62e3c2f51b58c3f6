//! Shadow rays ready to be cast for one light, and their replay: exact → the device's f32 rays, which are the answer.

use super::passes::RayPasses;
use crate::cause::{Cause, Replay, Stage};
use crate::mask::{Mask, Truth};
use crate::technique::footprint::Footprint;
use crate::technique::{Answer, Job, Prepared, ReceiverBuffer, TechniqueError};
use crate::truth;
use rayon::prelude::*;

pub(super) struct PreparedRays<'j> {
    job: Job<'j>,
    passes: RayPasses,
    receivers: ReceiverBuffer,
}

impl<'j> PreparedRays<'j> {
    pub(super) fn new(job: Job<'j>) -> Result<Self, TechniqueError> {
        let receivers = ReceiverBuffer::upload(job.gpu, job.receivers, job.classes)?;
        let passes = RayPasses::new(&job, &receivers)?;
        Ok(Self { job, passes, receivers })
    }

    /// The exact answer at a pixel, and the device's.
    fn replayed(&self, answer: &Mask, pixel: u32) -> Option<(u32, f64, f64)> {
        let job = &self.job;
        let receiver = job.receivers.pixels.get(pixel as usize).copied().flatten()?;
        let answered = f64::from(answer.pixels.get(pixel as usize).copied().flatten()?.get());
        let (eye, radius_m) = (job.scene.camera.eye.as_dvec3(), job.scene.bounds().radius());
        let exact = match truth::of_receiver(job.casters, job.light, &receiver, eye, radius_m) {
            Truth::Known(visibility) => f64::from(visibility.get()),
            // Of an area light's centre alone, which nobody asked about: either answer is right.
            Truth::Undecided => answered,
        };
        Some((pixel, exact, answered))
    }
}

impl Prepared for PreparedRays<'_> {
    fn run(&self) -> Result<Answer, TechniqueError> {
        let passes = self.passes.run(self.job.gpu, &self.receivers)?;
        Ok(Answer { mask: self.receivers.mask(self.job.gpu, self.job.receivers)?, passes })
    }

    fn bytes(&self) -> u64 {
        self.passes.bytes() + self.receivers.bytes()
    }

    fn facts(&self) -> Vec<(String, String)> {
        vec![("casting triangles".to_owned(), self.job.casters.triangle_count().to_string())]
    }

    fn replay(&self, answer: &Mask, pixels: &[u32]) -> Result<Replay, TechniqueError> {
        let replayed: Vec<_> = pixels.par_iter().filter_map(|pixel| self.replayed(answer, *pixel)).collect();
        let rays = Stage {
            name: "f32 rays",
            values: replayed.iter().map(|(_, _, answered)| *answered).collect(),
            causes: vec![Cause::Precision; replayed.len()],
        };
        Ok(Replay {
            pixels: replayed.iter().map(|(pixel, ..)| *pixel).collect(),
            exact: replayed.iter().map(|(_, exact, _)| *exact).collect(),
            stages: vec![rays],
        })
    }

    /// What the device's ray met it does not tell.
    fn lookup_facts(&self, _pixel: u32) -> Result<Vec<(String, String)>, TechniqueError> {
        Ok(Vec::new())
    }

    /// Rays have no samples.
    fn footprint(&self, _pixel: u32) -> Option<Footprint> {
        None
    }
}
