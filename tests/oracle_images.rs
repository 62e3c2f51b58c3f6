//! Our pictures against those of a renderer nobody here wrote: the same camera, lights and units. `make oracle` installs
//! it.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout, reason = "tests")]

mod support;

use serde_json::Value;
use std::process::Command;
use support::scenes::folder_of;

/// The rows of compare.json.
fn compared(scene: &str, options: &[&str]) -> Vec<Value> {
    let out = tempfile::tempdir().unwrap();
    let run = Command::new(env!("CARGO_BIN_EXE_gnomon"))
        .arg("compare-render")
        .arg(folder_of(scene))
        .args(options)
        .arg("--out")
        .arg(out.path())
        .output()
        .unwrap();
    println!("{}{}", String::from_utf8_lossy(&run.stdout), String::from_utf8_lossy(&run.stderr));
    let rows: Vec<Value> = serde_json::from_slice(&std::fs::read(out.path().join("compare.json")).unwrap()).unwrap();
    let differs = rows.iter().any(|row| row["shadows"] == "truth" && above(row) > 0);
    assert_eq!(run.status.code(), Some(i32::from(differs)));
    rows
}

fn above(row: &Value) -> usize {
    row["above"].as_array().unwrap().len()
}

#[test]
fn radiance_is_the_same_at_every_pixel_away_from_edges() {
    for scene in ["triangle", "torus", "room", "contact", "bunny"] {
        let rows = compared(scene, &["--size", "384x288"]);
        assert!(!rows.is_empty());
        for row in rows {
            assert_eq!(above(&row), 0, "{row}");
            assert!(row["compared"].as_u64().unwrap() > 10_000, "{row}");
            // FLIP sees the pixels at edges as well; they are few.
            assert!(row["flip"]["mean"].as_f64().unwrap() < 0.01, "{row}");
        }
    }
}

#[test]
fn area_lights_radiance_is_the_same_but_for_chance() {
    let rows = compared("area", &["--size", "160x120", "-t", "volume", "-t", "soft:samples=36"]);
    assert_eq!(rows.len(), 6);
    for row in rows.iter().filter(|row| row["shadows"] == "truth") {
        assert_eq!(above(row), 0, "{row}");
    }
    // A light taken for its centre is noticed, so the test has teeth.
    assert!(rows.iter().filter(|row| row["shadows"] == "volume").all(|row| above(row) > 100), "{rows:?}");
}

#[test]
fn a_technique_that_errs_away_from_edges_is_noticed() {
    let rows = compared("triangle", &["--size", "384x288", "--light", "lamp", "-t", "map:size=64,bias=none"]);
    assert_eq!((above(&rows[0]), rows[1]["shadows"].as_str()), (0, Some("map:size=64,bias=none")));
    assert!(above(&rows[1]) > 1000, "{}", rows[1]);
}
