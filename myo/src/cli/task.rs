//! `myo task`: what the simulated user has to do.

use std::path::Path;

use clap::Subcommand;
use myo::tasks::{Task, User, preset, preset_names, preset_text, task_schema};
use serde_json::json;

use super::failure::{Failure, Mistake, Result};
use super::output::{print, print_file, print_json, row, table};
use super::run_folder::run_task;
use super::scenario;

/// What to do with tasks.
#[derive(Subcommand)]
pub enum Command {
    /// Tasks that come with the program
    #[command(after_help = "Example:\n  myo task list")]
    List {
        /// Print a JSON list of objects with `name`, `description`, `targets` (their number), `time_limit_s`, `model`
        #[arg(long)]
        json: bool,
    },
    /// Print the commented file of a task, to read or to start one of your own
    #[command(after_help = "Examples:
  myo task show ar > my.yaml
  myo train my.yaml
  myo task show runs/ar-1        the task that was trained there")]
    Show {
        /// Name of a task, or a run folder
        name: String,
    },
    /// Print a task in the newest version of the format, without comments
    #[command(after_help = "Example:\n  myo task convert old.yaml > new.yaml")]
    Convert {
        /// Task file, or name of a task
        task: String,
    },
    /// Say what is wrong with a task, and what is odd
    #[command(after_help = "Examples:
  myo task check my.yaml
  myo task check my.yaml --json

Each finding is one line, `file:line:column: sentence`. Exit status 1 if the task cannot be trained, 0 if it can;
warnings do not count.

JSON: `ok`, and two lists `errors` and `warnings` of objects with `file`, `line`, `column` (null if about no place)
and `message`.")]
    Check {
        /// Task file, or name of a task
        task: String,
        /// Print the findings as JSON
        #[arg(long)]
        json: bool,
    },
    /// Users who can do a task, by name: `user` in a task file, `--user` of commands
    #[command(after_help = "Example:\n  myo task users\n  myo train pointing --user small_woman")]
    Users {
        /// Print a JSON list of objects with `name`, `about`, `body` (what the body differs in)
        #[arg(long)]
        json: bool,
    },
    /// Print the JSON Schema of task files, for editors and forms
    #[command(
        after_help = "Example:\n  myo task schema > myo-task.schema.json    completes and checks task files in editors"
    )]
    Schema,
}

/// Runs a `myo task` command.
pub fn run(command: Command) -> Result<()> {
    match command {
        Command::List { json } => list(json),
        Command::Show { name } => show(&name),
        Command::Convert { task } => print_file(&scenario::read(&task)?.task.converted().to_yaml()),
        Command::Check { task, json } => check(&task, json),
        Command::Users { json } => users(json),
        Command::Schema => print_json(&task_schema()),
    }
}

fn list(json: bool) -> Result<()> {
    let tasks: Vec<(&str, Task)> = preset_names().into_iter().filter_map(|name| Some((name, preset(name)?))).collect();
    if json {
        let object = |(name, task): &(&str, Task)| {
            json!({
                "name": name,
                "description": task.description,
                "targets": targets(task),
                "time_limit_s": task.time_limit_s,
                "model": task.model,
            })
        };
        return print_json(&tasks.iter().map(object).collect::<Vec<_>>());
    }
    let mut rows = vec![row(["name", "targets", "time limit", "description"])];
    rows.extend(tasks.iter().map(|(name, task)| {
        row([name, &targets(task).to_string(), &format!("{} s", task.time_limit_s), &task.description])
    }));
    print(&table(&rows))
}

fn users(json: bool) -> Result<()> {
    if json {
        let object = |user: User| {
            let body = Task::without_script("user").done_by(user).body;
            json!({"name": user.name(), "about": user.about(), "body": body.words()})
        };
        return print_json(&User::ALL.map(object));
    }
    let mut rows = vec![row(["name", "who"])];
    rows.extend(User::ALL.map(|user| row([user.name(), &user.about()])));
    print(&table(&rows))
}

/// Targets of a task that has been read: steps of its script.
fn targets(task: &Task) -> usize {
    task.flat().map_or(0, |flat| flat.steps.len())
}

fn show(name: &str) -> Result<()> {
    if let Some(text) = preset_text(name) {
        return print_file(text);
    }
    if Path::new(name).join("config.json").exists() {
        return print_file(&run_task(Path::new(name))?.to_yaml());
    }
    print_file(&scenario::read(name)?.text)
}

fn check(name_or_file: &str, json: bool) -> Result<()> {
    let (errors, warnings) = match findings(name_or_file) {
        Ok(found) => found,
        Err(Failure::Mistakes(errors)) => (errors, Vec::new()),
        Err(failure) => return Err(failure),
    };
    if json {
        let list = |mistakes: &[Mistake]| mistakes.iter().map(as_json).collect::<Vec<_>>();
        print_json(&json!({"ok": errors.is_empty(), "errors": list(&errors), "warnings": list(&warnings)}))?;
        return if errors.is_empty() { Ok(()) } else { Err(Failure::Mistakes(Vec::new())) };
    }
    warnings.iter().for_each(Mistake::tell);
    if !errors.is_empty() {
        return Err(Failure::Mistakes(errors));
    }
    let odd = if warnings.is_empty() { "" } else { ", with warnings" };
    print(&format!("{name_or_file} can be trained{odd}\n"))
}

fn findings(name_or_file: &str) -> Result<(Vec<Mistake>, Vec<Mistake>)> {
    let source = scenario::read(name_or_file)?;
    let (report, _) = scenario::examine(&source)?;
    Ok(scenario::mistakes(&source, &report))
}

pub fn as_json(mistake: &Mistake) -> serde_json::Value {
    let place = mistake.place.as_ref();
    json!({
        "file": place.map(|place| &place.file),
        "line": place.map(|place| place.line),
        "column": place.map(|place| place.column),
        "message": mistake.message,
    })
}
