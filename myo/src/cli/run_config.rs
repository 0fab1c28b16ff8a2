//! What the command line writes into a run's `config.json`, and reads from it.

use std::path::{Path, PathBuf};

use myo::Backend;
use myo::gpu::AdapterChoice;
use myo::model::ModelDescription;
use myo::tasks::{Anywhere, Task, check};
use myo::train::session::Goal;
use myo::train::{Checkpoint, RunError, RunFolder};
use serde::{Deserialize, Serialize};

use super::failure::{Failure, Result, complain};
use super::output::{argument, command, grouped};

/// The caller's part of `config.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Description {
    /// The whole task, with the keys of a task file.
    pub task: Task,
    /// The body, with the keys of a model file, unless it is the one that comes with the program under the name in the task.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model: Option<ModelDescription>,
    /// What computed the physics when the run began: `cpu` or `gpu`.
    pub backend: String,
    /// Name of the graphics card, if it was one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub device: Option<String>,
    /// Version of this program.
    pub version: String,
    /// Share of deterministic success at which training stops, if any.
    pub until: Option<f64>,
    /// Control steps after which training stops.
    pub steps: u64,
    /// What it began from, if not from nothing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from: Option<Inheritance>,
}

/// The run that a warm start began from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Inheritance {
    /// Its folder.
    pub run: PathBuf,
    /// Control steps that it had seen.
    pub env_steps: u64,
}

impl Description {
    /// What a run is about. A file that was edited is checked as a new task and new options are.
    pub fn of(run: &RunFolder) -> Result<Self> {
        let bad = |reason: String| RunError::BadConfig { path: run.path().join("config.json"), reason };
        let value = run.config().run.clone();
        let description: Self = serde_json::from_value(value).map_err(|error| bad(error.to_string()))?;
        description.check().map_err(bad)?;
        Ok(description)
    }

    fn check(&self) -> std::result::Result<(), String> {
        if let Some(error) = check(&self.task, &Anywhere).errors.first() {
            return Err(error.to_string());
        }
        if let Some(until) = self.until.filter(|until| !(*until > 0.0 && *until <= 1.0)) {
            return Err(format!("until is {until}; it must be a share above 0, at most 1, or null"));
        }
        match (self.steps, &self.backend[..]) {
            (0, _) => Err("steps is 0; it must be at least 1".into()),
            (_, "cpu" | "gpu") => Ok(()),
            (_, other) => Err(format!("backend is \"{other}\"; it must be \"cpu\" or \"gpu\"")),
        }
    }

    /// When to stop.
    pub fn goal(&self) -> Goal {
        Goal { until: self.until, steps: self.steps }
    }

    /// The backend that the run began on, where alone it goes on to the bit.
    pub fn choice(&self) -> Backend {
        match &self.device {
            Some(name) => Backend::Gpu(AdapterChoice::Named(name.clone())),
            None => Backend::Cpu,
        }
    }
}

/// The task that was trained in a run folder.
pub fn run_task(path: &Path) -> Result<Task> {
    Ok(Description::of(&RunFolder::open(path)?)?.task)
}

/// The newest checkpoint that is whole; refuses a run without one.
pub fn existing_checkpoint(run: &RunFolder) -> Result<Checkpoint> {
    newest_checkpoint(run)?.ok_or_else(|| {
        let next = command(&["train", "--resume", &argument(run.path())]);
        Failure::sentence(format!("{} has no checkpoint yet; go on with: {next}", run.path().display()))
    })
}

/// The newest checkpoint that is whole; tells about newer ones that are not. None if none was written yet.
pub fn newest_checkpoint(run: &RunFolder) -> Result<Option<Checkpoint>> {
    let latest = run.latest_checkpoint()?;
    for (path, reason) in &latest.refused {
        complain(&format!("warning: {} cannot be used: {reason}", path.display()));
    }
    match &latest.checkpoint {
        Some(checkpoint) if !latest.refused.is_empty() => {
            complain(&format!("the checkpoint of {} control steps is used instead", grouped(checkpoint.env_steps())));
        }
        None if !latest.refused.is_empty() => {
            let folder = run.path().display();
            return Err(Failure::sentence(format!("{folder} has no checkpoint that can be used; train it again")));
        }
        _ => {}
    }
    Ok(latest.checkpoint)
}
