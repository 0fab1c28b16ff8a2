//! Ways between spheres that must not be left: steering (Accot and Zhai 1997, doi:10.1145/258549.258760).
//!
//! A way is straight, from the middle of one sphere into another, and round: it is left where the pointer is farther from the
//! line than half the width. Who leaves it must come back to where it was left.

use super::{CompiledTask, Point, TaskState, difference, dot, norm};
use crate::flat::{Action, Step};
use myo_scalar::{Real, Scalar};

/// The way of a step; zeros where the step is none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SteerStep<T> {
    /// One if the step is a way.
    pub is_steer: T,
    /// Number of the sphere where it begins.
    pub from: T,
    /// Half its width (m).
    pub half_width: T,
}

/// How far the current way has been gone.
#[derive(Clone, Copy, Debug)]
pub struct Steering<S> {
    /// The farthest place along the way that was come to within it (m).
    pub along: S,
    /// One where the pointer is within it.
    pub within: S,
    /// How often it was left, within the control step.
    pub exits: S,
}

/// A way that is to be gone.
#[derive(Clone, Copy, Debug)]
pub struct GoalSteer<S: Scalar> {
    /// Where the step is a way; the rest means nothing elsewhere.
    pub is_steer: S::Mask,
    /// Where it begins (m).
    pub from: Point<S>,
    /// Unit vector to where it ends.
    pub direction: Point<S>,
    /// Its length (m), from centre to centre.
    pub length: S,
    /// How far it must be gone (m): into the sphere at its end.
    pub enough: S,
    /// Half its width (m).
    pub half_width: S,
}

/// Where the pointer is as seen from a way.
#[derive(Clone, Copy, Debug)]
struct Seen<S> {
    /// Along the way (m), beyond its ends too.
    along: S,
    /// From the nearest point of the way (m).
    off: Point<S>,
}

impl<C: Real> SteerStep<C> {
    /// `sphere` gives the number of an object among spheres.
    pub(super) fn new(step: &Step, sphere: impl Fn(usize) -> C) -> Self {
        let c = C::from_f64;
        match step.action {
            Action::Steer { from, width } => Self { is_steer: c(1.0), from: sphere(from), half_width: c(0.5 * width) },
            _ => Self { is_steer: c(0.0), from: c(0.0), half_width: c(0.0) },
        }
    }
}

impl<T> SteerStep<T> {
    #[inline(always)]
    pub(super) fn map<U>(&self, f: &mut impl FnMut(&T) -> U) -> SteerStep<U> {
        SteerStep { is_steer: f(&self.is_steer), from: f(&self.from), half_width: f(&self.half_width) }
    }
}

impl<S: Scalar> Steering<S> {
    /// Where a way begins.
    #[inline(always)]
    pub fn new() -> Self {
        let o = S::zero();
        Self { along: o, within: o, exits: o }
    }

    /// What is kept from one control step to the next.
    #[inline(always)]
    pub(super) fn kept(&mut self) -> [&mut S; 2] {
        [&mut self.along, &mut self.within]
    }

    /// Counts a physics step that began with the pointer here, and tells where the end was reached.
    ///
    /// What is gone of the way grows no faster than by half the width: nobody gets ahead outside.
    #[inline(always)]
    pub(super) fn follow(&mut self, goal: &GoalSteer<S>, pointer: Point<S>) -> S::Mask {
        let Seen { along, off } = goal.see(pointer);
        let is_within = goal.is_steer & norm(off).le(goal.half_width) & along.le(self.along + goal.half_width);
        let is_left = S::lit(0.5).lt(self.within) & !is_within;
        self.exits += S::indicator(is_left);
        self.within = S::indicator(is_within);
        self.along = S::select(is_within, self.along.max(along.min(goal.length)), self.along);
        is_within & goal.enough.le(self.along)
    }
}

impl<S: Scalar> Default for Steering<S> {
    fn default() -> Self {
        Self::new()
    }
}

impl<S: Scalar> GoalSteer<S> {
    /// Of step number `step`, whose way ends in the sphere of this `radius` at `to`.
    #[inline(always)]
    pub(super) fn of(task: &CompiledTask<S>, state: &TaskState<S>, step: S, to: Point<S>, radius: S) -> Self {
        let entry = |k: usize| {
            let SteerStep { is_steer, from, half_width } = task.steers[k];
            [is_steer, from, half_width]
        };
        let [is_steer, from, half_width] = S::gather(task.steers.len(), entry, step);
        let mut is_steer = S::lit(0.5).lt(is_steer);
        if let Some(corrects) = state.corrects() {
            is_steer = is_steer & !corrects;
        }
        let (from, _) = state.sphere(from);
        let way = difference(to, from);
        // Where there is no way the direction means nothing, and must be finite.
        let length = S::select(is_steer, norm(way), S::lit(1.0));
        let enough = (length - radius).max(S::zero());
        Self { is_steer, from, direction: way.map(|x| x * length.recip()), length, enough, half_width }
    }

    #[inline(always)]
    fn see(&self, pointer: Point<S>) -> Seen<S> {
        let seen = difference(pointer, self.from);
        let along = dot(seen, self.direction);
        let ([x, y, z], [a, b, c]) = (seen, self.direction);
        let nearest = along.max(S::zero()).min(self.length);
        Seen { along, off: [x - a * nearest, y - b * nearest, z - c * nearest] }
    }

    /// From the pointer to the farthest place of the way that was come to (m); zeros where the step is none.
    #[inline(always)]
    pub fn to_gone(&self, pointer: Point<S>, along: S) -> Point<S> {
        let from = difference(self.from, pointer);
        let [a, b, c] = self.direction;
        let [x, y, z] = [along.mul_add(a, from[0]), along.mul_add(b, from[1]), along.mul_add(c, from[2])];
        [x.only(self.is_steer), y.only(self.is_steer), z.only(self.is_steer)]
    }

    /// Distance (m) still to go: along the way, and back to where it was left.
    #[inline(always)]
    pub(super) fn left(&self, pointer: Point<S>, steering: &Steering<S>) -> S {
        let back = norm(self.to_gone(pointer, steering.along));
        (self.enough - steering.along).max(S::zero()) + back.only(steering.within.lt(S::lit(0.5)))
    }
}
