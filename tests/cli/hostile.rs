//! Names that break whoever does not quote them: suggested commands run as meant, and files stay where they belong.

#![cfg(unix)]

use crate::support::{SCENE, gnomon_in, runs, shell, tree, write_scene};
use tempfile::TempDir;

/// A folder's name that would make a file `pwned` in an unquoted command, and lights that look like other things.
const FOLDER: &str = "a b;$(touch pwned)'`touch pwned`";
const LIGHTS: [&str; 3] = ["it's; ünïcode $HOME", "--jitter", ".."];

fn hostile_scene() -> TempDir {
    let folder = TempDir::new().unwrap();
    let [first, second, third] = LIGHTS;
    let mut scene = SCENE.replace("\"lamp\"", &format!("\"{first}\"")).replace("\"sun\"", &format!("\"{second}\""));
    scene += &format!("[[light]]\nname = \"{third}\"\nkind = \"directional\"\ndirection = [1, -2, 0]\n");
    write_scene(folder.path(), FOLDER, &scene);
    folder
}

#[test]
fn reported_and_suggested_commands_run_as_they_stand() {
    let folder = hostile_scene();
    let args = ["check", FOLDER, "-t", "map:size=8,bias=none", "--size", "32x24", "--out", "out"];
    let call = gnomon_in(folder.path(), &args).returns(0);
    let reported = runs(&folder.path().join("out"));
    assert_eq!(reported.len(), LIGHTS.len());
    for (run, light) in reported.iter().zip(LIGHTS) {
        let again = shell(folder.path(), &format!("{} --out again", run["command"].as_str().unwrap())).returns(0);
        assert_eq!(again.stderr, "");
        let again = runs(&folder.path().join("again"));
        assert_eq!((again.len(), &again[0]["light"]), (1, &light.into()));
        assert_eq!(again[0]["pixels"], run["pixels"]);
    }
    let diagnosed = shell(folder.path(), call.after("next step:")).returns(0);
    shell(folder.path(), diagnosed.after("look closer:")).returns(0).says(&["verdict: wrong"]);
    shell(folder.path(), diagnosed.after("next step:")).returns(0);
    let made: Vec<String> = tree(folder.path()).into_iter().filter(|path| !path.contains('/')).collect();
    assert_eq!(made, [FOLDER, "again", "out"], "nothing in a name was run");
}

#[test]
fn pictures_stay_in_their_folder() {
    let folder = hostile_scene();
    let args = ["check", FOLDER, "-t", "map:size=8", "--size", "32x24", "--out", "out"];
    gnomon_in(folder.path(), &args).returns(0);
    let pictures: Vec<String> = tree(folder.path()).into_iter().filter(|path| path.ends_with(".error.png")).collect();
    assert_eq!(pictures.len(), LIGHTS.len());
    for picture in pictures {
        let name = picture.strip_prefix("out/").unwrap_or_else(|| panic!("{picture} is elsewhere"));
        assert!(!name.starts_with('.') && !name.contains(['/', '$', ';', '\'', '`', ' ']), "{name}");
    }
}
