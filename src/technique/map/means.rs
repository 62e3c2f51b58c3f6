//! What moment filters answer, replayed in f64: with the exact moments of the filter's kernel, and with the means that the
//! GPU holds.

use super::filter::moments::{Moments, beyond, visibility, z_of};
use super::lookup::Tap;
use super::prepared::PreparedMap;
use super::reading::{Depths, Looked, Reading, place};
use crate::technique::TechniqueError;
use glam::{DVec2, DVec4, IVec2};
use rayon::prelude::*;

/// The means that some pixels' lookups read, sorted by place.
pub(super) struct Means<'r> {
    map: &'r PreparedMap<'r>,
    moments: &'r dyn Moments,
    places: Vec<[u32; 4]>,
    values: Vec<DVec4>,
}

impl<'r> Means<'r> {
    /// Of these pixels; `None` for filters without moments.
    pub(super) fn read(map: &'r PreparedMap<'_>, pixels: &[u32]) -> Result<Option<Self>, TechniqueError> {
        let Some(moments) = map.settings.filter.moments() else { return Ok(None) };
        let read_by = |pixel: &u32| {
            let receiver = map.receiver(*pixel);
            let shares = receiver.map(|receiver| (receiver, map.lookup.select(receiver.point_in_world)));
            let in_views =
                shares.into_iter().flat_map(|(receiver, shares)| shares.iter().map(move |(view, _)| (view, receiver)));
            let placed = in_views.filter_map(|(view, receiver)| place(&map.lookup, view, &receiver));
            placed
                .flat_map(|placed| neighbours(map, placed.position_in_texels).0.map(|texel| at(texel, placed.view)))
                .collect::<Vec<_>>()
        };
        let mut places: Vec<[u32; 4]> = pixels.par_iter().flat_map_iter(read_by).collect();
        places.par_sort_unstable();
        places.dedup();
        let values = map.passes.gather_means(map.job.gpu, &places)?;
        Ok(Some(Self { map, moments, places, values }))
    }

    /// The bound of the exact moments of the filter's kernel.
    pub(super) fn exact_visibility(&self, reading: &Reading<'_>, looked: &Looked<'_>) -> f64 {
        let numbers = &self.map.numbers;
        let mut mean = DVec4::ZERO;
        reading.each_tap(Depths::Exact, looked, &mut |tap: Option<Tap>, weight| {
            let depth = tap.and_then(|tap| reading.depth(Depths::Exact, &tap));
            let moments = match depth {
                Some(depth) => self.moments.of(numbers, z_of(numbers, depth)),
                None => beyond(self.moments, numbers),
            };
            mean += weight * moments;
        });
        visibility(self.moments, numbers, z_of(numbers, looked.placed.reference), mean)
    }

    /// The bound of the means that the GPU holds.
    pub(super) fn stored_visibility(&self, looked: &Looked<'_>) -> f64 {
        let numbers = &self.map.numbers;
        let (texels, part) = neighbours(self.map, looked.placed.position_in_texels);
        let [a, b, c, d] = texels.map(|texel| {
            let place = at(texel, looked.placed.view);
            self.places.binary_search(&place).map_or(DVec4::NAN, |rank| self.values[rank])
        });
        let mean = a.lerp(b, part.x).lerp(c.lerp(d, part.x), part.y);
        visibility(self.moments, numbers, z_of(numbers, looked.placed.reference), mean)
    }
}

/// The four texels of means that a lookup reads, row by row, and how near it is to the last.
fn neighbours(map: &PreparedMap<'_>, position_in_texels: DVec2) -> ([IVec2; 4], DVec2) {
    let n = map.settings.kernel.number as i32;
    let start = position_in_texels - 0.5 * f64::from(n);
    let first = start.floor().as_ivec2() + (n + 1) / 2;
    ([IVec2::ZERO, IVec2::X, IVec2::Y, IVec2::ONE].map(|step| first + step), start - start.floor())
}

fn at(texel: IVec2, view: usize) -> [u32; 4] {
    // Beyond the texture nothing is read by receivers inside the map.
    let texel = texel.max(IVec2::ZERO).as_uvec2();
    [texel.x, texel.y, view as u32, 0]
}
