//! A square in tiles: each is as large as its parent's quarter, and together they cover the square once. Tiles split
//! where samples want them to and a picture of them shows that it is worth it, until a budget is spent.
//!
//! Tiles are named by the curve of G. Morton, "A Computer Oriented Geodetic Data Base", 1966: along it the tiles of any
//! such tree lie one after the other, so that whoever looks one up can bisect.

use glam::{DVec2, UVec2};

/// Levels that the curve resolves: 24 bits, which f32 holds exactly.
pub(super) const DEEPEST: u32 = 12;

/// A tile: the square is cut into 2^level columns and rows, counted from its upper left.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Tile {
    pub(super) level: u32,
    pub(super) cell: UVec2,
}

/// Something in the square that wants finer tiles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Sample {
    /// Where it is, 0..1.
    pub(super) uv: DVec2,
    /// By how much too coarse the whole square is for it as one tile; halves with every level.
    pub(super) m: f64,
}

/// How far to go.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rules {
    pub(super) max_level: u32,
    pub(super) max_tiles: usize,
    /// Samples with no more than this are content.
    pub(super) m_target: f64,
}

/// Tiles along the curve, and how many samples are not content, by what keeps them from it.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Tree {
    pub(super) tiles: Vec<Tile>,
    /// In tiles that are not worth splitting.
    pub(super) not_worth: usize,
    /// In tiles of the last level.
    pub(super) at_last_level: usize,
    /// In tiles that the budget did not reach.
    pub(super) beyond_budget: usize,
}

impl Tile {
    pub(super) const WHOLE: Self = Self { level: 0, cell: UVec2::ZERO };

    /// The first place of the tile along the curve.
    pub(super) fn first(self) -> u32 {
        place_on_curve(self.cell << (DEEPEST - self.level))
    }

    /// The four tiles in its place.
    fn quarters(self) -> [Self; 4] {
        let quarter = |x: u32, y: u32| Self { level: self.level + 1, cell: 2 * self.cell + UVec2::new(x, y) };
        [quarter(0, 0), quarter(1, 0), quarter(0, 1), quarter(1, 1)]
    }

    fn holds(self, uv: DVec2) -> bool {
        (uv * f64::from(1 << self.level)).floor() == self.cell.as_dvec2()
    }
}

/// Place on the curve of a cell of the deepest level; the f64 twin's share of `shaders/map/projection/adaptive.wgsl`.
pub(super) fn place_on_curve(cell: UVec2) -> u32 {
    bits_apart(cell.x) | bits_apart(cell.y) << 1
}

/// The bits of a number of [`DEEPEST`] bits, each followed by a zero.
fn bits_apart(number: u32) -> u32 {
    let bits = (number | number << 8) & 0x00ff_00ff;
    let bits = (bits | bits << 4) & 0x0f0f_0f0f;
    let bits = (bits | bits << 2) & 0x3333_3333;
    (bits | bits << 1) & 0x5555_5555
}

/// A tile that may split, with its samples.
struct Leaf {
    tile: Tile,
    samples: Vec<Sample>,
}

impl Leaf {
    /// Samples that are not content.
    fn wanting(&self, rules: &Rules) -> usize {
        let scale = 0.5_f64.powi(self.tile.level as i32);
        self.samples.iter().filter(|sample| scale * sample.m > rules.m_target).count()
    }

    fn split(&self) -> [Self; 4] {
        self.tile.quarters().map(|tile| {
            let samples = self.samples.iter().filter(|sample| tile.holds(sample.uv)).copied().collect();
            Self { tile, samples }
        })
    }
}

/// Splits level by level, tiles with the most discontented samples first. `is_worth` tells which of some tiles are worth
/// it.
pub(super) fn refined<E>(
    samples: Vec<Sample>,
    rules: &Rules,
    mut is_worth: impl FnMut(&[Tile]) -> Result<Vec<bool>, E>,
) -> Result<Tree, E> {
    let mut tree = Tree::default();
    let mut open = vec![Leaf { tile: Tile::WHOLE, samples }];
    let mut count = 1;
    while !open.is_empty() {
        let (candidates, content): (Vec<Leaf>, Vec<Leaf>) =
            open.drain(..).partition(|leaf| leaf.tile.level < rules.max_level && leaf.wanting(rules) > 0);
        tree.at_last_level += content.iter().map(|leaf| leaf.wanting(rules)).sum::<usize>();
        tree.tiles.extend(content.iter().map(|leaf| leaf.tile));
        let tiles: Vec<Tile> = candidates.iter().map(|leaf| leaf.tile).collect();
        let worth = is_worth(&tiles)?;
        let mut ranked: Vec<(Leaf, bool)> = candidates.into_iter().zip(worth).collect();
        ranked.sort_by_key(|(leaf, _)| (std::cmp::Reverse(leaf.wanting(rules)), leaf.tile.first()));
        for (leaf, is_worth) in ranked {
            if is_worth && count + 3 <= rules.max_tiles {
                count += 3;
                open.extend(leaf.split());
            } else {
                let unmet = if is_worth { &mut tree.beyond_budget } else { &mut tree.not_worth };
                *unmet += leaf.wanting(rules);
                tree.tiles.push(leaf.tile);
            }
        }
    }
    tree.tiles.sort_by_key(|tile| tile.first());
    Ok(tree)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    const RULES: Rules = Rules { max_level: 5, max_tiles: 400, m_target: 1.0 };

    /// Samples along a diagonal, the more demanding the farther down.
    fn samples() -> Vec<Sample> {
        let sample = |i: u32| {
            let at = (f64::from(i) + 0.5) / 100.0;
            Sample { uv: DVec2::new(at, 0.9 * at), m: 40.0 * at }
        };
        (0..100).map(sample).collect()
    }

    fn tree(rules: &Rules, worth: impl Fn(&Tile) -> bool) -> Tree {
        refined(samples(), rules, |tiles| Ok::<_, Infallible>(tiles.iter().map(&worth).collect())).unwrap()
    }

    /// The tile that bisection finds, and the one that holds the place.
    fn found(tree: &Tree, uv: DVec2) -> [Tile; 2] {
        let cell = (uv * f64::from(1 << DEEPEST)).floor().as_uvec2();
        let after = tree.tiles.partition_point(|tile| tile.first() <= place_on_curve(cell));
        let holding: Vec<Tile> = tree.tiles.iter().copied().filter(|tile| tile.holds(uv)).collect();
        assert_eq!(holding.len(), 1, "every place lies in one tile");
        [tree.tiles[after - 1], holding[0]]
    }

    #[test]
    fn tiles_cover_the_square_once_and_are_found_along_the_curve() {
        let tree = tree(&RULES, |tile| tile.cell.x % 5 != 3);
        let area: f64 = tree.tiles.iter().map(|tile| 0.25_f64.powi(tile.level as i32)).sum();
        assert!((area - 1.0).abs() < 1e-12 && tree.tiles.len() > 10);
        for i in 0..500 {
            let uv = DVec2::new((0.317 * f64::from(i)).fract(), (0.731 * f64::from(i)).fract());
            let [bisected, holding] = found(&tree, uv);
            assert_eq!(bisected, holding);
        }
    }

    /// AD-3: whoever is not content is counted with the reason.
    #[test]
    fn samples_end_content_or_with_a_reason() {
        let unmet = |tree: &Tree| {
            let wants = |sample: &Sample| {
                let [tile, _] = found(tree, sample.uv);
                sample.m * 0.5_f64.powi(tile.level as i32) > RULES.m_target
            };
            samples().iter().filter(|sample| wants(sample)).count()
        };
        let counts = |tree: &Tree| [tree.not_worth, tree.at_last_level, tree.beyond_budget];
        let all = tree(&RULES, |_| true);
        assert_eq!((counts(&all), unmet(&all)), ([0, unmet(&all), 0], unmet(&all)));
        assert!(unmet(&all) > 5, "40 takes more than five halvings");
        let poor = tree(&Rules { max_tiles: 40, ..RULES }, |_| true);
        assert!(poor.tiles.len() <= 40 && poor.beyond_budget > 0);
        assert_eq!(counts(&poor).iter().sum::<usize>(), unmet(&poor));
        let blind = tree(&RULES, |tile| tile.level < 2);
        assert_eq!(counts(&blind), [unmet(&blind), 0, 0]);
        assert_eq!(tree(&Rules { max_tiles: 1, ..RULES }, |_| true).tiles, [Tile::WHOLE]);
    }

    #[test]
    fn a_larger_budget_splits_whatever_a_smaller_one_does() {
        let tiles = |max_tiles: usize| tree(&Rules { max_tiles, ..RULES }, |_| true).tiles;
        for max_tiles in [4, 10, 33, 70] {
            let (few, many) = (tiles(max_tiles), tiles(2 * max_tiles));
            for tile in &few {
                let is_refined = |finer: &&Tile| finer.cell >> (finer.level - tile.level.min(finer.level)) == tile.cell;
                assert!(many.iter().any(|other| other.level >= tile.level && is_refined(&other)));
            }
        }
    }
}
