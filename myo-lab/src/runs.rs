//! The runs in a folder, for those who look for one.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use myo_train::{IoError, RunError, RunFolder};

use crate::layouts::layout_names;
use crate::run_description::RunDescription;

/// Folders within folders that are looked into: a comparison holds a folder for each layout, and that a run for each user.
const DEPTH: usize = 3;

/// A run that was found.
#[derive(Debug)]
pub struct FoundRun {
    /// Its folder.
    pub path: PathBuf,
    /// What is known of it, or why nothing is: a damaged run does not hide the others.
    pub summary: Result<RunSummary, RunError>,
}

/// What a run is about and how far it got.
#[derive(Clone, Debug, PartialEq)]
pub struct RunSummary {
    /// Names of the layouts, one or more.
    pub layouts: Vec<String>,
    /// Who does it: the user, and its body where that is not the model's.
    pub user: String,
    /// Seed of the training.
    pub seed: u64,
    /// What computed the physics when it began: `cpu`, or the name of the graphics card.
    pub device: String,
    /// Control steps of all environments up to the newest checkpoint.
    pub env_steps: u64,
    /// Whether somebody trains there, and whether it is evaluated.
    pub state: RunState,
    /// Share of fresh episodes that succeeded, where it is evaluated.
    pub success: Option<f64>,
    /// Mean duration of an episode (s), where it is evaluated.
    pub episode_length_s: Option<f64>,
    /// Mean squared control, where it is evaluated.
    pub effort: Option<f64>,
    /// Share of the strength of all muscles that fatigues in an episode, mean.
    pub fatigue: Option<f64>,
    /// When it was last written to.
    pub changed: SystemTime,
}

/// How a training stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RunState {
    /// A process trains there now.
    Training,
    /// It was stopped before its end.
    Stopped,
    /// It is over, and evaluated.
    Evaluated,
}

impl RunState {
    /// In a word: `training`, `stopped` or `evaluated`.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Training => "training",
            Self::Stopped => "stopped",
            Self::Evaluated => "evaluated",
        }
    }
}

/// All runs in a folder and the folders in it, by their paths, or the run that the folder is; those of several users lie a folder deeper,
/// those of comparisons two.
///
/// # Errors
/// The folder cannot be read. What cannot be read within it is left out.
pub fn find_runs(folder: &Path) -> Result<Vec<FoundRun>, IoError> {
    if let Some(summary) = known(folder) {
        return Ok(vec![FoundRun { path: folder.to_owned(), summary }]);
    }
    let mut found = Vec::new();
    look_in(folder, DEPTH, &mut found)?;
    found.sort_by(|a, b| a.path.cmp(&b.path));
    Ok(found)
}

fn look_in(folder: &Path, depth: usize, found: &mut Vec<FoundRun>) -> Result<(), IoError> {
    let entries = fs::read_dir(folder).map_err(|source| IoError::new("read", folder, source))?;
    for path in entries.filter_map(|entry| Some(entry.ok()?.path())).filter(|path| path.is_dir()) {
        match known(&path) {
            Some(summary) => found.push(FoundRun { path, summary }),
            // A folder that somebody else made, or one of several runs. What cannot be read is somebody else's.
            None if depth > 1 => drop(look_in(&path, depth - 1, found)),
            None => {}
        }
    }
    Ok(())
}

/// The summary of a folder, or what is wrong with it; none where there is no run, or nobody may look.
fn known(path: &Path) -> Option<Result<RunSummary, RunError>> {
    match run_summary(path) {
        Err(RunError::NotARun { .. }) => None,
        Err(RunError::Io(error)) if error.source.kind() == ErrorKind::PermissionDenied => None,
        summary => Some(summary),
    }
}

/// What a run is about and how far it got.
///
/// # Errors
/// There is no run, or its description or evaluation cannot be read.
pub fn run_summary(path: &Path) -> Result<RunSummary, RunError> {
    let run = RunFolder::open(path)?;
    let description = RunDescription::of(&run)?;
    let evaluation = run.evaluation()?;
    let state = match (run.is_training(), &evaluation) {
        (true, _) => RunState::Training,
        (false, None) => RunState::Stopped,
        (false, Some(_)) => RunState::Evaluated,
    };
    Ok(RunSummary {
        layouts: layout_names(&description.layouts()),
        user: description.task.who(),
        seed: run.config().seed,
        env_steps: run.env_steps()?,
        state,
        success: evaluation.as_ref().and_then(|evaluation| evaluation.success),
        episode_length_s: evaluation.as_ref().and_then(|evaluation| evaluation.episode_length_s),
        effort: evaluation.as_ref().and_then(|evaluation| evaluation.effort),
        fatigue: evaluation.as_ref().and_then(|evaluation| evaluation.fatigue),
        changed: run.changed()?,
        device: description.device.unwrap_or(description.backend),
    })
}
