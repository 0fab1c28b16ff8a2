//! Trainings of the studio: ordered, under way, over.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Settings of the learner that are not as they come, by name.
pub type Changes = BTreeMap<String, Value>;

/// What to train and how.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(deny_unknown_fields)]
pub struct JobOrder {
    /// Text of the task.
    pub text: String,
    /// What the runs are called after.
    pub name: String,
    /// Seed of the first user.
    pub seed: u64,
    /// How many users, of seeds in a row.
    pub users: u32,
    /// When to stop: `plateau`, `off` or a share of successful episodes such as `0.95`.
    pub until: String,
    /// After this many control steps in any case; the default without.
    pub steps: Option<u64>,
    /// Name of the run whose user goes on learning; a new user without.
    pub from: Option<String>,
    /// Whether it goes on whenever the task is changed: its run is that of the last task.
    pub live: bool,
    /// Settings of the learner that are not as they come.
    #[serde(default)]
    #[cfg_attr(test, ts(type = "Record<string, unknown>"))]
    pub settings: Changes,
}

/// A setting of the learner.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct LearnerSetting {
    /// Its name.
    pub name: String,
    /// What it says of itself.
    pub about: String,
    /// What it is where nobody changes it.
    #[cfg_attr(test, ts(type = "number | number[] | boolean"))]
    pub default: Value,
    /// What is allowed, in words; none for a switch.
    pub range: Option<String>,
}

/// A training.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Job {
    /// Its number.
    pub id: u32,
    /// Name of its run, once it has one.
    pub run: Option<String>,
    /// What it is called.
    pub title: String,
    /// Seed of the user.
    pub seed: u64,
    /// Whether it goes on whenever the task is changed.
    pub live: bool,
    /// How it stands.
    pub state: JobState,
    /// How far it is, once it has begun.
    pub progress: Option<JobProgress>,
    /// What is worth a word, latest last.
    pub news: Vec<String>,
}

/// How a training stands.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(rename_all = "snake_case", tag = "is")]
pub enum JobState {
    /// Others come before it.
    Waiting,
    /// Environments and networks are made.
    Preparing,
    /// It learns.
    Training,
    /// It waits to be told to go on.
    Paused,
    /// It is told how well it does on fresh episodes.
    Evaluating,
    /// It is over.
    Done {
        /// Why: `until`, `plateau` or `steps`.
        by: String,
        /// Share of fresh episodes that succeed.
        success: Option<f64>,
        /// Mean duration of an episode (s).
        episode_s: Option<f64>,
    },
    /// It was stopped, and can go on.
    Stopped,
    /// It cannot go on.
    Failed {
        /// Why.
        message: String,
    },
}

/// How far a training is.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct JobProgress {
    /// Control steps of all environments.
    pub env_steps: u64,
    /// Where it ends in any case.
    pub limit: u64,
    /// Time since it began (s), pauses aside.
    pub wall_s: f64,
    /// Control steps per second lately.
    pub rate: f64,
    /// Share of recent training episodes that succeed, whose actions are noisy.
    pub success: Option<f64>,
    /// Mean duration of recent episodes (s).
    pub episode_s: Option<f64>,
    /// Mean squared control of recent episodes.
    pub effort: Option<f64>,
    /// Share of recent episodes in which each step is done.
    pub step_success: Vec<f64>,
    /// Time that is left, in words, judged by what was learnt so far.
    pub left: String,
    /// What recent episodes fail at most.
    pub bottleneck: Option<Bottleneck>,
    /// How the user did this task before it learned it, where it comes from another.
    pub before: Option<Before>,
    /// What the last doubling of the practice brought, once that can be told.
    pub doubling: Option<Doubling>,
    /// What the body is trained on: `cpu`, or the name of a graphics card.
    pub device: String,
    /// Number of environments.
    pub environments: usize,
}

/// How a user does a task that it has not adapted to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Before {
    /// Share of fresh episodes that succeed.
    pub success: Option<f64>,
    /// Mean duration of an episode (s).
    pub episode_s: Option<f64>,
}

/// What a doubling of the practice brought.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Doubling {
    /// Change of the share of episodes that succeed.
    pub success: f64,
    /// Change of the duration of an episode, as a share of it.
    pub episode_time: f64,
    /// Whether nothing improves any more that is worth further practice.
    pub is_plateau: bool,
}

/// What episodes fail at most.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Bottleneck {
    /// Number of the step, from 0.
    pub step: usize,
    /// Share of the episodes that come to it and do it.
    pub success: f64,
}

/// What a training is told to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum Step {
    /// Wait.
    Pause,
    /// Go on after a pause or a stop.
    Resume,
    /// End now, with a checkpoint to go on from.
    Stop,
    /// Leave the list; what is under way is stopped.
    Dismiss,
}
