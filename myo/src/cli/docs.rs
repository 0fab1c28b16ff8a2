//! Tests: every command in the documents and in `--help` is one that this command line understands.

// The test that runs the commands uses the rest.
#[allow(dead_code)]
#[path = "../../tests/documented/mod.rs"]
mod documented;

use clap::error::ErrorKind;
use clap::{CommandFactory, Parser};

use super::Cli;
use documented::{commands, documents, filled_in};

/// Fails for words after `myo` that the command line would not understand.
fn check(place: &str, words: &[String]) {
    let all = [&["myo".to_owned()], words].concat();
    match Cli::try_parse_from(&all).err().map(|error| (error.kind(), error)) {
        None | Some((ErrorKind::DisplayHelp | ErrorKind::DisplayVersion, _)) => {}
        Some((_, error)) => panic!("{place}: {error}"),
    }
}

/// Whether words name a command and say nothing more, as in "`myo train` leaves a run folder".
fn names_command(words: &[String]) -> bool {
    words.iter().try_fold(Cli::command(), |command, word| command.find_subcommand(word).cloned()).is_some()
}

#[test]
fn documented_commands_are_understood() {
    let mut checked = 0;
    for (file, text) in documents() {
        for documented in commands(&file, &text) {
            let Some(words) = documented.myo() else { continue };
            if documented.in_block || !names_command(words) {
                let words = if documented.in_block { words.to_vec() } else { filled_in(words) };
                check(&documented.place, &words);
            }
            checked += 1;
        }
    }
    assert!(checked > 15, "only {checked} commands were found");
}

#[test]
fn examples_in_help_are_understood() {
    fn check_below(command: &clap::Command) -> usize {
        let help = command.get_after_help().map(ToString::to_string).unwrap_or_default();
        let examples = help.lines().filter_map(|line| line.strip_prefix("  myo "));
        let checked = examples.map(|example| {
            // An example may be followed by its purpose, two or more spaces away.
            let typed = example.split("  ").next().unwrap().split(['>', '|']).next().unwrap();
            let words = shlex::split(typed).unwrap();
            check(example, &words);
        });
        checked.count() + command.get_subcommands().map(check_below).sum::<usize>()
    }
    let checked = check_below(&Cli::command());
    assert!(checked > 25, "only {checked} examples were found");
}

#[test]
fn mentioned_options_exist() {
    fn options(command: &clap::Command) -> Vec<String> {
        let own = command.get_arguments().filter_map(|arg| Some(format!("--{}", arg.get_long()?)));
        own.chain(command.get_subcommands().flat_map(options)).collect()
    }
    let known = options(&Cli::command());
    for (file, text) in documents() {
        for code in text.split('`').filter(|code| code.starts_with("--") && code.len() > 3) {
            let option = code.split([' ', '=']).next().unwrap();
            assert!(known.iter().any(|known| known == option), "{file}: no command has `{option}`");
        }
    }
}

#[test]
fn what_is_no_command_is_noticed() {
    for words in ["fly", "train ar --wings", "train", "train ar --steps 0"] {
        let words: Vec<String> = words.split(' ').map(String::from).collect();
        assert!(std::panic::catch_unwind(|| check("here", &words)).is_err(), "{words:?}");
    }
    let [known, unknown] =
        ["task check", "task fly"].map(|words| words.split(' ').map(String::from).collect::<Vec<_>>());
    assert!(names_command(&known) && !names_command(&unknown));
}
