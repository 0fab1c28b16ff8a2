//! What happens to one task in one control step, generic over the number that runs it: drawing objects, telling whether
//! steps are done, and the reward.
//!
//! No branch depends on the state: the current step and its object are gathered from tables.

mod arrival;
mod compile;
mod goal;
mod progress;
mod reward;
mod sample;

pub use arrival::{Contact, Stay};
pub use compile::{CompiledTask, DrawnSphere, Kinds, TaskStep, TouchBox, Weights, Which};
pub use goal::{Goal, GoalButton, centre_ahead};
pub use progress::{Progress, Sensed, advance, inside};
pub use reward::{RewardTerms, distance_to_goal, remaining_path, reward};
pub use sample::{MAX_DRAWS, draw_spheres};

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
    /// Number of steps done.
    pub phase: S,
    /// Control steps inside the current sphere without a break.
    pub dwell: S,
    /// Physics steps on the current object without a break, up to the end of the last control step.
    pub held: S,
    /// One where the current step's press has counted and the button was not let go since.
    pub down: S,
    /// Number of the button that the last step pressed and that was not let go since; negative without one.
    pub old: S,
    /// One where a button is down that was not asked for.
    pub wrong: S,
    /// Control steps since the episode began.
    pub step: S,
    /// Per step: the control step at which it was done; negative if it was not.
    pub done_at: Vec<S>,
    /// Per step: the physics step, counted from the reset, at which the fingertip last came to its object, see [`advance`];
    /// negative if it did not.
    pub reached_at: Vec<S>,
}

impl<S: Scalar> TaskState<S> {
    /// Before the first episode.
    #[inline(always)]
    pub fn new(spheres: usize, steps: usize) -> Self {
        let o = S::zero();
        Self {
            position: vec![[o; 3]; spheres],
            size: vec![o; spheres],
            phase: o,
            dwell: o,
            held: o,
            down: o,
            old: S::lit(-1.0),
            wrong: o,
            step: o,
            done_at: vec![o; steps],
            reached_at: vec![o; steps],
        }
    }

    /// Starts the counters of a new episode where the mask is true.
    #[inline(always)]
    pub fn restart(&mut self, mask: S::Mask) {
        let marks = [&mut self.held, &mut self.down, &mut self.wrong];
        for counter in marks.into_iter().chain([&mut self.phase, &mut self.dwell, &mut self.step]) {
            *counter = S::select(mask, S::zero(), *counter);
        }
        for at in self.done_at.iter_mut().chain(&mut self.reached_at).chain([&mut self.old]) {
            *at = S::select(mask, S::lit(-1.0), *at);
        }
    }

    /// Where step `index` is the current one; after the last is done it stays the current one.
    #[inline(always)]
    pub fn is_current(&self, index: usize) -> S::Mask {
        let last = index + 1 == self.done_at.len();
        let reached = S::lit(index as f64 - 0.5).lt(self.phase);
        if last { reached } else { reached & self.phase.lt(S::lit(index as f64 + 0.5)) }
    }

    /// Centre and radius of the sphere of this number.
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

/// Length of a vector (m).
#[inline(always)]
pub fn norm<S: Scalar>(v: Point<S>) -> S {
    v[0].mul_add(v[0], v[1].mul_add(v[1], v[2] * v[2])).sqrt()
}
