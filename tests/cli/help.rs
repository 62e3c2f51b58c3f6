//! Help and version: every command has an example, and every example is one that gnomon understands.

use crate::check::RUN_KEYS;
use crate::support::{gnomon, typed};

const COMMANDS: [&str; 16] = [
    "check",
    "compare",
    "sweep",
    "merge",
    "advise",
    "bench-published",
    "render",
    "truth",
    "mask",
    "judge",
    "inspect",
    "explain",
    "diagnose",
    "scaffold",
    "list",
    "doctor",
];

#[test]
fn help_names_every_command_and_every_command_has_an_example() {
    let overview = typed("--help").returns(0).says(&["Exit codes: 0 ", "130 interrupted", "GNOMON_ADAPTER"]);
    for command in COMMANDS {
        assert!(overview.stdout.contains(&format!("\n  {command} ")), "{command}");
        let help = typed(&format!("{command} --help")).returns(0);
        assert!(
            help.stdout.contains("Example") && help.stdout.contains(&format!("gnomon {command}")),
            "{}",
            help.stdout
        );
    }
    let listed = overview.stdout.lines().skip_while(|line| *line != "Commands:").skip(1);
    let listed = listed.take_while(|line| !line.is_empty()).count();
    assert_eq!(listed, COMMANDS.len() + 1, "the list above is complete, but for help itself");
}

/// Whether gnomon understands the words of an example: it may fail to find a file, but not to read its arguments.
fn is_understood(example: &str) -> bool {
    let words: Vec<&str> = example.split_whitespace().skip(1).collect();
    // A shell would take the quotes off.
    let nowhere = words
        .iter()
        .map(|word| word.trim_matches('\'').replace("scenes/", "no/such/").replace("model", "no/such/model"));
    let call = gnomon(&nowhere.collect::<Vec<_>>());
    !call.stderr.contains("Usage:") && !call.stderr.contains("unknown technique") && !call.stderr.contains("parameter")
}

#[test]
fn examples_are_understood() {
    for command in COMMANDS {
        let help = typed(&format!("{command} --help")).stdout;
        let examples: Vec<&str> = help.lines().filter(|line| line.starts_with("  gnomon ")).collect();
        assert!(!examples.is_empty(), "{command}");
        for example in examples {
            assert!(is_understood(example), "{example}");
        }
    }
    assert!(!is_understood("gnomon check scenes/torus --nonsense"));
    assert!(!is_understood("gnomon check scenes/torus -t map:nonsense=1"));
}

#[test]
fn the_handbook_names_every_command_exit_code_and_key_and_its_examples_are_understood() {
    let handbook = include_str!("../../docs/commands.md");
    let examples: Vec<&str> = handbook.lines().filter_map(|line| line.trim_start().strip_prefix("$ ")).collect();
    for command in COMMANDS {
        assert!(handbook.contains(&format!("| `{command}")), "{command}");
        let is_of_it = |example: &&str| example.split(' ').nth(1) == Some(command);
        assert!(examples.iter().any(is_of_it), "no example of {command}");
    }
    for example in examples {
        assert!(is_understood(example), "{example}");
    }
    for code in [0, 1, 2, 3, 4, 130] {
        assert!(handbook.contains(&format!("\n| {code} | ")), "{code}");
    }
    for key in RUN_KEYS {
        assert!(handbook.contains(&format!("`{key}`")), "{key}");
    }
}

#[test]
fn the_version_is_the_packages() {
    assert_eq!(typed("--version").returns(0).stdout, format!("gnomon {}\n", env!("CARGO_PKG_VERSION")));
}
