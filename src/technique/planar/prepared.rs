//! Planar shadows ready to run for one light: planes, the triangles on them, the GPU objects, and for replays the
//! flattened casters.

use super::flatten::{FlatCasters, flattened};
use super::membership::Membership;
use super::passes::PlanarPasses;
use super::settings::Settings;
use super::{ShadowPlane, replay};
use crate::cause::Replay;
use crate::gpu::GpuError;
use crate::mask::{Mask, Visibility};
use crate::receiver::{PixelClass, Receiver};
use crate::technique::footprint::Footprint;
use crate::technique::{Answer, Job, Prepared, TechniqueError};
use std::sync::OnceLock;

pub(super) struct PreparedPlanar<'j> {
    pub(super) job: Job<'j>,
    pub(super) settings: Settings,
    pub(super) planes: Vec<ShadowPlane>,
    pub(super) members: Membership,
    passes: PlanarPasses,
    /// Per plane, made when a replay first needs them.
    flat_casters: Vec<OnceLock<FlatCasters>>,
}

impl<'j> PreparedPlanar<'j> {
    pub(super) fn new(settings: Settings, planes: Vec<ShadowPlane>, job: Job<'j>) -> Result<Self, GpuError> {
        let members = Membership::new(job.scene, &planes, settings.plane_tolerance_m);
        let passes = PlanarPasses::new(&job, &settings, &planes, &members)?;
        let flat_casters = planes.iter().map(|_| OnceLock::new()).collect();
        Ok(Self { job, settings, planes, members, passes, flat_casters })
    }

    pub(super) fn receiver(&self, pixel: u32) -> Option<Receiver> {
        self.job.receivers.pixels.get(pixel as usize).copied().flatten()
    }

    /// The casters as they lie on a plane.
    pub(super) fn flat_casters(&self, plane: usize) -> &FlatCasters {
        let shadow = &self.planes[plane];
        let projection = self.settings.projection;
        self.flat_casters[plane]
            .get_or_init(|| FlatCasters::new(&flattened(self.job.scene, shadow, &self.members, projection), shadow))
    }
}

impl Prepared for PreparedPlanar<'_> {
    fn run(&self) -> Result<Answer, TechniqueError> {
        let passes = self.passes.run(self.job.gpu, self.job.geometry)?;
        let layers = self.passes.layers(self.job.gpu)?;
        let size = self.job.receivers.size;
        let answer = |(pixel, (layers, class)): (usize, (u8, &PixelClass))| {
            if *class != PixelClass::Asked {
                return Ok(None);
            }
            let value = self.settings.visibility(layers.into()) as f32;
            let (x, y) = (pixel as u32 % size.x, pixel as u32 / size.x);
            Visibility::new(value).map(Some).ok_or(TechniqueError::NoAnswer { x, y, value })
        };
        let pixels = layers.into_iter().zip(self.job.classes).enumerate().map(answer).collect::<Result<_, _>>()?;
        Ok(Answer { mask: Mask { size, pixels }, passes })
    }

    fn bytes(&self) -> u64 {
        self.passes.bytes()
    }

    fn facts(&self) -> Vec<(String, String)> {
        let is_sun = self.planes.iter().any(|plane| plane.light.w == 0.0);
        let describe = |(index, plane): (usize, &ShadowPlane)| {
            let height = plane.light_height();
            let light = if is_sun {
                format!("light {:.2} degrees above it", height.clamp(-1.0, 1.0).asin().to_degrees())
            } else {
                format!("light {height:.6} m above it")
            };
            let receivers = self.members.receiver_count(self.job.scene, index);
            let drawn: u32 =
                self.members.casters(self.job.scene, plane).iter().map(|range| range.end - range.start).sum();
            let value = format!("{receivers} receiving triangles, {drawn} casting ones flattened, {light}");
            (self.label(index), value)
        };
        self.planes.iter().enumerate().map(describe).collect()
    }

    fn replay(&self, answer: &Mask, pixels: &[u32]) -> Result<Replay, TechniqueError> {
        Ok(replay::replay(self, answer, pixels))
    }

    fn lookup_facts(&self, pixel: u32) -> Result<Vec<(String, String)>, TechniqueError> {
        Ok(replay::lookup_facts(self, pixel))
    }

    fn footprint(&self, _pixel: u32) -> Option<Footprint> {
        None
    }
}

impl PreparedPlanar<'_> {
    /// "plane 2": its number in the scene.
    pub(super) fn label(&self, plane: usize) -> String {
        format!("plane {}", self.settings.only_plane.unwrap_or(plane) + 1)
    }
}
