//! Runs, as they lie in the folder, whoever trained there.

use serde::{Deserialize, Serialize};

/// A run in a list.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct RunEntry {
    /// The path of its folder below that of all runs.
    pub name: String,
    /// What is known of it.
    pub standing: RunStanding,
    /// What people wrote down.
    pub note: RunNote,
}

/// What is known of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(tag = "is", rename_all = "snake_case")]
pub enum RunStanding {
    /// It can be read.
    Readable {
        /// Names of the layouts, one or more.
        layouts: Vec<String>,
        /// Seed of the training.
        seed: u64,
        /// What computed the physics: `cpu`, or the name of a graphics card.
        device: String,
        /// Control steps up to the newest checkpoint.
        env_steps: u64,
        /// `training`, `stopped` or `evaluated`.
        state: String,
        /// Share of fresh episodes that succeed.
        success: Option<f64>,
        /// Mean duration of an episode (s).
        episode_s: Option<f64>,
        /// Mean squared control.
        effort: Option<f64>,
        /// Share of the strength of all muscles that fatigues in an episode.
        fatigue: Option<f64>,
        /// When it was last written to (s since 1970).
        changed_s: f64,
    },
    /// It cannot.
    Damaged {
        /// Why.
        message: String,
    },
}

/// What people wrote down about a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(deny_unknown_fields)]
pub struct RunNote {
    /// A few words to find it by.
    #[serde(default)]
    pub tags: Vec<String>,
    /// Free text.
    #[serde(default)]
    pub note: String,
}

/// All that is known of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct RunDetail {
    /// The run in the list.
    pub entry: RunEntry,
    /// Text of its task.
    pub text: String,
    /// Name of the body.
    pub model: String,
    /// What its learning was like.
    pub curve: Vec<CurvePoint>,
    /// Each step on fresh episodes, in the order of the script; empty before it is evaluated.
    pub targets: Vec<TargetResult>,
    /// Episodes that were counted.
    pub episodes: u64,
    /// 95 % confidence interval of the success.
    pub success_interval: Option<[f64; 2]>,
    /// 95 % confidence interval of the duration of an episode (s).
    pub episode_s_interval: Option<[f64; 2]>,
    /// 95 % confidence interval of the effort.
    pub effort_interval: Option<[f64; 2]>,
    /// Control steps of the checkpoints that are kept, newest first.
    pub checkpoints: Vec<u64>,
    /// What its user, and others with other seeds, answered when they were asked what people were asked (`myo eval --protocol`).
    #[serde(default)]
    pub protocols: Vec<ProtocolAnswer>,
}

/// What users answered to a protocol.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct ProtocolAnswer {
    /// Name of the protocol, or `bands`.
    pub name: String,
    /// The answer as text, in columns.
    pub text: String,
    /// Its plot as SVG, if it has one.
    pub plot: Option<String>,
}

/// A row of the metrics of a training.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct CurvePoint {
    /// Control steps of all environments.
    pub env_steps: u64,
    /// Time since the training began (s).
    pub wall_s: f64,
    /// Share of the episodes that succeeded; none before one ended.
    pub success: Option<f64>,
    /// Mean duration of an episode (s).
    pub episode_s: Option<f64>,
    /// Mean squared control.
    pub effort: Option<f64>,
    /// Mean sum of rewards.
    pub reward: Option<f64>,
}

/// How well a step is done.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct TargetResult {
    /// For people.
    pub label: String,
    /// Share of the episodes in which it is done.
    pub success: f64,
    /// Mean movement time (s), without dwell.
    pub movement_time_s: Option<f64>,
    /// 95 % confidence interval of it.
    pub movement_time_interval: Option<[f64; 2]>,
    /// Mean time with dwell (s).
    pub time_s: Option<f64>,
}
