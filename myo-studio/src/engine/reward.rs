//! What a task is rewarded for, and how that lies in space.

use myo_lab::{ModelReach, Slice, reward_slice, reward_terms};
use myo_model::Model;
use myo_tasks::Task;

use crate::protocol::{Cut, Refusal, RewardMap, RewardTerm, RewardView};

/// Width and height of a map (m): as far as an arm moves.
const SIZE_M: f64 = 1.2;
/// Places along each side of it.
const PLACES: usize = 61;
/// Terms that are given, and not taken.
const BONUSES: [&str; 2] = ["subtask_bonus", "completion_bonus"];

/// The reward as a sum.
///
/// # Errors
/// The task has errors.
pub fn view(task: &Task, model: &Model, reach: &ModelReach) -> Result<RewardView, Refusal> {
    let term = |term: myo_lab::RewardTerm| RewardTerm {
        path: format!("reward.{}", term.field),
        weight: term.weight,
        of: term.of.into(),
        is_cost: !BONUSES.contains(&term.field),
        step: term.step,
        episode: term.episode,
    };
    let terms: Vec<RewardTerm> = reward_terms(task, reach, model.muscles.len())?.into_iter().map(term).collect();
    let sum = |end: usize| terms.iter().map(|term| term.episode[end]).sum();
    let episode = [sum(0), sum(1)];
    Ok(RewardView { terms, episode, control_steps: task.time_limit_steps() })
}

/// The reward over a rectangle through the object of a step.
///
/// # Errors
/// The task has errors.
pub fn map(task: &Task, step: usize, cut: Cut) -> Result<RewardMap, Refusal> {
    let (along, across) = match cut {
        Cut::Front => ([0.0, SIZE_M, 0.0], [0.0, 0.0, SIZE_M]),
        Cut::Side => ([SIZE_M, 0.0, 0.0], [0.0, 0.0, SIZE_M]),
        Cut::Above => ([SIZE_M, 0.0, 0.0], [0.0, SIZE_M, 0.0]),
    };
    let around = |centre: [f64; 3]| {
        let corner = std::array::from_fn(|k| centre[k] - 0.5 * (along[k] + across[k]));
        Slice { corner, along, across, places: [PLACES; 2] }
    };
    let (Slice { corner, places: [columns, rows], .. }, values) = reward_slice(task, step, around)?;
    Ok(RewardMap { corner, along, across, columns, rows, values: values.into_iter().map(|x| x as f32).collect() })
}
