//! An irregular z-buffer ready to run for one light: its grids, the GPU objects, and what the f64 twin says of a pixel.

use super::grids::Grids;
use super::passes::IrregularPasses;
use super::replay;
use super::segment_test::{Decision, crossing};
use crate::cause::Replay;
use crate::mask::Mask;
use crate::receiver::{Asked, PixelClass, Receiver};
use crate::technique::footprint::Footprint;
use crate::technique::{Answer, Job, Prepared, ReceiverBuffer, TechniqueError};
use std::collections::HashMap;

/// See the module.
pub struct PreparedIrregular<'j> {
    pub(super) job: Job<'j>,
    pub(super) grids: Grids,
    /// Per triangle the side the light is on, as a sign; 0 for what casts nothing.
    pub(super) light_sides: Vec<i32>,
    passes: IrregularPasses,
    receivers: ReceiverBuffer,
}

impl std::fmt::Debug for PreparedIrregular<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("PreparedIrregular").field("grid", &self.grids.grid).finish_non_exhaustive()
    }
}

impl<'j> PreparedIrregular<'j> {
    /// Builds everything for one light, with grids of `grid` cells a side.
    ///
    /// # Errors
    /// What the device reported.
    pub fn new(grid: u32, job: Job<'j>) -> Result<Self, TechniqueError> {
        // Its samples are the asked points themselves, wherever the camera is by now.
        let asked = Asked { receivers: job.receivers, classes: job.classes };
        let grids = Grids::fit(job.light, &[asked.points(), job.fitted_to.points()].concat(), grid);
        let light_sides = light_sides(&job);
        let receivers = ReceiverBuffer::upload(job.gpu, job.receivers, job.classes)?;
        let passes = IrregularPasses::new(&job, &grids, &light_sides, &receivers)?;
        Ok(Self { job, grids, light_sides, passes, receivers })
    }

    pub(super) fn receiver(&self, pixel: u32) -> Option<Receiver> {
        self.job.receivers.pixels.get(pixel as usize).copied().flatten()
    }

    /// Whether f32 may decide a pixel either way: no caster blocks it beyond doubt, and one may within the error bound
    /// of its edge functions.
    #[must_use]
    pub fn is_in_doubt(&self, pixel: u32) -> bool {
        let Some(receiver) = self.receiver(pixel) else { return false };
        let mut in_doubt = false;
        for (_, decision) in self.decisions(&receiver) {
            match decision {
                Decision::Blocked => return false,
                Decision::InDoubt => in_doubt = true,
                Decision::Clear => {}
            }
        }
        in_doubt
    }

    /// Every casting triangle but the receiver's own, and what exact arithmetic knows of its test.
    pub(super) fn decisions<'r>(&'r self, receiver: &'r Receiver) -> impl Iterator<Item = (u32, Decision)> + 'r {
        let (job, light) = (&self.job, self.job.light.homogeneous());
        let own = job.casters.surface_of(receiver.triangle);
        let sides = (0..).zip(&self.light_sides).filter(move |(triangle, side)| **side != 0 && *triangle != own);
        sides.map(move |(triangle, side)| {
            (triangle, crossing(receiver.point_in_world, light, job.scene.triangle_in_world(triangle), *side))
        })
    }
}

impl PreparedIrregular<'_> {
    /// How many rectangles the casters cover, and how large they are.
    fn covered_cells(&self) -> String {
        let casting = (0..).zip(&self.light_sides).filter(|(_, side)| **side != 0).map(|(triangle, _)| triangle);
        let corners = casting.map(|triangle| self.job.scene.triangle_in_world(triangle));
        let faces = 0..self.grids.faces.len();
        let rectangles =
            corners.flat_map(|corners| faces.clone().filter_map(move |f| self.grids.rectangle(f, corners)));
        let (count, cells) = rectangles.fold((0_u64, 0_u64), |(count, cells), rectangle| {
            let size = rectangle.last - rectangle.first + 1;
            (count + 1, cells + u64::from(size.x) * u64::from(size.y))
        });
        format!("{cells} in {count} rectangles")
    }
}

/// On which side of each casting triangle the light is; of coinciding triangles only one casts, and none that the light
/// sees edge-on.
fn light_sides(job: &Job<'_>) -> Vec<i32> {
    let light = job.light.homogeneous();
    let mut sides = vec![0; job.scene.triangles.len()];
    for triangle in job.scene.casting_triangles().filter(|&triangle| job.casters.surface_of(triangle) == triangle) {
        let facing = job.scene.facing(triangle, light);
        sides[triangle as usize] = i32::from(facing > 0.0) - i32::from(facing < 0.0);
    }
    sides
}

impl Prepared for PreparedIrregular<'_> {
    fn run(&self) -> Result<Answer, TechniqueError> {
        let passes = self.passes.run(self.job.gpu, &self.receivers)?;
        Ok(Answer { mask: self.receivers.mask(self.job.gpu, self.job.receivers)?, passes })
    }

    fn bytes(&self) -> u64 {
        self.passes.bytes() + self.receivers.bytes()
    }

    fn facts(&self) -> Vec<(String, String)> {
        let fact = |label: &str, value: String| (label.to_owned(), value);
        let mut lists: HashMap<_, usize> = HashMap::new();
        for (pixel, class) in self.job.receivers.pixels.iter().zip(self.job.classes) {
            let receiver = pixel.filter(|_| *class == PixelClass::Asked);
            if let Some(cell) = receiver.and_then(|receiver| self.grids.cell_of(receiver.point_in_world)) {
                *lists.entry(cell).or_default() += 1;
            }
        }
        let (filled, longest) = (lists.len().max(1), lists.values().max().copied().unwrap_or(0));
        let mean = lists.values().sum::<usize>() as f64 / filled as f64;
        let side = self.grids.grid;
        vec![
            fact("grids", format!("{} of {side} x {side} cells", self.grids.faces.len())),
            fact("receivers per filled cell", format!("{mean:.1}, most {longest}")),
            fact("casters' cells", self.covered_cells()),
        ]
    }

    fn replay(&self, answer: &Mask, pixels: &[u32]) -> Result<Replay, TechniqueError> {
        Ok(replay::replay(self, answer, pixels))
    }

    fn lookup_facts(&self, pixel: u32) -> Result<Vec<(String, String)>, TechniqueError> {
        Ok(replay::lookup_facts(self, pixel))
    }

    /// Samples lie where the receivers are.
    fn footprint(&self, _pixel: u32) -> Option<Footprint> {
        None
    }
}
