//! What happens to one task in one control step, generic over the number that runs it: drawing targets, telling whether
//! they are done, and the reward.
//!
//! No branch depends on the state: every lane computes every target and selects its own.

mod arrival;
mod compile;
mod progress;
mod reward;
mod sample;

pub use arrival::{Aim, Contact, Stay};
pub use compile::{Button, CompiledTask, Sphere, TargetKind, Weights};
pub use progress::{Progress, Sensed, advance, inside};
pub use reward::{RewardTerms, distance_to_target, remaining_path, reward};
pub use sample::{MAX_DRAWS, draw_spheres, place_buttons};

use myo_scalar::Scalar;

/// Random streams of this crate; [`myo_scalar::Counter::stream`] of target `i` is `TARGET_STREAM + i`.
pub const TARGET_STREAM: u32 = 0x100;

/// A point (m, from the shoulder centre).
pub type Point<S> = [S; 3];

/// State of a task within an episode.
#[derive(Clone, Debug)]
pub struct TaskState<S> {
    /// Centre of each target (m).
    pub position: Vec<Point<S>>,
    /// Radius of each sphere, half the width of each button (m).
    pub size: Vec<S>,
    /// Number of targets done.
    pub phase: S,
    /// Control steps inside the current target without a break.
    pub dwell: S,
    /// Physics steps on the current target without a break, up to the end of the last control step.
    pub held: S,
    /// Control steps since the episode began.
    pub step: S,
    /// Per target: the control step at which it was done; negative if it was not.
    pub done_at: Vec<S>,
    /// Per target: the physics step, counted from the reset, at which the fingertip last came to it, see [`advance`];
    /// negative if it did not.
    pub reached_at: Vec<S>,
}

impl<S: Scalar> TaskState<S> {
    /// Before the first episode.
    #[inline(always)]
    pub fn new(ntarget: usize) -> Self {
        let o = S::zero();
        Self {
            position: vec![[o; 3]; ntarget],
            size: vec![o; ntarget],
            phase: o,
            dwell: o,
            held: o,
            step: o,
            done_at: vec![o; ntarget],
            reached_at: vec![o; ntarget],
        }
    }

    /// Starts the counters of a new episode where the mask is true.
    #[inline(always)]
    pub fn restart(&mut self, mask: S::Mask) {
        for counter in [&mut self.phase, &mut self.dwell, &mut self.held, &mut self.step] {
            *counter = S::select(mask, S::zero(), *counter);
        }
        for at in self.done_at.iter_mut().chain(&mut self.reached_at) {
            *at = S::select(mask, S::lit(-1.0), *at);
        }
    }

    /// Where target `index` is the current one; after the last is done it stays the current one.
    #[inline(always)]
    pub fn is_current(&self, index: usize) -> S::Mask {
        let last = index + 1 == self.position.len();
        let reached = S::lit(index as f64 - 0.5).lt(self.phase);
        if last { reached } else { reached & self.phase.lt(S::lit(index as f64 + 0.5)) }
    }

    /// Centre of the current target, or of the one `ahead` of it; the last one where there is none.
    #[inline(always)]
    pub fn centre(&self, ahead: usize) -> Point<S> {
        let last = self.position.len() - 1;
        let mut centre = self.position[last];
        for index in 0..last {
            centre = select_point(self.is_current(index), self.position[(index + ahead).min(last)], centre);
        }
        centre
    }

    /// Size of the current target (m).
    #[inline(always)]
    pub fn current_size(&self) -> S {
        let mut size = self.size[self.size.len() - 1];
        for index in 0..self.size.len() - 1 {
            size = S::select(self.is_current(index), self.size[index], size);
        }
        size
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
