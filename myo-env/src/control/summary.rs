//! What is summed up over an episode, and the summary at its end.

use crate::columns::Column;
use crate::state::{EnvState, REWARD_TERMS};
use crate::tables::Tables;
use myo_scalar::{Real, Scalar};
use myo_tasks::logic::{self, Progress, RewardTerms, Sensed};

/// Columns of an episode summary, those of its targets aside.
pub const EPISODE_COLUMNS: [Column; 11] = [
    Column::new("return", "", "Sum of the rewards."),
    Column::new("length", "control steps", "Control steps from reset to end."),
    Column::new("success", "", "1 if every target was done, else 0."),
    Column::new("targets_done", "", "Targets that were done."),
    Column::new("final_distance", "m", "From the fingertip to the centre of the current target at the end."),
    Column::new("effort", "", "Squared muscle control, mean over muscles and control steps."),
    Column::new("reward_distance", "", "What the cost of distance and of time added up to, negative."),
    Column::new("reward_subtask", "", "What was given for targets."),
    Column::new("reward_completion", "", "What was given for the whole task."),
    Column::new("reward_neural_effort", "", "What muscle control cost, negative."),
    Column::new("reward_acceleration_effort", "", "What joint accelerations cost, negative."),
];

/// Columns of every target `k`, counted from 1, which are called `target_{k}_` and this.
pub const TARGET_COLUMNS: [Column; 2] = [
    Column::new("success", "", "1 if the target was done, else 0."),
    Column::new(
        "time",
        "s",
        "From the end of the target before it, or from the reset, to its own end, dwell included; NaN if it was not done.",
    ),
];

/// Names of the columns of an episode summary.
pub fn episode_names(ntarget: usize) -> Vec<String> {
    let per_target = (1..=ntarget).flat_map(|k| TARGET_COLUMNS.map(|column| format!("target_{k}_{}", column.name)));
    EPISODE_COLUMNS.iter().map(|column| column.name.to_owned()).chain(per_target).collect()
}

/// Adds the reward terms and the effort of a control step.
#[inline(always)]
pub fn add_up<S: Scalar>(tables: &Tables<S::Const>, env: &mut EnvState<S>, terms: &RewardTerms<S>, effort: S) {
    let terms = terms.array();
    for (sum, term) in env.sums.iter_mut().zip(terms) {
        *sum += term;
    }
    env.sums[REWARD_TERMS] += effort * S::lit(1.0 / tables.plan.nmuscle().max(1) as f64);
}

/// Summary of the episode up to now; meaningful where it just ended.
#[inline(always)]
pub fn summarise<S: Scalar>(
    tables: &Tables<S::Const>,
    env: &EnvState<S>,
    sensed: &Sensed<S>,
    progress: &Progress<S>,
    out: &mut Vec<S>,
) {
    let task = &env.task;
    let mut total = S::zero();
    for &term in &env.sums[..REWARD_TERMS] {
        total += term;
    }
    out.clear();
    out.push(total);
    out.push(task.step);
    out.push(S::indicator(progress.task_done));
    out.push(task.phase);
    out.push(logic::norm(logic::difference(sensed.fingertip, task.centre(0))));
    out.push(env.sums[REWARD_TERMS] * task.step.recip());
    out.extend_from_slice(&env.sums[..REWARD_TERMS]);
    let dt = tables.task.control_dt.to_f64();
    let mut before = S::zero();
    for &done_at in &task.done_at {
        let done = S::zero().lt(done_at);
        out.push(S::indicator(done));
        // Time since the target before was done.
        out.push(S::select(done, (done_at - before) * S::lit(dt), S::lit(f64::NAN)));
        before = done_at;
    }
}
