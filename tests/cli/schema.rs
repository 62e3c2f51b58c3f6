//! Real reports are what docs/report.schema.json says they are.

use crate::support::{gnomon_in, report, scene_in_temp, write_scene};
use jsonschema::Validator;
use serde_json::{Value, json};
use std::fs;
use std::path::Path;

fn schema() -> Validator {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/report.schema.json");
    jsonschema::validator_for(&serde_json::from_slice(&fs::read(file).unwrap()).unwrap()).unwrap()
}

/// Every way in which a report is not what the schema says.
fn violations(report: &Value) -> Vec<String> {
    schema().iter_errors(report).map(|error| format!("{}: {error}", error.instance_path())).collect()
}

/// A report with a judged, a budgeted, a jittered and an unsupported run.
fn real_report() -> Value {
    let folder = scene_in_temp();
    let budget = "\n[[budget]]\ntechnique = \"map:size=64\"\nwrong_fraction = 0.5\n";
    write_scene(folder.path(), "other", &format!("{}{budget}", crate::support::SCENE));
    let args = [
        "check",
        "scene",
        "other",
        "-t",
        "map:size=64",
        "-t",
        "planar",
        "-t",
        "map:projection=cube,size=64",
        "--jitter",
        "2",
        "--out",
        "out",
    ];
    gnomon_in(folder.path(), &args).returns(0);
    report(&folder.path().join("out"))
}

#[test]
fn a_real_report_is_valid_and_a_changed_one_is_not() {
    let report = real_report();
    assert_eq!(violations(&report), [""; 0]);
    let status =
        |wanted: &str| report["runs"].as_array().unwrap().iter().position(|run| run["status"] == wanted).unwrap();
    let (ok, unsupported) = (status("ok"), status("unsupported"));
    assert!(
        ["budget", "seams"].iter().all(|key| report["runs"].as_array().unwrap().iter().any(|run| !run[key].is_null()))
    );
    // Controls: each change is one that a reader would stumble over.
    let controls = [
        ("/schema".to_owned(), json!(2)),
        (format!("/runs/{ok}/status"), json!("good")),
        (format!("/runs/{ok}/pixels/wrong"), json!(-1)),
        (format!("/runs/{ok}/pixels"), Value::Null),
        (format!("/runs/{ok}/error/wrong_fraction"), json!(1.5)),
        (format!("/runs/{ok}/causes"), json!({"bad-luck": {"pixels": 1, "sum": 0.5}})),
        (format!("/runs/{ok}/cost/bytes"), json!("many")),
        (format!("/runs/{unsupported}/why"), Value::Null),
        (format!("/runs/{unsupported}/image"), json!([64])),
    ];
    for (at, value) in controls {
        let mut changed = report.clone();
        *changed.pointer_mut(&at).unwrap() = value;
        assert_ne!(violations(&changed), [""; 0], "{at}");
    }
    let mut extended = report.clone();
    extended["runs"][ok]["mood"] = json!("fine");
    assert_ne!(violations(&extended), [""; 0], "a key that nobody documented");
    let mut shortened = report;
    shortened["runs"][ok].as_object_mut().unwrap().remove("cost");
    assert_ne!(violations(&shortened), [""; 0], "a key that is missing");
}
