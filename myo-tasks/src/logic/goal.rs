//! What the current step of the task is about, gathered from the tables once.

use super::{CompiledTask, Point, TaskState, TaskStep, TouchBox, select_point};
use myo_scalar::{Mask, Scalar};

/// A step of the task and its object.
#[derive(Clone, Debug)]
pub struct Goal<S: Scalar> {
    /// Centre of the sphere or box (m).
    pub centre: Point<S>,
    /// Radius of the sphere, half the width of the box (m).
    pub size: S,
    /// Control steps to stay in the sphere.
    pub dwell: S,
    /// Whether it is a press; none is where the task has none.
    pub is_press: S::Mask,
    /// The button to press, where there are presses; meaningless where this is none.
    pub button: Option<GoalButton<S>>,
}

/// A button that is to be pressed.
#[derive(Clone, Debug)]
pub struct GoalButton<S: Scalar> {
    /// Its number among the boxes; negative where the step is no press.
    pub number: S,
    /// Where it is, and the force that it needs.
    pub shape: TouchBox<S>,
    /// Whether it must be let go, too.
    pub releases: S::Mask,
}

/// Centre of the object of the step that comes `ahead` of the current one; of the last step's where there is none (m).
#[inline(always)]
pub fn centre_ahead<S: Scalar>(task: &CompiledTask<S>, state: &TaskState<S>, ahead: usize) -> Point<S> {
    let (steps, boxes) = (&task.steps, &task.boxes);
    let step = state.phase + S::lit(ahead as f64);
    let [object, is_press] = S::gather(steps.len(), |k| [steps[k].object, steps[k].is_press], step);
    match (task.kinds.dwell, task.kinds.press) {
        (true, true) => {
            let button = S::gather(boxes.len(), |k| boxes[k].centre, object);
            select_point(S::lit(0.5).lt(is_press), button, state.sphere(object).0)
        }
        (true, false) => state.sphere(object).0,
        (false, _) => S::gather(boxes.len(), |k| boxes[k].centre, object),
    }
}

impl<S: Scalar> Goal<S> {
    /// Of the current step; of the last one when all are done.
    #[inline(always)]
    pub fn of(task: &CompiledTask<S>, state: &TaskState<S>) -> Self {
        let steps = &task.steps;
        let [object, is_press, dwell, releases] = S::gather(
            steps.len(),
            |k| {
                let TaskStep { is_press, object, dwell, releases } = steps[k];
                [object, is_press, dwell, releases]
            },
            state.phase,
        );
        let is_press = match (task.kinds.dwell, task.kinds.press) {
            (true, true) => S::lit(0.5).lt(is_press),
            (_, press) => S::Mask::splat(press),
        };
        let mut goal = Self { centre: [S::zero(); 3], size: S::zero(), dwell, is_press, button: None };
        if task.kinds.dwell {
            (goal.centre, goal.size) = state.sphere(object);
        }
        if task.kinds.press {
            let shape = TouchBox::from_row(S::gather(task.boxes.len(), |k| task.boxes[k].row(), object));
            goal.centre = select_point(is_press, shape.centre, goal.centre);
            goal.size = S::select(is_press, shape.half_size[1], goal.size);
            let number = if task.kinds.dwell { S::select(is_press, object, S::lit(-1.0)) } else { object };
            let releases = if task.kinds.release { S::lit(0.5).lt(releases) } else { S::Mask::splat(false) };
            goal.button = Some(GoalButton { number, shape, releases });
        }
        goal
    }
}
