//! What is summed up over an episode, and the summary at its end.

use crate::state::{EnvState, REWARD_TERMS};
use crate::tables::Tables;
use myo_scalar::{Real, Scalar};
use myo_tasks::logic::{self, Progress, RewardTerms, Sensed};

/// Columns of an episode summary.
pub fn episode_names(ntarget: usize) -> Vec<String> {
    let fixed = [
        "return",
        "length",
        "success",
        "targets_done",
        "final_distance",
        "effort",
        "reward_distance",
        "reward_subtask",
        "reward_completion",
        "reward_neural_effort",
        "reward_acceleration_effort",
    ];
    let per_target = (1..=ntarget).flat_map(|k| [format!("target_{k}_success"), format!("target_{k}_time")]);
    fixed.into_iter().map(String::from).chain(per_target).collect()
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
