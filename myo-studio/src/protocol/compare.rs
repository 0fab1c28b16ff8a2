//! Layouts side by side: how well users do them, and what tells them apart.

use serde::{Deserialize, Serialize};

/// Layouts, each with its users.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct LayoutTable {
    /// A row for each, in the order in which their first runs were named.
    pub layouts: Vec<LayoutRow>,
    /// Runs that nothing can be said of.
    pub left_out: Vec<LeftOut>,
}

/// A run that is in no row.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct LeftOut {
    /// Its name.
    pub run: String,
    /// Why.
    pub reason: String,
}

/// A layout and those who learnt it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct LayoutRow {
    /// What people call it.
    pub name: String,
    /// Who learnt it, at least one.
    pub users: Vec<UserRow>,
    /// Share of fresh episodes that succeed, over users.
    pub success: Option<Mean>,
    /// Mean duration of an episode (s), over users.
    pub episode_s: Option<Mean>,
    /// Mean squared control, over users.
    pub effort: Option<Mean>,
    /// Share of the strength of all muscles that fatigues in an episode, over users.
    pub fatigue: Option<Mean>,
    /// Each step, in the order of the script.
    pub steps: Vec<StepRow>,
    /// How it differs from the first layout; none for the first.
    pub against: Option<Against>,
}

/// A user of a layout.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct UserRow {
    /// Name of the run.
    pub run: String,
    /// Seed of the training.
    pub seed: u64,
    /// Share of fresh episodes that succeed.
    pub success: Option<f64>,
    /// Mean duration of an episode (s).
    pub episode_s: Option<f64>,
    /// Mean squared control.
    pub effort: Option<f64>,
    /// Share of the strength of all muscles that fatigues in an episode.
    pub fatigue: Option<f64>,
}

/// A mean over users.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Mean {
    /// The mean.
    pub mean: f64,
    /// Range that holds the mean of all possible users with 95 % confidence; none with a single user.
    pub interval: Option<[f64; 2]>,
}

/// A step of a layout, over users.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct StepRow {
    /// For people.
    pub label: String,
    /// Share of fresh episodes in which it is done.
    pub success: Option<Mean>,
    /// Mean movement time (s), without dwell.
    pub movement_time_s: Option<Mean>,
}

/// A layout against the first.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Against {
    /// Success, time, effort and fatigue, as far as both have them.
    pub contrasts: Vec<Contrast>,
    /// What can be said, for people.
    pub sentences: Vec<String>,
    /// What weakens that, for people.
    pub caveats: Vec<String>,
}

/// A quantity of two layouts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Contrast {
    /// `success`, `episode_length_s`, `effort` or `fatigue`.
    pub quantity: String,
    /// This layout less the first.
    pub difference: f64,
    /// 95 % confidence interval of it; none with a single user.
    pub interval: Option<[f64; 2]>,
    /// `higher`, `lower`, `within_training`, `no_difference` or `unknown`.
    pub verdict: String,
}

/// Users of a task as it is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct LayoutUsers {
    /// Names of the runs of those who have learnt it and are tested, each of another seed.
    pub runs: Vec<String>,
    /// Numbers of the trainings of those who learn it or wait for that.
    pub on_the_way: Vec<u32>,
}
