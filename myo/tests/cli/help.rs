//! Help, and arguments that are refused.

use std::process::Command;

use crate::{assert_refused, here, stderr, stdout};

/// The commands below one that its help lists; none for one that does something itself.
fn commands(of: &[String]) -> Vec<Vec<String>> {
    let help = stdout(&here(&[of.iter().map(String::as_str).collect(), vec!["--help"]].concat()));
    let listed = help.split_once("Commands:\n").map_or("", |(_, rest)| rest.split("\n\n").next().unwrap());
    // A long explanation goes on below, further to the right.
    let names = listed.lines().filter(|line| line.starts_with("  ") && !line.starts_with("   "));
    let names = names.map(|line| line.split_whitespace().next().unwrap()).filter(|name| *name != "help");
    names.map(|name| [of, &[name.to_owned()]].concat()).collect()
}

#[test]
fn every_command_explains_itself_with_an_example() {
    let (mut left, mut explained) = (commands(&[]), Vec::new());
    while let Some(command) = left.pop() {
        let below = commands(&command);
        if below.is_empty() {
            explained.push(command);
        }
        left.extend(below);
    }
    for command in &explained {
        let args: Vec<&str> = command.iter().map(String::as_str).chain(["--help"]).collect();
        let (help, line) = (stdout(&here(&args)), format!("myo {}", command.join(" ")));
        let (_, examples) = help.split_once("Example").unwrap_or_else(|| panic!("{line} has no example: {help}"));
        assert!(examples.contains(&line), "{line}: {help}");
    }
    assert!(explained.len() >= 17, "{explained:?}");
    assert!(stdout(&here(&["--help"])).contains("myo train pointing"));
}

#[test]
fn wrong_usage_has_status_2() {
    for args in [&["train"][..], &["fly"], &["train", "ar", "--steps", "0"], &["eval", "x", "--episodes", "-1"], &[]] {
        assert_eq!(here(args).status.code(), Some(2), "{args:?}");
    }
}

#[test]
fn unknown_names_get_the_nearest_ones() {
    assert_refused(&here(&["train", "pontin"]), "did you mean `pointing`");
    assert_refused(&here(&["task", "show", "mobile"]), "did you mean `mobile-typing`");
    assert_refused(&here(&["model", "show", "mobl-arm"]), "did you mean `mobl-arms`");
    assert_refused(&here(&["train", "ar", "--set", "discount=1"]), "did you mean `discount_per_s`");
}

#[test]
fn numbers_that_nobody_can_mean_are_refused() {
    let greatest = u64::MAX.to_string();
    for args in [
        &["train", "ar", "--envs", "0"][..],
        &["train", "ar", "--seeds", "0"],
        &["train", "ar", "--seed", "-1"],
        &["train", "ar", "--steps", "1e30"],
        &["train", "ar", "--until", "nan"],
        &["train", "ar", "--threads", &greatest],
        &["eval", "run", "--episodes", "0"],
    ] {
        let output = here(args);
        assert_eq!(output.status.code(), Some(2), "{args:?}: {}", stderr(&output));
        let value = args.last().unwrap();
        assert!(stderr(&output).contains(&format!("'{value}'")), "{args:?}: {}", stderr(&output));
    }
}

/// Otherwise the program would compute with another level than it was asked for, and not say so.
#[test]
fn every_command_refuses_a_level_that_there_is_not() {
    let with = |level: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_myo"));
        command.args(["task", "list"]).env("MYO_LEVEL", level).output().expect("the program starts")
    };
    let sentence =
        "MYO_LEVEL is \"avx\", which is no level; levels are portable, avx2, avx512, and this processor has portable";
    assert_refused(&with("avx"), sentence);
    assert_eq!(with("avx").stdout, b"");
    assert_eq!(stdout(&with("portable")), stdout(&with("")));
}
