//! Whether the current target is done.

use super::{CompiledTask, Point, TargetKind, TaskState, difference, norm};
use myo_scalar::{Mask, Scalar};

/// What the task sees of the body after a control step.
#[derive(Clone, Copy, Debug)]
pub struct Sensed<S> {
    /// Position of the fingertip (m, from the shoulder centre).
    pub fingertip: Point<S>,
    /// Greatest contact force during the control step (N).
    pub touch_force: S,
    /// Number of the button that it acted on.
    pub touched: S,
    /// Physics step, counted from the reset, at which the fingertip came to the current target; meaningless where it is not
    /// on it. [`Aim`](super::Aim) tells.
    pub reached_at: S,
}

/// What happened in a control step.
#[derive(Clone, Copy, Debug)]
pub struct Progress<S: Scalar> {
    /// The target that was current is done.
    pub target_done: S::Mask,
    /// The last target is done.
    pub task_done: S::Mask,
    /// The time limit is reached and the task is not done.
    pub timed_out: S::Mask,
}

/// Counts the step, judges the current target, and moves on to the next one when it is done. The dwell counter starts
/// again whenever the fingertip leaves and with every new target.
///
/// A target is reached, in [`TaskState::reached_at`], when the fingertip enters a sphere for the dwell that completes it or
/// touches a button for the press that counts. Where that dwell begins is judged with it, at the end of a control step: what
/// the fingertip does between two such ends while a dwell goes on, a slip out and back in, breaks neither.
#[inline(always)]
pub fn advance<S: Scalar>(task: &CompiledTask<S>, sensed: &Sensed<S>, state: &mut TaskState<S>) -> Progress<S> {
    let one = S::lit(1.0);
    let is_inside = inside(sensed, state);
    let enters = is_inside & state.dwell.lt(S::lit(0.5));
    let longer = (state.dwell + one).only(is_inside);
    state.step += one;
    let mut target_done = S::Mask::splat(false);
    for (index, target) in task.targets.iter().enumerate() {
        let current = state.is_current(index);
        let (reached, done) = match target {
            TargetKind::Sphere(sphere) => (enters, sphere.dwell.le(longer)),
            TargetKind::Button(button) => {
                let pressed = is_pressed(button.number, button.min_force, sensed);
                (pressed, pressed)
            }
        };
        let done = current & done;
        state.reached_at[index] = S::select(current & reached, sensed.reached_at, state.reached_at[index]);
        state.done_at[index] = S::select(done, state.step, state.done_at[index]);
        target_done = target_done | done;
    }
    state.dwell = S::select(target_done, S::zero(), longer);
    state.held = S::select(target_done, S::zero(), state.held);
    state.phase += S::indicator(target_done);
    let task_done = S::lit(task.targets.len() as f64 - 0.5).lt(state.phase);
    let timed_out = task.time_limit.le(state.step) & !task_done;
    Progress { target_done, task_done, timed_out }
}

/// Where the fingertip is inside the current sphere. (For buttons the value means nothing.)
#[inline(always)]
pub fn inside<S: Scalar>(sensed: &Sensed<S>, state: &TaskState<S>) -> S::Mask {
    norm(difference(sensed.fingertip, state.centre(0))).lt(state.current_size())
}

#[inline(always)]
fn is_pressed<S: Scalar>(number: usize, min_force: S, sensed: &Sensed<S>) -> S::Mask {
    let this_one = (sensed.touched - S::lit(number as f64)).abs().lt(S::lit(0.5));
    this_one & min_force.le(sensed.touch_force)
}
