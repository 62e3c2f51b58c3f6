//! Blobs: connected groups of wrong pixels. A hundred scattered pixels are noise, a hundred in one place are a hole.

use glam::UVec2;

/// One 8-connected component of wrong pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Blob {
    /// Index of its first pixel in reading order (`y * width + x`).
    pub first: u32,
    /// How many pixels it has.
    pub pixels: u64,
}

/// The 8-connected components of `wrong` (one entry per pixel, row by row), in reading order of their first pixels.
#[must_use]
pub fn blobs(size: UVec2, wrong: &[bool]) -> Vec<Blob> {
    let mut unvisited = wrong.to_vec();
    let mut found = Vec::new();
    let mut pending = Vec::new();
    for first in 0..unvisited.len() {
        if !std::mem::take(&mut unvisited[first]) {
            continue;
        }
        pending.push(first);
        let mut pixels = 0;
        while let Some(pixel) = pending.pop() {
            pixels += 1;
            for neighbour in neighbours(size, pixel) {
                if std::mem::take(&mut unvisited[neighbour]) {
                    pending.push(neighbour);
                }
            }
        }
        found.push(Blob { first: first as u32, pixels });
    }
    found
}

/// The up to eight pixels around one, and the pixel itself.
fn neighbours(size: UVec2, pixel: usize) -> impl Iterator<Item = usize> {
    let (width, height) = (size.x as usize, size.y as usize);
    let (x, y) = (pixel % width, pixel / width);
    let columns = x.saturating_sub(1)..(x + 2).min(width);
    (y.saturating_sub(1)..(y + 2).min(height)).flat_map(move |y| columns.clone().map(move |x| y * width + x))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn picture(rows: &[&str]) -> (UVec2, Vec<bool>) {
        let wrong = rows.iter().flat_map(|row| row.bytes().map(|b| b == b'#')).collect();
        (UVec2::new(rows[0].len() as u32, rows.len() as u32), wrong)
    }

    #[test]
    fn diagonal_neighbours_are_connected_and_opposite_borders_are_not() {
        let (size, wrong) = picture(&["#..#", ".#..", "#..#"]);
        let found = blobs(size, &wrong);
        // 3 and 11 touch nothing; a row-wrapping neighbourhood would join 3 with 4 or 8.
        assert_eq!(found, [Blob { first: 0, pixels: 3 }, Blob { first: 3, pixels: 1 }, Blob { first: 11, pixels: 1 }]);
    }

    #[test]
    fn a_ring_is_one_blob_and_a_cut_ring_too() {
        let (size, ring) = picture(&["####", "#..#", "#..#", "####"]);
        assert_eq!(blobs(size, &ring), [Blob { first: 0, pixels: 12 }]);
        let (size, halves) = picture(&["####", "....", "....", "####"]);
        assert_eq!(blobs(size, &halves).len(), 2);
    }

    #[test]
    fn nothing_wrong_and_no_pixels_have_no_blobs() {
        assert!(blobs(UVec2::new(3, 2), &[false; 6]).is_empty());
        assert!(blobs(UVec2::ZERO, &[]).is_empty());
    }

    /// The slow reference: labels spread until nothing changes.
    fn reference(size: UVec2, wrong: &[bool]) -> Vec<Blob> {
        let mut label: Vec<usize> = (0..wrong.len()).collect();
        loop {
            let before = label.clone();
            for pixel in (0..wrong.len()).filter(|&p| wrong[p]) {
                for other in (0..wrong.len()).filter(|&p| wrong[p]) {
                    let (w, p, o) = (size.x as usize, pixel, other);
                    if (p % w).abs_diff(o % w) <= 1 && (p / w).abs_diff(o / w) <= 1 {
                        label[p] = label[p].min(label[o]);
                    }
                }
            }
            if label == before {
                break;
            }
        }
        let roots = (0..wrong.len()).filter(|&p| wrong[p] && label[p] == p);
        roots
            .map(|root| Blob {
                first: root as u32,
                pixels: (0..wrong.len()).filter(|&p| wrong[p] && label[p] == root).count() as u64,
            })
            .collect()
    }

    proptest! {
        #[test]
        fn blobs_equal_the_reference(width in 1_u32..9, height in 1_u32..9, bits: u64) {
            let size = UVec2::new(width, height);
            let wrong: Vec<bool> = (0..width * height).map(|i| bits >> i & 1 == 1).collect();
            prop_assert_eq!(blobs(size, &wrong), reference(size, &wrong));
        }
    }
}
