//! Files and pipes that end early: full disks, limits, readers that go away.

#![cfg(unix)]

use crate::support::{SCENE, command, runs, scene_in_temp, shell, tree, write_scene};
use std::fs;
use std::process::Stdio;

/// The shell's words for: no file may grow beyond one block.
const TINY_FILES: &str = "ulimit -f 1;";

#[test]
fn a_file_that_cannot_be_completed_is_an_error_and_leaves_nothing() {
    let folder = scene_in_temp();
    for line in [
        "gnomon check scene -t map:size=8 --light sun --out out",
        "gnomon render scene --size 256x192 -o out/x.png",
        "gnomon truth scene --light sun --size 256x192 -o out/x.exr",
    ] {
        let call = shell(folder.path(), &format!("{TINY_FILES} {line}")).returns(2);
        call.complains(&["error: ", "out/", "could not be written"]);
        assert_eq!(tree(folder.path()).iter().filter(|path| path.starts_with("out/")).count(), 0, "{line}");
    }
}

#[test]
fn a_file_that_cannot_be_replaced_stays_as_it_was() {
    let folder = scene_in_temp();
    fs::write(folder.path().join("x.exr"), "before").unwrap();
    let line = format!("{TINY_FILES} gnomon truth scene --light sun --size 256x192 -o x.exr");
    shell(folder.path(), &line).returns(2);
    assert_eq!(fs::read_to_string(folder.path().join("x.exr")).unwrap(), "before");
    shell(folder.path(), "gnomon truth scene --light sun -o x.exr").returns(0);
    assert!(fs::read(folder.path().join("x.exr")).unwrap().len() > 6, "without the limit it is");
}

#[test]
fn a_standard_output_that_is_full_is_told() {
    let folder = scene_in_temp();
    let call = shell(folder.path(), "gnomon list techniques > /dev/full").returns(2);
    call.complains(&["standard output cannot be written"]);
}

#[test]
fn a_reader_that_goes_away_ends_a_command_quietly() {
    let folder = scene_in_temp();
    let call = shell(folder.path(), "gnomon list techniques | head -1").returns(0).says(&["map: "]);
    assert_eq!(call.stderr, "");
}

#[test]
fn a_reader_that_goes_away_costs_neither_files_nor_exit_code() {
    let folder = scene_in_temp();
    let budget = "[[budget]]\ntechnique = \"map:size=8\"\nlight = \"sun\"\nmean_abs = 0.0\n";
    write_scene(folder.path(), "strict", &format!("{SCENE}{budget}"));
    let mut check = command();
    check.args(["check", "strict", "--light", "sun", "--out", "out"]).current_dir(folder.path());
    let mut child = check.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!((output.status.code(), output.stderr.as_slice()), (Some(1), &b""[..]));
    assert_eq!(runs(&folder.path().join("out")).len(), 1);
}
