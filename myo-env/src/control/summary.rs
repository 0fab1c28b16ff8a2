//! What is summed up over an episode, and the summary at its end.

use crate::columns::{self, Column};
use crate::parameters::World;
use crate::state::{EFFORT_SUM, EXIT_SUM, EnvState, FATIGUE_SUM, REWARD_TERMS, ROUNDS_SUM, UNSOLVED_SUM, WRONG_SUM};
use myo_dynamics::SolverTally;
use myo_scalar::Scalar;
use myo_tasks::logic::{self, Goal, Progress, Sensed};

/// Columns of an episode summary, those of its targets aside.
pub const EPISODE_COLUMNS: [Column; 22] = [
    columns::RETURN,
    columns::LENGTH,
    Column::new("success", "", "1 if every target was done, else 0."),
    Column::new("targets_done", "", "Targets that were done."),
    Column::new(
        "final_distance",
        "m",
        "From the fingertip, or the pointer, to the centre of the current target at the end.",
    ),
    columns::EFFORT,
    columns::FATIGUE,
    Column::new("reward_distance", "", "What the cost of distance and of time added up to, negative."),
    Column::new("reward_subtask", "", "What was given for targets, and for being inside what was tracked."),
    Column::new("reward_completion", "", "What was given for the whole task."),
    Column::new("reward_neural_effort", "", "What muscle control cost, negative."),
    Column::new("reward_acceleration_effort", "", "What joint accelerations cost, negative."),
    Column::new("reward_control_change", "", "What changing controls cost, negative."),
    Column::new("reward_contact", "", "What touching hard cost, negative."),
    Column::new("reward_wrong_press", "", "What presses cost that were not asked for, negative."),
    Column::new("reward_exit", "", "What leaving ways cost, negative."),
    columns::SOLVER_ROUNDS,
    columns::SOLVER_UNSOLVED,
    Column::new("wrong_presses", "", "How often a button was pressed that the current step did not ask for."),
    Column::new("exits", "", "How often a way was left that was to be steered along."),
    Column::new(
        "on_target",
        "",
        "Share of the time of `track` steps in which the pointer was inside the sphere; NaN without such steps.",
    ),
    Column::new(
        "tracking_error",
        "m",
        "From the pointer to the centre of the sphere that is to be tracked, root mean square over the time of `track` steps; NaN without such \
         steps.",
    ),
];

/// Columns of every target `k`, counted from 1, which are called `target_{k}_` and this.
pub const TARGET_COLUMNS: [Column; 3] = [
    Column::new("success", "", "1 if the target was done, else 0."),
    Column::new(
        "time",
        "s",
        "From the start of the target, which is the end of the one before it or the reset, or later, when it lit up or the wait \
         was over, to its own end, dwell included, in whole control steps; NaN if it was not done.",
    ),
    Column::new(
        "movement_time",
        "s",
        "From the start of the target to the last entry into the sphere, after which the dwell ran through, or into the knob that was \
         left at the right angle, to the end of a way, or to the onset of the contact that pressed the button or took hold of the \
         handle: without dwell, in whole physics steps; 0 if the fingertip was there at the start, \
         NaN if the target was not done.",
    ),
];

/// Names of the columns of an episode summary.
pub fn episode_names(ntarget: usize) -> Vec<String> {
    let per_target = (1..=ntarget).flat_map(|k| TARGET_COLUMNS.map(|column| format!("target_{k}_{}", column.name)));
    EPISODE_COLUMNS.iter().map(|column| column.name.to_owned()).chain(per_target).collect()
}

/// Adds the reward terms, in their order and at most so many, the effort, what fatigues, and the solver's work of a control step.
#[inline(always)]
pub fn add_up<S: Scalar>(
    world: &World<'_, S>,
    env: &mut EnvState<S>,
    terms: &[S],
    [wrong_presses, exits]: [S; 2],
    effort: S,
    solver: &SolverTally<S>,
) {
    for (sum, &term) in env.sums.iter_mut().zip(terms) {
        *sum += term;
    }
    env.sums[EFFORT_SUM] += effort * S::lit(1.0 / world.tables.plan.nmuscle().max(1) as f64);
    for (&share, &act) in world.tables.fatigue.iter().zip(&env.body.act) {
        env.sums[FATIGUE_SUM] = act.mul_add(S::lit(share), env.sums[FATIGUE_SUM]);
    }
    env.sums[ROUNDS_SUM] += S::from_word(solver.rounds);
    env.sums[UNSOLVED_SUM] += S::from_word(solver.unsolved);
    env.sums[WRONG_SUM] += wrong_presses;
    env.sums[EXIT_SUM] += exits;
}

/// Summary of the episode up to now; meaningful where it just ended.
#[inline(always)]
pub fn summarise<S: Scalar>(
    world: &World<'_, S>,
    goal: &Goal<S>,
    env: &EnvState<S>,
    sensed: &Sensed<S>,
    progress: &Progress<S>,
    out: &mut Vec<S>,
) {
    let task = &env.task;
    out.clear();
    out.push(total_reward(env));
    out.push(task.step);
    out.push(S::indicator(progress.task_done));
    out.push(task.given_up.map_or(task.phase, |given_up| task.phase - given_up));
    out.push(logic::norm(logic::difference(sensed.pointer, goal.centre)));
    let per_step = task.step.recip();
    out.extend([env.sums[EFFORT_SUM] * per_step, env.sums[FATIGUE_SUM]]);
    out.extend_from_slice(&env.sums[..REWARD_TERMS]);
    out.push(env.sums[ROUNDS_SUM] * per_step * S::lit(1.0 / f64::from(world.tables.substeps)));
    out.push(env.sums[UNSOLVED_SUM]);
    out.push(env.sums[WRONG_SUM]);
    out.push(env.sums[EXIT_SUM]);
    let none = S::lit(f64::NAN);
    out.extend(task.tracking.map_or([none; 2], |tracking| [tracking.on_target(), tracking.error()]));
    let timestep = world.tables.timestep;
    let dt = f64::from(world.tables.substeps) * timestep;
    let substeps = S::lit(f64::from(world.tables.substeps));
    let mut start = S::zero();
    for (step, (&done_at, &reached_at)) in task.done_at.iter().zip(&task.reached_at).enumerate() {
        let done = S::zero().lt(done_at);
        // What must be waited for begins when it may be gone for, what has no fixed order after the step done before it.
        start = task.cue.as_ref().map_or(start, |cue| cue.shown_at[step]);
        let where_done = |time| S::select(done, time, S::lit(f64::NAN));
        out.push(S::indicator(done));
        out.push(where_done((done_at - start) * S::lit(dt)));
        let mut movement = (reached_at - start * substeps) * S::lit(timestep);
        if world.parameters.task.kinds.track {
            // What is tracked is not moved to.
            let follows = world.parameters.task.follows[step];
            movement = S::select(S::lit(1.5).lt(follows), none, movement);
        }
        out.push(where_done(movement));
        start = done_at;
    }
}

/// The same under rules, in the order of [`RULES_COLUMNS`](crate::RULES_COLUMNS), where it just ended with success, or as failed.
#[inline(always)]
pub fn summarise_own<S: Scalar>(world: &World<'_, S>, env: &EnvState<S>, ended: [S::Mask; 2], out: &mut Vec<S>) {
    let (step, [success, failed]) = (env.task.step, ended);
    let per_step = step.recip();
    out.clear();
    out.extend([total_reward(env), step, S::indicator(success), S::indicator(failed)]);
    out.extend([env.sums[EFFORT_SUM] * per_step, env.sums[FATIGUE_SUM]]);
    out.push(env.sums[ROUNDS_SUM] * per_step * S::lit(1.0 / f64::from(world.tables.substeps)));
    out.push(env.sums[UNSOLVED_SUM]);
}

#[inline(always)]
fn total_reward<S: Scalar>(env: &EnvState<S>) -> S {
    let mut total = S::zero();
    for &term in &env.sums[..REWARD_TERMS] {
        total += term;
    }
    total
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control::{Scratch, control_step, reset};
    use crate::tables::Tables;
    use myo_scalar::Word;

    /// No model is known whose steps the solver leaves unsolved, so its tally is made up.
    #[test]
    fn steps_left_unsolved_are_summed_up_and_forgotten_with_the_episode() {
        let task = myo_tasks::preset("pointing-single").unwrap();
        let model = myo_model::Model::new(&myo_model::builtin(&task.model).unwrap()).unwrap();
        let tables = Tables::<f64>::exact(&model, &task).unwrap();
        let (mut env, mut ws) = (EnvState::new(&tables), Scratch::new(&tables));
        let names = episode_names(tables.steps());
        let column = names.iter().position(|name| name == "solver_unsolved").unwrap();
        let word = <f64 as Scalar>::Word::splat;
        let (rounds, unsolved) = (word(300), word(2));
        let world = &tables.splat();
        reset(world, true, &mut env, &mut ws);
        for _ in 0..3 {
            add_up(world, &mut env, &[], [0.0; 2], 0.0, &SolverTally { rounds, unsolved });
        }
        control_step(world, &mut env, &mut ws);
        assert_eq!(ws.episode[column], 6.0);
        let own = ws.episode[column - 1] - 900.0 / f64::from(tables.substeps);
        assert!((1.0..2.0).contains(&own), "{own}");
        assert!(ws.physics.tally.rounds != rounds, "the next step counts anew");

        reset(world, true, &mut env, &mut ws);
        control_step(world, &mut env, &mut ws);
        assert_eq!(ws.episode[column], 0.0);
        assert!((1.0..2.0).contains(&ws.episode[column - 1]), "{}", ws.episode[column - 1]);
    }
}
