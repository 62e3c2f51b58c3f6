//! `gnomon sweep` and `gnomon merge`: whatever ends a sweep, it ends up with the same results.

use crate::support::{MODEL, SCENE, command, gnomon_in, runs, scene_in_temp};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::Stdio;
use std::time::Duration;
use tempfile::TempDir;

const MAPS: &str = "map:size=16..128,filter=nearest|pcf-box3,bias=none|closed-form";
const VOLUMES: &str = "volume:count=z-pass|z-fail";
/// 4 sizes × 2 filters × 2 biases + 2 counts, for two lights.
const ROWS: usize = 2 * (4 * 2 * 2 + 2);

fn args<'a>(out: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    [&["sweep", "scene", "--grid", MAPS, "--grid", VOLUMES, "--out", out], more].concat()
}

/// The rows of a results.jsonl without its times, in the order of the sweep.
fn rows(folder: &Path) -> Vec<Value> {
    let text = fs::read_to_string(folder.join("results.jsonl")).unwrap();
    let mut rows: Vec<Value> =
        text.lines().skip(1).map(|line| without_times(serde_json::from_str(line).unwrap())).collect();
    rows.sort_by_key(|row| row["row"].as_u64());
    rows
}

fn without_times(mut value: Value) -> Value {
    match &mut value {
        Value::Object(fields) => {
            fields.retain(|key, _| key != "ms" && !key.ends_with("_ms") && !key.starts_with("ms_"));
            fields.values_mut().for_each(|field| *field = without_times(field.take()));
        }
        Value::Array(items) => items.iter_mut().for_each(|item| *item = without_times(item.take())),
        _ => {}
    }
    value
}

#[test]
fn a_sweep_leaves_rows_fronts_and_plots_and_counts_the_same_work_every_time() {
    let folder = scene_in_temp();
    gnomon_in(folder.path(), &args("a", &[])).returns(0).says(&["36 rows, 0 failed", "wrote a/fronts.csv"]);
    let out = folder.path().join("a");
    let found = rows(&out);
    assert_eq!(found.len(), ROWS);
    assert!(found.iter().enumerate().all(|(index, row)| row["row"] == index && row["run"]["status"] == "ok"));
    assert_eq!(runs(&out).len(), ROWS);
    assert_eq!(fs::read_to_string(out.join("results.csv")).unwrap().lines().count(), 1 + ROWS);
    let fronts = fs::read_to_string(out.join("fronts.csv")).unwrap();
    assert!(fronts.lines().filter(|line| line.starts_with("scene,lamp,work,")).count() >= 2, "{fronts}");
    let plot = fs::read_to_string(out.join("scene.lamp.work.svg")).unwrap();
    assert!(plot.contains("wrong pixels of those asked") && plot.contains("volume"));
    // Counted work and everything else but times is the same again; and nothing is measured twice in one folder.
    gnomon_in(folder.path(), &args("b", &[])).returns(0);
    assert_eq!(rows(&folder.path().join("b")), found);
    let bytes = fs::read(out.join("results.jsonl")).unwrap();
    gnomon_in(folder.path(), &args("a", &[])).returns(0);
    assert_eq!(fs::read(out.join("results.jsonl")).unwrap(), bytes);
}

#[test]
fn a_sweep_that_is_killed_twenty_times_ends_as_if_it_never_was() {
    let folder = scene_in_temp();
    gnomon_in(folder.path(), &args("whole", &[])).returns(0);
    let whole = rows(&folder.path().join("whole"));
    // A multiplicative sequence: moments spread over what a sweep takes, always the same.
    let mut moment = 7_u64;
    let mut torn = 0;
    for _ in 0..20 {
        moment = moment * 48_271 % 2_147_483_647;
        let mut child = command();
        child.current_dir(folder.path()).args(args("killed", &[])).stdout(Stdio::null()).stderr(Stdio::null());
        let mut child = child.spawn().unwrap();
        std::thread::sleep(Duration::from_millis(100 + moment % 400));
        child.kill().unwrap();
        child.wait().unwrap();
        // A crash may also tear the line at hand, which a killed process alone rarely does.
        let file = folder.path().join("killed/results.jsonl");
        if let Ok(bytes) = fs::read(&file)
            && moment.is_multiple_of(3)
            && bytes.iter().filter(|byte| **byte == b'\n').count() > 2
        {
            fs::write(&file, &bytes[..bytes.len() - 1 - (moment % 50) as usize]).unwrap();
            torn += 1;
        }
    }
    gnomon_in(folder.path(), &args("killed", &[])).returns(0);
    assert_eq!(rows(&folder.path().join("killed")), whole);
    assert!(torn > 0 || whole.len() == ROWS);
}

#[test]
fn shards_merged_are_the_whole() {
    let folder = scene_in_temp();
    gnomon_in(folder.path(), &args("whole", &["--truth-cache", "truth"])).returns(0);
    for (shard, out) in [("3/3", "c"), ("1/3", "a"), ("2/3", "b")] {
        gnomon_in(folder.path(), &args(out, &["--shard", shard, "--truth-cache", "truth"])).returns(0);
        assert_eq!(rows(&folder.path().join(out)).len(), ROWS / 3);
    }
    gnomon_in(folder.path(), &["merge", "a", "b", "c", "--out", "merged"]).returns(0).says(&["36 rows"]);
    assert_eq!(rows(&folder.path().join("merged")), rows(&folder.path().join("whole")));
    // Control: two of three shards are not the whole.
    gnomon_in(folder.path(), &["merge", "a", "c", "--out", "less"]).returns(0);
    assert_ne!(rows(&folder.path().join("less")), rows(&folder.path().join("whole")));
    assert_eq!(fs::read_dir(folder.path().join("truth")).unwrap().count(), 2, "one truth per light, for all");
}

#[test]
fn a_damaged_or_foreign_truth_is_noticed_and_worked_out_again() {
    let folder = scene_in_temp();
    let sweep = |out: &str| {
        gnomon_in(folder.path(), &["sweep", "scene", "--grid", "map:size=64", "--truth-cache", "truth", "--out", out])
            .returns(0)
    };
    sweep("a");
    let files = || -> Vec<_> {
        let mut files: Vec<_> =
            fs::read_dir(folder.path().join("truth")).unwrap().map(|file| file.unwrap().path()).collect();
        files.sort();
        files
    };
    let kept: Vec<Vec<u8>> = files().iter().map(|file| fs::read(file).unwrap()).collect();
    assert_eq!(sweep("b").stderr, "", "whole entries are used");
    // A flipped byte in one entry; the other entry under its neighbour's name.
    let mut flipped = kept[0].clone();
    let middle = flipped.len() / 2;
    flipped[middle] ^= 1;
    fs::write(&files()[0], &flipped).unwrap();
    fs::write(&files()[1], &kept[0]).unwrap();
    sweep("c").complains(&["it is damaged", "it answers another question", "worked out again"]);
    assert_eq!(rows(&folder.path().join("c")), rows(&folder.path().join("a")));
    assert_eq!(sweep("d").stderr, "", "and kept again");
}

#[test]
fn what_a_row_may_not_take_is_a_failed_row() {
    let folder = scene_in_temp();
    let grid = ["sweep", "scene", "--light", "sun", "--grid", "map:size=64|1024", "--out"];
    let call = |out: &str, limit: [&str; 2]| gnomon_in(folder.path(), &[&grid[..], &[out], &limit].concat()).returns(4);
    call("small", ["--row-megabytes", "1"]).says(&["2 rows, 1 failed"]);
    let found = rows(&folder.path().join("small"));
    assert_eq!((&found[0]["run"]["status"], &found[1]["run"]["status"]), (&"ok".into(), &"failed".into()));
    assert!(found[1]["run"]["why"].as_str().unwrap().contains("MB on the GPU, more than 1"));
    call("hasty", ["--row-seconds", "0"]).says(&["2 rows, 2 failed"]);
    assert!(rows(&folder.path().join("hasty"))[0]["run"]["why"].as_str().unwrap().contains("longer than 0 s"));
}

#[test]
fn results_of_something_else_are_left_alone() {
    let folder = TempDir::new().unwrap();
    crate::support::write_scene(folder.path(), "scene", SCENE);
    fs::write(folder.path().join("scene/model.obj"), MODEL).unwrap();
    fs::create_dir(folder.path().join("out")).unwrap();
    let file = folder.path().join("out/results.jsonl");
    fs::write(&file, "{\"mine\": 1}\n").unwrap();
    gnomon_in(folder.path(), &args("out", &[])).returns(2).complains(&["results.jsonl", "line 1 is no row"]);
    assert_eq!(fs::read_to_string(&file).unwrap(), "{\"mine\": 1}\n");
    gnomon_in(folder.path(), &args("new", &["--shard", "4/3"])).returns(2).complains(&["is not like 1/3"]);
    gnomon_in(folder.path(), &["sweep", "scene", "--grid", "map:size=3..1", "--out", "new"])
        .returns(2)
        .complains(&["is no range"]);
    assert!(!folder.path().join("new").exists());
}
