//! `pcf-poisson`: the mean of up to 64 comparisons spread evenly, but not regularly, over a disc, turned for each pixel
//! otherwise or not: noise in place of the steps of a box.
//!
//! The pattern is a progression of best candidates (D. Mitchell, "Spectrally Optimal Sampling for Distribution Ray
//! Tracing", 1991): each of its points is the farthest from those before it among 4000 random ones, so its beginning of
//! any length is spread evenly too. It begins at the centre, so one tap is `nearest`.

use super::turn::{TURN, turned};
use super::{Asked, Blocker, Filter, Kernel};
use crate::gpu::shader::{Wgsl, wgsl};
use crate::technique::param::{Choice, ChoiceNumber};
use glam::{DVec2, IVec2};

/// k taps of equal weight.
#[derive(Debug)]
pub(super) struct PcfPoisson;

/// What the pattern is given in: exact in f32.
const UNITS: f64 = 1024.0;

#[rustfmt::skip]
const PATTERN: [[i32; 2]; 64] = [
    [0, 0], [-286, -983], [973, -319], [632, 805], [-545, 865], [-992, -244], [466, -885], [-597, 244], [590, 187],
    [42, 641], [-442, -421], [431, -340], [29, -618], [1014, 108], [-787, -645], [-1003, 161], [-136, 1012], [270,
    967], [-834, 592], [887, 486], [-217, 334], [777, -639], [100, -987], [384, 502], [-382, -63], [686, -128],
    [-126, -311], [-708, -75], [-298, 651], [328, -20], [115, 317], [-484, -741], [331, -626], [-730, -368], [-552,
    527], [152, -349], [-247, -626], [697, -389], [633, 555], [353, 255], [-93, -834], [-836, 342], [362, 743],
    [810, 272], [45, 868], [-368, 164], [541, -550], [-318, 879], [901, -91], [-788, 130], [217, -807], [-547,
    -215], [-162, 129], [-910, -467], [175, 118], [765, 65], [-920, -35], [-427, 363], [-136, 525], [-178, -100],
    [-592, -557], [166, -138], [-323, -252], [-140, 787],
];

impl Filter for PcfPoisson {
    fn choice(&self) -> Choice {
        Choice { name: "pcf-poisson", number: Some(ChoiceNumber { min: 1, max: PATTERN.len() as u32, default: 16 }) }
    }
    fn shader(&self) -> Wgsl {
        wgsl!("map/filter/pcf_poisson.wgsl")
    }
    fn builds_on(&self) -> &'static [Wgsl] {
        &[TURN]
    }
    fn radius_texels(&self, kernel: &Kernel) -> f64 {
        if kernel.number == 1 { 0.0 } else { kernel.pattern_radius_texels.ceil() }
    }
    fn bias_kernel(&self, kernel: &Kernel) -> f64 {
        if kernel.number == 1 { 0.5 } else { 0.5 + kernel.pattern_radius_texels }
    }
    fn taps(&self, kernel: &Kernel, position_in_texels: DVec2, tap: &mut dyn FnMut(IVec2, f64)) {
        for offset in offsets(kernel) {
            tap((position_in_texels + offset).floor().as_ivec2(), 1.0 / f64::from(kernel.number));
        }
    }
    fn taps_at(&self, asked: &Asked<'_>, _blocker: Blocker<'_>, tap: &mut dyn FnMut(IVec2, f64)) {
        for offset in offsets(asked.kernel) {
            let place = asked.placed.position_in_texels + turned(asked.kernel, asked.pixel, offset);
            tap(place.floor().as_ivec2(), 1.0 / f64::from(asked.kernel.number));
        }
    }
}

/// From the receiver, texels.
fn offsets(kernel: &Kernel) -> impl Iterator<Item = DVec2> {
    let scale = kernel.pattern_radius_texels / UNITS;
    PATTERN.into_iter().take(kernel.number as usize).map(move |[x, y]| DVec2::new(x.into(), y.into()) * scale)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shader_holds_the_same_pattern() {
        let written = |separator: &str, point: fn([i32; 2]) -> String| PATTERN.map(point).join(separator);
        let flat = PcfPoisson.shader().text.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(flat.contains(&written(", ", |[x, y]| format!("vec2i({x}, {y})"))));
        assert!(!flat.contains(&written(", ", |[x, y]| format!("vec2i({y}, {x})"))));
    }

    #[test]
    fn points_lie_in_the_disc_and_keep_their_distance() {
        let points = PATTERN.map(|[x, y]| DVec2::new(x.into(), y.into()) / UNITS);
        assert!(points.iter().all(|point| point.length() <= 1.0));
        for (i, a) in points.iter().enumerate() {
            // k discs of this radius, apart from each other, fill at most the unit disc grown by it.
            let least = 0.5 / ((i + 1) as f64).sqrt();
            assert!(points[..i].iter().all(|b| a.distance(*b) > least), "{i}");
        }
    }
}
