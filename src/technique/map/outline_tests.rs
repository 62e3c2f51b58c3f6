//! What segments leave in the cells between texel centres, in the twin and on the device, and which corner then answers:
//! all sixteen combinations of corners as pictures drawn by hand.

use super::outline::{PointPass, Points};
use super::projection::{LightFrustum, Rows, Shape, View, Window};
use super::settings::DepthMetric;
use crate::gpu::{Gpu, Recorder};
use glam::{DMat4, DVec2, DVec3, UVec2, Vec4};
use proptest::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use wgpu::{BufferUsages, TextureFormat, TextureUsages, TextureViewDescriptor, TextureViewDimension};

/// Places in a few dozen cells, rounded to f32 and scaled by rows that are.
const ROUNDING: f64 = 2e-5;
/// Depth of all segments.
const DEPTH: f64 = 0.5;

type Segment = [DVec2; 2];

/// A view in which a world point lies at its own x and y, counted in cells, and as deep as its z.
fn grid(cells: u32) -> View {
    let frustum = LightFrustum {
        light_view_from_world: DMat4::IDENTITY,
        window: Window { min: DVec2::ZERO, max: DVec2::ONE },
        near_m: 0.0,
        far_m: 1.0,
        shape: Shape::Parallel,
        reversed: true,
        depth_metric: DepthMetric::Projected,
        texels: UVec2::splat(cells + 1),
    };
    let texel = 1.0 / (cells as f32 + 1.0);
    let row = |axis: Vec4| texel * (axis + 0.5 * Vec4::W);
    let rows = Rows { u: row(Vec4::X), v: row(Vec4::Y), q: Vec4::W, depth: Vec4::Z, depth_q: Vec4::W };
    View { rows, ..frustum.view("grid") }
}

fn edges(segments: &[Segment]) -> Vec<[DVec3; 2]> {
    segments.iter().map(|ends| ends.map(|end| end.extend(DEPTH))).collect()
}

/// What segments before an empty map leave.
fn drawn(cells: u32, segments: &[Segment]) -> Points {
    let view = grid(cells);
    let depths = vec![view.cleared(); view.texels.element_product() as usize];
    Points::drawn(&edges(segments), &view, &depths)
}

/// The same on the device.
fn drawn_by(gpu: &Gpu, cells: u32, segments: &[Segment]) -> Points {
    let view = grid(cells);
    // Fresh textures are 0: empty, under a reversed depth.
    let usage = TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING;
    let map = gpu.texture("empty map", view.texels, TextureFormat::Depth32Float, usage);
    let dimension = Some(TextureViewDimension::D2Array);
    let layers = map.create_view(&TextureViewDescriptor { dimension, ..Default::default() });
    let views = gpu.buffer("views", &[view.gpu()], BufferUsages::STORAGE);
    let pass = PointPass::new(gpu, view.texels, &views, &layers, &edges(segments));
    let mut recorder = Recorder::new(gpu);
    pass.record(&mut recorder);
    recorder.finish("points").unwrap();
    pass.read(gpu).unwrap()
}

/// The points there are, by cell.
fn stored(points: &Points) -> BTreeMap<[i64; 2], DVec2> {
    let cells = (0..points.cells.y).flat_map(|y| (0..points.cells.x).map(move |x| [i64::from(x), i64::from(y)]));
    cells
        .zip(&points.points)
        .filter(|(_, point)| point.x <= 1.0)
        .map(|(cell, point)| (cell, point.as_dvec2()))
        .collect()
}

/// Whether the cells that a segment leaves points in are 4-connected and all that it passes, and whether each point lies
/// in its cell and on the segment.
fn follow(points: &Points, [from, to]: Segment) -> bool {
    let stored = stored(points);
    let place = |cell: &[i64; 2]| DVec2::new(cell[0] as f64, cell[1] as f64);
    let are_on_it = stored.iter().all(|(cell, point)| {
        let at = place(cell) + *point;
        let along = (to - from).normalize_or_zero();
        let nearest = from + along * (at - from).dot(along).clamp(0.0, (to - from).length());
        point.clamp(DVec2::ZERO, DVec2::ONE) == *point && at.distance(nearest) < ROUNDING
    });
    let is_clear = |at: DVec2| (at - at.round()).abs().min_element() > ROUNDING;
    let mut passed = (0..=1000).map(|step| from.lerp(to, f64::from(step) / 1000.0)).filter(|at| is_clear(*at));
    let misses_none = passed.all(|at| stored.contains_key(&[at.x.floor() as i64, at.y.floor() as i64]));
    are_on_it && misses_none && are_connected(&stored.into_keys().collect())
}

/// Whether each cell is reached from each other across shared sides.
fn are_connected(cells: &BTreeSet<[i64; 2]>) -> bool {
    let mut reached = BTreeSet::new();
    let mut next: Vec<[i64; 2]> = cells.iter().take(1).copied().collect();
    while let Some([x, y]) = next.pop() {
        if cells.contains(&[x, y]) && reached.insert([x, y]) {
            next.extend([[x - 1, y], [x + 1, y], [x, y - 1], [x, y + 1]]);
        }
    }
    !cells.is_empty() && reached == *cells
}

fn place() -> impl Strategy<Value = DVec2> {
    (0.1..7.9_f64, 0.1..7.9_f64).prop_map(|(x, y)| DVec2::new(x, y))
}

/// Places in quarters of cells: segments between them run through corners and along borders of cells.
fn quarters() -> impl Strategy<Value = DVec2> {
    (1..32_u32, 1..32_u32).prop_map(|(x, y)| DVec2::new(x.into(), y.into()) / 4.0)
}

/// A place that a segment through it passes though its ends are no round numbers.
fn through_a_corner() -> impl Strategy<Value = Segment> {
    (place(), 1..8_u32, 1..8_u32, 0.2..1.0_f64).prop_map(|(from, x, y, beyond)| {
        let corner = DVec2::new(x.into(), y.into());
        [from, (corner + beyond * (corner - from)).clamp(DVec2::splat(0.1), DVec2::splat(7.9))]
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 512, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_cells_of_a_segment_are_connected(
        anywhere in (place(), place()), round in (quarters(), quarters()), through in through_a_corner(),
    ) {
        for segment in [anywhere.into(), round.into(), through] {
            prop_assert!(follow(&drawn(8, &[segment]), segment), "{segment:?}");
        }
    }

    /// Among cells whose neighbours are in the grid too.
    #[test]
    fn a_line_through_the_grid_is_reproduced(from in -2.0..10.0_f64, to in -2.0..10.0_f64, is_upright: bool) {
        prop_assert_eq!(misplaced(line(from, to, is_upright), DVec2::ZERO), 0);
    }
}

/// A line all the way through eight cells.
fn line(from: f64, to: f64, is_upright: bool) -> Segment {
    let turned = |x: f64, y: f64| if is_upright { DVec2::new(y, x) } else { DVec2::new(x, y) };
    [turned(-2.0, from), turned(10.0, to)]
}

/// Places that a corner on the other side of the line answers for, if they are taken to lie `off` of where they do.
fn misplaced([from, to]: Segment, off: DVec2) -> usize {
    let points = drawn(8, &[[from, to]]);
    let side = |at: DVec2| (to - from).normalize().perp_dot(at - from);
    let places = (0..48 * 48).map(|i| 1.0 + (DVec2::new((i % 48).into(), (i / 48).into()) + 0.5) / 8.0);
    let is_misplaced = |at: &DVec2| {
        let corner = points.texel(*at + 0.5 + off).as_dvec2();
        // A corner on the line is on either side.
        side(*at) * side(corner) < 0.0 && side(*at).abs() > ROUNDING && side(corner).abs() > ROUNDING
    };
    places.filter(is_misplaced).count()
}

/// SI-4: a grid that is half a texel off moves every edge by as much.
#[test]
fn half_a_texel_is_noticed() {
    let (a, b) = (line(1.7, 5.9, false), line(6.3, 2.2, true));
    for (segment, off) in [(a, DVec2::new(0.0, 0.5)), (a, DVec2::splat(-0.5)), (b, DVec2::new(0.5, 0.0))] {
        assert!(misplaced(segment, off) > 48, "{segment:?} {off}");
    }
}

#[test]
fn points_off_their_segment_and_gaps_are_noticed() {
    let segment = [DVec2::new(0.6, 1.7), DVec2::new(7.2, 5.9)];
    let sound = drawn(8, &[segment]);
    assert!(follow(&sound, segment));
    let mut moved = sound.clone();
    moved.points.iter_mut().filter(|point| point.x <= 0.5).for_each(|point| point.x += 0.5);
    assert!(!follow(&moved, segment));
    for cell in stored(&sound).into_keys() {
        let mut gap = sound.clone();
        gap.points[(cell[1] * 8 + cell[0]) as usize] = NONE.as_vec2();
        assert!(!follow(&gap, segment), "{cell:?}");
    }
}

#[test]
fn the_device_connects_the_cells_of_a_segment_too() {
    let gpu = Gpu::open().unwrap();
    let segment = |ends: [f64; 4]| [DVec2::new(ends[0], ends[1]), DVec2::new(ends[2], ends[3])];
    let segments = [
        [0.5, 0.5, 6.5, 6.5],
        [6.25, 1.0, 1.0, 6.25],
        [0.1, 1.0 / 3.0, 2.3, 2.0],
        [3.0, 0.5, 3.0, 5.5],
        [0.5, 4.0, 5.0, 4.0],
        [0.3, 7.7, 7.9, 0.2],
        [5.2, 5.3, 5.6, 5.4],
        [2.9, 2.95, 3.1, 3.05],
        [2.5, 2.5, 2.5, 2.5],
    ]
    .map(segment);
    for segment in segments {
        for cells in [8, 31] {
            let (by_device, twin) = (drawn_by(&gpu, cells, &[segment]), drawn(cells, &[segment]));
            assert!(follow(&by_device, segment) && follow(&twin, segment), "{segment:?}");
        }
    }
    // Without neighbours to connect: the smallest grids.
    for cells in [1, 2, 4] {
        let across = segment([-1.0, 0.3, 5.0, 0.7]);
        let (by_device, twin) = (drawn_by(&gpu, cells, &[across]), drawn(cells, &[across]));
        assert_eq!(
            stored(&by_device).into_keys().collect::<Vec<_>>(),
            (0..cells).map(|x| [x.into(), 0]).collect::<Vec<_>>()
        );
        let pairs = by_device.points.iter().zip(&twin.points);
        assert!(pairs.clone().all(|(a, b)| a.as_dvec2().distance(b.as_dvec2()) < ROUNDING), "{pairs:?}");
    }
}

#[test]
fn an_edge_along_a_border_is_stored_on_both_sides() {
    // Eight texels, so that their borders are exact.
    let points = stored(&drawn(7, &[[DVec2::new(3.0, 1.25), DVec2::new(3.0, 1.75)]]));
    let expected = [([2, 1], DVec2::new(1.0, 0.5)), ([3, 1], DVec2::new(0.0, 0.5))];
    assert_eq!(points, BTreeMap::from(expected));
}

#[test]
fn an_edge_shorter_than_a_texel_leaves_its_middle() {
    let points = stored(&drawn(8, &[[DVec2::new(3.25, 1.125), DVec2::new(3.75, 1.375)]]));
    assert_eq!(points, BTreeMap::from([([3, 1], DVec2::new(0.5, 0.25))]));
}

#[test]
fn of_three_edges_in_a_texel_the_last_wins() {
    let gpu = Gpu::open().unwrap();
    let corner = DVec2::new(4.25, 4.5);
    let rays = [[7.0, 1.25], [1.0, 3.5], [3.5, 7.75]].map(|[x, y]| [corner, DVec2::new(x, y)]);
    for turn in 0..3 {
        let turned = [0, 1, 2].map(|i| rays[(i + turn) % 3]);
        let alone = stored(&drawn(8, &[turned[2]]));
        for points in [drawn(8, &turned), drawn_by(&gpu, 8, &turned)] {
            let points = stored(&points);
            assert!(alone.iter().all(|(cell, point)| points[cell].distance(*point) < ROUNDING), "{turned:?}");
            assert!(points.len() > alone.len(), "the others leave theirs elsewhere");
        }
    }
}

/// Points of three by three cells, each counted from its own cell, and the picture of the middle cell under corners.
#[derive(Debug, Clone, PartialEq)]
struct Fixture {
    points: [[DVec2; 3]; 3],
    /// By row and column.
    is_dark: [[bool; 2]; 2],
    /// Dark places are #.
    picture: Vec<String>,
}

/// Samples of a cell along each axis.
const SAMPLES: usize = 6;
/// No point.
const NONE: DVec2 = DVec2::splat(2.0);

impl Fixture {
    /// By the points of the middle cell and of those left of it, above, right and below.
    fn new(dark: [&str; 2], points: [[f64; 2]; 5], picture: [&str; SAMPLES]) -> Self {
        let [own, left, top, right, bottom] = points.map(DVec2::from_array);
        let row = |row: &str| [0, 1].map(|column| &row[column..=column] == "#");
        Self {
            points: [[NONE, top, NONE], [left, own, right], [NONE, bottom, NONE]],
            is_dark: dark.map(row),
            picture: picture.map(str::to_owned).to_vec(),
        }
    }

    /// Turned by a right angle, from x to y.
    fn turned(&self) -> Self {
        let turned_point = |point: DVec2| if point == NONE { NONE } else { DVec2::new(1.0 - point.y, point.x) };
        let sample = |row: usize, column: usize| self.picture[SAMPLES - 1 - column].chars().nth(row).unwrap();
        Self {
            points: [0, 1, 2].map(|row| [0, 1, 2].map(|column| turned_point(self.points[2 - column][row]))),
            is_dark: [0, 1].map(|row| [0, 1].map(|column| self.is_dark[1 - column][row])),
            picture: (0..SAMPLES).map(|row| (0..SAMPLES).map(|column| sample(row, column)).collect()).collect(),
        }
    }

    /// With light and shadow exchanged.
    fn inverted(&self) -> Self {
        let inverted = |sample: char| if sample == '#' { '.' } else { '#' };
        Self {
            is_dark: self.is_dark.map(|row| row.map(|is_dark| !is_dark)),
            picture: self.picture.iter().map(|row| row.chars().map(inverted).collect()).collect(),
            points: self.points,
        }
    }

    /// What the middle cell answers.
    fn answered(&self) -> Vec<String> {
        let points = self.points.as_flattened().iter().map(|point| point.as_vec2()).collect();
        let points = Points { cells: UVec2::splat(3), points };
        let sample = |row: usize, column: usize| {
            let within = (DVec2::new(column as f64, row as f64) + 0.5) / SAMPLES as f64;
            let corner = points.texel(1.5 + within) - 1;
            if self.is_dark[corner.y as usize][corner.x as usize] { '#' } else { '.' }
        };
        (0..SAMPLES).map(|row| (0..SAMPLES).map(|column| sample(row, column)).collect()).collect()
    }
}

/// One for each combination of corners that is no other one turned or inverted, and two more.
fn fixtures() -> [Fixture; 6] {
    let empty = [2.0, 2.0];
    let all_lit = ["......"; SAMPLES];
    [
        // Points where nothing calls for any.
        Fixture::new(["..", ".."], [[0.2, 0.7], [0.8, 0.8], [0.1, 0.9], [0.3, 0.4], [0.9, 0.1]], all_lit),
        // Nothing known but the corners: x < 1/2, y < 1/2.
        Fixture::new(["#.", ".."], [empty; 5], ["###...", "###...", "###...", "......", "......", "......"]),
        // A straight edge: x + y < 0.6.
        Fixture::new(
            ["#.", ".."],
            [[0.3, 0.3], [0.8, 0.8], [0.8, 0.8], empty, empty],
            ["###...", "##....", "#.....", "......", "......", "......"],
        ),
        // An inward corner of the outline at (0.22, 0.22), whose edges meet those two sides of the cell at about 0.69.
        Fixture::new(
            ["#.", ".."],
            [[0.22, 0.22], [0.9, 0.9], [0.9, 0.9], empty, empty],
            ["###...", "#.....", "#.....", "......", "......", "......"],
        ),
        // A straight edge: y < 0.2 + 0.4 x.
        Fixture::new(
            ["##", ".."],
            [[0.5, 0.4], [0.75, 0.1], empty, [0.5, 0.8], empty],
            ["######", ".#####", "...###", "......", "......", "......"],
        ),
        // Two edges that cross, turned by atan(1/4).
        Fixture::new(
            ["#.", ".#"],
            [[0.5, 0.5], [0.5, 0.25], [0.75, 0.5], [0.5, 0.75], [0.25, 0.5]],
            ["####..", "###...", ".##...", "...##.", "...###", "..####"],
        ),
    ]
}

#[test]
fn all_sixteen_combinations_of_corners_are_decided() {
    let mut seen = BTreeSet::new();
    for fixture in fixtures() {
        for mut fixture in [fixture.inverted(), fixture] {
            for _ in 0..4 {
                assert_eq!(fixture.answered(), fixture.picture, "{fixture:?}");
                seen.insert(fixture.is_dark);
                fixture = fixture.turned();
            }
        }
    }
    assert_eq!(seen.len(), 16);
    // Control: other points are another picture.
    let [.., straight, _] = fixtures();
    let mut moved = straight.clone();
    moved.points[1][1].y += 0.3;
    assert_ne!(moved.answered(), straight.picture);
    assert_ne!(straight.turned(), straight, "turning changes something");
}

#[test]
fn without_points_the_nearest_centre_answers() {
    let empty = Points { cells: UVec2::splat(3), points: vec![NONE.as_vec2(); 9] };
    for (x, y, nearest) in [(0.2, 0.3, [0, 0]), (0.8, 0.3, [1, 0]), (0.7, 0.9, [1, 1]), (0.1, 0.6, [0, 1])] {
        assert_eq!((empty.texel(DVec2::new(1.5 + x, 1.5 + y)) - 1).to_array(), nearest);
    }
}
