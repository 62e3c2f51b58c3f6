//! The exact Euclidean distance transform, for the pixels that ask.
//!
//! P. Felzenszwalb, D. Huttenlocher, "Distance Transforms of Sampled Functions", Theory of Computing 8, 2012: the squared
//! distance is separable, so a scan of the columns is followed, in each row, by the lower envelope of one parabola per
//! column. Columns are scanned for the whole picture; rows nobody asks about are skipped.
//!
//! Distances are exact: squares are integers below 2⁵³ for every picture a GPU can make, and where two parabolas cross
//! between two pixels they do so at least 1/(2 × width) away from either, far beyond f64 rounding.

use glam::UVec2;
use rayon::prelude::*;

/// No site in this column.
const NONE: u32 = u32::MAX;

/// For each pixel of `asking` in reading order: its index and the squared distance, in pixels², from its centre to the
/// centre of the nearest pixel of `sites`. Empty without sites. Both slices have one entry per pixel.
pub(super) fn squared_distances(size: UVec2, sites: &[bool], asking: &[bool]) -> Vec<(usize, u64)> {
    let width = size.x as usize;
    if !sites.contains(&true) {
        return Vec::new();
    }
    let in_column = distances_in_columns(width, sites);
    let rows = in_column.par_chunks(width).zip(asking.par_chunks(width)).enumerate();
    rows.filter(|(_, (_, asking))| asking.contains(&true))
        .flat_map_iter(|(y, (in_column, asking))| {
            squared_distances_in_row(in_column, asking).into_iter().map(move |(x, square)| (y * width + x, square))
        })
        .collect()
}

/// Distance of every pixel to the nearest site above or below it, [`NONE`] if its column has none.
fn distances_in_columns(width: usize, sites: &[bool]) -> Vec<u32> {
    let mut distance: Vec<u32> = sites.iter().map(|&site| if site { 0 } else { NONE }).collect();
    let height = sites.len() / width;
    let mut relax = |from: usize, to: usize| {
        let (from, to) = (from * width, to * width);
        for x in 0..width {
            distance[to + x] = distance[to + x].min(distance[from + x].saturating_add(1));
        }
    };
    for y in 1..height {
        relax(y - 1, y);
    }
    for y in (1..height).rev() {
        relax(y, y - 1);
    }
    distance
}

/// One parabola of the lower envelope: (x − `x`)² + `height`, lowest from `start` to the next one's `start`.
struct Parabola {
    x: f64,
    height: f64,
    start: f64,
}

impl Parabola {
    fn at(&self, x: f64) -> f64 {
        (x - self.x) * (x - self.x) + self.height
    }

    /// Where a parabola of the same shape further right begins to be lower.
    fn meets(&self, x: f64, height: f64) -> f64 {
        ((height + x * x) - (self.height + self.x * self.x)) / (2.0 * (x - self.x))
    }
}

fn squared_distances_in_row(in_column: &[u32], asking: &[bool]) -> Vec<(usize, u64)> {
    let envelope = lower_envelope(in_column);
    let mut current = 0;
    let asking = asking.iter().enumerate().filter(|&(_, &asks)| asks);
    asking
        .map(|(column, _)| {
            let x = column as f64;
            while envelope.get(current + 1).is_some_and(|next| next.start <= x) {
                current += 1;
            }
            (column, envelope[current].at(x) as u64)
        })
        .collect()
}

/// Never empty: some column has a site, and then every row of that column has a distance.
fn lower_envelope(in_column: &[u32]) -> Vec<Parabola> {
    let mut envelope: Vec<Parabola> = Vec::new();
    for (column, &distance) in in_column.iter().enumerate().filter(|&(_, &distance)| distance != NONE) {
        let (x, height) = (column as f64, f64::from(distance) * f64::from(distance));
        let mut start = f64::NEG_INFINITY;
        while let Some(last) = envelope.last() {
            let meeting = last.meets(x, height);
            if meeting > last.start {
                start = meeting;
                break;
            }
            envelope.pop();
        }
        envelope.push(Parabola { x, height, start });
    }
    envelope
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The definition, in O(n²).
    fn reference(size: UVec2, sites: &[bool], asking: &[bool]) -> Vec<(usize, u64)> {
        let width = size.x as usize;
        let square = |a: usize, b: usize| {
            let (dx, dy) = ((a % width).abs_diff(b % width) as u64, (a / width).abs_diff(b / width) as u64);
            dx * dx + dy * dy
        };
        let nearest = |p: usize| (0..sites.len()).filter(|&s| sites[s]).map(|s| square(p, s)).min();
        (0..asking.len()).filter(|&p| asking[p]).filter_map(|p| Some((p, nearest(p)?))).collect()
    }

    proptest! {
        #[test]
        fn distances_equal_the_reference(
            width in 1_u32..24,
            height in 1_u32..24,
            rarity in 1_u32..40,
            seed: u64,
        ) {
            let size = UVec2::new(width, height);
            let random = |salt: u64| -> Vec<bool> {
                let hash = |i: u32| (seed ^ salt ^ (u64::from(i) << 32)).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 33;
                (0..width * height).map(|i| hash(i).is_multiple_of(u64::from(rarity))).collect()
            };
            let (sites, asking) = (random(1), random(2));
            prop_assert_eq!(squared_distances(size, &sites, &asking), reference(size, &sites, &asking));
        }
    }

    #[test]
    fn one_far_corner_is_reached_exactly() {
        let size = UVec2::new(301, 127);
        let mut sites = vec![false; 301 * 127];
        sites[0] = true;
        let distances = squared_distances(size, &sites, &vec![true; sites.len()]);
        assert_eq!(distances.last(), Some(&(301 * 127 - 1, 300 * 300 + 126 * 126)));
        // Control: the site moved by one pixel is another answer.
        sites.swap(0, 1);
        let moved = squared_distances(size, &sites, &vec![true; sites.len()]);
        assert_eq!(moved.last(), Some(&(301 * 127 - 1, 299 * 299 + 126 * 126)));
    }

    #[test]
    fn without_sites_nobody_gets_an_answer() {
        assert!(squared_distances(UVec2::new(2, 2), &[false; 4], &[true; 4]).is_empty());
        assert!(squared_distances(UVec2::ZERO, &[], &[]).is_empty());
    }
}
