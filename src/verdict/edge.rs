//! How far wrong pixels are from the true shadow edge: aliasing stays within a few pixels of it, holes do not.

use super::LIT_FROM;
use super::counts::EdgeDistance;
use super::distance::squared_distances;
use glam::UVec2;

/// The shortest way from a pixel's centre to its border, which is as close as an edge between two pixels can be.
const HALF_PIXEL: f64 = 0.5;

/// On which side of the true shadow edge a pixel lies; `None` where nothing is compared.
pub(super) type Side = Option<bool>;

/// The side of an exact visibility: true is lit.
pub(super) fn side_of(visibility: f32) -> bool {
    visibility >= LIT_FROM
}

/// Distances of the wrong pixels, which are all compared, to the nearest pixel on the other side. One entry per pixel in
/// both slices.
pub(super) fn edge_distance(size: UVec2, sides: &[Side], wrong: &[bool]) -> Option<EdgeDistance> {
    let (mut distances, in_shadow) =
        rayon::join(|| distances_across(size, sides, wrong, true), || distances_across(size, sides, wrong, false));
    distances.extend(in_shadow);
    distances.sort_by(f64::total_cmp);
    Some(EdgeDistance {
        p50: nearest_rank(&distances, 50)?,
        p99: nearest_rank(&distances, 99)?,
        max: *distances.last()?,
    })
}

/// The distances of the wrong pixels of one side to the other side.
fn distances_across(size: UVec2, sides: &[Side], wrong: &[bool], from: bool) -> Vec<f64> {
    let asking: Vec<bool> = sides.iter().zip(wrong).map(|(&side, &wrong)| wrong && side == Some(from)).collect();
    if !asking.contains(&true) {
        return Vec::new();
    }
    let sites: Vec<bool> = sides.iter().map(|&side| side == Some(!from)).collect();
    let squares = squared_distances(size, &sites, &asking);
    squares.into_iter().map(|(_, square)| (square as f64).sqrt() - HALF_PIXEL).collect()
}

/// The smallest of the ascending values that at least this percentage of them does not exceed; `None` of no values.
fn nearest_rank(ascending: &[f64], percent: usize) -> Option<f64> {
    let rank = (ascending.len() * percent).div_ceil(100);
    ascending.get(rank.checked_sub(1)?).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `L` lit, `S` shadow, lower case: the same and wrong, `.` not compared.
    fn distance_in(rows: &[&str]) -> Option<EdgeDistance> {
        let pixels: Vec<u8> = rows.concat().into_bytes();
        let sides: Vec<Side> = pixels.iter().map(|p| (*p != b'.').then_some(p.eq_ignore_ascii_case(&b'l'))).collect();
        let wrong: Vec<bool> = pixels.iter().map(u8::is_ascii_lowercase).collect();
        edge_distance(UVec2::new(rows[0].len() as u32, rows.len() as u32), &sides, &wrong)
    }

    #[test]
    fn a_pixel_at_the_edge_is_half_a_pixel_away() {
        let at_edge = distance_in(&["LLlSS"]);
        assert_eq!(at_edge, Some(EdgeDistance { p50: 0.5, p99: 0.5, max: 0.5 }));
        let inside = distance_in(&["LLLSsS"]);
        assert_eq!(inside, Some(EdgeDistance { p50: 1.5, p99: 1.5, max: 1.5 }));
    }

    #[test]
    fn each_wrong_pixel_looks_across_the_edge_not_at_its_own_side() {
        // The lone lit pixel is 0.5 from the shadow around it, the shadow pixel in the corner is √8 − 0.5 from it.
        let both = distance_in(&["sSS", "SSS", "SSl"]);
        assert_eq!(both, Some(EdgeDistance { p50: 0.5, p99: 8.0_f64.sqrt() - 0.5, max: 8.0_f64.sqrt() - 0.5 }));
    }

    #[test]
    fn pixels_that_are_not_compared_are_no_edge() {
        assert_eq!(distance_in(&["l..S"]), Some(EdgeDistance { p50: 2.5, p99: 2.5, max: 2.5 }));
        assert_eq!(distance_in(&["l..."]), None);
        assert_eq!(distance_in(&["LLSS"]), None, "nothing is wrong");
    }

    #[test]
    fn percentiles_are_by_nearest_rank() {
        let values: Vec<f64> = (1..=200).map(f64::from).collect();
        assert_eq!(nearest_rank(&values, 50), Some(100.0));
        assert_eq!(nearest_rank(&values, 99), Some(198.0));
        assert_eq!(nearest_rank(&values[..1], 99), Some(1.0));
        assert_eq!(nearest_rank(&values[..3], 50), Some(2.0));
        assert_eq!(nearest_rank(&[], 50), None);
    }
}
