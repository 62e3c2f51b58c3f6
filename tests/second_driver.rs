//! A second software Vulkan driver, where there is one: the same techniques come out in the same classes, up to what
//! rasterisers may do differently (docs/drivers.md). Skipped, and told, where there is none.

#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout, reason = "tests")]

use gnomon::technique::map::{bias, filter, projection};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;
use tempfile::TempDir;

/// Names the second driver's ICD file.
const VARIABLE: &str = "GNOMON_SECOND_DRIVER";
/// SwiftShader as Debian's chromium-common brings it.
const SWIFTSHADER: &str = "/usr/lib/chromium/vk_swiftshader_icd.json";

/// Families and what only they have; every part of a map joins them.
const FAMILIES: [&str; 14] = [
    "map",
    "map:size=512,filter=pcf-box3,bias=slope",
    "map:size=512,filter=pcf-bilinear3,depth_convention=forward",
    "volume",
    "volume:count=mixed",
    "volume:count=z-pass,extrude=gpu",
    "volume:extrude=degenerate-quads,range_mask=on",
    "planar",
    "projective-texture:size=512",
    "silhouette",
    "hybrid",
    "irregular",
    "ray-query",
    "map:size=512,near_mode=depth-clamp",
];

/// What is compared: each family, and a map with each projection, filter and bias.
fn specs() -> Vec<String> {
    let projections = projection::registry().iter().map(|part| format!("projection={}", part.name()));
    let filters = filter::registry().iter().map(|part| format!("filter={}", part.choice().name));
    let biases = bias::registry().iter().map(|part| format!("bias={}{SLACK}", part.name()));
    let maps = projections.chain(filters).chain(biases).map(|part| format!("map:size=512,{part}"));
    FAMILIES.into_iter().map(str::to_owned).chain(maps).collect()
}

/// A bias that follows the device's grid has more slack on a coarse one, more than hollows of the torus rise above their
/// facets' planes; so both get more than that.
const SLACK: &str = ",bias_depth_texels=0.1";

/// Pixels that rasterisers may give to another triangle or to the other side of an edge in a picture of this size:
/// vertices snap to 1/16 pixel instead of 1/256. Without a bias some more compare nearly equal depths: measured, 28.
const SNAPPED: f64 = 32.0;
/// A count of wrong pixels may change by as much where texels along edges fall otherwise.
const SHARE: f64 = 0.35;
/// Share of the asked pixels that may become undecided or another class.
const CLASSES: f64 = 0.01;

fn second_driver() -> Option<PathBuf> {
    let named = std::env::var_os(VARIABLE).map(PathBuf::from);
    named.or_else(|| Some(PathBuf::from(SWIFTSHADER))).filter(|path| path.is_file())
}

/// The runs of a report, made on the usual driver or on another.
fn runs(driver: Option<&Path>) -> Vec<Value> {
    let out = TempDir::new().unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_gnomon"));
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/torus");
    command.arg("check").arg(scene).args(["--size", "200x150", "--out"]).arg(out.path().join("r"));
    command.args(specs().iter().flat_map(|spec| ["-t", spec]));
    if let Some(driver) = driver {
        command.env("VK_DRIVER_FILES", driver);
    }
    let output = command.output().unwrap();
    let text = std::fs::read_to_string(out.path().join("r/report.json"));
    let text = text.unwrap_or_else(|_| panic!("no report: {}", String::from_utf8_lossy(&output.stderr)));
    let report: Value = serde_json::from_str(&text).unwrap();
    println!("{} {}", report["adapter"]["name"], report["adapter"]["driver"]);
    report["runs"].as_array().unwrap().clone()
}

fn number(run: &Value, of: &str, key: &str) -> f64 {
    run[of][key].as_f64().unwrap_or(0.0)
}

/// What two drivers disagree about beyond what they may.
fn disagreement(one: &Value, other: &Value) -> Option<String> {
    let what = format!("{} {}", one["light"], one["typed"]);
    if one["status"] != other["status"] {
        return Some(format!("{what}: {} and {}", one["status"], other["status"]));
    }
    let [asked, asked_there] = [one, other].map(|run| number(run, "pixels", "asked"));
    if (asked - asked_there).abs() > CLASSES * asked {
        return Some(format!("{what}: {asked} and {asked_there} asked"));
    }
    let may_differ = |a: f64, b: f64| (a - b).abs() <= SNAPPED.max(SHARE * a.max(b));
    for key in ["wrong", "false_shadow", "false_light"] {
        let [here, there] = [one, other].map(|run| number(run, "pixels", key));
        if !may_differ(here, there) {
            return Some(format!("{what}: {here} and {there} {key}"));
        }
    }
    let causes = one["causes"].as_object()?.keys().chain(other["causes"].as_object()?.keys());
    let pixels = |run: &Value, cause: &str| run["causes"][cause]["pixels"].as_f64().unwrap_or(0.0);
    let differing = causes.map(|cause| (cause, pixels(one, cause), pixels(other, cause)));
    let mut differing = differing.filter(|(_, here, there)| !may_differ(*here, *there));
    differing.next().map(|(cause, here, there)| format!("{what}: {here} and {there} px of {cause}"))
}

#[test]
fn a_second_driver_gives_the_same_classes() {
    let Some(driver) = second_driver() else {
        println!("skipped: no second driver; {VARIABLE} names its ICD file, or install chromium-common");
        return;
    };
    let (usual, second) = (runs(None), runs(Some(&driver)));
    assert_eq!(usual.len(), second.len());
    let found: Vec<String> = usual.iter().zip(&second).filter_map(|(a, b)| disagreement(a, b)).collect();
    assert_eq!(found, [""; 0]);
    // Control: another technique's figures are noticed.
    assert!(disagreement(&usual[0], &usual[1]).is_some());
}
