//! Whether the current step is done.

use super::{CompiledTask, Goal, Landmarks, Point, Stay, TaskState, difference, is_same, norm};
use myo_scalar::Scalar;

/// What the task sees of the body after a control step.
#[derive(Clone, Copy, Debug)]
pub struct Sensed<S> {
    /// Where the body is.
    pub body: Landmarks<S>,
    /// Position of what points (m, from the shoulder centre): the fingertip, or what the technique makes of the posture.
    pub pointer: Point<S>,
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
    /// It is over: done, or given up since it took too long.
    pub target_over: S::Mask,
    /// Every step is done.
    pub task_done: S::Mask,
    /// Every step is over: done, or given up.
    pub task_over: S::Mask,
    /// The episode ends and the task is not done: the time limit is reached, or all steps are over and some of them were given up.
    pub timed_out: S::Mask,
    /// How often a button was pressed that was not asked for.
    pub wrong_presses: S,
    /// How often a way was left.
    pub exits: S,
    /// What of the bonus for a target is earned: one where a target is done, and of what is tracked the seconds inside.
    pub bonuses: S,
}

/// Counts the control step, judges the current step of the task or the correction of a wrong press, and moves on to the next one
/// when it is done, or takes too long; `share` of a control step is a physics step. How long the fingertip stayed counts from zero again whenever it leaves, to
/// the physics step, and with every new step of the task.
///
/// An object is reached, in [`TaskState::reached_at`], when the fingertip enters a sphere for the dwell that completes it, first enters what it
/// follows, touches a button or a handle for the press or the drag that counts, comes into the knob that it leaves at the right angle, or to
/// the end of a way, and where what it drives stops. What was completed within the control step stays so, wherever the fingertip is at its end.
#[inline(always)]
pub fn advance<S: Scalar>(
    task: &CompiledTask<S>,
    goal: &Goal<S>,
    sensed: &Sensed<S>,
    state: &mut TaskState<S>,
    share: f64,
) -> Progress<S> {
    let (one, half) = (S::lit(1.0), S::lit(0.5));
    let arrived = S::zero().lt(sensed.stay.pressed);
    let (mut reached, mut done) = (arrived, arrived);
    if let Some(follows) = goal.follows {
        // Entered long before it is done.
        done = (follows & goal.is_stayed(sensed.stay.held, share)) | (!follows & arrived);
    }
    if let Some(button) = &goal.button {
        let let_go = half.lt(sensed.stay.let_go);
        done = (button.releases & let_go) | (!button.releases & done);
    }
    if let Some(swing) = &goal.swing {
        // Where it is taken and left within one control step, it is left that counts.
        let taken = half.lt(sensed.stay.held) | (arrived & state.held.lt(half));
        reached = (swing.is_swing & taken) | (!swing.is_swing & reached);
    }
    state.step += one;
    let reached_at = sensed.now - sensed.stay.since_arrival();
    // What corrects a wrong press is none of the steps.
    let mut is_over = done;
    if let Some(corrects) = goal.corrects {
        (reached, done) = (reached & !corrects, done & !corrects);
        count_errors(&sensed.stay, is_over & corrects, state);
    }
    let mut target_over = done;
    if let Some(gives_up) = gives_up(task, goal, done, state) {
        (target_over, is_over) = (done | gives_up, is_over | gives_up);
    }
    let number = state.step_ahead(0);
    for index in 0..task.steps.len() {
        let current = state.is_current(number, index);
        state.reached_at[index] = S::select(current & reached, reached_at, state.reached_at[index]);
        state.done_at[index] = S::select(current & done, state.step, state.done_at[index]);
        if let Some(cue) = &mut state.cue {
            cue.shown_at[index] = S::select(current, cue.lit_at, cue.shown_at[index]);
        }
    }
    state.held = S::select(is_over, S::zero(), sensed.stay.held);
    if task.kinds.dwell {
        state.dwell = (state.held * S::lit(share)).only(is_stay(goal));
    }
    if task.kinds.release {
        state.down = S::select(is_over, S::zero(), sensed.stay.down);
        for (pressing, now) in state.pressing.iter_mut().zip(&sensed.stay.pressing) {
            *pressing = *now;
        }
        for (holds, now) in state.holds.iter_mut().zip(&sensed.stay.holds) {
            *holds = now.only(!is_over);
        }
    }
    if let Some(drag) = goal.drag() {
        for (number, value) in state.values.iter_mut().enumerate() {
            let is_it = drag.is_drag & is_same(drag.slider, S::lit(number as f64));
            *value = S::select(is_it, sensed.stay.value, *value);
        }
    }
    if let Some(steering) = &mut state.steering {
        *steering = sensed.stay.steering;
        for kept in steering.kept() {
            *kept = kept.only(!target_over);
        }
    }
    if let Some(tracking) = &mut state.tracking {
        tracking.add(&sensed.stay.tracking);
    }
    if let (Some(sticks), Some(swing)) = (&mut state.sticks, &goal.swing) {
        sticks.update(swing, &sensed.stay.hold, target_over);
    }
    if let (Some(vehicles), Some(drive)) = (&mut state.vehicles, &goal.drive) {
        vehicles.update(drive, &sensed.stay.ride, target_over);
    }
    if let Some(open) = &mut state.open {
        // What is pinched next asks for fingers that opened before.
        *open = sensed.stay.open.only(!target_over);
    }
    if let Some(cursor) = &mut state.cursor {
        *cursor = sensed.stay.cursor;
    }
    pause(task, sensed.stay.wrong_presses, state);
    state.phase += S::indicator(target_over);
    let mut task_over = S::lit(task.steps.len() as f64 - 0.5).lt(state.phase);
    if let Some(corrects) = state.corrects() {
        task_over = task_over & !corrects;
    }
    let task_done = state.given_up.map_or(task_over, |given_up| task_over & given_up.lt(half));
    let timed_out = (task_over | task.time_limit.le(state.step)) & !task_done;
    let Stay { wrong_presses, steering, .. } = sensed.stay;
    let bonuses = bonuses(task, goal, &sensed.stay, done, share);
    Progress {
        target_done: done,
        target_over,
        task_done,
        task_over,
        timed_out,
        wrong_presses,
        exits: steering.exits,
        bonuses,
    }
}

/// Counts the current step among those that are given up where it takes too long and is not `done`, and tells where, if that can be. Time passes from when it counts, and
/// it is not given up while a wrong press must be corrected.
#[inline(always)]
fn gives_up<S: Scalar>(
    task: &CompiledTask<S>,
    goal: &Goal<S>,
    done: S::Mask,
    state: &mut TaskState<S>,
) -> Option<S::Mask> {
    let (limit, cue, given_up) = (task.step_limit?, state.cue.as_ref()?, state.given_up.as_mut()?);
    let mut gives_up = (cue.lit_at + limit).le(state.step) & !done;
    if let Some(corrects) = goal.corrects {
        gives_up = gives_up & !corrects;
    }
    *given_up += S::indicator(gives_up);
    Some(gives_up)
}

/// See [`Progress::bonuses`].
#[inline(always)]
fn bonuses<S: Scalar>(task: &CompiledTask<S>, goal: &Goal<S>, stay: &Stay<S>, done: S::Mask, share: f64) -> S {
    let bonus = S::indicator(done);
    match (goal.tracks, task.control_s) {
        (Some(tracks), Some(control_s)) => {
            (stay.tracking.inside * control_s).mul_add(S::lit(share), bonus.only(!tracks))
        }
        _ => bonus,
    }
}

/// Who pressed something wrong in this control step goes on some time later.
#[inline(always)]
fn pause<S: Scalar>(task: &CompiledTask<S>, wrong_presses: S, state: &mut TaskState<S>) {
    let (Some(left), Some(whole)) = (&mut state.pause, task.error_pause) else { return };
    let passes = (*left - S::lit(1.0)).max(S::zero());
    *left = S::select(S::lit(0.5).lt(wrong_presses), whole, passes);
}

/// Where the step is to stay in a sphere.
#[inline(always)]
fn is_stay<S: Scalar>(goal: &Goal<S>) -> S::Mask {
    let is_stay = !goal.is_press;
    goal.swing.as_ref().map_or(is_stay, |swing| is_stay & !swing.is_swing)
}

/// Every wrong press is to be corrected, by a press of its own. `corrected`: where one just was.
#[inline(always)]
fn count_errors<S: Scalar>(stay: &Stay<S>, corrected: S::Mask, state: &mut TaskState<S>) {
    let Some(errors) = &mut state.errors else { return };
    *errors += stay.wrong_presses - S::indicator(corrected);
}

/// Where the pointer is inside the current sphere, for a goal that was gathered there and then. (For buttons the value means
/// nothing.)
#[inline(always)]
pub fn inside<S: Scalar>(sensed: &Sensed<S>, goal: &Goal<S>) -> S::Mask {
    norm(difference(sensed.pointer, goal.centre)).lt(goal.size)
}
