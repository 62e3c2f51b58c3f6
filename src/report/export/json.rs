//! report.json: the model, key by key.
//!
//! Numbers are written with the fewest digits that read back as the same f64.

use super::ExportError;
use crate::report::Report;

/// The report as indented JSON.
///
/// # Errors
/// None that a report of this type can cause; the JSON library's are passed on.
pub fn to_json(report: &Report) -> Result<Vec<u8>, ExportError> {
    let mut bytes = serde_json::to_vec_pretty(report)?;
    bytes.push(b'\n');
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::model::tests::{HOSTILE, report, report_of};
    use serde_json::{Value, json};

    fn parsed(report: &Report) -> Value {
        serde_json::from_slice(&to_json(report).unwrap()).unwrap()
    }

    fn keys(object: &Value) -> Vec<&str> {
        object.as_object().unwrap().keys().map(String::as_str).collect()
    }

    /// Keys in the order in which they are written.
    fn written_keys(text: &str, indent: usize) -> Vec<String> {
        let start = format!("{}\"", " ".repeat(indent));
        let keys = text.lines().filter_map(|line| line.strip_prefix(&start)?.split_once("\": "));
        keys.map(|(key, _)| key.to_owned()).collect()
    }

    const RUN_KEYS: [&str; 19] = [
        "scene",
        "light",
        "typed",
        "technique",
        "command",
        "status",
        "why",
        "image",
        "wrong_above",
        "pixels",
        "error",
        "causes",
        "cost",
        "truth",
        "budget",
        "jitter",
        "motion",
        "seams",
        "bias",
    ];

    #[test]
    fn the_keys_are_the_documented_ones_in_their_order() {
        let text = String::from_utf8(to_json(&report()).unwrap()).unwrap();
        assert_eq!(written_keys(&text, 2), ["schema", "tool", "adapter", "runs"]);
        let run_keys = written_keys(&text, 6);
        assert_eq!(run_keys.len(), 3 * RUN_KEYS.len(), "every run has every key");
        assert!(run_keys.chunks(RUN_KEYS.len()).all(|keys| keys == RUN_KEYS));

        let run = &parsed(&report())["runs"][0];
        let mut pixel_keys = keys(&run["pixels"]);
        pixel_keys.sort_unstable();
        let mut documented = [
            "total",
            "background",
            "facing_away",
            "not_lit",
            "undecided",
            "asked",
            "wrong",
            "differing",
            "false_shadow",
            "false_light",
        ];
        documented.sort_unstable();
        assert_eq!(pixel_keys, documented);
        let counted = ["background", "facing_away", "not_lit", "undecided", "asked"];
        let sum: u64 = counted.iter().map(|key| run["pixels"][key].as_u64().unwrap()).sum();
        assert_eq!(Some(sum), run["pixels"]["total"].as_u64());
        assert_eq!(
            keys(&run["error"]),
            ["edge_distance_px", "largest_blob_px", "mean_abs", "signed", "wrong_fraction"]
        );
        assert_eq!(run["causes"]["acne"], json!({"pixels": 2, "sum": -2.1}));
        assert_eq!(
            keys(&run["cost"]),
            [
                "bytes",
                "fragments",
                "gbuffer_ms",
                "gpu_ms",
                "passes",
                "prepare_ms",
                "primitives",
                "texel_reads",
                "vertices"
            ]
        );
        assert_eq!(keys(&run["cost"]["gpu_ms"]), ["max", "median", "min", "runs"]);
        assert_eq!(run["cost"]["passes"], json!([{"name": "map", "ms": 0.75, "ms_min": 0.5, "ms_max": 1.0}]));
        assert_eq!(run["truth"]["disagreements"], json!({"mitsuba": null, "brute": 0}));
        let budget = json!({"wrong_fraction": 0.001, "mean_abs": null, "met": false, "met_worst_case": false});
        assert_eq!(run["budget"], budget);
        assert_eq!(keys(&run["jitter"]["wrong_fraction"]), ["max", "mean", "min", "stddev"]);
        assert_eq!(keys(&run["motion"]), ["camera_flips", "followed", "light_flips", "steps"]);
        assert_eq!(run["motion"]["camera_flips"]["mean"], json!(2.0));
        assert_eq!(run["seams"]["views"][0], json!({"name": "near", "asked": 2, "wrong": 2, "mean_abs": 1.0}));
        let bin = json!({"from_texels": 2.0, "to_texels": 4.0, "asked": 5, "wrong": 1, "mean_abs": 0.2});
        assert_eq!(run["seams"]["distances"][2], bin);
        let of_view = [
            "acne_free",
            "along_light",
            "along_light_depth",
            "along_normal",
            "contact_gap",
            "receivers",
            "stored",
            "view",
        ];
        assert_eq!(keys(&run["bias"][0]), of_view);
        assert_eq!(run["bias"][0]["along_light"]["texels"], json!({"min": 1.0, "median": 1.0, "max": 1.0}));
    }

    #[test]
    fn figures_that_do_not_apply_are_null() {
        let json = parsed(&report());
        assert_eq!(json["runs"][1]["status"], "unsupported");
        assert_eq!(json["runs"][2]["status"], "failed");
        for key in ["pixels", "error", "causes", "cost", "truth", "budget", "jitter", "motion", "seams"] {
            assert!(json["runs"][0][key].is_object(), "{key}");
        }
        assert!(json["runs"][0]["bias"].is_array());
        for key in RUN_KEYS.into_iter().skip_while(|key| *key != "pixels") {
            assert!(json["runs"][1][key].is_null() && json["runs"][2][key].is_null(), "{key}");
        }
        assert!(json["runs"][0]["why"].is_null());
        assert_eq!(json["runs"][0]["error"]["edge_distance_px"], Value::Null, "a picture without an edge has none");
    }

    #[test]
    fn numbers_read_back_as_they_were() {
        let mut report = report();
        let numbers = [0.1 + 0.2, 1.0 / 3.0, 5e-324, f64::MAX, 1e-7, 123_456_789.123_456_79];
        for number in numbers {
            report.runs[0].error.as_mut().unwrap().mean_abs = Some(number);
            let read = parsed(&report)["runs"][0]["error"]["mean_abs"].as_f64().unwrap();
            assert_eq!(read.to_bits(), number.to_bits());
        }
        report.runs[0].pixels.as_mut().unwrap().total = u64::MAX;
        assert_eq!(parsed(&report)["runs"][0]["pixels"]["total"].as_u64(), Some(u64::MAX));
    }

    #[test]
    fn hostile_names_come_back_unchanged() {
        let json = parsed(&report_of(HOSTILE));
        assert_eq!(json["runs"][0]["scene"], HOSTILE);
    }
}
