//! `gnomon check`: table, report, pictures, budgets.

use crate::support::{MODEL, SCENE, gnomon_in, report, runs, scene_in_temp, tree, typed, write_scene};
use serde_json::Value;
use std::{fs, path::Path};
use tempfile::TempDir;

/// Sums of f64 contributions against a mean times a count: both round a few thousand times.
const SUM_TOLERANCE: f64 = 1e-6;

/// The keys of a run, sorted.
pub(crate) const RUN_KEYS: [&str; 19] = [
    "bias",
    "budget",
    "causes",
    "command",
    "cost",
    "error",
    "image",
    "jitter",
    "light",
    "motion",
    "pixels",
    "scene",
    "seams",
    "status",
    "technique",
    "truth",
    "typed",
    "why",
    "wrong_above",
];

#[test]
fn it_prints_a_table_and_writes_nothing_unless_told_where() {
    let folder = scene_in_temp();
    let before = tree(folder.path());
    let call = gnomon_in(folder.path(), &["check", "scene", "-t", "map:size=64"]).returns(0);
    assert_eq!(tree(folder.path()), before);
    assert_eq!(call.stderr, "");
    let call = call.says(&[
        "scene / lamp   64 × 48",
        "scene / sun   64 × 48",
        "wrong px",
        "map:size=64",
        "perspective-aliasing",
    ]);
    assert!(call.after("next step:").starts_with("gnomon diagnose scene -t map:size=64 --light "), "{}", call.stdout);
    assert!(call.after("pictures:").ends_with("--size 64x48 --out out"), "{}", call.stdout);
}

#[test]
fn the_report_has_the_documented_keys_and_its_sums_add_up() {
    let out = TempDir::new().unwrap();
    let command = format!("check scenes/torus -t map:size=64,bias=none --size 64x48 --out {}", out.path().display());
    typed(&command).returns(0).says(&["wrote ", "report.json"]);
    let report = report(out.path());
    assert_eq!(report["schema"], 1);
    assert_eq!(report["tool"]["name"], "gnomon");
    assert_eq!(report["tool"]["version"], env!("CARGO_PKG_VERSION"));
    ["name", "backend", "driver", "features", "software"]
        .iter()
        .for_each(|key| assert!(!report["adapter"][key].is_null()));
    let lights: Vec<&Value> = report["runs"].as_array().unwrap().iter().map(|run| &run["light"]).collect();
    assert_eq!(lights, ["lamp", "sun"]);
    for run in report["runs"].as_array().unwrap() {
        assert_eq!(run.as_object().unwrap().keys().collect::<Vec<_>>(), RUN_KEYS);
        assert_eq!((&run["status"], &run["scene"]), (&"ok".into(), &"torus".into()));
        assert_eq!(run["image"], serde_json::json!([64, 48]));
        assert!(run["technique"].as_str().unwrap().contains("filter=nearest"), "every parameter is spelled out");
        let count = |key: &str| run["pixels"][key].as_u64().unwrap();
        let kinds = ["background", "facing_away", "not_lit", "undecided", "asked"];
        assert_eq!(kinds.map(count).iter().sum::<u64>(), count("total"));
        assert_eq!(count("total"), 64 * 48);
        assert_eq!(count("false_shadow") + count("false_light"), count("wrong"));
        assert!(count("wrong") > 0, "a map of 64 texels without bias is wrong somewhere");
        assert_causes_add_up(run);
        assert_eq!(run["truth"]["disagreements"]["brute"], 0);
        assert!(run["cost"]["bytes"].as_u64().unwrap() >= 64 * 64 * 4);
    }
}

fn assert_causes_add_up(run: &Value) {
    let causes = run["causes"].as_object().unwrap().values();
    let sum: f64 = causes.clone().map(|cause| cause["sum"].as_f64().unwrap()).sum();
    let error = run["error"]["signed"].as_f64().unwrap() * run["pixels"]["asked"].as_f64().unwrap();
    assert!((sum - error).abs() <= SUM_TOLERANCE, "{sum} and {error}");
    let pixels: u64 = causes.map(|cause| cause["pixels"].as_u64().unwrap()).sum();
    assert_eq!(Some(pixels), run["pixels"]["wrong"].as_u64());
}

#[test]
#[should_panic(expected = "and")]
fn a_changed_sum_does_not_add_up() {
    let cause = serde_json::json!({"acne": {"pixels": 1, "sum": -0.5}});
    assert_causes_add_up(&serde_json::json!({
        "causes": cause, "error": {"signed": -0.1}, "pixels": {"asked": 10, "wrong": 1}
    }));
}

#[test]
fn the_same_input_gives_the_same_bytes_but_for_times() {
    let folder = scene_in_temp();
    for out in ["a", "b"] {
        gnomon_in(folder.path(), &["check", "scene", "-t", "map:size=128", "--jitter", "2", "--out", out]).returns(0);
    }
    let (a, b) = (folder.path().join("a"), folder.path().join("b"));
    assert_eq!(without_times(report(&a)), without_times(report(&b)));
    assert_eq!(tree(&a), tree(&b));
    for file in tree(&a).iter().filter(|file| file.ends_with(".png")) {
        assert!(fs::read(a.join(file)).unwrap() == fs::read(b.join(file)).unwrap(), "{file}");
    }
    let mut changed = report(&b);
    changed["runs"][0]["error"]["signed"] = 2.into();
    assert_ne!(without_times(report(&a)), without_times(changed), "what is no time counts");
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
fn pictures_are_named_after_scene_light_and_place_in_the_report() {
    let folder = scene_in_temp();
    gnomon_in(folder.path(), &["check", "scene", "-t", "map:size=64", "-t", "map:size=32", "--out", "out"]).returns(0);
    let out = folder.path().join("out");
    for (index, run) in runs(&out).iter().enumerate() {
        let picture = format!("scene.{}.{index}.error.png", run["light"].as_str().unwrap());
        let picture = image::open(out.join(&picture)).unwrap_or_else(|error| panic!("{picture}: {error}"));
        assert!(picture.width() >= 3 * 64, "truth, technique and error stand side by side");
    }
    assert_eq!(tree(&out).iter().filter(|name| name.ends_with(".error.png")).count(), 4);
    assert_only_results(&out);
}

/// Nothing but the report's files and pictures named `<scene>.<light>.<n>.<kind>.png`.
fn assert_only_results(out: &Path) {
    let runs = runs(out).len();
    for name in tree(out) {
        let parts: Vec<&str> = name.split('.').collect();
        let is_picture = |index: &str| index.parse::<usize>().is_ok_and(|index| index < runs);
        let is_ours = match parts[..] {
            ["report", _] => true,
            [_, _, index, _, "png"] => is_picture(index),
            _ => false,
        };
        assert!(is_ours, "{name}");
    }
}

#[test]
fn further_formats_stand_beside_the_report() {
    let folder = scene_in_temp();
    let args = ["check", "scene", "-t", "map:size=64", "--out", "deep/out", "--format", "csv,markdown,junit"];
    gnomon_in(folder.path(), &args).returns(0);
    let out = folder.path().join("deep/out");
    let file = |name: &str| fs::read_to_string(out.join(name)).unwrap();
    assert_eq!(file("report.csv").lines().count(), 1 + 2, "a head and two lights");
    assert!(file("report.md").contains("map:size=64"));
    assert!(file("report.xml").contains("<testsuite"));
    assert_only_results(&out);
}

#[test]
fn jitter_reports_a_spread_and_does_not_follow_into_other_commands() {
    let folder = scene_in_temp();
    let args = ["check", "scene", "-t", "map:size=64", "--light", "sun", "--jitter", "3", "--out", "out"];
    let call = gnomon_in(folder.path(), &args).returns(0);
    let run = &runs(&folder.path().join("out"))[0];
    assert_eq!(run["jitter"]["phases"], 3);
    let figure = |key: &str| run["jitter"]["wrong_fraction"][key].as_f64().unwrap();
    assert!(figure("min") <= figure("mean") && figure("mean") <= figure("max"));
    assert!(figure("max") > 0.0 && figure("stddev") >= 0.0);
    assert!(run["command"].as_str().unwrap().ends_with("--jitter 3"), "{}", run["command"]);
    assert!(!call.after("next step:").contains("jitter"), "diagnose takes no --jitter");
    call.says(&["\n  jitter  3 texel phases: ", " % wrong on average, "]);
}

#[test]
fn several_scenes_and_techniques_are_reported_in_the_order_typed() {
    let folder = scene_in_temp();
    write_scene(folder.path(), "other", SCENE);
    let args = ["check", "other", "scene", "-t", "map:size=64", "-t", "map:size=32", "--light", "sun", "--out", "out"];
    gnomon_in(folder.path(), &args).returns(0);
    let runs = runs(&folder.path().join("out"));
    let run: Vec<String> =
        runs.iter().map(|run| format!("{} {}", run["scene"], run["typed"]).replace('"', "")).collect();
    assert_eq!(run, ["other map:size=64", "other map:size=32", "scene map:size=64", "scene map:size=32"]);
}

#[test]
fn a_bare_obj_is_a_scene_of_its_own() {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("model.obj"), MODEL).unwrap();
    gnomon_in(folder.path(), &["check", "model.obj", "--size", "64x48"]).returns(0).says(&["model / sun", "map"]);
    assert_eq!(tree(folder.path()), ["model.obj"]);
}

#[test]
fn a_technique_that_does_not_apply_is_a_row_and_no_failure() {
    let out = TempDir::new().unwrap();
    let call = typed(&format!("check scenes/pipe -t map --size 32x24 --out {}", out.path().display())).returns(0);
    call.says(&["not applicable: the receivers span", "no pixel was compared in any run"]);
    let run = &runs(out.path())[0];
    assert_eq!(run["status"], "unsupported");
    assert!(run["why"].as_str().unwrap().contains("317 degrees") && run["pixels"].is_null());
}

#[test]
fn a_picture_of_one_pixel_and_one_where_nothing_is_asked_are_legal() {
    let folder = scene_in_temp();
    gnomon_in(folder.path(), &["check", "scene", "-t", "map:size=8", "--size", "1x1"]).returns(0);
    let away = SCENE.replace("target = [0, 0.5, 0]", "target = [0, 9, 0]");
    write_scene(folder.path(), "sky", &away);
    let call = gnomon_in(folder.path(), &["check", "sky", "-t", "map:size=8"]).returns(0);
    call.says(&["0 asked", "no pixel was compared in any run"]);
}

#[test]
fn a_budget_exceeded_is_exit_code_1_and_every_budget_binds() {
    let folder = scene_in_temp();
    let budget = |limit: &str| format!("[[budget]]\ntechnique = \"map:size=16\"\n{limit}\n");
    let generous = budget("wrong_fraction = 0.9");
    let impossible = format!("{generous}{}", budget("light = \"sun\"\nmean_abs = 0.0"));
    write_scene(folder.path(), "generous", &format!("{SCENE}{generous}"));
    write_scene(folder.path(), "impossible", &format!("{SCENE}{impossible}"));
    gnomon_in(folder.path(), &["check", "generous"]).returns(0).says(&["met"]);
    gnomon_in(folder.path(), &["check", "generous", "impossible", "--out", "out"]).returns(1).says(&["EXCEEDED"]);
    let budgets: Vec<Value> = runs(&folder.path().join("out")).iter().map(|run| run["budget"].clone()).collect();
    assert_eq!(budgets.len(), 4, "two budgets on one technique are one run");
    let met: Vec<&Value> = budgets.iter().map(|budget| &budget["met"]).collect();
    assert_eq!(met, [true, true, true, false]);
    assert_eq!((&budgets[3]["wrong_fraction"], &budgets[3]["mean_abs"]), (&0.9.into(), &0.0.into()));
    // The budget binds its technique however that is spelled, and no other.
    let spelled = ["check", "impossible", "--light", "sun", "-t", "map:filter=nearest,size=16"];
    gnomon_in(folder.path(), &spelled).returns(1);
    gnomon_in(folder.path(), &["check", "impossible", "--light", "sun", "-t", "map:size=17"]).returns(0);
}

#[test]
fn warnings_are_told_once_and_name_the_scene() {
    let folder = TempDir::new().unwrap();
    write_scene(folder.path(), "warned", &SCENE.replace("[2, 5, 1]", "[2, 0, 1]"));
    let call = gnomon_in(folder.path(), &["check", "warned", "-t", "map:size=8", "--light", "sun"]).returns(0);
    assert_eq!(call.stderr.matches("lies exactly").count(), 1, "{}", call.stderr);
    call.complains(&["warning: scene 'warned': light `lamp`"]);
}
