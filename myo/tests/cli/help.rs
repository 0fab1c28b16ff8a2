//! Help, and arguments that are refused.

use crate::{assert_refused, here, stderr, stdout};

#[test]
fn every_command_explains_itself_with_an_example() {
    for command in [
        "train",
        "eval",
        "devices",
        "task list",
        "task show",
        "task check",
        "task schema",
        "model list",
        "model show",
        "model export",
        "bench physics",
        "bench env",
        "bench train",
        "bench kernel",
        "bench nan",
        "completions",
        "man",
    ] {
        let args: Vec<&str> = command.split(' ').chain(["--help"]).collect();
        let help = stdout(&here(&args));
        assert!(help.contains("Example") && help.contains(&format!("myo {command}")), "{command}: {help}");
    }
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
