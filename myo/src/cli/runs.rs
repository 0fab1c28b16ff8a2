//! `myo runs`: the users that were trained.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use clap::Args;
use myo::{FoundRun, RunSummary, find_runs};
use serde_json::{Value, json};

use super::failure::{Failure, Result};
use super::output::{argument, command, duration, name, percent, print, print_json, rounded, row, table};

/// Arguments of `myo runs`.
#[derive(Args)]
#[command(after_help = HELP)]
pub struct Runs {
    /// Folder in which the runs are
    #[arg(default_value = "runs")]
    folder: PathBuf,

    /// Only runs in whose path or task this text occurs, in upper or lower case
    #[arg(long, value_name = "TEXT")]
    find: Option<String>,

    /// Every run on a line of its own, those of `--seeds` and of comparisons too
    #[arg(long)]
    all: bool,

    /// Print the list as JSON, every run by itself
    #[arg(long)]
    json: bool,
}

const HELP: &str = "\
Examples:
  myo runs                     what was trained here, the latest first
  myo runs --find ticket
  myo runs runs/grid-row       the users of a comparison
  myo compare runs/a runs/b    whether one of two is better

A run is `training` while a process trains there, `stopped` before its end (go on with `myo train --resume`), and `evaluated` after it.
Runs that cannot be read are listed with the reason. Users of one task in one folder, as of
`--seeds`, share a line, with means.

JSON: `runs`, a list of objects with `run` (the folder), and `damage`, why it cannot be read, or null; then `tasks` (names of its layouts), `user` (who it is, with its body),
`seed`, `device` (`cpu`, or the name of the card), `env_steps`, `state`, `success`, `episode_length_s`, `effort` (null
before the evaluation) and `changed_s` (seconds since 1970-01-01).";

/// Runs `myo runs`.
pub fn run(args: &Runs) -> Result<()> {
    if !args.folder.is_dir() {
        let next = command(&["train", "pointing"]);
        return Err(Failure::sentence(format!(
            "there is no folder {}; a first run is made by: {next}",
            args.folder.display()
        )));
    }
    let mut found = find_runs(&args.folder)?;
    if let Some(text) = &args.find {
        found.retain(|run| is_about(run, &text.to_lowercase()));
    }
    if args.json {
        let runs: Vec<Value> = found.iter().map(as_json).collect();
        return print_json(&json!({ "runs": runs }));
    }
    print(&listing(args, &found))
}

fn is_about(run: &FoundRun, text: &str) -> bool {
    let layouts = run.summary.iter().flat_map(|summary| summary.layouts.clone());
    layouts.chain([run.path.display().to_string()]).any(|word| word.to_lowercase().contains(text))
}

fn as_json(run: &FoundRun) -> Value {
    let since = |time: SystemTime| time.duration_since(SystemTime::UNIX_EPOCH).map_or(0, |since| since.as_secs());
    match &run.summary {
        Err(error) => json!({ "run": run.path, "damage": error.to_string() }),
        Ok(summary) => json!({
            "run": run.path,
            "damage": null,
            "tasks": summary.layouts,
            "user": summary.user,
            "seed": summary.seed,
            "device": summary.device,
            "env_steps": summary.env_steps,
            "state": summary.state.word(),
            "success": summary.success,
            "episode_length_s": summary.episode_length_s,
            "effort": summary.effort,
            "changed_s": since(summary.changed),
        }),
    }
}

fn listing(args: &Runs, found: &[FoundRun]) -> String {
    let mut lines = lines(args, found);
    if lines.is_empty() && found.is_empty() {
        let looked_for = args.find.as_ref().map_or(String::new(), |text| format!(" of {}", name(text)));
        return format!("no run{looked_for} in {}\n", args.folder.display());
    }
    lines.sort_by_key(|line| std::cmp::Reverse(line.changed));
    let heading = row(["run", "task", "user", "users", "steps", "success", "episode", "effort", "state", "changed"]);
    let rows: Vec<_> = [heading].into_iter().chain(lines.iter().map(Line::row)).collect();
    let mut text = if lines.is_empty() { String::new() } else { table(&rows) };
    for run in found {
        if let Err(error) = &run.summary {
            text += &format!("damaged: {}: {error}\n", run.path.display());
        }
    }
    let goes_on = |line: &&Line| line.states == ["stopped"] && (line.users == 1 || line.run.join("plan.json").exists());
    if let Some(Line { run, .. }) = lines.iter().find(goes_on) {
        text += &format!("\nstopped before its end; go on with: {}\n", command(&["train", "--resume", &argument(run)]));
    }
    text
}

/// What the runs of a line have in common, or their means.
struct Line {
    run: PathBuf,
    task: String,
    /// Who they are; others of the same folder may be others.
    user: String,
    users: usize,
    env_steps: f64,
    success: Option<f64>,
    episode_length_s: Option<f64>,
    effort: Option<f64>,
    states: Vec<&'static str>,
    changed: SystemTime,
}

/// A line for each run, or for each folder of several.
fn lines(args: &Runs, found: &[FoundRun]) -> Vec<Line> {
    let mut groups: BTreeMap<(&Path, &[String]), Vec<&RunSummary>> = BTreeMap::new();
    for run in found {
        let Ok(summary) = &run.summary else { continue };
        // A folder within the one that is looked into.
        let parent = run.path.parent().filter(|parent| !args.all && *parent != args.folder && run.path != args.folder);
        groups.entry((parent.unwrap_or(&run.path), &summary.layouts)).or_default().push(summary);
    }
    groups.into_iter().filter_map(|((run, _), users)| Line::of(run, &users)).collect()
}

impl Line {
    fn of(run: &Path, users: &[&RunSummary]) -> Option<Self> {
        let mean = |value: fn(&RunSummary) -> Option<f64>| {
            let values: Option<Vec<f64>> = users.iter().map(|user| value(user)).collect();
            values.map(|values| values.iter().sum::<f64>() / values.len() as f64)
        };
        let mut states: Vec<_> = users.iter().map(|user| user.state.word()).collect();
        states.sort_unstable();
        states.dedup();
        let first = users.first()?;
        Some(Self {
            run: run.to_owned(),
            task: match &first.layouts[..] {
                [one] => name(one),
                [one, others @ ..] => format!("{} and {} more", name(one), others.len()),
                [] => String::new(),
            },
            user: match users.iter().all(|user| user.user == first.user) {
                true => first.user.clone(),
                false => "several".into(),
            },
            users: users.len(),
            env_steps: mean(|user| Some(user.env_steps as f64))?,
            success: mean(|user| user.success),
            episode_length_s: mean(|user| user.episode_length_s),
            effort: mean(|user| user.effort),
            states,
            changed: users.iter().map(|user| user.changed).max()?,
        })
    }

    fn row(&self) -> Vec<String> {
        let shown = |value: Option<f64>, show: &dyn Fn(f64) -> String| value.map_or("-".into(), show);
        vec![
            name(&self.run.display().to_string()),
            self.task.clone(),
            self.user.clone(),
            self.users.to_string(),
            rounded(self.env_steps),
            shown(self.success, &percent),
            shown(self.episode_length_s, &|seconds| format!("{seconds:.2} s")),
            shown(self.effort, &|effort| format!("{effort:.4}")),
            self.states.join(", "),
            match self.changed.elapsed() {
                Ok(since) if since.as_secs() > 0 => format!("{} ago", duration(since.as_secs_f64())),
                _ => "now".into(),
            },
        ]
    }
}
