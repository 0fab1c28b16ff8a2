//! The reference pages of `docs/reference` are made from the code and may not drift from it.
//!
//! `MYO_BLESS=1 cargo test -p myo-sim --test reference` writes them anew.

mod columns;
mod commands;
mod schema;

use std::path::Path;

/// First line of every page, so that nobody mends the wrong file.
const MADE: &str = "<!-- Made from the code by `MYO_BLESS=1 cargo test -p myo-sim --test reference`. -->";

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
    check("task.md", &schema::page("Task files", TASK_INTRODUCTION, "The file", &schema));
}

const TASK_INTRODUCTION: &str = "\
A task is a YAML file. `myo task show ar` prints one with comments, `myo task check FILE` checks one, and `myo task schema` prints its JSON Schema, which \
editors use to complete and check while you type. Keys that are left out have their defaults; unknown keys are refused.";

#[test]
fn the_page_of_settings_is_that_of_the_code() {
    let schema = serde_json::to_value(schemars::schema_for!(myo::train::PpoConfig)).unwrap();
    check("settings.md", &schema::page("Settings of the learner", SETTINGS_INTRODUCTION, "PPO", &schema));
}

const SETTINGS_INTRODUCTION: &str = "\
`myo train TASK --set NAME=VALUE` changes one of these, `myoenv.train(task, settings={...})` several. [Training](../training.md) tells what was tried.";

#[test]
fn the_pages_of_columns_are_those_of_the_code() {
    check("observations.md", &columns::observations(&myo::tasks::task_schema()));
    check("episodes.md", &columns::episodes());
    check("metrics.md", &columns::metrics());
}

#[test]
fn the_book_has_every_page_and_no_other() {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs");
    let summary = std::fs::read_to_string(docs.join("SUMMARY.md")).unwrap();
    let listed: Vec<&str> = summary.split("](").skip(1).map(|rest| rest.split(')').next().unwrap()).collect();
    for page in &listed {
        assert!(docs.join(page).is_file(), "SUMMARY.md lists {page}, which is not there");
    }
    for folder in ["", "reference"] {
        for file in std::fs::read_dir(docs.join(folder)).unwrap() {
            let name = file.unwrap().file_name().into_string().unwrap();
            let page = Path::new(folder).join(&name).to_str().unwrap().to_owned();
            assert!(
                !name.ends_with(".md") || name == "SUMMARY.md" || listed.contains(&page.as_str()),
                "SUMMARY.md lacks {page}"
            );
        }
    }
}

#[test]
fn the_page_of_commands_is_that_of_the_program() {
    check("command-line.md", &commands::page());
}
