//! Error by view and by distance to the seam: whether a map of several views (cascades, faces, halves, tiles) is worse in
//! one of them, or where two of them meet. Specification: docs/map.md#seam-statistics.

use crate::technique::InView;
use serde::{Deserialize, Serialize};

/// How many pixels were compared in a bin, and how wrong they are.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct BinError {
    /// Asked and decided pixels.
    pub asked: u64,
    /// Wrong ones.
    pub wrong: u64,
    /// Mean of |technique − truth|, 0..=1; `None` over no pixel.
    pub mean_abs: Option<f64>,
}

/// The pixels that one view answers for.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ViewError {
    /// What people call the view.
    pub name: String,
    /// Their error.
    #[serde(flatten)]
    pub error: BinError,
}

/// The pixels within some distance of a seam.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct DistanceError {
    /// Least distance, texels of the pixel's own view.
    pub from_texels: f64,
    /// Distance that is no longer in the bin; `None` in the last one.
    pub to_texels: Option<f64>,
    /// Their error.
    #[serde(flatten)]
    pub error: BinError,
}

/// Error by view and by distance to the seam.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Seams {
    /// Every view in the map's order.
    pub views: Vec<ViewError>,
    /// Bins of growing distance.
    pub distances: Vec<DistanceError>,
}

/// Where bins of distance end, texels. Kernels reach a few texels, so bins are narrow there.
const BIN_ENDS: [f64; 7] = [1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0];

/// Bins the errors of pixels (`None` where nothing was compared) by the place of each in the named views.
#[must_use]
pub fn seams(names: &[String], places: &[Option<InView>], signed_error: &[Option<f64>], wrong_above: f64) -> Seams {
    let mut by_view = vec![Sum::default(); names.len()];
    let mut by_distance = [Sum::default(); BIN_ENDS.len() + 1];
    for (place, error) in places.iter().zip(signed_error) {
        let (Some(place), Some(error)) = (place, error) else { continue };
        if let Some(sum) = by_view.get_mut(place.view) {
            sum.add(error.abs(), wrong_above);
        }
        if let Some(texels) = place.seam_texels {
            by_distance[BIN_ENDS.iter().filter(|end| texels >= **end).count()].add(error.abs(), wrong_above);
        }
    }
    let views = names.iter().zip(&by_view).map(|(name, sum)| ViewError { name: name.clone(), error: sum.bin() });
    let distance = |(bin, sum): (usize, &Sum)| DistanceError {
        from_texels: bin.checked_sub(1).map_or(0.0, |before| BIN_ENDS[before]),
        to_texels: BIN_ENDS.get(bin).copied(),
        error: sum.bin(),
    };
    Seams { views: views.collect(), distances: by_distance.iter().enumerate().map(distance).collect() }
}

#[derive(Debug, Clone, Copy, Default)]
struct Sum {
    asked: u64,
    wrong: u64,
    abs: f64,
}

impl Sum {
    fn add(&mut self, abs: f64, wrong_above: f64) {
        self.asked += 1;
        self.wrong += u64::from(abs > wrong_above);
        self.abs += abs;
    }

    fn bin(&self) -> BinError {
        let mean_abs = (self.asked > 0).then(|| self.abs / self.asked as f64);
        BinError { asked: self.asked, wrong: self.wrong, mean_abs }
    }
}

impl BinError {
    /// Share of wrong pixels; `None` over no pixel.
    #[must_use]
    pub fn wrong_fraction(&self) -> Option<f64> {
        (self.asked > 0).then(|| self.wrong as f64 / self.asked as f64)
    }

    /// Of both bins together.
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        let abs = |bin: Self| bin.mean_abs.unwrap_or(0.0) * bin.asked as f64;
        let asked = self.asked + other.asked;
        let mean_abs = (asked > 0).then(|| (abs(self) + abs(other)) / asked as f64);
        Self { asked, wrong: self.wrong + other.wrong, mean_abs }
    }
}

impl Seams {
    /// The pixels nearer to a seam than `texels`, which is where a bin ends, and the others.
    #[must_use]
    pub fn split_at(&self, texels: f64) -> [BinError; 2] {
        let mut sides = [BinError::default(); 2];
        for bin in &self.distances {
            let side = usize::from(bin.from_texels >= texels);
            sides[side] = sides[side].plus(bin.error);
        }
        sides
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WRONG_ABOVE: f64 = 0.5;

    fn binned(pixels: &[(usize, f64, f64)]) -> Seams {
        let places: Vec<Option<InView>> =
            pixels.iter().map(|(view, texels, _)| Some(InView { view: *view, seam_texels: Some(*texels) })).collect();
        let errors: Vec<Option<f64>> = pixels.iter().map(|(.., error)| Some(*error)).collect();
        seams(&["front".to_owned(), "back".to_owned()], &places, &errors, WRONG_ABOVE)
    }

    #[test]
    fn pixels_fall_into_the_bins_of_their_view_and_distance() {
        let found = binned(&[(0, 0.0, 1.0), (0, 0.99, 0.0), (1, 1.0, -0.25), (1, 3.9, 0.0), (1, 1e6, -1.0)]);
        let front = BinError { asked: 2, wrong: 1, mean_abs: Some(0.5) };
        assert_eq!(found.views[0], ViewError { name: "front".to_owned(), error: front });
        assert_eq!((found.views[1].error.asked, found.views[1].error.wrong), (3, 1));
        let counts: Vec<(u64, u64)> = found.distances.iter().map(|bin| (bin.error.asked, bin.error.wrong)).collect();
        assert_eq!(counts, [(2, 1), (1, 0), (1, 0), (0, 0), (0, 0), (0, 0), (0, 0), (1, 1)]);
        assert_eq!((found.distances[0].from_texels, found.distances[0].to_texels), (0.0, Some(1.0)));
        assert_eq!((found.distances[7].from_texels, found.distances[7].to_texels), (64.0, None));
        assert_eq!(found.distances[3].error.mean_abs, None);
        let [near, far] = found.split_at(2.0);
        assert_eq!((near.asked, near.wrong, far.asked, far.wrong), (3, 1, 2, 1));
        assert_eq!(near.mean_abs, Some(1.25 / 3.0));
    }

    #[test]
    fn what_was_not_compared_or_lies_in_no_view_does_not_count() {
        let inside = Some(InView { view: 0, seam_texels: None });
        let found = seams(&["one".to_owned()], &[inside, None, inside], &[Some(0.0), Some(1.0), None], WRONG_ABOVE);
        assert_eq!(found.views[0].error.asked, 1);
        assert!(found.distances.iter().all(|bin| bin.error.asked == 0), "one view alone has no seam");
    }
}
