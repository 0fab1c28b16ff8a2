//! The page of commands: what the program says about itself.

use std::fmt::Write;
use std::process::Command;

/// Help of the program and of all its commands, one section each.
pub fn page() -> String {
    let mut page = String::from("# Command line\n\nWhat `myo help COMMAND` prints.\n");
    section(&[], &mut page);
    page
}

fn section(command: &[&str], page: &mut String) {
    let help = help(command);
    let name = [&["myo"], command].concat().join(" ");
    write!(page, "\n## `{name}`\n\n```text\n{}\n```\n", help.trim_end()).unwrap();
    for sub in subcommands(&help) {
        section(&[command, &[sub]].concat(), page);
    }
}

fn help(command: &[&str]) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_myo")).args(command).arg("--help").output().unwrap();
    assert!(output.status.success(), "`myo {} --help` failed", command.join(" "));
    let text = String::from_utf8(output.stdout).unwrap();
    text.lines().map(|line| line.trim_end().to_owned() + "\n").collect()
}

/// The names under `Commands:`, `help` aside.
fn subcommands(help: &str) -> impl Iterator<Item = &str> {
    let list = help.split_once("\nCommands:\n").map_or("", |(_, rest)| rest);
    let lines = list.lines().take_while(|line| !line.is_empty());
    let names = lines.filter(|line| line.starts_with("  ") && !line.starts_with("   "));
    names.filter_map(|line| line.split_whitespace().next()).filter(|&name| name != "help")
}
