//! `gnomon advise` and `gnomon bench-published`.

use crate::support::{gnomon_in, scene_in_temp, shell, typed};
use std::path::Path;

const GRID: [&str; 4] = ["--grid", "map:size=16..1024,filter=nearest|pcf-box3", "--grid", "volume:count=z-fail|z-pass"];

fn advise(folder: &Path, more: &[&str]) -> crate::support::Call {
    gnomon_in(folder, &[&["advise", "scene", "--light", "sun"], more].concat())
}

#[test]
fn it_answers_with_a_configuration_that_keeps_to_the_budget_and_the_command_that_shows_it() {
    let folder = scene_in_temp();
    let call = advise(folder.path(), &[&["--max-wrong", "1%"], &GRID[..]].concat()).returns(0);
    let call = call.says(&["at most 1 % wrong", "of 16 configurations tried", "counted work", "texel phases"]);
    assert!(call.after("next cheaper").starts_with("map:size="), "{}", call.stdout);
    call.stdout.lines().find(|line| line.contains("because of")).unwrap();
    // The command given measures what was said.
    let command = call.stdout.lines().find(|line| line.contains("gnomon check")).unwrap().trim();
    let answer = call.stdout.lines().skip_while(|line| !line.starts_with("answer")).nth(1).unwrap();
    let share = answer.split_whitespace().next().unwrap().parse::<f64>().unwrap();
    assert!(share <= 1.0, "{answer}");
    let shown = shell(folder.path(), command).returns(0);
    let mean = shown.stdout.lines().find(|line| line.contains("texel phases")).unwrap();
    let mean = mean.split("phases: ").nth(1).unwrap().split(' ').next().unwrap().parse::<f64>().unwrap();
    assert!((mean - share).abs() <= 0.01 * share, "{mean} and {share}");
}

#[test]
fn without_an_answer_it_names_the_closest_and_what_is_wrong_with_it() {
    let folder = scene_in_temp();
    let only_maps = ["--max-wrong", "0", "--grid", "map:size=16..64"];
    let call = advise(folder.path(), &only_maps).returns(1).says(&["answer        none", "because of "]);
    assert!(call.after("closest").starts_with("map:size=64"), "{}", call.stdout);
}

#[test]
fn it_says_what_the_scene_rules_out() {
    let call = typed("advise scenes/pipe --max-wrong 1% --size 48x36 --grid map:size=64 --grid planar --grid volume");
    call.returns(0)
        .says(&["answer        volume", "left out      map (1 configurations): the receivers span 317 degrees"]);
}

#[test]
fn published_experiments_are_repeated_with_their_errors() {
    let call = typed("bench-published --size 32x24").returns(0);
    let says =
        ["frame cost against map size", "volumes against maps", "× 3.13", "% wrong", "published conclusions hold here"];
    call.says(&says);
}
