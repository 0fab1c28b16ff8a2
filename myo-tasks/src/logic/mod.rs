//! What happens to one task in one control step, generic over the number that runs it: drawing objects, telling whether
//! steps are done, and the reward.
//!
//! No branch depends on the state: the current step and its object are gathered from tables.

mod arrival;
mod compile;
mod cue;
mod drive;
mod fingers;
mod goal;
mod memory;
mod order;
mod pointer;
mod progress;
mod reward;
mod sample;
mod shift;
mod slide;
mod steer;
mod swing;
mod touch;
mod track;
mod waves;

pub use arrival::Stay;
pub use compile::{CompiledTask, DrawnSphere, Kinds, TaskStep, TouchBox, Weights, Which};
pub use cue::{CueState, StepCue, begin_step};
pub use drive::{DriveStep, GoalDrive, Ride, Vehicles};
pub use fingers::{GoalFinger, GoalPinch, PinchStep, gap, is_pinched_with};
pub use goal::{Goal, GoalButton, begins_at, centre_ahead, sphere};
pub use memory::{Seen, remember};
pub use order::choose_nearest;
pub use pointer::{Face, Landmarks, Pointer};
pub use progress::{Progress, Sensed, advance, inside};
pub use reward::{Efforts, RewardTerms, distance_to_goal, felt, remaining_path, reward};
pub use sample::{MAX_DRAWS, draw_objects};
pub use shift::Shifts;
pub use slide::{DragStep, GoalDrag, Handle};
pub use steer::{GoalSteer, SteerStep, Steering};
pub(crate) use swing::arm;
pub use swing::{GoalSwing, Hold, Sticks, Swing, SwingStep};
pub use touch::{Contact, PRESSERS, Pressing};
pub use track::Tracking;
pub use waves::{DrawnSines, Sines, Wave, Waves};

use crate::motion::SINES;
use myo_scalar::Scalar;

/// Random streams of this crate; [`myo_scalar::Counter::stream`] of object `i` is `TARGET_STREAM + i`.
pub const TARGET_STREAM: u32 = 0x100;

/// A point (m, from the shoulder centre).
pub type Point<S> = [S; 3];

/// State of a task within an episode.
#[derive(Clone, Debug)]
pub struct TaskState<S> {
    /// Centre of each sphere (m).
    pub position: Vec<Point<S>>,
    /// Radius of each sphere (m).
    pub size: Vec<S>,
    /// Per draw, how far off their places groups and boxes stand, or half the sizes of boxes are off the middle of their ranges (m); empty
    /// where nothing of that is drawn.
    pub shifts: Vec<Point<S>>,
    /// Where the waves of each sphere's path begin (turns); empty where nothing moves.
    pub phases: Vec<[S; 4]>,
    /// The waves of each sphere that this episode drew; empty where none are drawn.
    pub sines: Vec<DrawnSines<S>>,
    /// Where the handle of each slider stands, as a share of its way; empty where none is dragged.
    pub values: Vec<S>,
    /// Which step stands at each place of the script; empty where all stand where they are written.
    pub order: Vec<S>,
    /// What the current step waits for; none where all count at once and in the order of the script.
    pub cue: Option<CueState<S>>,
    /// Wrong presses that are still to be corrected; none where none must be.
    pub errors: Option<S>,
    /// Control steps until the user goes on that pressed something wrong; none where it always goes on at once.
    pub pause: Option<S>,
    /// How far the current way has been gone; none where no step has one.
    pub steering: Option<Steering<S>>,
    /// How well spheres were tracked in this episode; none where no step asks for it.
    pub tracking: Option<Tracking<S>>,
    /// How sticks stand; none where there are none to swing.
    pub sticks: Option<Sticks<S>>,
    /// Where vehicles are; none where no step drives one.
    pub vehicles: Option<Vehicles<S>>,
    /// One where fingers are open for a pinch; none where nothing is to be pinched.
    pub open: Option<S>,
    /// What is remembered of the current object; none where it is seen all the time.
    pub seen: Option<Seen<S>>,
    /// Where a cursor that moves by itself stands, see [`Landmarks::cursor`]; none where there is none.
    pub cursor: Option<[S; 2]>,
    /// Steps that took too long; none where they may take as long as they do.
    pub given_up: Option<S>,
    /// Number of steps done or given up.
    pub phase: S,
    /// Control steps inside the current sphere, to the physics step: what [`held`](Self::held) is of a dwell, and zero of all else.
    pub dwell: S,
    /// Physics steps on the current object, up to the end of the last control step; see [`Stay::held`].
    pub held: S,
    /// Physics steps until the button of the current step's press counts as let go, see [`CompiledTask::bounce`]; zero where it is, or was not pressed.
    pub down: S,
    /// What each finger that may press does to boxes, the fingertip first.
    pub pressing: Vec<Pressing<S>>,
    /// Of each of them, one from when it pressed the button that it was asked to until it is off it or the step is over; none where no other finger
    /// presses.
    pub holds: Vec<S>,
    /// Control steps since the episode began.
    pub step: S,
    /// Per step: the control step at which it was done; negative if it was not.
    pub done_at: Vec<S>,
    /// Per step: the physics step, counted from the reset, at which the fingertip came to its object for what counted, see [`advance`];
    /// negative if it did not.
    pub reached_at: Vec<S>,
}

impl<S: Scalar> TaskState<S> {
    /// Before the first episode.
    #[inline(always)]
    pub fn new<T>(task: &CompiledTask<T>) -> Self {
        let (o, spheres, steps) = (S::zero(), task.spheres.len(), task.steps.len());
        Self {
            position: vec![[o; 3]; spheres],
            size: vec![o; spheres],
            shifts: vec![[o; 3]; task.shifts.spans.len()],
            phases: vec![[o; 4]; task.waves.len()],
            sines: vec![[[o; 3]; 3 * SINES]; task.sines.len()],
            tracking: task.kinds.track.then(Tracking::new),
            values: vec![o; task.handles.len()],
            order: if task.orders.is_empty() { vec![] } else { (0..steps).map(|step| S::lit(step as f64)).collect() },
            cue: task.has_cues().then(|| CueState::new(steps)),
            given_up: task.step_limit.is_some().then(S::zero),
            steering: task.kinds.steer.then(Steering::new),
            sticks: task.kinds.swing.then(|| Sticks::new(spheres)),
            vehicles: task.kinds.drive.then(|| Vehicles::new(spheres)),
            errors: task.correction.is_some().then(S::zero),
            pause: task.error_pause.is_some().then(S::zero),
            open: task.kinds.pinch.then(S::zero),
            seen: task.kinds.memory.then(Seen::new),
            cursor: task.pointer.is_rate_cursor().then_some([o; 2]),
            phase: o,
            dwell: o,
            held: o,
            down: o,
            pressing: vec![Pressing::in_the_air(); task.pressers()],
            holds: vec![o; if task.kinds.chord { task.pressers() } else { 0 }],
            step: o,
            done_at: vec![o; steps],
            reached_at: vec![o; steps],
        }
    }

    /// Starts the counters of a new episode where the mask is true.
    #[inline(always)]
    pub fn restart(&mut self, mask: S::Mask) {
        let marks = [&mut self.held, &mut self.down];
        let counters = marks.into_iter().chain([&mut self.phase, &mut self.dwell, &mut self.step]);
        let steering = self.steering.iter_mut().flat_map(Steering::kept);
        let steering = steering.chain(self.tracking.iter_mut().flat_map(Tracking::numbers));
        let steering = steering.chain(self.vehicles.iter_mut().flat_map(Vehicles::numbers));
        let pointed = self.cursor.iter_mut().flatten().chain(self.sticks.iter_mut().map(|sticks| &mut sticks.held));
        for counter in counters
            .chain(&mut self.given_up)
            .chain(&mut self.errors)
            .chain(&mut self.pause)
            .chain(&mut self.open)
            .chain(&mut self.holds)
            .chain(steering)
            .chain(pointed)
        {
            *counter = S::select(mask, S::zero(), *counter);
        }
        let shown_at = self.cue.iter_mut().flat_map(|cue| &mut cue.shown_at);
        for at in self.done_at.iter_mut().chain(&mut self.reached_at).chain(shown_at) {
            *at = S::select(mask, S::lit(-1.0), *at);
        }
        for pressing in &mut self.pressing {
            pressing.forget(mask);
        }
    }

    /// Number of the step that comes `ahead` of the current one, where there is one.
    #[inline(always)]
    pub fn step_ahead(&self, ahead: usize) -> S {
        let place = self.phase + S::lit(ahead as f64);
        if self.order.is_empty() {
            return place;
        }
        let [step] = S::gather(self.order.len(), |k| [self.order[k]], place);
        step
    }

    /// Where a wrong press is to be corrected before anything else.
    #[inline(always)]
    pub fn corrects(&self) -> Option<S::Mask> {
        self.errors.map(|errors| S::lit(0.5).lt(errors))
    }

    /// Where presses do not count because the last one was wrong; none where that makes no difference.
    #[inline(always)]
    pub fn pauses(&self) -> Option<S::Mask> {
        self.pause.map(|left| S::lit(0.5).lt(left))
    }

    /// Where step `index` is the current one, whose number is `current`; after the last is done it stays the current one.
    #[inline(always)]
    pub fn is_current(&self, current: S, index: usize) -> S::Mask {
        if !self.order.is_empty() {
            return is_same(current, S::lit(index as f64));
        }
        let last = index + 1 == self.done_at.len();
        let reached = S::lit(index as f64 - 0.5).lt(current);
        if last { reached } else { reached & current.lt(S::lit(index as f64 + 0.5)) }
    }

    /// Every number, in a fixed order.
    #[inline(always)]
    pub fn numbers(&mut self) -> impl Iterator<Item = &mut S> {
        // All fields are named, so that a new one cannot be forgotten.
        let Self {
            position,
            size,
            shifts,
            phases,
            sines,
            values,
            order,
            cue,
            steering,
            tracking,
            sticks,
            vehicles,
            errors,
            pause,
            open,
            seen,
            cursor,
            given_up,
            phase,
            dwell,
            held,
            down,
            pressing,
            holds,
            step,
            done_at,
            reached_at,
        } = self;
        let points = position.iter_mut().chain(shifts).flatten();
        let waves = phases.iter_mut().flatten().chain(sines.iter_mut().flatten().flatten());
        let objects = points.chain(size).chain(waves);
        let cue = cue
            .iter_mut()
            .flat_map(|CueState { object, lit_at, shown_at }| [object, lit_at].into_iter().chain(shown_at));
        let times = done_at.iter_mut().chain(reached_at);
        let steering = steering.iter_mut().flat_map(Steering::kept);
        let pressing = pressing.iter_mut().flat_map(Pressing::numbers);
        let counters = [phase, dwell, held, down].into_iter().chain(pressing).chain([step]);
        let pointed = seen.iter_mut().flat_map(Seen::numbers).chain(cursor.iter_mut().flatten());
        let script = order
            .iter_mut()
            .chain(cue)
            .chain(times)
            .chain(counters)
            .chain(given_up)
            .chain(errors)
            .chain(pause)
            .chain(open)
            .chain(holds);
        let sticks = sticks.iter_mut().flat_map(Sticks::numbers);
        let sticks = sticks.chain(vehicles.iter_mut().flat_map(Vehicles::numbers));
        let ways = steering.chain(tracking.iter_mut().flat_map(Tracking::numbers));
        objects.chain(values).chain(sticks).chain(script).chain(ways).chain(pointed)
    }

    /// Place and radius of the sphere of this number.
    #[inline(always)]
    fn sphere(&self, number: S) -> (Point<S>, S) {
        let sphere = |index: usize| {
            let [x, y, z] = self.position[index];
            [x, y, z, self.size[index]]
        };
        let [x, y, z, radius] = S::gather(self.position.len(), sphere, number);
        ([x, y, z], radius)
    }
}

/// `a` where the mask is true, else `b`.
#[inline(always)]
pub(crate) fn select_point<S: Scalar>(mask: S::Mask, a: Point<S>, b: Point<S>) -> Point<S> {
    [S::select(mask, a[0], b[0]), S::select(mask, a[1], b[1]), S::select(mask, a[2], b[2])]
}

/// `a - b`.
#[inline(always)]
pub fn difference<S: Scalar>(a: Point<S>, b: Point<S>) -> Point<S> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// Whether two whole numbers are equal.
#[inline(always)]
pub(crate) fn is_same<S: Scalar>(a: S, b: S) -> S::Mask {
    (a - b).abs().lt(S::lit(0.5))
}

/// Scalar product.
#[inline(always)]
pub fn dot<S: Scalar>([a, b, c]: Point<S>, [x, y, z]: Point<S>) -> S {
    a.mul_add(x, b.mul_add(y, c * z))
}

/// Length of a vector (m).
#[inline(always)]
pub fn norm<S: Scalar>(v: Point<S>) -> S {
    dot(v, v).sqrt()
}
