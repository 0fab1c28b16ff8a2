//! Runs as they lie in the folder: of the studio, of the command line, of Python.

use std::fs;
use std::path::Path;

use myo_lab::protocol::{KeptAnswer, kept_answers};
use myo_lab::{FoundRun, RunDescription, RunSummary, find_runs, run_summary};
use myo_train::{RunFolder, write_whole};

use super::workspace::{Workspace, seconds};
use crate::protocol::{CurvePoint, ProtocolAnswer, Refusal, RunDetail, RunEntry, RunNote, RunStanding, TargetResult};

/// What people write down about a run lies beside it.
pub const NOTE: &str = "note.json";
/// Most points of a curve that a page is told.
const POINTS: usize = 600;

/// All runs, latest first.
///
/// # Errors
/// The folder cannot be read.
pub fn list(workspace: &Workspace) -> Result<Vec<RunEntry>, Refusal> {
    let folder = workspace.runs();
    if !folder.exists() {
        return Ok(vec![]);
    }
    let found = find_runs(&folder)?;
    let mut entries: Vec<RunEntry> = found.into_iter().map(|run| entry(workspace.name_of(&run.path), run)).collect();
    entries.sort_by(|a, b| changed(b).total_cmp(&changed(a)).then_with(|| a.name.cmp(&b.name)));
    Ok(entries)
}

fn changed(entry: &RunEntry) -> f64 {
    match entry.standing {
        RunStanding::Readable { changed_s, .. } => changed_s,
        RunStanding::Damaged { .. } => f64::NEG_INFINITY,
    }
}

fn entry(name: String, FoundRun { path, summary }: FoundRun) -> RunEntry {
    let standing = match summary {
        Ok(summary) => readable(summary),
        Err(error) => RunStanding::Damaged { message: error.to_string() },
    };
    RunEntry { name, standing, note: note(&path) }
}

fn readable(summary: RunSummary) -> RunStanding {
    RunStanding::Readable {
        layouts: summary.layouts,
        seed: summary.seed,
        device: summary.device,
        env_steps: summary.env_steps,
        state: summary.state.word().into(),
        success: summary.success,
        episode_s: summary.episode_length_s,
        effort: summary.effort,
        fatigue: summary.fatigue,
        changed_s: seconds(summary.changed),
    }
}

/// What people wrote down; nothing where the file is damaged, which costs nobody a run.
fn note(folder: &Path) -> RunNote {
    let text = fs::read(folder.join(NOTE)).unwrap_or_default();
    serde_json::from_slice(&text).unwrap_or_default()
}

/// Writes a note down.
///
/// # Errors
/// There is no such run, or its folder cannot be written.
pub fn write_note(workspace: &Workspace, name: &str, note: &RunNote) -> Result<(), Refusal> {
    let folder = workspace.run(name)?;
    RunFolder::open(&folder)?;
    Ok(write_whole(&folder.join(NOTE), &serde_json::to_vec_pretty(note)?)?)
}

/// All that is known of a run.
///
/// # Errors
/// There is no such run, or it cannot be read.
pub fn detail(workspace: &Workspace, name: &str) -> Result<RunDetail, Refusal> {
    detail_of(&workspace.run(name)?, name)
}

/// The same of a run wherever it lies.
///
/// # Errors
/// There is no such run, or it cannot be read.
pub fn detail_of(folder: &Path, name: &str) -> Result<RunDetail, Refusal> {
    let run = RunFolder::open(folder)?;
    let description = RunDescription::of(&run)?;
    let evaluation = run.evaluation()?;
    let flat = description.task.flat()?;
    let targets = evaluation.as_ref().map_or(&[][..], |evaluation| &evaluation.targets);
    let target = |(index, target): (usize, &myo_train::TargetEvaluation)| TargetResult {
        label: if index < flat.steps.len() { flat.label(index) } else { format!("step {}", index + 1) },
        success: target.success,
        movement_time_s: target.movement_time_s,
        movement_time_interval: target.movement_time_s_interval,
        time_s: target.time_s,
    };
    Ok(RunDetail {
        entry: RunEntry { name: name.to_owned(), standing: readable(run_summary(folder)?), note: note(folder) },
        text: description.task.to_yaml(),
        model: description.task.model.clone(),
        curve: curve(folder, description.task.control_dt_s),
        targets: targets.iter().enumerate().map(target).collect(),
        episodes: evaluation.as_ref().map_or(0, |evaluation| evaluation.episodes),
        success_interval: evaluation.as_ref().and_then(|evaluation| evaluation.success_interval),
        episode_s_interval: evaluation.as_ref().and_then(|evaluation| evaluation.episode_length_s_interval),
        effort_interval: evaluation.as_ref().and_then(|evaluation| evaluation.effort_interval),
        checkpoints: run.numbered_checkpoints()?.into_iter().map(|(env_steps, _)| env_steps).collect(),
        protocols: protocols(folder)?,
    })
}

/// What users of a run answered to protocols.
fn protocols(folder: &Path) -> Result<Vec<ProtocolAnswer>, Refusal> {
    let answers = kept_answers(folder).map_err(|error| {
        Refusal::sentence(format!("cannot read answers to protocols in {}: {error}", folder.display()))
    })?;
    let answer = |kept: KeptAnswer| ProtocolAnswer { name: kept.name.into(), text: kept.text, plot: kept.plot };
    Ok(answers.into_iter().map(answer).collect())
}

/// The learning curve, thinned out; empty where no metrics can be read.
fn curve(folder: &Path, control_dt_s: f64) -> Vec<CurvePoint> {
    let text = fs::read_to_string(folder.join("metrics.csv")).unwrap_or_default();
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap_or_default().split(',').collect();
    let column = |name: &str| names.iter().position(|other| *other == name);
    let (steps, wall) = (column("env_steps"), column("wall_s"));
    let [success, length, effort, reward] = ["success", "length", "effort", "return"].map(column);
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    let every = rows.len().div_ceil(POINTS).max(1);
    let value = |row: &[&str], column: Option<usize>| row.get(column?)?.parse::<f64>().ok();
    let point = |(_, row): (usize, &Vec<&str>)| {
        Some(CurvePoint {
            env_steps: row.get(steps?)?.parse().ok()?,
            wall_s: value(row, wall)?,
            success: value(row, success),
            episode_s: value(row, length).map(|steps| steps * control_dt_s),
            effort: value(row, effort),
            reward: value(row, reward),
        })
    };
    let last = rows.len().saturating_sub(1);
    rows.iter().enumerate().filter(|(index, _)| index % every == 0 || *index == last).filter_map(point).collect()
}
