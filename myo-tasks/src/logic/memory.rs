//! Objects that are seen until a movement begins, and remembered from then on.

use super::{Goal, Point, TaskState, difference, is_same, norm, select_point};
use myo_scalar::{Mask, Scalar};

/// How far (m) the pointer goes before its movement has begun.
const ONSET: f64 = 0.01;

/// What is remembered of the current object.
#[derive(Clone, Copy, Debug)]
pub struct Seen<S> {
    /// Where it was seen last (m).
    pub centre: Point<S>,
    /// Its size then (m).
    pub size: S,
    /// Where the pointer was when it was shown (m).
    pub from: Point<S>,
    /// One where the movement has begun.
    pub moved: S,
    /// What it is: the number of the step, or a number below zero where a wrong press is to be corrected.
    pub what: S,
}

impl<S: Scalar> Seen<S> {
    /// Before the first episode.
    #[inline(always)]
    pub(super) fn new() -> Self {
        let o = S::zero();
        Self { centre: [o; 3], size: o, from: [o; 3], moved: o, what: o }
    }

    /// Every number, in a fixed order.
    #[inline(always)]
    pub(super) fn numbers(&mut self) -> [&mut S; 9] {
        let Self { centre: [x, y, z], size, from: [a, b, c], moved, what } = self;
        [x, y, z, size, a, b, c, moved, what]
    }
}

/// Looks at the object of the current step while its movement has not begun, and returns the goal as it is known: as it is remembered,
/// once it has; none where it is seen all the time. `begins`: where an episode or a step does. It is another object, too, where a wrong
/// press is to be corrected and where the user takes the steps in any order. What is waited for is seen until it lights up.
#[inline(always)]
pub fn remember<S: Scalar>(
    goal: &Goal<S>,
    pointer: Point<S>,
    begins: S::Mask,
    state: &mut TaskState<S>,
) -> Option<Goal<S>> {
    let step = state.step_ahead(0);
    let seen = state.seen.as_mut()?;
    let what = goal.corrects.map_or(step, |corrects| S::select(corrects, S::lit(-1.0), step));
    let is_still = begins | !goal.lit() | !is_same(what, seen.what);
    seen.what = what;
    seen.from = select_point(is_still, pointer, seen.from);
    let is_away = S::lit(ONSET).lt(norm(difference(pointer, seen.from)));
    let has_moved = (is_away | S::lit(0.5).lt(seen.moved)) & !is_still;
    seen.moved = S::indicator(has_moved);
    seen.centre = select_point(has_moved, seen.centre, goal.centre);
    seen.size = S::select(has_moved, seen.size, goal.size);
    Some(Goal {
        centre: seen.centre,
        size: seen.size,
        moves: goal.moves.map(|moves| moves.map(|x| x.only(!has_moved))),
        remembered: Some(has_moved),
        ..goal.clone()
    })
}

impl<S: Scalar> Goal<S> {
    /// Where it is seen, and not only remembered.
    #[inline(always)]
    pub fn is_seen(&self) -> S::Mask {
        self.remembered.map_or_else(|| S::Mask::splat(true), |remembered| !remembered)
    }
}
