//! A map ready to run for one light: the fitted frustum, the GPU objects, and what the CPU needs for replays.

use super::lookup::Lookup;
use super::passes::MapPasses;
use super::projection::{Refined, View};
use super::scout::DeviceScout;
use super::{Placed, Settings, filter, texel_footprint};
use crate::cause::Replay;
use crate::gpu::PassRecord;
use crate::mask::Mask;
use crate::receiver::{PixelClass, Receiver};
use crate::technique::footprint::Footprint;
use crate::technique::{
    Answer, BiasAt, EffectiveBias, InView, Job, LightDepths, Prepared, ReceiverBuffer, TechniqueError,
};
use glam::{DMat4, DVec2, DVec3, UVec2, Vec4};
use rayon::prelude::*;

/// What `bias=midpoint` does to stored depths.
const HALFWAY: &str = "halfway to the second surface";

/// More views than these are not listed one by one.
const LISTED_VIEWS: usize = 8;

/// A map of one light, ready to run.
pub(in crate::technique) struct PreparedMap<'j> {
    pub(super) job: Job<'j>,
    pub(super) settings: Settings,
    pub(super) lookup: Lookup,
    /// What the fit has to say, for people.
    fit_facts: Vec<(String, String)>,
    pub(super) passes: MapPasses,
    receivers: ReceiverBuffer,
    /// What the filter's shader and its twin are told.
    pub(super) numbers: Vec<Vec4>,
    pub(super) scene_radius_m: f64,
    /// The edges of the casters' silhouettes, for a map that draws them.
    pub(super) silhouettes: Option<Vec<[DVec3; 2]>>,
}

impl<'j> PreparedMap<'j> {
    /// With the edges of the casters' silhouettes for a map that draws them.
    pub(in crate::technique) fn new(
        settings: &Settings,
        job: Job<'j>,
        silhouettes: Option<&[[DVec3; 2]]>,
    ) -> Result<Self, TechniqueError> {
        let fitted = settings.projection.fit(job.scene, job.light, settings, &job.fitted_to.points())?;
        let receivers = ReceiverBuffer::upload(job.gpu, job.receivers, job.classes)?;
        let scout = DeviceScout { job: &job, settings, receivers: &receivers };
        let refined = settings.projection.refine(job.scene, job.light, settings, &scout)?;
        let Refined { views, facts: fit_facts } = refined.unwrap_or(Refined { views: fitted, facts: Vec::new() });
        let lookup = Lookup::new(views, settings, job.light).drawn_with_step(job.gpu.vertex_step_px());
        let own_numbers = settings.filter.numbers(&settings.kernel, job.light);
        let numbers = match settings.filter.moments() {
            Some(moments) => {
                let (texels, sign) = (settings.kernel.number, lookup.views[0].depth_sign);
                filter::moments::numbers(moments, own_numbers, texels, settings.z_beyond(), sign)
            }
            None => own_numbers,
        };
        let passes = MapPasses::new(job.gpu, settings, &lookup, &numbers, &receivers, silhouettes)?;
        let scene_radius_m = job.scene.bounds().radius();
        let silhouettes = silhouettes.map(<[_]>::to_vec);
        let settings = *settings;
        Ok(Self { job, settings, lookup, fit_facts, passes, receivers, numbers, scene_radius_m, silhouettes })
    }

    /// Draws the map and answers on the device, where the answers stay.
    pub(in crate::technique) fn draw(&self) -> Result<Vec<PassRecord>, TechniqueError> {
        Ok(self.passes.run(self.job.gpu, self.job.geometry, &self.receivers)?)
    }

    /// Who asks, with the answers of the last run.
    pub(in crate::technique) fn receivers(&self) -> &ReceiverBuffer {
        &self.receivers
    }

    pub(super) fn receiver(&self, pixel: u32) -> Option<Receiver> {
        self.job.receivers.pixels.get(pixel as usize).copied().flatten()
    }

    /// The depths of all texels as the GPU holds them: views below each other, row by row.
    pub(super) fn all_depths(&self) -> Result<Vec<f64>, TechniqueError> {
        let texels = self.lookup.texels().element_product() * self.lookup.views.len() as u32;
        let indices: Vec<u32> = (0..texels).collect();
        Ok(self.passes.gather(self.job.gpu, &self.lookup, &indices)?)
    }

    /// What the bias does at a placed receiver, and what it should do.
    pub(super) fn bias_at(&self, receiver: &Receiver, placed: &Placed) -> BiasAt {
        let lookup = &self.lookup;
        let site = lookup.views[placed.view].site(placed.point_in_world);
        let metres_per_depth = site.metres_per_depth();
        let corners = self.job.scene.triangle_in_world(receiver.triangle);
        let by_rasteriser = lookup.hardware_bias(placed.view, corners, placed.point_in_world);
        let sign = lookup.views[placed.view].depth_sign;
        let along_light_depth = sign * (placed.depth - placed.reference + by_rasteriser);
        let along_light_m = along_light_depth * metres_per_depth;
        let kernel = self.settings.filter.bias_kernel(&self.settings.kernel);
        let acne_free = lookup.closed_form(&site, receiver.normal_in_world, DVec2::splat(kernel));
        let light = self.job.light.homogeneous();
        let to_light = (light.truncate() - receiver.point_in_world * light.w).normalize_or_zero();
        let sine_of_elevation = receiver.normal_in_world.dot(to_light);
        BiasAt {
            along_light_depth,
            along_light_m,
            along_normal_m: placed.point_in_world.distance(receiver.point_in_world),
            acne_free_m: acne_free * metres_per_depth,
            contact_gap_m: along_light_m * (1.0 - sine_of_elevation * sine_of_elevation).max(0.0).sqrt(),
            texel_m: site.texel_m().max_element(),
        }
    }
}

impl Prepared for PreparedMap<'_> {
    fn run(&self) -> Result<Answer, TechniqueError> {
        let passes = self.draw()?;
        Ok(Answer { mask: self.receivers.mask(self.job.gpu, self.job.receivers)?, passes })
    }

    fn bytes(&self) -> u64 {
        self.passes.bytes(&self.settings) + self.receivers.bytes()
    }

    fn facts(&self) -> Vec<(String, String)> {
        let mut facts: Vec<(String, String)> = match self.lookup.views.as_slice() {
            [view] => vec![
                ("light window".to_owned(), view.window.clone()),
                ("light near, far".to_owned(), view.near_far.clone()),
            ],
            views if views.len() <= LISTED_VIEWS => {
                views.iter().map(|v| (v.name.clone(), format!("{}; {}", v.window, v.near_far))).collect()
            }
            views => vec![("light near, far".to_owned(), views[0].near_far.clone())],
        };
        facts.extend(self.fit_facts.iter().cloned());
        let biases = self.bias();
        let is_alone = biases.len() == 1;
        for bias in biases.iter().filter(|_| biases.len() <= LISTED_VIEWS) {
            let label = |label: String| if is_alone { label } else { format!("{}: {label}", bias.view) };
            facts.extend(bias.facts().into_iter().map(|(of, value)| (label(of), value)));
        }
        // What cannot be read back is not told.
        if let Ok(Some(overflowed)) = self.passes.overflowed(self.job.gpu) {
            facts.push(("overflowed moments".to_owned(), overflowed.to_string()));
        }
        facts
    }

    fn bias(&self) -> Vec<EffectiveBias> {
        let asked = self.job.classes.par_iter().zip(&self.job.receivers.pixels);
        let receivers = asked.filter(|(class, _)| **class == PixelClass::Asked).filter_map(|(_, pixel)| *pixel);
        let placed = receivers.filter_map(|receiver| {
            let view = self.lookup.select(receiver.point_in_world).first;
            let placed = self.lookup.place(view, receiver.point_in_world, receiver.normal_in_world).ok()?;
            Some((view, self.bias_at(&receiver, &placed)))
        });
        let placed: Vec<(usize, BiasAt)> = placed.collect();
        let of_view = |(index, view): (usize, &View)| {
            let biases: Vec<BiasAt> = placed.iter().filter(|(of, _)| *of == index).map(|(_, bias)| *bias).collect();
            let bias = EffectiveBias::of(&view.name, &biases)?;
            Some(if self.settings.stores_midpoint() { bias.with_stored(HALFWAY) } else { bias })
        };
        self.lookup.views.iter().enumerate().filter_map(of_view).collect()
    }

    fn replay(&self, answer: &Mask, pixels: &[u32]) -> Result<Replay, TechniqueError> {
        super::replay::replay(self, answer, pixels)
    }

    fn lookup_facts(&self, pixel: u32) -> Result<Vec<(String, String)>, TechniqueError> {
        super::lookup_facts::lookup_facts(self, pixel)
    }

    fn footprint(&self, pixel: u32) -> Option<Footprint> {
        let receiver = self.receiver(pixel)?;
        let site = self.lookup.project(receiver.point_in_world).ok()?;
        texel_footprint(&self.job, &site, &receiver)
    }

    fn view_names(&self) -> Vec<String> {
        self.lookup.views.iter().map(|view| view.name.clone()).collect()
    }

    fn in_view(&self, pixel: u32) -> Option<InView> {
        Some(self.lookup.in_view(self.receiver(pixel)?.point_in_world))
    }

    fn light_frusta(&self) -> Vec<DMat4> {
        self.lookup.views.iter().map(|view| view.clip_from_world.as_dmat4()).collect()
    }

    fn light_depths(&self) -> Result<Option<LightDepths>, TechniqueError> {
        // Views below each other.
        let size = self.lookup.texels() * UVec2::new(1, self.lookup.views.len() as u32);
        let depths = self.all_depths()?;
        // Cleared texels are exactly at one end of the range.
        let drawn = |depth: f64| (depth > 0.0 && depth < 1.0).then_some(depth);
        Ok(Some(LightDepths { size, depths: depths.into_iter().map(drawn).collect() }))
    }
}
