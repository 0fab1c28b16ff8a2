//! The reference pages of `docs/reference` are made from the code and may not drift from it.
//!
//! `MYO_BLESS=1 cargo test -p myo --test reference` writes them anew.

mod commands;
mod schema;

use std::path::Path;

/// First line of every page, so that nobody mends the wrong file.
const MADE: &str = "<!-- Made from the code by `MYO_BLESS=1 cargo test -p myo --test reference`. -->";

/// Compares a page with its file, or writes the file where that is asked for.
fn check(page: &str, text: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/reference").join(page);
    let text = format!("{MADE}\n{}\n", text.trim_end());
    if std::env::var_os("MYO_BLESS").is_some() {
        std::fs::write(&path, &text).unwrap();
    }
    let file = std::fs::read_to_string(&path).unwrap_or_default();
    let line = file.lines().zip(text.lines()).position(|(old, new)| old != new).unwrap_or(0);
    assert!(file == text, "docs/reference/{page} is out of date, first at line {}; {MADE}", line + 1);
}

#[test]
fn the_page_of_task_files_is_that_of_the_code() {
    let schema = myo::tasks::task_schema();
    check("task.md", &schema::page("Task files", TASK_INTRODUCTION, &schema));
}

const TASK_INTRODUCTION: &str = "\
A task is a YAML file. `myo task show ar` prints one with comments, `myo task check FILE` checks one, and `myo task schema` prints its JSON Schema, which \
editors use to complete and check while you type. Keys that are left out have their defaults; unknown keys are refused.";

#[test]
fn the_page_of_commands_is_that_of_the_program() {
    check("command-line.md", &commands::page());
}
