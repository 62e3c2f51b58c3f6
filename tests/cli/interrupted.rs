//! Ctrl-C in the middle: what is done is kept, nothing half-written stays, the exit code says so.

use crate::support::{SCENE, command, runs, scene_in_temp, tree, write_scene};
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, ChildStderr, Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// What no check takes, however busy the machine: a hang, not slowness.
const HANG: Duration = Duration::from_secs(300);

fn start(folder: &Path, args: &[&str]) -> (Child, BufReader<ChildStderr>) {
    let mut check = command();
    check.args(args).current_dir(folder).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = check.spawn().unwrap();
    let stderr = BufReader::new(child.stderr.take().unwrap());
    (child, stderr)
}

fn interrupt(child: &Child) {
    let status = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(status.success());
}

/// Reads standard error up to a line with `word`.
fn wait_for(stderr: &mut BufReader<ChildStderr>, word: &str) {
    let mut line = String::new();
    while !line.contains(word) {
        line.clear();
        assert_ne!(stderr.read_line(&mut line).unwrap(), 0, "ended without '{word}'");
    }
}

fn ends_with_130(mut child: Child) {
    let ended = child.wait().unwrap();
    assert_eq!(ended.code(), Some(130), "{ended}");
}

/// A check that takes minutes, and that warns once it reads its scene.
fn endless() -> (TempDir, Child, BufReader<ChildStderr>) {
    let folder = TempDir::new().unwrap();
    write_scene(folder.path(), "warned", &SCENE.replace("[2, 5, 1]", "[2, 0, 1]"));
    let args = ["check", "warned", "--light", "sun", "--size", "512x384", "--jitter", "1024", "--out", "out"];
    let (child, mut stderr) = start(folder.path(), &args);
    wait_for(&mut stderr, "warning");
    (folder, child, stderr)
}

#[test]
fn finished_runs_are_reported_and_no_other_leaves_files() {
    let folder = scene_in_temp();
    let techniques: Vec<String> = (1..=400).map(|size| format!("-tmap:size={size}")).collect();
    let mut args = vec!["check", "scene", "--light", "sun", "--out", "out"];
    args.extend(techniques.iter().map(String::as_str));
    let (child, mut stderr) = start(folder.path(), &args);
    let first = folder.path().join("out/scene.sun.0.error.png");
    let began = Instant::now();
    while !first.exists() {
        assert!(began.elapsed() < HANG, "no picture appears");
        std::thread::sleep(Duration::from_millis(5));
    }
    interrupt(&child);
    wait_for(&mut stderr, "interrupted: finishing what is begun");
    wait_for(&mut stderr, "error: scene 'scene': interrupted");
    ends_with_130(child);
    let out = folder.path().join("out");
    let finished = runs(&out);
    assert!((1..techniques.len()).contains(&finished.len()), "{} of {}", finished.len(), techniques.len());
    assert!(finished.iter().all(|run| run["status"] == "ok"));
    let errors = tree(&out).iter().filter(|name| name.ends_with(".error.png")).count();
    assert_eq!(errors, finished.len(), "pictures of finished runs only");
    assert!(tree(&out).iter().all(|name| name == "report.json" || name.ends_with(".png")), "{:?}", tree(&out));
}

#[test]
fn before_the_first_run_is_done_nothing_is_written() {
    let (folder, child, mut stderr) = endless();
    interrupt(&child);
    wait_for(&mut stderr, "error: scene 'warned': interrupted");
    ends_with_130(child);
    assert!(tree(folder.path()).iter().all(|path| path.starts_with("warned")), "{:?}", tree(folder.path()));
}

#[test]
fn a_second_interrupt_ends_at_once() {
    let (_folder, child, mut stderr) = endless();
    interrupt(&child);
    wait_for(&mut stderr, "once more ends at once");
    interrupt(&child);
    ends_with_130(child);
}
