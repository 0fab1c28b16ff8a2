//! What a run is about: the caller's part of its `config.json`, written and read here by every interface.

use std::path::PathBuf;

use myo_gpu::AdapterChoice;
use myo_model::{Model, ModelDescription, ModelError, builtin};
use myo_tasks::{Anywhere, Task, User, check};
use myo_train::session::{Goal, Until};
use myo_train::{Checkpoint, RunClaim, RunConfig, RunError, RunFolder};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use thiserror::Error;

use crate::{Backend, Device};

/// What was trained, on what, until when.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunDescription {
    /// The whole task, with the keys of a task file; the first of several layouts.
    pub task: Task,
    /// The other layouts that the same user learns, tasks of the same structure.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub other_layouts: Vec<Task>,
    /// The body, with the keys of a model file, unless it is the one that comes with the program under the name in the task.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model: Option<ModelDescription>,
    /// What computed the physics when the run began: `cpu` or `gpu`.
    pub backend: String,
    /// Name of the graphics card, if it was one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub device: Option<String>,
    /// Version of the program that began the run.
    pub version: String,
    /// What ends the training before its steps do: `plateau`, a share of deterministic success above 0 and at most 1, or null.
    pub until: Until,
    /// Control steps of all environments after which training stops in any case, at least 1.
    pub steps: u64,
    /// The run whose networks it started from, if any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from: Option<WarmStart>,
}

/// The run that a warm start began from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WarmStart {
    /// Its folder, or one of its checkpoints.
    pub run: PathBuf,
    /// Control steps that it had seen.
    pub env_steps: u64,
}

/// The run that a warm start was to begin from has changed since.
#[derive(Clone, Debug, PartialEq, Error)]
#[error(
    "the run was to begin from {} after {} control steps, and was stopped before it did; that run is at {env_steps} now. \
     Start it again, from there",
    from.run.display(),
    from.env_steps
)]
pub struct WarmStartMoved {
    /// What it was.
    pub from: WarmStart,
    /// Control steps that the run has seen now.
    pub env_steps: u64,
}

/// Parts of the observation that there are by default now, and were not when runs were written without them.
const NEW_PARTS: [&str; 2] = ["target_direction", "control"];

/// A description in which users are who they were when it was written, and perceive no more: it names all parts that there were, and before
/// it named users there was but one.
fn as_it_was_then(mut value: Value) -> Value {
    let others = value["other_layouts"].as_array().map_or(0, Vec::len);
    let tasks = std::iter::once("/task".to_owned()).chain((0..others).map(|layout| format!("/other_layouts/{layout}")));
    for task in tasks {
        if let Some(Value::Object(task)) = value.pointer_mut(&task) {
            task.entry("user").or_insert_with(|| User::Fastest.name().into());
        }
        if let Some(Value::Object(parts)) = value.pointer_mut(&format!("{task}/observation")) {
            for part in NEW_PARTS {
                parts.entry(part).or_insert(Value::Bool(false));
            }
        }
    }
    value
}

impl RunDescription {
    /// A new run; `model` is the body unless it comes with the program. With other layouts, set
    /// [`other_layouts`](Self::other_layouts).
    pub fn new(
        task: Task,
        model: Option<ModelDescription>,
        device: &Device,
        goal: Goal,
        from: Option<WarmStart>,
    ) -> Self {
        Self {
            task,
            other_layouts: vec![],
            model,
            backend: device.backend().into(),
            device: device.card().map(String::from),
            version: env!("CARGO_PKG_VERSION").into(),
            until: goal.until,
            steps: goal.steps,
            from,
        }
    }

    /// What a run is about. A file that was edited is checked as a new task and new options are.
    ///
    /// # Errors
    /// The description is not one that a training could have begun with.
    pub fn of(run: &RunFolder) -> Result<Self, RunError> {
        let bad = |reason: String| RunError::BadConfig { path: run.path().join("config.json"), reason };
        let RunConfig { run: value, .. } = run.config().clone();
        let description: Self =
            serde_json::from_value(as_it_was_then(value)).map_err(|error| bad(error.to_string()))?;
        description.check().map_err(bad)?;
        let others = description.other_layouts.into_iter().map(Task::with_costs_per_second).collect();
        Ok(Self { task: description.task.with_costs_per_second(), other_layouts: others, ..description })
    }

    fn check(&self) -> Result<(), String> {
        for task in [&self.task].into_iter().chain(&self.other_layouts) {
            if let Some(error) = check(task, &Anywhere).errors.first() {
                return Err(error.to_string());
            }
        }
        match (self.steps, &self.backend[..], &self.device) {
            (0, ..) => Err("steps is 0; it must be at least 1".into()),
            (_, "cpu", None) | (_, "gpu", Some(_)) => Ok(()),
            (_, "cpu", Some(device)) => {
                Err(format!("device is \"{device}\", but backend \"cpu\" has none; leave it out"))
            }
            (_, "gpu", None) => Err("backend is \"gpu\", so device must name the graphics card".into()),
            (_, other, _) => Err(format!("backend is \"{other}\"; it must be \"cpu\" or \"gpu\"")),
        }
    }

    /// All layouts, one or more.
    pub fn layouts(&self) -> Vec<Task> {
        [&self.task].into_iter().chain(&self.other_layouts).cloned().collect()
    }

    /// When to stop.
    pub fn goal(&self) -> Goal {
        Goal { until: self.until, steps: self.steps }
    }

    /// The same with another goal.
    pub fn with_goal(self, goal: Goal) -> Self {
        Self { until: goal.until, steps: goal.steps, ..self }
    }

    /// The backend that the run began on; only there does it continue bit for bit.
    pub fn backend(&self) -> Backend {
        match &self.device {
            Some(name) => Backend::Gpu(AdapterChoice::Named(name.clone())),
            None => Backend::Cpu,
        }
    }

    /// The body.
    ///
    /// # Errors
    /// It cannot be simulated, or no model of that name comes with the program.
    pub fn body(&self) -> Result<Model, ModelError> {
        match &self.model {
            Some(own) => self.task.embody(own),
            None => self.task.embody(&builtin(&self.task.model)?),
        }
    }

    /// Writes the goal of a run into its `config.json` if it differs from the one there, so that it is kept however often
    /// the run is stopped.
    ///
    /// # Errors
    /// The description cannot be read or written.
    pub fn aim(claim: &mut RunClaim, goal: Goal) -> Result<(), RunError> {
        let description = Self::of(claim.folder())?;
        if description.goal() == goal {
            return Ok(());
        }
        let path = claim.folder().path().join("config.json");
        let bad = |error: serde_json::Error| RunError::BadConfig { path, reason: error.to_string() };
        claim.describe(serde_json::to_value(description.with_goal(goal)).map_err(bad)?)
    }
}

impl WarmStart {
    /// Refuses any checkpoint but the one that the training was to begin from: it would make a different training.
    ///
    /// # Errors
    /// `checkpoint` has another number of control steps.
    pub fn check(&self, checkpoint: &Checkpoint) -> Result<(), WarmStartMoved> {
        if checkpoint.env_steps() == self.env_steps {
            return Ok(());
        }
        Err(WarmStartMoved { from: self.clone(), env_steps: checkpoint.env_steps() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn users_of_old_runs_are_who_they_were_and_perceive_what_they_did_then() {
        let old = json!({"task": {"observation": {"activation": true}}, "other_layouts": [{"observation": {"control": true}}]});
        let expected = json!({
            "task": {"user": "fastest", "observation": {"activation": true, "target_direction": false, "control": false}},
            "other_layouts": [{"user": "fastest", "observation": {"control": true, "target_direction": false}}],
        });
        assert_eq!(as_it_was_then(old), expected);
        let new = serde_json::to_value(myo_tasks::preset("pointing").unwrap()).unwrap();
        let new = json!({"task": new});
        assert_eq!(as_it_was_then(new.clone()), new, "all parts are written down");
    }
}
