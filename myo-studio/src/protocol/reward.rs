//! What a task is rewarded for, and how that lies in space.

use serde::{Deserialize, Serialize};

/// The reward of a task as a sum.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct RewardView {
    /// What is summed up.
    pub terms: Vec<RewardTerm>,
    /// Least and greatest sum over an episode; none where there is no bound.
    pub episode: [Option<f64>; 2],
    /// Control steps of the longest episode.
    pub control_steps: u32,
}

/// A term of the reward: a weight times something that is counted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct RewardTerm {
    /// Path of its weight in the task, such as `reward.distance_cost`.
    pub path: String,
    /// The weight.
    pub weight: f64,
    /// What is multiplied by it, for people.
    pub of: String,
    /// Whether it is subtracted.
    pub is_cost: bool,
    /// Least and greatest value in one control step; none where there is no bound.
    pub step: [Option<f64>; 2],
    /// Least and greatest sum over an episode; none where there is no bound.
    pub episode: [Option<f64>; 2],
}

/// From where the reward is looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum Cut {
    /// Upright before the user, from left to right.
    Front,
    /// Upright from the user forward.
    Side,
    /// Level.
    Above,
}

/// The reward over a rectangle through the object of a step: what distance and time are worth per second to a pointer that stays there.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct RewardMap {
    /// A corner (m).
    pub corner: [f64; 3],
    /// From it along a row (m).
    pub along: [f64; 3],
    /// From it from row to row (m).
    pub across: [f64; 3],
    /// Places in a row.
    pub columns: usize,
    /// Rows.
    pub rows: usize,
    /// Reward per second, row by row.
    pub values: Vec<f32>,
}
