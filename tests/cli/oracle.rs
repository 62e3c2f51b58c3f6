//! The second oracle from the command line: what it reports, and what happens where it is missing.

use crate::support::{gnomon_in, gnomon_with, runs, scene_in_temp, typed};
use std::fs;
use tempfile::TempDir;

#[test]
fn a_missing_oracle_is_told_in_one_line_and_ends_with_code_3() {
    let folder = TempDir::new().unwrap();
    let image = folder.path().join("t.png").display().to_string();
    for command in ["truth", "compare-render"] {
        let mut args = vec![command, "scenes/triangle", "--light", "lamp", "--size", "16x12"];
        if command == "truth" {
            args.extend(["--oracle", "both", "-o", &image]);
        }
        let call = gnomon_with(&[("GNOMON_ORACLE", "/nowhere")], &args).returns(3).complains(&["run `make oracle`"]);
        assert_eq!(call.stderr.lines().filter(|line| line.starts_with("error: Mitsuba")).count(), 1, "{}", call.stderr);
    }
    assert!(!folder.path().join("t.png").exists());
}

#[test]
fn every_answer_of_the_oracle_is_in_the_report() {
    let out = TempDir::new().unwrap();
    for oracle in ["both", "mitsuba"] {
        let folder = out.path().join(oracle);
        let line = format!(
            "check scenes/triangle --light lamp --size 64x48 -t map:size=64 --oracle {oracle} --out {}",
            folder.display()
        );
        typed(&line).returns(0).says(&["differs from the exact truth on 0 of"]);
        let run = &runs(&folder)[0];
        assert_eq!(run["truth"]["oracle"], if oracle == "both" { "exact" } else { "mitsuba" });
        assert_eq!(run["truth"]["disagreements"]["mitsuba"], 0);
        assert_eq!(run["truth"]["mitsuba"]["rays"], run["truth"]["rays"]);
        assert_eq!(run["truth"]["mitsuba"]["listed"].as_array().map(Vec::len), Some(0));
        assert!(run["command"].as_str().unwrap().ends_with(&format!("--oracle {oracle}")), "{}", run["command"]);
    }
}

#[test]
fn nothing_beside_a_scene_is_executed() {
    let folder = scene_in_temp();
    for place in [".", "scene"] {
        let bin = folder.path().join(place).join("oracle/.venv/bin");
        fs::create_dir_all(&bin).unwrap();
        fs::write(bin.parent().unwrap().join("installed-requirements.txt"), "").unwrap();
        let marker = folder.path().join("executed");
        fs::write(bin.join("python"), format!("#!/bin/sh\ntouch {}\n", marker.display())).unwrap();
        #[cfg(unix)]
        fs::set_permissions(bin.join("python"), std::os::unix::fs::PermissionsExt::from_mode(0o755)).unwrap();
    }
    gnomon_in(
        folder.path(),
        &["truth", "scene", "--light", "lamp", "--size", "16x12", "--oracle", "both", "-o", "t.png"],
    )
    .returns(0);
    assert!(!folder.path().join("executed").exists());
}

#[test]
fn a_profile_has_every_pixel_of_its_line_and_the_predicted_width() {
    let out = TempDir::new().unwrap();
    let call = typed(&format!(
        "profile scenes/area --light panel -t soft:samples=36 --size 512x384 --line 230,250,420,300 --out {}",
        out.path().display()
    ));
    let call = call.returns(0).says(&["truth [m] technique predicted", "profile.csv", "profile.svg"]);
    let row: Vec<f64> = call.stdout.lines().nth(2).unwrap().split_whitespace().filter_map(|w| w.parse().ok()).collect();
    let [_, _, truth, technique, predicted] = row[..] else { panic!("{row:?}") };
    assert!((truth - technique).abs() < 0.02 && (truth / predicted - 1.0).abs() < 0.3, "{row:?}");
    let table = fs::read_to_string(out.path().join("profile.csv")).unwrap();
    assert_eq!(table.lines().count(), 1 + 191);
    assert!(fs::read_to_string(out.path().join("profile.svg")).unwrap().starts_with("<svg"));
    typed("profile scenes/area --light panel -t soft --line 0,0,9999,0").returns(2).complains(&["outside the picture"]);
    typed("profile scenes/area --light panel -t soft --line 1,2,3").returns(2).complains(&["is not like"]);
}
