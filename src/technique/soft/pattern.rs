//! Where the points of a soft shadow lie: in the unit square, and from there on a rectangle or a disc, uniform in area.

use glam::DVec2;
use std::f64::consts::FRAC_PI_4;

/// A way to spread points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pattern {
    /// Those that the truth counts ([`crate::scene::Emitter`]).
    Truth,
    /// The middles of n × n equal cells.
    GridMidpoint,
    /// A random place in each of n × n equal cells.
    Stratified,
    /// J. Hammersley's set ("Monte Carlo Methods for Solving Multivariable Problems", 1960), bits flipped by the seed.
    Hammersley,
}

impl Pattern {
    /// Every pattern with its name.
    pub const ALL: [(&'static str, Self); 4] = [
        ("truth", Self::Truth),
        ("grid-midpoint", Self::GridMidpoint),
        ("stratified", Self::Stratified),
        ("hammersley", Self::Hammersley),
    ];

    /// The pattern of that name.
    #[must_use]
    pub fn named(name: &str) -> Self {
        Self::ALL.iter().find(|(known, _)| *known == name).map_or(Self::Truth, |(_, pattern)| *pattern)
    }

    /// Points of the unit square: `count` of them, or for the patterns of cells the largest square number up to that.
    /// None for [`Self::Truth`], whose points the light has.
    #[must_use]
    pub fn points(self, count: u32, seed: u64) -> Vec<DVec2> {
        let side = count.isqrt();
        let cells = (0..side * side).map(|i| DVec2::new((i % side).into(), (i / side).into()));
        match self {
            Self::Truth => Vec::new(),
            Self::GridMidpoint => cells.map(|cell| (cell + 0.5) / f64::from(side)).collect(),
            Self::Stratified => {
                let place = |(index, cell): (u64, DVec2)| {
                    let within = [0, 1].map(|axis| fraction(hash(seed ^ hash(2 * index + axis))));
                    (cell + DVec2::from_array(within)) / f64::from(side)
                };
                (0..).zip(cells).map(place).collect()
            }
            Self::Hammersley => {
                let flips = (hash(seed) >> 32) as u32 * u32::from(seed != 0);
                let height = |i: u32| (f64::from(i.reverse_bits() ^ flips) + 0.5) / 2.0_f64.powi(32);
                (0..count).map(|i| DVec2::new((f64::from(i) + 0.5) / f64::from(count), height(i))).collect()
            }
        }
    }
}

/// SplitMix64 (G. Steele, D. Lea, C. Flood, "Fast Splittable Pseudorandom Number Generators", 2014).
fn hash(value: u64) -> u64 {
    let z = value.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// In 0..1, from the upper 53 bits.
fn fraction(bits: u64) -> f64 {
    (bits >> 11) as f64 / 2.0_f64.powi(53)
}

/// From the unit square to the unit disc, areas kept (P. Shirley, K. Chiu, "A Low Distortion Map Between Disk and
/// Square", 1997).
pub(super) fn on_disc(at: DVec2) -> DVec2 {
    let from_middle = 2.0 * at - 1.0;
    let (x, y) = (from_middle.x, from_middle.y);
    if from_middle == DVec2::ZERO {
        return DVec2::ZERO;
    }
    let (radius, angle) =
        if x.abs() > y.abs() { (x, FRAC_PI_4 * y / x) } else { (y, 2.0 * FRAC_PI_4 - FRAC_PI_4 * x / y) };
    DVec2::from_angle(angle) * radius
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_cell_holds_one_point_and_a_seed_repeats_them() {
        for pattern in [Pattern::GridMidpoint, Pattern::Stratified, Pattern::Hammersley] {
            let points = pattern.points(16, 7);
            assert_eq!(points, pattern.points(16, 7));
            assert_eq!(points.len(), 16);
            let mut cells: Vec<_> = points.iter().map(|p| (4.0 * *p).floor().as_ivec2().to_array()).collect();
            cells.sort_unstable();
            cells.dedup();
            assert!(cells.len() == 16 || pattern == Pattern::Hammersley, "{pattern:?}: {points:?}");
            assert!(points.iter().all(|p| p.min_element() >= 0.0 && p.max_element() < 1.0));
        }
        assert_ne!(Pattern::Stratified.points(16, 7), Pattern::Stratified.points(16, 8));
        assert_eq!(Pattern::GridMidpoint.points(15, 0).len(), 9);
    }

    #[test]
    fn the_disc_keeps_areas() {
        let points: Vec<_> = Pattern::GridMidpoint.points(4096, 0).into_iter().map(on_disc).collect();
        for radius in [0.3_f64, 0.5, 0.8] {
            let inside = points.iter().filter(|point| point.length() < radius).count() as f64 / 4096.0;
            assert!((inside - radius * radius).abs() < 0.03, "{radius}: {inside}");
        }
        assert!(points.iter().all(|point| point.length() <= 1.0));
    }
}
