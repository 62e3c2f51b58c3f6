//! A soft shadow ready to run: for each of its points the inner technique is prepared, run and dropped again, so that
//! one map or volume is held at a time.

use super::{Pattern, points, replay};
use crate::cause::{Cause, Replay};
use crate::gpu::PassRecord;
use crate::mask::{Mask, Visibility};
use crate::receiver::{Asked, PixelClass};
use crate::scene::{Light, LightKind};
use crate::technique::footprint::Footprint;
use crate::technique::{Answer, Job, Prepared, Spec, TechniqueError};

pub(super) struct PreparedSoft<'j> {
    pub(super) job: Job<'j>,
    pub(super) inner: Spec,
    pub(super) lights: Vec<Light>,
    bytes: u64,
}

impl<'j> PreparedSoft<'j> {
    pub(super) fn new(spec: &Spec, job: Job<'j>) -> Result<Self, TechniqueError> {
        let pattern = Pattern::named(spec.choice("pattern").0);
        let lights = points::point_lights(&job, pattern, spec.integer("samples") as u32, spec.integer("seed") as u64);
        let mut soft = Self { job, inner: spec.nested("inner"), lights, bytes: 0 };
        if let Some(first) = soft.lights.first() {
            soft.bytes = soft.with_point(first, |inner, _| Ok(inner.bytes()))?;
        }
        Ok(soft)
    }

    /// Who owns what the points of this technique say otherwise than those of the truth.
    pub(super) fn blamed_for_points(&self) -> Cause {
        match self.job.light.kind {
            LightKind::Sphere { .. } => Cause::TechniqueModel,
            _ => Cause::FilterWidth,
        }
    }

    /// Does something with the inner technique for one point, and the class of every pixel for that point: what is
    /// asked about the whole light is asked about the point, unless it lies behind the receiver's surface.
    pub(super) fn with_point<T>(
        &self,
        light: &Light,
        act: impl FnOnce(&dyn Prepared, &[PixelClass]) -> Result<T, TechniqueError>,
    ) -> Result<T, TechniqueError> {
        let classes = self.for_point(light, Asked { receivers: self.job.receivers, classes: self.job.classes });
        let fitted_to = self.for_point(light, self.job.fitted_to);
        let fitted_to = Asked { receivers: self.job.fitted_to.receivers, classes: &fitted_to };
        let job = Job { light, classes: &classes, fitted_to, ..self.job };
        let prepared = self.inner.technique().prepare(&self.inner, job)?;
        act(prepared.as_ref(), &classes)
    }

    /// The class of every pixel for one point.
    fn for_point(&self, point: &Light, whole: Asked<'_>) -> Vec<PixelClass> {
        let mut classes = whole.receivers.classify(self.job.scene, point);
        for (class, whole) in classes.iter_mut().zip(whole.classes) {
            if *whole != PixelClass::Asked {
                *class = *whole;
            }
        }
        classes
    }
}

impl Prepared for PreparedSoft<'_> {
    fn run(&self) -> Result<Answer, TechniqueError> {
        let mut sums = vec![0.0_f64; self.job.classes.len()];
        let mut passes: Vec<PassRecord> = Vec::new();
        for light in &self.lights {
            let answer = self.with_point(light, |inner, _| inner.run())?;
            for (sum, visibility) in sums.iter_mut().zip(&answer.mask.pixels) {
                *sum += visibility.map_or(0.0, |visibility| f64::from(visibility.get()));
            }
            add(&mut passes, answer.passes);
        }
        let mean = |(sum, class): (f64, &PixelClass)| {
            let mean = (sum / self.lights.len() as f64) as f32;
            Visibility::new(mean).filter(|_| *class == PixelClass::Asked)
        };
        let pixels = sums.into_iter().zip(self.job.classes).map(mean).collect();
        Ok(Answer { mask: Mask { size: self.job.receivers.size, pixels }, passes })
    }

    fn bytes(&self) -> u64 {
        self.bytes
    }

    fn facts(&self) -> Vec<(String, String)> {
        vec![("points".to_owned(), format!("{}, each with {}", self.lights.len(), self.inner.short()))]
    }

    fn replay(&self, answer: &Mask, pixels: &[u32]) -> Result<Replay, TechniqueError> {
        replay::replay(self, answer, pixels)
    }

    fn lookup_facts(&self, pixel: u32) -> Result<Vec<(String, String)>, TechniqueError> {
        let mut seen = 0;
        for light in &self.lights {
            let mask = self.with_point(light, |inner, _| Ok(inner.run()?.mask))?;
            let visibility = mask.pixels.get(pixel as usize).copied().flatten();
            seen += usize::from(visibility.is_some_and(|visibility| visibility.get() > 0.5));
        }
        Ok(vec![("points seen".to_owned(), format!("{seen} of {}", self.lights.len()))])
    }

    fn footprint(&self, _pixel: u32) -> Option<Footprint> {
        None
    }
}

/// Adds the passes of one more point to those of the same place in the sequence.
fn add(passes: &mut Vec<PassRecord>, more: Vec<PassRecord>) {
    for (index, pass) in more.into_iter().enumerate() {
        match passes.get_mut(index).filter(|known| known.name == pass.name) {
            Some(known) => {
                known.ms = known.ms.zip(pass.ms).map(|(a, b)| a + b);
                known.work = known.work.zip(pass.work).map(|(a, b)| a + b);
            }
            None => passes.push(pass),
        }
    }
}
