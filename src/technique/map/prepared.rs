//! A map ready to run for one light: the fitted frustum, the GPU objects, and what the CPU needs for replays.

use super::lookup::Lookup;
use super::passes::MapPasses;
use super::{Placed, Settings, texel_footprint};
use crate::cause::Replay;
use crate::mask::Mask;
use crate::receiver::{PixelClass, Receiver};
use crate::technique::footprint::Footprint;
use crate::technique::{Answer, Job, Prepared, ReceiverBuffer, TechniqueError};
use glam::DVec3;

pub(super) struct PreparedMap<'j> {
    pub(super) job: Job<'j>,
    pub(super) settings: Settings,
    pub(super) lookup: Lookup,
    pub(super) passes: MapPasses,
    receivers: ReceiverBuffer,
    pub(super) scene_radius_m: f64,
}

impl<'j> PreparedMap<'j> {
    pub(super) fn new(settings: Settings, job: Job<'j>) -> Result<Self, TechniqueError> {
        let asked = job.receivers.pixels.iter().zip(job.classes).filter(|(_, class)| **class == PixelClass::Asked);
        let visible: Vec<DVec3> = asked.filter_map(|(pixel, _)| pixel.map(|r| r.point_in_world)).collect();
        let frustum = settings.projection.fit(job.scene, job.light, &settings, &visible)?;
        let lookup = Lookup::new(frustum, &settings, job.light);
        let receivers = ReceiverBuffer::upload(job.gpu, job.receivers, job.classes)?;
        let passes = MapPasses::new(job.gpu, &settings, &lookup, &receivers)?;
        let scene_radius_m = job.scene.bounds().radius();
        Ok(Self { job, settings, lookup, passes, receivers, scene_radius_m })
    }

    pub(super) fn receiver(&self, pixel: u32) -> Option<Receiver> {
        self.job.receivers.pixels.get(pixel as usize).copied().flatten()
    }

    /// Total bias at a placed receiver in metres along the light, and in texels.
    fn effective_bias(&self, receiver: &Receiver, placed: &Placed) -> (f64, f64) {
        let frustum = &self.lookup.frustum;
        let at_receiver = (placed.depth - placed.reference).abs();
        let by_rasteriser = self.lookup.hardware_bias(self.job.scene.triangle_in_world(receiver.triangle)).abs();
        let metres = (at_receiver + by_rasteriser) * frustum.metres_per_depth(placed.q);
        (metres, metres / frustum.texel_m(placed.q).max_element())
    }
}

impl Prepared for PreparedMap<'_> {
    fn run(&self) -> Result<Answer, TechniqueError> {
        let passes = self.passes.run(self.job.gpu, self.job.geometry, &self.receivers)?;
        Ok(Answer { mask: self.receivers.mask(self.job.gpu, self.job.receivers)?, passes })
    }

    fn bytes(&self) -> u64 {
        self.passes.bytes(&self.settings) + self.receivers.bytes()
    }

    fn facts(&self) -> Vec<(String, String)> {
        let frustum = &self.lookup.frustum;
        let size = frustum.window.max - frustum.window.min;
        let asked = self.job.classes.iter().zip(&self.job.receivers.pixels);
        let receivers = asked.filter(|(class, _)| **class == PixelClass::Asked).filter_map(|(_, pixel)| *pixel);
        let mut biases: Vec<(f64, f64)> = receivers
            .filter_map(|receiver| {
                let placed = self.lookup.place(receiver.point_in_world, receiver.normal_in_world).ok()?;
                Some(self.effective_bias(&receiver, &placed))
            })
            .collect();
        biases.sort_by(|a, b| a.0.total_cmp(&b.0));
        let bias = biases.get(biases.len() / 2).zip(biases.last()).map_or_else(
            || "no receiver in the map".to_owned(),
            |(middle, most)| format!("median {:.3e} m = {:.2} texels, largest {:.3e} m", middle.0, middle.1, most.0),
        );
        let window = match frustum.shape {
            super::projection::Shape::Parallel => format!("{:.4} m x {:.4} m", size.x, size.y),
            super::projection::Shape::Perspective => {
                let angles = [size.x, size.y].map(|tangents| 2.0 * (0.5 * tangents).atan().to_degrees());
                format!("{:.2} x {:.2} degrees", angles[0], angles[1])
            }
        };
        vec![
            ("light window".to_owned(), window),
            ("light near, far".to_owned(), format!("{:.6} m, {:.6} m", frustum.near_m, frustum.far_m)),
            ("effective bias".to_owned(), bias),
        ]
    }

    fn replay(&self, answer: &Mask, pixels: &[u32]) -> Result<Replay, TechniqueError> {
        super::replay::replay(self, answer, pixels)
    }

    fn lookup_facts(&self, pixel: u32) -> Result<Vec<(String, String)>, TechniqueError> {
        super::replay::lookup_facts(self, pixel)
    }

    fn footprint(&self, pixel: u32) -> Option<Footprint> {
        texel_footprint(&self.job, &self.lookup, &self.receiver(pixel)?)
    }
}

/// What `replay` needs of the bias at one receiver, in words.
pub(super) fn bias_in_words(map: &PreparedMap<'_>, receiver: &Receiver, placed: &Placed) -> String {
    let (metres, texels) = map.effective_bias(receiver, placed);
    format!("{metres:.3e} m = {texels:.2} texels")
}
