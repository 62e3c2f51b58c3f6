//! What a projection may find out on the device before it settles on its views: it draws some, and reads their depths.

use super::Settings;
use super::lookup::Lookup;
use super::passes::MapPasses;
use super::projection::{Scout, View};
use super::{bias, filter, texel_footprint};
use crate::receiver::Receiver;
use crate::technique::{Job, ReceiverBuffer, TechniqueError};

/// Scouts for one job.
pub(super) struct DeviceScout<'s, 'j> {
    pub(super) job: &'s Job<'j>,
    pub(super) settings: &'s Settings,
    pub(super) receivers: &'s ReceiverBuffer,
}

impl Scout for DeviceScout<'_, '_> {
    fn receivers(&self) -> Vec<Receiver> {
        self.job.fitted_to.iter().collect()
    }

    fn m(&self, view: &View, receiver: &Receiver) -> Option<f64> {
        let site = view.site(receiver.point_in_world);
        texel_footprint(self.job, &site, receiver).map(|footprint| footprint.m)
    }

    fn depths(&self, views: &[View]) -> Result<Vec<Vec<f64>>, TechniqueError> {
        let Some(first) = views.first() else { return Ok(Vec::new()) };
        let texels = first.texels.element_product();
        // Depths alone, as they are drawn.
        let settings = Settings {
            filter: filter::by_name("nearest"),
            kernel: filter::Kernel::wide(1),
            bias: bias::by_name("none"),
            ..*self.settings
        };
        let lookup =
            Lookup::new(views.to_vec(), &settings, self.job.light).drawn_with_step(self.job.gpu.vertex_step_px());
        let passes = MapPasses::new(self.job.gpu, &settings, &lookup, &[], self.receivers, None)?;
        passes.draw(self.job.gpu, self.job.geometry)?;
        let indices: Vec<u32> = (0..texels * views.len() as u32).collect();
        let depths = passes.gather(self.job.gpu, &lookup, &indices)?;
        Ok(depths.chunks_exact(texels as usize).map(<[f64]>::to_vec).collect())
    }
}
