//! The reward of a control step.

use super::{
    CompiledTask, Goal, Hold, Point, Progress, Sensed, TaskState, Weights, centre_ahead, difference, dot, fingers, norm,
};
use myo_model::StaticBox;
use myo_scalar::Scalar;

/// Weighted terms of the reward; their sum is the reward.
#[derive(Clone, Copy, Debug)]
pub struct RewardTerms<S> {
    /// Minus the distance, and minus the time.
    pub distance: S,
    /// For a target done, and for being inside what is tracked.
    pub subtask: S,
    /// For the task done.
    pub completion: S,
    /// Minus squared controls.
    pub neural_effort: S,
    /// Minus squared accelerations.
    pub acceleration_effort: S,
    /// Minus squared changes of controls.
    pub control_change: S,
    /// Minus squared forces of contact.
    pub contact: S,
    /// Minus presses that were not asked for.
    pub wrong_press: S,
    /// Minus ways that were left.
    pub exit: S,
}

impl<S: Scalar> RewardTerms<S> {
    /// Their sum.
    #[inline(always)]
    pub fn sum(&self) -> S {
        self.distance
            + self.subtask
            + self.completion
            + self.neural_effort
            + self.acceleration_effort
            + self.control_change
            + self.contact
            + self.wrong_press
            + self.exit
    }
    /// In the order of the fields.
    #[inline(always)]
    pub fn array(&self) -> [S; 9] {
        let Self {
            distance,
            subtask,
            completion,
            neural_effort,
            acceleration_effort,
            control_change,
            contact,
            wrong_press,
            exit,
        } = *self;
        [distance, subtask, completion, neural_effort, acceleration_effort, control_change, contact, wrong_press, exit]
    }
}

/// Distance (m) from the pointer to what counts of the current object at the end of a control step, and of a handle, a stick, a way or a vehicle how
/// far it must still go; zero before the step counts.
#[inline(always)]
pub fn distance_to_goal<S: Scalar>(task: &CompiledTask<S>, sensed: &Sensed<S>, goal: &Goal<S>) -> S {
    let to_centre = norm(difference(sensed.pointer, goal.centre_after(S::lit(1.0))));
    let inside_is_zero = task.weights.inside_is_zero;
    let mut distance = if inside_is_zero { (to_centre - goal.size).max(S::zero()) } else { to_centre };
    if let Some(button) = &goal.button {
        if inside_is_zero {
            distance = S::select(goal.is_press, distance_to_face(&button.shape, sensed.pointer), distance);
        }
        if let Some(drag) = &button.drag {
            let is_held = drag.is_drag & S::lit(0.5).lt(sensed.stay.down);
            distance = S::select(is_held, S::zero(), distance) + drag.left(sensed.stay.value).abs();
        }
    }
    if let Some(swing) = &goal.swing {
        let Hold { angle, held } = sensed.stay.hold;
        let to_knob = swing.distance(sensed.pointer, angle, inside_is_zero).only(held.lt(S::lit(0.5)));
        let mut left = swing.left(angle);
        if let Some(drive) = &goal.drive {
            left = S::select(drive.is_drive, drive.left(sensed.stay.ride.along, inside_is_zero), left);
        }
        distance = S::select(swing.is_swing, to_knob + left, distance);
    }
    if let Some(steer) = &goal.steer {
        distance = S::select(steer.is_steer, steer.left(sensed.pointer, &sensed.stay.steering), distance);
    }
    if task.kinds.also || task.kinds.pinch {
        let inside = to_centre.lt(goal.size);
        distance += fingers::fingers_left(task, goal, &sensed.body, &sensed.stay, inside);
    }
    goal.is_lit.map_or(distance, |is_lit| distance.only(is_lit))
}

/// How much farther it is from behind a face than it is through the button: whoever is there must come round to the front.
const ROUND: f64 = 3.0;

/// Distance (m) to the nearest point of the pressed face. Behind its plane, depth counts [`ROUND`] times: on the straight way there is the
/// button, and whatever it stands on, where a fingertip would stay that is drawn there.
#[inline(always)]
pub(super) fn distance_to_face<S: Scalar>(button: &StaticBox<S>, finger: Point<S>) -> S {
    let from_centre = difference(finger, button.centre);
    let mut excess = [S::zero(); 3];
    for (k, e) in excess.iter_mut().enumerate() {
        let along = dot(from_centre, button.axes[k]);
        let half = button.half_size[k];
        // Out of the face: from its plane. Along it: past its edge.
        let off = along - half;
        *e = if k == 2 { off.max(off * S::lit(-ROUND)) } else { (along.abs() - half).max(S::zero()) };
    }
    norm(excess)
}

/// Length of the path over the centres from the current object to the last (m).
#[inline(always)]
pub fn remaining_path<S: Scalar>(task: &CompiledTask<S>, state: &TaskState<S>) -> S {
    let mut path = S::zero();
    let mut centre = centre_ahead(task, state, 0);
    for ahead in 1..task.steps.len() {
        // Past the last step the object stays the same, and the leg is zero.
        let next = centre_ahead(task, state, ahead);
        path += norm(difference(next, centre));
        centre = next;
    }
    path
}

/// A distance (m) as it is felt: far away it grows no more. After the proximity term of doi 10.1145/3746059.3747779.
#[inline(always)]
pub fn felt<S: Scalar>(distance: S, scale: Option<S>) -> S {
    let Some(scale) = scale else { return distance };
    scale * (S::lit(1.0) - (-distance * scale.recip()).exp())
}

/// What a control step asked of the body, as the reward counts it.
#[derive(Clone, Copy, Debug)]
pub struct Efforts<S> {
    /// Sum over muscles of squared controls.
    pub squared_control: S,
    /// Sum over independent joints of squared accelerations ((rad/s^2)^2).
    pub squared_acceleration: S,
    /// Sum over muscles of squared changes of the control since the control step before.
    pub squared_change: S,
    /// Mean over physics steps of the squared force of all contacts (N^2).
    pub squared_force: S,
}

impl<S: Scalar> Efforts<S> {
    /// None at all.
    #[inline(always)]
    pub fn none() -> Self {
        let o = S::zero();
        Self { squared_control: o, squared_acceleration: o, squared_change: o, squared_force: o }
    }
}

/// The reward of a step. `distance` is what [`distance_to_goal`] and, if it counts, [`remaining_path`] gave before the
/// step was judged.
#[inline(always)]
pub fn reward<S: Scalar>(
    task: &CompiledTask<S>,
    progress: &Progress<S>,
    distance: S,
    efforts: Efforts<S>,
) -> RewardTerms<S> {
    let w = &task.weights;
    let [neural_effort, acceleration_effort, control_change, contact] = movement_costs(w, efforts);
    RewardTerms {
        distance: -(w.distance_cost.mul_add(felt(distance, w.distance_scale), w.time_cost)),
        subtask: w.subtask_bonus * progress.bonuses,
        completion: w.completion_bonus.only(progress.task_done),
        neural_effort: -neural_effort,
        acceleration_effort: -acceleration_effort,
        control_change: -control_change,
        contact: -contact,
        wrong_press: -(w.cost_share * w.wrong_press * progress.wrong_presses),
        exit: -(w.cost_share * w.exit * progress.exits),
    }
}

/// What effort, acceleration, changes of controls and contact cost in a control step. Together they count in full up to
/// [`Weights::dear`], `d`, and from there on a cost `c` as `d (1 + ln(c / d))`.
///
/// An arm in cramps, all of its muscles tensed or pulling in turn, would pay a hundred times as much as one that does what it should, for as long as it does not find out.
/// One such arm among four thousand drowns what a learner could learn from all others. But more must cost more: where it is free beyond
/// a bound, the most violent way to be fast is the best.
#[inline(always)]
fn movement_costs<S: Scalar>(w: &Weights<S>, efforts: Efforts<S>) -> [S; 4] {
    let Efforts { squared_control, squared_acceleration, squared_change, squared_force } = efforts;
    let effort = w.cost_share * w.effort_cost * squared_control;
    let acceleration = w.cost_share * w.acceleration_cost * squared_acceleration;
    let change = w.change_cost.map_or(S::zero(), |cost| w.cost_share * cost * squared_change);
    let contact = w.contact_cost.map_or(S::zero(), |cost| w.cost_share * cost * squared_force);
    let times_dear = ((effort + acceleration + change + contact) * w.dear.recip()).max(S::lit(1.0));
    let paid = (S::lit(1.0) + times_dear.ln()) * times_dear.recip();
    [paid * effort, paid * acceleration, paid * change, paid * contact]
}
