//! A projective texture ready to run for one light: the fitted frustum, the GPU objects, and what replays need.

use super::passes::PicturePasses;
use super::{Settings, replay};
use crate::cause::Replay;
use crate::mask::Mask;
use crate::receiver::Receiver;
use crate::technique::footprint::Footprint;
use crate::technique::map::projection::{Site, View};
use crate::technique::map::{Lookup, texel_footprint};
use crate::technique::{Answer, Job, Prepared, ReceiverBuffer, TechniqueError};
use glam::DVec3;

pub(super) struct PreparedPicture<'j> {
    pub(super) job: Job<'j>,
    pub(super) settings: Settings,
    pub(super) lookup: Lookup,
    passes: PicturePasses,
    receivers: ReceiverBuffer,
}

impl<'j> PreparedPicture<'j> {
    pub(super) fn new(settings: &Settings, job: Job<'j>) -> Result<Self, TechniqueError> {
        let visible = job.fitted_to.points();
        let views = settings.map.projection.fit(job.scene, job.light, &settings.map, &visible)?;
        let lookup = Lookup::new(views, &settings.map, job.light).drawn_with_step(job.gpu.vertex_step_px());
        let receivers = ReceiverBuffer::upload(job.gpu, job.receivers, job.classes)?;
        let passes = PicturePasses::new(&job, settings, &lookup, &receivers)?;
        Ok(Self { job, settings: *settings, lookup, passes, receivers })
    }

    pub(super) fn receiver(&self, pixel: u32) -> Option<Receiver> {
        self.job.receivers.pixels.get(pixel as usize).copied().flatten()
    }

    /// The one view of the picture.
    pub(super) fn view(&self) -> &View {
        &self.lookup.views[0]
    }

    /// A point as the light sees it; `None` behind the light and beside the picture. Its depth does not matter.
    pub(super) fn place(&self, point_in_world: DVec3) -> Option<Site<'_>> {
        let site = self.view().site(point_in_world);
        let is_inside = site.at.q > 0.0 && site.at.uv.min_element() >= 0.0 && site.at.uv.max_element() < 1.0;
        is_inside.then_some(site)
    }
}

impl Prepared for PreparedPicture<'_> {
    fn run(&self) -> Result<Answer, TechniqueError> {
        let passes = self.passes.run(&self.job, &self.receivers)?;
        Ok(Answer { mask: self.receivers.mask(self.job.gpu, self.job.receivers)?, passes })
    }

    fn bytes(&self) -> u64 {
        self.passes.bytes() + self.receivers.bytes()
    }

    fn facts(&self) -> Vec<(String, String)> {
        let meshes = &self.job.scene.meshes;
        let receiving = meshes.iter().filter(|mesh| mesh.receives && self.settings.takes_shadow(mesh)).count();
        vec![
            ("light near, far".to_owned(), self.view().near_far.clone()),
            ("thrown on".to_owned(), format!("{receiving} of {} meshes", meshes.len())),
        ]
    }

    fn replay(&self, answer: &Mask, pixels: &[u32]) -> Result<Replay, TechniqueError> {
        Ok(replay::replay(self, answer, pixels))
    }

    fn lookup_facts(&self, pixel: u32) -> Result<Vec<(String, String)>, TechniqueError> {
        Ok(replay::lookup_facts(self, pixel))
    }

    fn footprint(&self, pixel: u32) -> Option<Footprint> {
        let receiver = self.receiver(pixel)?;
        texel_footprint(&self.job, &self.place(receiver.point_in_world)?, &receiver)
    }
}
