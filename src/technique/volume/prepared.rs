//! Volumes ready to run for one light: the GPU objects, and the f64 twin that counts at any pixel.

use super::count::{Count, Counter};
use super::eye::Eye;
use super::passes::VolumePasses;
use super::range::distances_m;
use super::settings::{FarPlane, Settings};
use super::states::Side;
use super::target::Target;
use super::volumes::Volumes;
use super::{facts, replay};
use crate::cause::Replay;
use crate::gpu::PassRecord;
use crate::mask::Mask;
use crate::receiver::Receiver;
use crate::technique::footprint::Footprint;
use crate::technique::{Answer, Job, Prepared, TechniqueError};

/// Shadow volumes of one light, ready to run.
pub struct PreparedVolume<'j> {
    pub(super) job: Job<'j>,
    pub(super) settings: Settings,
    pub(super) eye: Eye,
    pub(super) volumes: Volumes,
    pub(super) counter: Counter<'j>,
    /// What counting starts from: the volumes counted before the surface that hold the near rectangle's middle.
    pub(super) start: i64,
    pub(super) passes: VolumePasses,
    target: Target,
}

impl std::fmt::Debug for PreparedVolume<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("PreparedVolume").field("settings", &self.settings).finish_non_exhaustive()
    }
}

/// What the stencil should hold at one pixel, one approximation after the other. Each is a number of volumes, which a
/// stencil of 8 bits keeps modulo 256, or 128 under a range mask.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PixelCounts {
    /// Casting triangles in use that the segment from the receiver to the light crosses.
    pub crossed: i64,
    /// With volumes cut off at their length and at the far plane.
    pub reached: i64,
    /// With counts that begin at the near plane instead of outside all volumes.
    pub from_near: i64,
    /// With nothing drawn outside the scissor and the range mask.
    pub drawn: i64,
    /// Bits of the stencil that count.
    pub bits: u32,
    /// True if the segment runs through an edge or a corner of the casters, where the count may be off by rounding.
    pub is_tied: bool,
}

impl PixelCounts {
    /// What a stencil that wraps holds.
    #[must_use]
    pub fn stencil(&self) -> u8 {
        self.drawn.rem_euclid(1 << self.bits) as u8
    }
}

impl<'j> PreparedVolume<'j> {
    /// Builds everything for one light.
    ///
    /// # Errors
    /// [`TechniqueError`]; a far plane before the near plane is [`TechniqueError::Unsupported`].
    pub fn new(settings: Settings, job: Job<'j>) -> Result<Self, TechniqueError> {
        let target = Target::everywhere(&job)?;
        Self::with_target(settings, job, target)
    }

    /// The same for a target of one's own; with a mask the settings are [`Settings::masked`].
    pub(in crate::technique) fn with_target(
        settings: Settings,
        job: Job<'j>,
        target: Target,
    ) -> Result<Self, TechniqueError> {
        let eye = Eye::new(job.scene, &settings)?;
        let volumes = Volumes::new(job.scene, job.light, &settings, &eye);
        let counter = Counter::new(job.scene, job.light, job.casters, job.adjacency, &volumes);
        let start = if settings.starts_at_eye_count && volumes.near_casters.is_none() {
            counter.at(eye.near_centre(), None).before
        } else {
            0
        };
        let passes = VolumePasses::new(&job, &settings, &eye, &volumes, &target, start)?;
        Ok(Self { job, settings, eye, volumes, counter, start, passes, target })
    }

    /// Counts volumes and answers on the device, where the answers stay.
    pub(in crate::technique) fn draw(&self) -> Result<Vec<PassRecord>, TechniqueError> {
        Ok(self.passes.run(self.job.gpu, &self.target.receivers)?)
    }

    /// The stencil that the last run left, one value per pixel, row by row from the top.
    ///
    /// # Errors
    /// What the device reported.
    pub fn stencil(&self) -> Result<Vec<u8>, TechniqueError> {
        Ok(self.passes.stencil(self.job.gpu)?)
    }

    /// How many objects are counted before the surface, and how many behind it.
    #[must_use]
    pub fn objects_before_and_behind(&self) -> (usize, usize) {
        let before = self.volumes.sides.iter().filter(|side| **side == Side::Before).count();
        (before, self.volumes.sides.len() - before)
    }

    /// What the stencil should hold at a pixel (`y * width + x`); `None` for background.
    #[must_use]
    pub fn counts(&self, pixel: u32) -> Option<PixelCounts> {
        Some(self.counts_of(pixel, &self.receiver(pixel)?))
    }

    /// The same if the pixel showed this receiver.
    #[must_use]
    pub fn counts_of(&self, pixel: u32, receiver: &Receiver) -> PixelCounts {
        let at_receiver = self.counter.at(receiver.point_in_world, Some(receiver.triangle));
        let at_far = self.eye.far_m.map(|far_m| self.counter.at(self.eye.point_at(pixel, far_m), None));
        // A surface behind the far plane is not drawn: the stencil counts up to the plane.
        let is_beyond_far = self.eye.far_m.is_some_and(|far_m| self.eye.distance_m(receiver.point_in_world) > far_m);
        let at_surface = at_far.filter(|_| is_beyond_far).unwrap_or(at_receiver);
        let cut_at_far = at_far.filter(|_| matches!(self.settings.far, FarPlane::Finite(_))).unwrap_or_default();
        // zp-plus draws what is missing at the near plane.
        let starts_at_near = self.volumes.sides.contains(&Side::Before) && self.volumes.near_casters.is_none();
        let at_near = if starts_at_near { self.counter.at(self.eye.near_point(pixel), None) } else { Count::default() };
        let reached = at_surface.reached() - cut_at_far.behind;
        let from_near = reached - at_near.before + self.start;
        let is_drawn = self.passes.scissor().contains(pixel, self.job.receivers.size.x) && self.is_in_range(receiver);
        PixelCounts {
            crossed: at_receiver.endless,
            reached,
            from_near,
            drawn: if is_drawn { from_near } else { self.start },
            bits: self.settings.counting_bits(),
            is_tied: [at_surface, cut_at_far, at_near].iter().any(|count| count.is_tied),
        }
    }

    /// Whether what a pixel shows is as deep as the range mask lets volumes be drawn.
    fn is_in_range(&self, receiver: &Receiver) -> bool {
        let [from_m, to_m] = distances_m(self.job.light, &self.eye);
        let distance_m = self.eye.distance_m(receiver.point_in_world);
        !self.settings.range_mask || (from_m..to_m).contains(&distance_m)
    }

    pub(super) fn receiver(&self, pixel: u32) -> Option<Receiver> {
        self.job.receivers.pixels.get(pixel as usize).copied().flatten()
    }

    /// The stencil that other settings leave for the same question.
    pub(super) fn stencil_under(&self, settings: &Settings) -> Result<Vec<u8>, TechniqueError> {
        let volumes = Volumes::new(self.job.scene, self.job.light, settings, &self.eye);
        let passes = VolumePasses::new(&self.job, settings, &self.eye, &volumes, &self.target, self.start)?;
        passes.run(self.job.gpu, &self.target.receivers)?;
        Ok(passes.stencil(self.job.gpu)?)
    }
}

impl Prepared for PreparedVolume<'_> {
    fn run(&self) -> Result<Answer, TechniqueError> {
        let passes = self.draw()?;
        Ok(Answer { mask: self.target.receivers.mask(self.job.gpu, self.job.receivers)?, passes })
    }

    fn bytes(&self) -> u64 {
        self.passes.bytes() + self.target.receivers.bytes()
    }

    fn facts(&self) -> Vec<(String, String)> {
        facts::facts(self)
    }

    fn replay(&self, answer: &Mask, pixels: &[u32]) -> Result<Replay, TechniqueError> {
        replay::replay(self, answer, pixels)
    }

    fn lookup_facts(&self, pixel: u32) -> Result<Vec<(String, String)>, TechniqueError> {
        facts::lookup_facts(self, pixel)
    }

    /// Volumes have no samples.
    fn footprint(&self, _pixel: u32) -> Option<Footprint> {
        None
    }
}
