//! A hybrid ready to run for one light: the map answers all, the pixels that it cannot tell are marked, and volumes answer
//! those.

use super::replay;
use crate::cause::Replay;
use crate::gpu::shader::{Wgsl, wgsl};
use crate::gpu::{GpuError, Recorder};
use crate::mask::{Mask, Truth};
use crate::receiver::PixelClass;
use crate::technique::footprint::Footprint;
use crate::technique::map::{self, PreparedMap};
use crate::technique::receiver_buffer::{Chunk, LookUp};
use crate::technique::volume::{self, PreparedVolume, Target};
use crate::technique::{Answer, EffectiveBias, InView, Job, LightDepths, Prepared, TechniqueError};
use crate::truth;
use glam::DMat4;
use rayon::prelude::*;
use wgpu::{BindGroup, Buffer, BufferUsages, ComputePipeline};

const RECEIVER: Wgsl = wgsl!("shared/receiver.wgsl");
const CLASSIFY: Wgsl = wgsl!("hybrid/classify.wgsl");

/// Every shader module this family builds by itself.
pub(super) fn shader_modules() -> Vec<(String, Vec<Wgsl>)> {
    vec![("hybrid classify".to_owned(), vec![RECEIVER, CLASSIFY])]
}

/// See the module.
pub(super) struct PreparedHybrid<'j> {
    pub(super) job: Job<'j>,
    pub(super) map: PreparedMap<'j>,
    pub(super) volume: PreparedVolume<'j>,
    /// A word per pixel, not 0 at silhouettes.
    pixel_mask: Buffer,
    classify: ComputePipeline,
    classify_bindings: Vec<BindGroup>,
}

impl<'j> PreparedHybrid<'j> {
    pub(super) fn new(map: &map::Settings, volume: volume::Settings, job: Job<'j>) -> Result<Self, TechniqueError> {
        let map = PreparedMap::new(map, job, None)?;
        let receivers = map.receivers();
        let (pixel_mask, classify, classify_bindings) = job.gpu.scoped("the hybrid's set-up", || {
            let usage = BufferUsages::STORAGE | BufferUsages::COPY_SRC;
            let pixel_mask = job.gpu.buffer("silhouettes", &vec![0_u32; job.classes.len()], usage);
            let classify = job.gpu.compute_pipeline("hybrid classify", &[RECEIVER, CLASSIFY]);
            let bind = |chunk: &Chunk| {
                let buffers = [&chunk.receivers, &chunk.visibilities, &pixel_mask].map(Buffer::as_entire_binding);
                job.gpu.bind(&classify.get_bind_group_layout(0), &buffers)
            };
            let bindings = receivers.chunks().iter().map(bind).collect();
            (pixel_mask, classify, bindings)
        })?;
        let target = Target { receivers: receivers.clone(), mask: Some(pixel_mask.clone()) };
        let volume = PreparedVolume::with_target(volume, job, target)?;
        Ok(Self { job, map, volume, pixel_mask, classify, classify_bindings })
    }

    /// Whether each pixel is on a silhouette, by the last run.
    pub(super) fn silhouettes(&self) -> Result<Vec<bool>, GpuError> {
        let words: Vec<u32> = self.job.gpu.read_buffer(&self.pixel_mask, "reading the silhouettes")?;
        Ok(words.into_iter().map(|word| word != 0).collect())
    }

    /// How many asked pixels are on a silhouette; and of the others, how many the map gets wrong: most often because the
    /// silhouette there is missed.
    fn found_and_missed(&self) -> Result<[usize; 2], TechniqueError> {
        let mask = self.run()?.mask;
        let silhouettes = self.silhouettes()?;
        let (eye, radius_m) = (self.job.scene.camera.eye.as_dvec3(), self.job.scene.bounds().radius());
        let is_missed = |pixel: &usize| {
            let answer = mask.pixels[*pixel].map(|answer| f64::from(answer.get()));
            self.job.receivers.pixels[*pixel].is_some_and(|receiver| {
                match truth::of_receiver(self.job.casters, self.job.light, &receiver, eye, radius_m) {
                    Truth::Known(exact) => answer.is_some_and(|answer| answer != f64::from(exact.get())),
                    Truth::Undecided => false,
                }
            })
        };
        let asked: Vec<usize> =
            (0..self.job.classes.len()).filter(|pixel| self.job.classes[*pixel] == PixelClass::Asked).collect();
        let (on, off): (Vec<usize>, Vec<usize>) = asked.into_iter().partition(|pixel| silhouettes[*pixel]);
        Ok([on.len(), off.par_iter().filter(|pixel| is_missed(pixel)).count()])
    }
}

impl Prepared for PreparedHybrid<'_> {
    fn run(&self) -> Result<Answer, TechniqueError> {
        let (gpu, receivers) = (self.job.gpu, self.map.receivers());
        let mut passes = self.map.draw()?;
        let recorder = gpu.scoped("recording the silhouettes", || {
            let mut recorder = Recorder::new(gpu);
            let (pipeline, bindings) = (&self.classify, self.classify_bindings.as_slice());
            receivers.look_up(&mut recorder, &LookUp { name: "classify", pipeline, bindings, texel_reads: 0 });
            recorder
        })?;
        passes.extend(recorder.finish("the silhouettes")?);
        passes.extend(self.volume.draw()?);
        Ok(Answer { mask: receivers.mask(gpu, self.job.receivers)?, passes })
    }

    fn bytes(&self) -> u64 {
        // Both have the same receivers.
        self.map.bytes() + self.volume.bytes() - self.map.receivers().bytes() + self.pixel_mask.size()
    }

    fn facts(&self) -> Vec<(String, String)> {
        let mut facts = self.map.facts();
        facts.extend(self.volume.facts());
        if let Ok([found, missed]) = self.found_and_missed() {
            let asked = self.job.classes.iter().filter(|class| **class == PixelClass::Asked).count();
            facts.push(("silhouette pixels".to_owned(), format!("{found} of {asked} asked")));
            facts.push(("wrong off silhouettes".to_owned(), format!("{missed} pixels, which the map answers")));
        }
        facts
    }

    fn replay(&self, answer: &Mask, pixels: &[u32]) -> Result<Replay, TechniqueError> {
        replay::replay(self, answer, pixels)
    }

    fn lookup_facts(&self, pixel: u32) -> Result<Vec<(String, String)>, TechniqueError> {
        let is_silhouette = self.silhouettes()?.get(pixel as usize).copied().unwrap_or(false);
        let who = if is_silhouette { "the texels disagree: volumes" } else { "the texels agree: the map" };
        let mut facts = vec![("answered by".to_owned(), who.to_owned())];
        facts.extend(self.map.lookup_facts(pixel)?);
        if is_silhouette {
            facts.extend(self.volume.lookup_facts(pixel)?);
        }
        Ok(facts)
    }

    fn footprint(&self, pixel: u32) -> Option<Footprint> {
        self.map.footprint(pixel)
    }

    fn view_names(&self) -> Vec<String> {
        self.map.view_names()
    }

    fn in_view(&self, pixel: u32) -> Option<InView> {
        self.map.in_view(pixel)
    }

    fn bias(&self) -> Vec<EffectiveBias> {
        self.map.bias()
    }

    fn light_frusta(&self) -> Vec<DMat4> {
        self.map.light_frusta()
    }

    fn light_depths(&self) -> Result<Option<LightDepths>, TechniqueError> {
        self.map.light_depths()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cast::Casters;
    use crate::gpu::{GBufferPass, Geometry, Gpu};
    use crate::inspect::neighbours;
    use crate::receiver::{Asked, Receivers};
    use crate::scene::{LoadOptions, load};
    use crate::technique::Spec;
    use glam::UVec2;
    use std::path::Path;

    /// HY-4.
    #[test]
    fn off_silhouettes_nothing_is_counted() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/torus");
        let size = Some(UVec2::new(200, 150));
        let scene = load(&folder, &LoadOptions { size, ..LoadOptions::default() }).unwrap();
        let gpu = Gpu::open().unwrap();
        let geometry = Geometry::upload(&gpu, &scene).unwrap();
        let gbuffer = GBufferPass::new(&gpu, &scene).unwrap();
        gbuffer.run(&gpu, &geometry).unwrap();
        let receivers = Receivers::new(&scene, &gbuffer.read(&gpu).unwrap().triangles);
        let light = &scene.lights[0];
        let classes = receivers.classify(&scene, light);
        let (casters, adjacency) = (Casters::new(&scene), neighbours(&scene));
        let job = Job {
            gpu: &gpu,
            scene: &scene,
            geometry: &geometry,
            casters: &casters,
            adjacency: &adjacency,
            light,
            receivers: &receivers,
            classes: &classes,
            fitted_to: Asked { receivers: &receivers, classes: &classes },
        };
        let map = map::Settings::of(&Spec::parse("map:size=64,filter=pcf-box2").unwrap());
        let settings = volume::Settings::of(&Spec::parse("volume").unwrap());
        let hybrid = PreparedHybrid::new(&map, settings.masked(), job).unwrap();
        hybrid.run().unwrap();
        let (silhouettes, counts) = (hybrid.silhouettes().unwrap(), hybrid.volume.stencil().unwrap());
        let counted = |counts: &[u8], on: bool| {
            silhouettes.iter().zip(counts).filter(|(is_on, count)| **is_on == on && **count > 0).count()
        };
        assert_eq!(counted(&counts, false), 0);
        assert!(counted(&counts, true) > 100, "{}", counted(&counts, true));
        // Control: without the mask the same pixels are in volumes.
        let everywhere = PreparedVolume::new(settings, job).unwrap();
        everywhere.run().unwrap();
        let off = counted(&everywhere.stencil().unwrap(), false);
        assert!(off > 100, "{off}");
    }
}
