//! The reward of a control step.

use super::{Button, CompiledTask, Progress, Sensed, TargetKind, TaskState, difference, norm};
use myo_scalar::Scalar;

/// Weighted terms of the reward; their sum is the reward.
#[derive(Clone, Copy, Debug)]
pub struct RewardTerms<S> {
    /// Minus the distance, and minus the time.
    pub distance: S,
    /// For a target done.
    pub subtask: S,
    /// For the task done.
    pub completion: S,
    /// Minus squared controls.
    pub neural_effort: S,
    /// Minus squared accelerations.
    pub acceleration_effort: S,
}

impl<S: Scalar> RewardTerms<S> {
    /// Their sum.
    #[inline(always)]
    pub fn sum(&self) -> S {
        self.distance + self.subtask + self.completion + self.neural_effort + self.acceleration_effort
    }
    /// In the order of the fields.
    #[inline(always)]
    pub fn array(&self) -> [S; 5] {
        [self.distance, self.subtask, self.completion, self.neural_effort, self.acceleration_effort]
    }
}

/// Distance (m) from the fingertip to what counts of the current target, before [`super::advance`].
#[inline(always)]
pub fn distance_to_target<S: Scalar>(task: &CompiledTask<S>, sensed: &Sensed<S>, state: &TaskState<S>) -> S {
    let to_centre = norm(difference(sensed.fingertip, state.centre(0)));
    if !task.weights.inside_is_zero {
        return to_centre;
    }
    let mut distance = (to_centre - state.current_size()).max(S::zero());
    for (index, target) in task.targets.iter().enumerate() {
        if let TargetKind::Button(button) = target {
            distance = S::select(state.is_current(index), distance_to_face(button, sensed), distance);
        }
    }
    distance
}

/// Distance (m) to the nearest point of the pressed face.
#[inline(always)]
fn distance_to_face<S: Scalar>(button: &Button<S>, sensed: &Sensed<S>) -> S {
    let from_centre = difference(sensed.fingertip, button.centre);
    let mut excess = [S::zero(); 3];
    for (k, e) in excess.iter_mut().enumerate() {
        let axis = button.axes[k];
        let along = from_centre[0].mul_add(axis[0], from_centre[1].mul_add(axis[1], from_centre[2] * axis[2]));
        let half = button.half_size[k];
        // Out of the face: from its plane. Along it: past its edge.
        *e = if k == 2 { along - half } else { (along.abs() - half).max(S::zero()) };
    }
    norm(excess)
}

/// Length of the path over the centres from the current target to the last (m), before [`super::advance`].
#[inline(always)]
pub fn remaining_path<S: Scalar>(state: &TaskState<S>) -> S {
    let mut path = S::zero();
    for index in 1..state.position.len() {
        let leg = norm(difference(state.position[index], state.position[index - 1]));
        path += leg.only(state.phase.lt(S::lit(index as f64 - 0.5)));
    }
    path
}

/// The reward of a step. `distance` is what [`distance_to_target`] and, if it counts, [`remaining_path`] gave before the
/// step was judged; sums run over muscles and independent joints.
#[inline(always)]
pub fn reward<S: Scalar>(
    task: &CompiledTask<S>,
    progress: &Progress<S>,
    distance: S,
    squared_control: S,
    squared_acceleration: S,
) -> RewardTerms<S> {
    let w = &task.weights;
    RewardTerms {
        distance: -(w.distance.mul_add(distance, w.time_cost)),
        subtask: w.subtask_bonus.only(progress.target_done),
        completion: w.completion_bonus.only(progress.task_done),
        neural_effort: -(w.neural_effort * squared_control),
        acceleration_effort: -(w.acceleration_effort * squared_acceleration),
    }
}
