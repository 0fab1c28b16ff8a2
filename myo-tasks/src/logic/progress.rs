//! Whether the current step is done.

use super::{CompiledTask, Goal, Point, Stay, TaskState, difference, norm};
use myo_scalar::Scalar;

/// What the task sees of the body after a control step.
#[derive(Clone, Copy, Debug)]
pub struct Sensed<S> {
    /// Position of the fingertip (m, from the shoulder centre).
    pub fingertip: Point<S>,
    /// What it did with the current object during the control step.
    pub stay: Stay<S>,
    /// Physics step at the end of the control step, counted from the reset.
    pub now: S,
}

/// What happened in a control step.
#[derive(Clone, Copy, Debug)]
pub struct Progress<S: Scalar> {
    /// The step that was current is done.
    pub target_done: S::Mask,
    /// The last step is done.
    pub task_done: S::Mask,
    /// The time limit is reached and the task is not done.
    pub timed_out: S::Mask,
    /// How often a button was pressed that was not asked for.
    pub wrong_presses: S,
}

/// Counts the control step, judges the current step of the task, and moves on to the next one when it is done. The dwell counter
/// starts again whenever the fingertip leaves and with every new step of the task.
///
/// An object is reached, in [`TaskState::reached_at`], when the fingertip enters a sphere for the dwell that completes it or
/// touches a button for the press that counts. Where that dwell begins is judged with it, at the end of a control step: what
/// the fingertip does between two such ends while a dwell goes on, a slip out and back in, breaks neither.
#[inline(always)]
pub fn advance<S: Scalar>(
    task: &CompiledTask<S>,
    goal: &Goal<S>,
    sensed: &Sensed<S>,
    state: &mut TaskState<S>,
) -> Progress<S> {
    let one = S::lit(1.0);
    let is_inside = inside(sensed, goal);
    let longer = (state.dwell + one).only(is_inside);
    let (mut reached, mut done) = (is_inside & state.dwell.lt(S::lit(0.5)), goal.dwell.le(longer));
    if let Some(button) = &goal.button {
        let pressed = S::zero().lt(sensed.stay.pressed);
        let let_go = S::lit(0.5).lt(sensed.stay.let_go);
        let is_over = (button.releases & let_go) | (!button.releases & pressed);
        reached = (goal.is_press & pressed) | (!goal.is_press & reached);
        done = (goal.is_press & is_over) | (!goal.is_press & done);
    }
    state.step += one;
    let reached_at = sensed.now - sensed.stay.since_arrival();
    for index in 0..task.steps.len() {
        let current = state.is_current(index);
        state.reached_at[index] = S::select(current & reached, reached_at, state.reached_at[index]);
        state.done_at[index] = S::select(current & done, state.step, state.done_at[index]);
    }
    state.dwell = S::select(done, S::zero(), longer);
    state.held = S::select(done, S::zero(), sensed.stay.held);
    if task.kinds.release {
        hand_over(goal, &sensed.stay, done, state);
        state.wrong = sensed.stay.wrong;
    }
    state.phase += S::indicator(done);
    let task_done = S::lit(task.steps.len() as f64 - 0.5).lt(state.phase);
    let timed_out = task.time_limit.le(state.step) & !task_done;
    Progress { target_done: done, task_done, timed_out, wrong_presses: sensed.stay.wrong_presses }
}

/// A button that is still down when its step is done must be let go before it can be pressed again.
#[inline(always)]
fn hand_over<S: Scalar>(goal: &Goal<S>, stay: &Stay<S>, done: S::Mask, state: &mut TaskState<S>) {
    let Some(button) = &goal.button else { return };
    let stays_down = done & S::lit(0.5).lt(stay.down);
    state.old = S::select(stays_down, button.number, stay.old);
    state.down = S::select(done, S::zero(), stay.down);
}

/// Where the fingertip is inside the current sphere. (For buttons the value means nothing.)
#[inline(always)]
pub fn inside<S: Scalar>(sensed: &Sensed<S>, goal: &Goal<S>) -> S::Mask {
    norm(difference(sensed.fingertip, goal.centre)).lt(goal.size)
}
