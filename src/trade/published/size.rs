//! What a map's size costs, and when volumes are cheaper than maps.
//!
//! M. Brasas, master's thesis, Kaunas University of Technology, 2010, measured on a GeForce GTX 260 at 1024 × 768.

use super::lab::{Lab, LabError, Sample};
use super::{Experiment, Row, is_like, times};
use crate::scene::Scene;

const SOURCE: &str = "M. Brasas, master's thesis, Kaunas 2010 (GeForce GTX 260, 1024 x 768)";
/// Sizes, and published frame times over that of 128 for a light and a heavy scene.
const FRAME_COST: [(u32, f64, f64); 7] = [
    (128, 1.0, 1.0),
    (256, 1.0, 1.0),
    (512, 1.02, 1.02),
    (1024, 1.14, 1.03),
    (2048, 1.29, 1.05),
    (4096, 3.12, 1.13),
    (8192, 12.0, 2.31),
];
/// Published ratio of the last two sizes, the light scene's and the heavy one's.
const LAST_DOUBLING: [f64; 2] = [3.84, 2.06];
/// Polygons, and published milliseconds of volumes and of maps of the [`MAPS`].
const VOLUMES_AND_MAPS: [(u32, f64, [f64; 3]); 3] =
    [(14, 0.577, [0.580, 0.649, 1.961]), (32, 1.156, [0.628, 0.672, 2.070]), (69, 1.805, [0.658, 0.709, 2.268])];
const MAPS: [u32; 3] = [1024, 2048, 4096];

/// Frame cost against the map's size.
pub(super) fn frame_cost(lab: &Lab<'_>, scenes: &[Scene]) -> Result<Experiment, LabError> {
    let typed: Vec<String> = FRAME_COST.iter().map(|(size, ..)| format!("map:size={size}")).collect();
    let samples = lab.samples(&scenes[0], &typed)?;
    let mut rows: Vec<Row> = FRAME_COST
        .iter()
        .zip(&samples)
        .map(|((size, light, heavy), sample)| Row {
            what: format!("map {size} over map 128"),
            published: format!("× {} … {}", times(*heavy), times(*light)),
            here: sample.over(&samples[0]),
            error: sample.error(),
            holds: None,
        })
        .collect();
    let cost: Vec<f64> = samples.iter().map(|sample| lab.cost(sample)).collect();
    let last = cost[6] / cost[5];
    let conclusions = [
        (
            "flat up to 512",
            "at most × 1.02".to_owned(),
            cost[2] / cost[0],
            cost[2] / cost[0] <= 1.02 * super::TOLERANCE,
        ),
        (
            "a knee, then towards × 4 per doubling",
            format!("4096 → 8192 × {} … {}", LAST_DOUBLING[1], LAST_DOUBLING[0]),
            last,
            LAST_DOUBLING.iter().any(|published| is_like(*published, last)),
        ),
    ];
    rows.extend(conclusions.into_iter().map(|(what, published, ratio, holds)| Row {
        what: what.to_owned(),
        published,
        here: format!("× {}", times(ratio)),
        error: String::new(),
        holds: Some(holds),
    }));
    let wrong = |index: usize| format!("{:.4} %", 100.0 * samples[index].wrong);
    rows.push(Row {
        what: "a larger map is a better map".to_owned(),
        published: "assumed, never measured".to_owned(),
        here: format!("{} wrong at 128, {} at 8192", wrong(0), wrong(6)),
        error: String::new(),
        holds: Some(samples.is_sorted_by(|a, b| a.wrong >= b.wrong)),
    });
    Ok(Experiment { title: "frame cost against map size", source: SOURCE, rows })
}

/// Volumes against maps as polygons grow. Theirs were volumes per polygon; silhouette volumes stand beside them.
pub(super) fn volumes_and_maps(lab: &Lab<'_>, scenes: &[Scene]) -> Result<Experiment, LabError> {
    let volumes = ["volume:shape=per-triangle", "volume"].map(str::to_owned);
    let maps = MAPS.map(|size| format!("map:size={size}"));
    let typed = [&volumes[..], &maps].concat();
    let mut rows = Vec::new();
    let mut measured: Vec<Vec<Sample>> = Vec::new();
    for ((polygons, volume_ms, map_ms), scene) in VOLUMES_AND_MAPS.iter().zip(&scenes[1..4]) {
        let samples = lab.samples(scene, &typed)?;
        for (index, map_ms) in map_ms.iter().enumerate() {
            rows.push(Row {
                what: format!("{polygons} polygons: volumes over map {}", MAPS[index]),
                published: format!("× {}", times(volume_ms / map_ms)),
                here: samples[0].over(&samples[2 + index]),
                error: format!("volumes {}; map {}", samples[0].error(), samples[2 + index].error()),
                holds: None,
            });
        }
        measured.push(samples);
    }
    rows.extend(conclusions(lab, &measured));
    Ok(Experiment { title: "volumes against maps", source: SOURCE, rows })
}

/// What was concluded from 14, 32 and 69 polygons, held against the same here.
fn conclusions(lab: &Lab<'_>, measured: &[Vec<Sample>]) -> Vec<Row> {
    let cost = |scene: usize, technique: usize| lab.cost(&measured[scene][technique]);
    let growth = |technique: usize| cost(2, technique) / cost(0, technique);
    let over_map = |scene: usize, map: usize| cost(scene, 0) / cost(scene, 2 + map);
    let row = |what: &str, published: &str, here: String, holds: bool| Row {
        what: what.to_owned(),
        published: published.to_owned(),
        here,
        error: String::new(),
        holds: Some(holds),
    };
    let at_4096: Vec<f64> = (0..3).map(|scene| over_map(scene, 2)).collect();
    vec![
        row(
            "volumes grow with the polygons, 14 to 69",
            "× 3.13",
            format!("× {}", times(growth(0))),
            is_like(3.13, growth(0)),
        ),
        row("maps hardly do", "× 1.13", format!("× {}", times(growth(2))), is_like(1.13, growth(2))),
        row(
            "volumes over map 1024 grow with the polygons",
            "× 1.00 → 2.74",
            format!("× {} → {}", times(over_map(0, 0)), times(over_map(2, 0))),
            over_map(0, 0) < over_map(1, 0) && over_map(1, 0) < over_map(2, 0),
        ),
        row(
            "at 4096 volumes are cheaper in every scene",
            "× 0.29, 0.56, 0.80",
            at_4096.iter().map(|ratio| format!("× {}", times(*ratio))).collect::<Vec<_>>().join(", "),
            at_4096.iter().all(|ratio| *ratio < 1.0),
        ),
        row(
            "silhouette volumes grow less than those of every polygon",
            "expected, not measured",
            format!("× {} against × {}", times(growth(1)), times(growth(0))),
            growth(1) < growth(0),
        ),
    ]
}
