//! `gnomon compare`: what changed between two reports.

use crate::support::{gnomon_in, report, scene_in_temp};
use std::fs;

#[test]
fn it_tells_what_changed_and_fails_on_a_regression() {
    let folder = scene_in_temp();
    for (out, technique) in [("a", "map:size=64"), ("b", "map:size=64")] {
        gnomon_in(folder.path(), &["check", "scene", "-t", technique, "--light", "sun", "--out", out]).returns(0);
    }
    gnomon_in(folder.path(), &["compare", "a", "b/report.json"]).returns(0).says(&["1 runs, 1 of them unchanged"]);
    // A worse report: more wrong pixels of a cause, twice the fragments.
    let mut worse = report(&folder.path().join("b"));
    let run = &mut worse["runs"][0];
    let share = run["error"]["wrong_fraction"].as_f64().unwrap();
    run["error"]["wrong_fraction"] = (share + 0.01).into();
    run["pixels"]["wrong"] = (run["pixels"]["wrong"].as_u64().unwrap() + 20).into();
    run["causes"]["acne"] = serde_json::json!({"pixels": 20, "sum": -20.0});
    run["cost"]["fragments"] = (2 * run["cost"]["fragments"].as_u64().unwrap()).into();
    fs::write(folder.path().join("worse.json"), worse.to_string()).unwrap();
    let says = ["REGRESSION scene / sun", "acne +20", "fragments × 2", "1 % more of the asked pixels are wrong"];
    gnomon_in(folder.path(), &["compare", "a", "worse.json"]).returns(1).says(&says);
    let tolerant = ["compare", "a", "worse.json", "--max-new-wrong", "2%", "--max-work-ratio", "2"];
    gnomon_in(folder.path(), &tolerant).returns(0).says(&["changed    scene / sun"]);
    gnomon_in(folder.path(), &["compare", "worse.json", "a"]).returns(0);
    fs::write(folder.path().join("no.json"), "{}").unwrap();
    gnomon_in(folder.path(), &["compare", "a", "no.json"]).returns(2).complains(&["is no report of gnomon's"]);
    gnomon_in(folder.path(), &["compare", "a", "nothing"]).returns(2).complains(&["nothing: cannot be read"]);
}
