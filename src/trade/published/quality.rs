//! What filtering buys, and how the families compare.

use super::lab::{Lab, LabError};
use super::{Experiment, Row, is_like, times};
use crate::scene::Scene;
use crate::technique::Spec;

/// A filter's kernels, unfiltered first.
const FILTERS: [&str; 3] = ["nearest", "pcf-box3", "pcf-box5"];
/// Published frames per second of map, volume and silhouette map in three scenes.
const SEN: [(&str, [f64; 3]); 3] =
    [("CROWD", [11.5, 9.2, 9.5]), ("JEEP", [75.0, 72.0, 58.0]), ("CASTLE", [97.0, 95.0, 80.0])];

/// Percentage-closer filtering at one map size.
pub(super) fn filters(lab: &Lab<'_>, scenes: &[Scene]) -> Result<Experiment, LabError> {
    let typed = FILTERS.map(|filter| format!("map:size=512,filter={filter}"));
    let samples = lab.samples(&scenes[0], &typed)?;
    let mut rows: Vec<Row> = typed
        .iter()
        .zip(&samples)
        .map(|(typed, sample)| Row {
            what: typed.clone(),
            published: "edges look smoother, at more cost".to_owned(),
            here: sample.over(&samples[0]),
            error: sample.error(),
            holds: None,
        })
        .collect();
    let [first, .., last] = &samples[..] else { return Ok(Experiment { title: "", source: "", rows }) };
    rows.push(Row {
        what: "filtered edges are nearer to the truth".to_owned(),
        published: "looks so".to_owned(),
        here: format!(
            "wrong × {}, mean |e| × {}",
            times(last.wrong / first.wrong),
            times(last.mean_abs / first.mean_abs)
        ),
        error: String::new(),
        holds: Some(last.wrong <= first.wrong),
    });
    let source = "W. Reeves, D. Salesin, R. Cook, Rendering Antialiased Shadows with Depth Maps, 1987";
    Ok(Experiment { title: "percentage-closer filtering", source, rows })
}

/// Map, volume and silhouette map.
pub(super) fn techniques(lab: &Lab<'_>, scenes: &[Scene]) -> Result<Experiment, LabError> {
    let known = |typed: &&str| Spec::parse(typed).is_ok();
    let typed: Vec<String> = ["map:size=1024", "volume", "silhouette:size=1024"]
        .iter()
        .filter(|t| known(t))
        .map(|t| (*t).to_owned())
        .collect();
    let samples = lab.measure(&scenes[0], &typed)?;
    let published = |technique: usize| {
        let ratios = SEN.map(|(scene, fps)| format!("{scene} {}", times(fps[0] / fps[technique])));
        ratios.join(", ")
    };
    let rows = typed.iter().zip(&samples).enumerate().map(|(index, (typed, sample))| {
        let base = samples[0].as_ref().ok();
        Row {
            what: format!("{typed} over the map"),
            published: published(index),
            here: sample.as_ref().ok().zip(base).map_or_else(String::new, |(own, base)| own.over(base)),
            error: sample.as_ref().map_or_else(|why| format!("not applicable: {why}"), super::lab::Sample::error),
            holds: None,
        }
    });
    let mut rows: Vec<Row> = rows.collect();
    if let [Ok(map), _, Ok(silhouette)] = &samples[..] {
        let ratio = lab.cost(silhouette) / lab.cost(map);
        let slowest = SEN.map(|(_, fps)| fps[0] / fps[2]).into_iter().fold(0.0, f64::max);
        let conclusion = |what: &str, published: String, here: String, holds: bool| Row {
            what: what.to_owned(),
            published,
            here,
            error: String::new(),
            holds: Some(holds),
        };
        rows.push(conclusion(
            "a silhouette map costs little more than a map",
            format!("× {} at most", times(slowest)),
            format!("× {}", times(ratio)),
            is_like(slowest, ratio),
        ));
        rows.push(conclusion(
            "and has no staircase",
            "looks so".to_owned(),
            format!("wrong × {}", times(silhouette.wrong / map.wrong)),
            silhouette.wrong < map.wrong,
        ));
    }
    let source = "P. Sen, M. Cammarano, P. Hanrahan, Shadow Silhouette Maps, 2003";
    Ok(Experiment { title: "map, volume, silhouette map", source, rows })
}
