//! What the current step of the task is about, gathered from the tables once.

use super::waves::moved;
use super::{
    CompiledTask, GoalDrag, GoalDrive, GoalFinger, GoalPinch, GoalSteer, GoalSwing, Point, TaskState, TaskStep,
    TouchBox, cue, drive, fingers, order, select_point, slide, swing,
};
use myo_model::StaticBox;
use myo_scalar::{Mask, Scalar};

/// A step of the task and its object.
#[derive(Clone, Debug)]
pub struct Goal<S: Scalar> {
    /// Centre of the sphere, box, handle or knob at the beginning of the control step (m).
    pub centre: Point<S>,
    /// How far the centre moves within the control step (m); none where all stands still.
    pub moves: Option<Point<S>>,
    /// Radius of the sphere, half the width of the box (m).
    pub size: S,
    /// Control steps to stay in the sphere, a real number; see [`is_stayed`](Self::is_stayed).
    pub dwell: S,
    /// Where all the time inside is added up, or all the time; none where the task has no such step.
    pub follows: Option<S::Mask>,
    /// Where all the time is, inside or not; none where the task has no such step.
    pub tracks: Option<S::Mask>,
    /// Whether it is a press or a drag; none is where the task has none.
    pub is_press: S::Mask,
    /// Where the step counts already; none where all of the task count at once.
    pub is_lit: Option<S::Mask>,
    /// See [`TaskState::pauses`].
    pub pauses: Option<S::Mask>,
    /// Where the object is only remembered; none in tasks in which it is seen all the time.
    pub remembered: Option<S::Mask>,
    /// The way to go, in tasks with ways.
    pub steer: Option<GoalSteer<S>>,
    /// The stick to swing, in tasks with sticks.
    pub swing: Option<GoalSwing<S>>,
    /// The vehicle to drive, in tasks with vehicles.
    pub drive: Option<GoalDrive<S>>,
    /// Number of the finger that points instead of the fingertip, or -1; none in tasks where it always is the fingertip, or what the technique makes of it.
    pub lead: Option<S>,
    /// Where other fingers must be, in tasks that ask for that.
    pub fingers: Vec<GoalFinger<S>>,
    /// The pinch that is asked for, in tasks with pinches.
    pub pinch: Option<GoalPinch<S>>,
    /// Where a wrong press is to be corrected; none where none must be.
    pub corrects: Option<S::Mask>,
    /// The button to press, where there are presses; meaningless where this is none.
    pub button: Option<GoalButton<S>>,
}

/// A button that is to be pressed, or a handle that is to be dragged.
#[derive(Clone, Debug)]
pub struct GoalButton<S: Scalar> {
    /// Its number among the boxes; negative where the step is no press.
    pub number: S,
    /// Where it is, and how large.
    pub shape: StaticBox<S>,
    /// Force that counts as pressed (N).
    pub min_force: S,
    /// Whether it must be let go, too.
    pub releases: S::Mask,
    /// Numbers of the boxes that may be pressed as well, because any order counts; negative where there is none.
    pub open: Vec<S>,
    /// Where it must be dragged, in tasks with sliders.
    pub drag: Option<GoalDrag<S>>,
}

/// Centre of the object, or of the handle, of the step that comes `ahead` of the current one; of the last step's where there is none
/// (m).
#[inline(always)]
pub fn centre_ahead<S: Scalar>(task: &CompiledTask<S>, state: &TaskState<S>, ahead: usize) -> Point<S> {
    let step = state.step_ahead(ahead);
    let drawn = state.cue.as_ref().filter(|_| ahead == 0).map(|cue| cue.object);
    let centre = centre_of_step(task, state, step, drawn);
    match cue::is_lit(task, state) {
        Some(is_lit) => {
            let hidden = cue::hidden(task, state, step, if ahead == 0 { is_lit } else { S::Mask::splat(false) });
            select_point(hidden.mask, hidden.centre, centre)
        }
        None => centre,
    }
}

/// Centre of the object, or of the handle, of a step by its number (m); of the object `drawn` where there is one.
#[inline(always)]
pub(super) fn centre_of_step<S: Scalar>(
    task: &CompiledTask<S>,
    state: &TaskState<S>,
    step: S,
    drawn: Option<S>,
) -> Point<S> {
    let steps = &task.steps;
    let [object, is_press] = S::gather(steps.len(), |k| [steps[k].object, steps[k].is_press], step);
    let object = drawn.unwrap_or(object);
    match (task.kinds.dwell, task.kinds.press) {
        (true, true) => {
            let (button, sphere) = (box_of_step(task, state, step, object), sphere(task, state, object).0);
            select_point(S::lit(0.5).lt(is_press), button, sphere)
        }
        (true, false) => sphere(task, state, object).0,
        (false, _) => box_of_step(task, state, step, object),
    }
}

/// Centre (m) of the box of this number, or of the handle on it that a step asks for.
#[inline(always)]
fn box_of_step<S: Scalar>(task: &CompiledTask<S>, state: &TaskState<S>, step: S, object: S) -> Point<S> {
    let boxes = &task.boxes;
    let place = S::gather(boxes.len(), |k| boxes[k].shape.centre, object);
    let centre = task.shifts.move_box(state, object, place);
    if task.kinds.drag { slide::handle_of_step(task, state, step, centre) } else { centre }
}

/// How far in front of its face the press of a button is begun (m): about the breadth of a hand.
const BEFORE_FACE_M: f64 = 0.1;

/// Where the current step is begun (m): at the beginning of a way, in front of a button, else at its object.
#[inline(always)]
pub fn begins_at<S: Scalar>(task: &CompiledTask<S>, state: &TaskState<S>) -> Point<S> {
    let mut centre = centre_ahead(task, state, 0);
    if task.kinds.press {
        let before = before_face(task, state);
        centre = [0, 1, 2].map(|k| centre[k] + before[k]);
    }
    if !task.kinds.steer {
        return centre;
    }
    let steer = GoalSteer::of(task, state, state.step_ahead(0), centre, S::zero());
    select_point(steer.is_steer, steer.from, centre)
}

/// The way from the button of the current step to where its press is begun (m); none where the step is no press.
#[inline(always)]
fn before_face<S: Scalar>(task: &CompiledTask<S>, state: &TaskState<S>) -> Point<S> {
    let (steps, boxes) = (&task.steps, &task.boxes);
    let step = state.step_ahead(0);
    let [object, is_press] = S::gather(steps.len(), |k| [steps[k].object, steps[k].is_press], step);
    let object = state.cue.as_ref().map_or(object, |cue| cue.object);
    let out = S::gather(boxes.len(), |k| boxes[k].shape.axes[2], object);
    out.map(|x| x * is_press * S::lit(BEFORE_FACE_M))
}

/// Centre of a sphere (m) at the beginning of the control step, its radius (m), and how far it moves within the control step.
#[inline(always)]
pub fn sphere<S: Scalar>(task: &CompiledTask<S>, state: &TaskState<S>, number: S) -> (Point<S>, S, Option<Point<S>>) {
    let (mut centre, radius) = state.sphere(number);
    if task.kinds.swing {
        for (x, off) in centre.iter_mut().zip(swing::swung(task, state, number)) {
            *x += off;
        }
    }
    if task.kinds.drive {
        for (x, off) in centre.iter_mut().zip(drive::driven(task, state, number)) {
            *x += off;
        }
    }
    if !task.kinds.motion {
        return (centre, radius, None);
    }
    let (off, moves) = moved(task, state, number, state.step);
    for (x, off) in centre.iter_mut().zip(off) {
        *x += off;
    }
    (centre, radius, Some(moves))
}

/// The box of this number where it stands, and as large as it is, in this episode.
#[inline(always)]
pub(super) fn touch_box<S: Scalar>(task: &CompiledTask<S>, state: &TaskState<S>, number: S) -> TouchBox<S> {
    let mut it = TouchBox::from_row(S::gather(task.boxes.len(), |k| task.boxes[k].row(), number));
    it.shape.centre = task.shifts.move_box(state, number, it.shape.centre);
    it.shape.half_size = task.shifts.grow_box(state, number, it.shape.half_size);
    it
}

/// See [`GoalButton::open`].
#[inline(always)]
fn open_boxes<S: Scalar>(task: &CompiledTask<S>, state: &TaskState<S>, corrects: Option<S::Mask>) -> Vec<S> {
    let (none, steps) = (S::lit(-1.0), &task.steps);
    let mut open = vec![];
    for order in task.orders.iter().filter(|order| order.is_any) {
        for (place, mut is_open) in order::open_places(order, state) {
            if let Some(corrects) = corrects {
                is_open = is_open & !corrects;
            }
            let [object, is_press] =
                S::gather(steps.len(), |k| [steps[k].object, steps[k].is_press], state.order[place]);
            open.push(S::select(is_open & S::lit(0.5).lt(is_press), object, none));
        }
    }
    open
}

impl<S: Scalar> Goal<S> {
    /// Of the current step; of the last one when all are done. Where a wrong press is to be corrected: of that.
    #[inline(always)]
    pub fn of(task: &CompiledTask<S>, state: &TaskState<S>) -> Self {
        let (steps, number) = (&task.steps, state.step_ahead(0));
        let [object, is_press, dwell, releases] = S::gather(
            steps.len(),
            |k| {
                let TaskStep { is_press, object, dwell, releases } = steps[k];
                [object, is_press, dwell, releases]
            },
            number,
        );
        let mut object = state.cue.as_ref().map_or(object, |cue| cue.object);
        let mut is_press = match (task.kinds.dwell, task.kinds.press) {
            (true, true) => S::lit(0.5).lt(is_press),
            (_, press) => S::Mask::splat(press),
        };
        let mut is_lit = cue::is_lit(task, state);
        let corrects = state.corrects();
        if let (Some(corrects), Some(correction)) = (corrects, task.correction) {
            object = S::select(corrects, correction, object);
            is_press = is_press | corrects;
            is_lit = is_lit.map(|is_lit| is_lit | corrects);
        }
        let follows = task.kinds.follow.then_some(&task.follows);
        let follows = follows.map(|follows| S::gather(follows.len(), |k| [follows[k]], number)[0]);
        let beyond = |least: f64| {
            let is_so = S::lit(least).lt(follows?);
            Some(corrects.map_or(is_so, |corrects| is_so & !corrects))
        };
        let (follows, tracks) = (beyond(0.5), beyond(1.5).filter(|_| task.kinds.track));
        let (centre, size) = ([S::zero(); 3], S::zero());
        let mut goal = Self {
            centre,
            moves: None,
            size,
            dwell,
            follows,
            tracks,
            is_press,
            is_lit,
            pauses: state.pauses(),
            steer: None,
            swing: None,
            drive: None,
            lead: fingers::lead_of(task, number),
            fingers: vec![],
            pinch: GoalPinch::of(task, number, corrects),
            corrects,
            button: None,
            remembered: None,
        };
        if let (Some(lead), Some(corrects)) = (&mut goal.lead, corrects) {
            // The fingertip corrects.
            *lead = S::select(corrects, S::lit(-1.0), *lead);
        }
        goal.fingers = GoalFinger::all(task, state, number, &goal);
        if task.kinds.dwell {
            (goal.centre, goal.size, goal.moves) = sphere(task, state, object);
        }
        if task.kinds.steer {
            let steer = GoalSteer::of(task, state, number, goal.centre, goal.size);
            goal.size = S::select(steer.is_steer, steer.half_width, goal.size);
            goal.steer = Some(steer);
        }
        if task.kinds.swing {
            goal.swing = Some(GoalSwing::of(task, state, number, object));
        }
        if task.kinds.drive {
            goal.drive = Some(GoalDrive::of(task, state, number));
        }
        if task.kinds.press {
            goal.press(task, state, object, releases);
        }
        if let Some(is_lit) = is_lit {
            let hidden = cue::hidden(task, state, number, is_lit);
            goal.centre = select_point(hidden.mask, hidden.centre, goal.centre);
            goal.size = S::select(hidden.mask, hidden.size, goal.size);
            goal.moves = goal.moves.map(|moves| moves.map(|x| x.only(!hidden.mask)));
        }
        goal
    }

    /// Adds the box of this number where the step is a press.
    #[inline(always)]
    fn press(&mut self, task: &CompiledTask<S>, state: &TaskState<S>, object: S, releases: S) {
        let is_press = self.is_press;
        let TouchBox { mut shape, min_force } = touch_box(task, state, object);
        let drag = if task.kinds.drag { Some(GoalDrag::of(task, state, &mut shape)) } else { None };
        self.centre = select_point(is_press, shape.centre, self.centre);
        self.size = S::select(is_press, shape.half_size[1], self.size);
        let number = if task.kinds.dwell { S::select(is_press, object, S::lit(-1.0)) } else { object };
        let number = match self.is_lit {
            Some(is_lit) => S::select(is_lit, number, S::lit(-1.0)),
            None => number,
        };
        let mut releases = if task.kinds.release { S::lit(0.5).lt(releases) } else { S::Mask::splat(false) };
        if let Some(corrects) = self.corrects {
            releases = releases & !corrects;
        }
        let open = open_boxes(task, state, self.corrects);
        self.button = Some(GoalButton { number, shape, min_force, releases, open, drag });
    }

    /// The centre (m) when this share of the control step has passed.
    #[inline(always)]
    pub fn centre_after(&self, share: S) -> Point<S> {
        let mut centre = self.centre;
        if let Some(moves) = self.moves {
            for (x, moves) in centre.iter_mut().zip(moves) {
                *x = moves.mul_add(share, *x);
            }
        }
        centre
    }

    /// Where so many physics steps inside are long enough, `share` of a control step being one. A dwell ends with the physics step that is
    /// nearest to its end, and takes one at least.
    #[inline(always)]
    pub(super) fn is_stayed(&self, held: S, share: f64) -> S::Mask {
        // Whole numbers are compared half a step beside, where rounding decides nothing.
        self.dwell.mul_add(S::lit(share.recip()), S::lit(-0.5)).max(S::lit(0.5)).le(held)
    }

    /// The handle to drag, in tasks with sliders.
    #[inline(always)]
    pub fn drag(&self) -> Option<&GoalDrag<S>> {
        self.button.as_ref()?.drag.as_ref()
    }

    /// Where something counts already.
    #[inline(always)]
    pub fn lit(&self) -> S::Mask {
        self.is_lit.unwrap_or_else(|| S::Mask::splat(true))
    }
}
