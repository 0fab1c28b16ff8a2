//! Sticks on hinges: where a knob is, and where it must be left.
//!
//! A knob is held from where the pointer comes into it to where the pointer leaves it. In between it follows the pointer on its
//! circle: of small steps only those across the circle leave it, and those beyond the end of its swing.

use super::{CompiledTask, Point, TaskState, difference, dot, is_same, norm};
use crate::flat::{Action, Object, Shape, Step};
use crate::stick::Stick;
use myo_scalar::{Counter, Real, Scalar, Word, philox, unit};

/// Random streams of how sticks stand when an episode begins; that of object `i` is this and `i`.
const STICK_STREAM: u32 = 0x700;

/// How a sphere goes on a circle about its place, if it is the knob of a stick; of one that is none, zeros.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Swing<T> {
    /// From the hinge to the middle of the knob at an angle of 0 (m).
    pub upright: [T; 3],
    /// The same at a right angle (m).
    pub aside: [T; 3],
    /// Least angle (rad),
    pub least: T,
    /// and greatest.
    pub most: T,
    /// How it stands when an episode begins: the least angle (rad),
    pub start: T,
    /// and how much more at most.
    pub start_extent: T,
    /// How much of its angle a spring takes back in a control step where its knob is not held; zero where it stays.
    pub back: T,
}

/// How a step wants a stick; zeros where it is about none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SwingStep<T> {
    /// One if it is about a stick.
    pub is_swing: T,
    /// At which angle it must be left (rad).
    pub to: T,
    /// How far off that it may be (rad).
    pub within: T,
}

/// How sticks stand.
#[derive(Clone, Debug)]
pub struct Sticks<S> {
    /// Per sphere, the angle of the stick whose knob it is (rad).
    pub angles: Vec<S>,
    /// One where the knob of the current stick is held.
    pub held: S,
}

/// How the current stick stands, followed to the physics step.
#[derive(Clone, Copy, Debug)]
pub struct Hold<S> {
    /// Its angle (rad).
    pub angle: S,
    /// One where its knob is held.
    pub held: S,
}

/// A stick that is to be swung.
#[derive(Clone, Copy, Debug)]
pub struct GoalSwing<S: Scalar> {
    /// Where the step is about a stick; the rest means nothing elsewhere.
    pub is_swing: S::Mask,
    /// Number of its knob among spheres.
    pub knob: S,
    /// Radius of the knob (m).
    pub radius: S,
    /// Its hinge (m).
    pub hinge: Point<S>,
    /// From the hinge to the middle of the knob at an angle of 0 (m).
    pub upright: Point<S>,
    /// The same at a right angle (m).
    pub aside: Point<S>,
    /// Least angle (rad),
    pub least: S,
    /// and greatest.
    pub most: S,
    /// At which angle it must be left (rad).
    pub to: S,
    /// How far off that it may be (rad).
    pub within: S,
    /// Its angle at the beginning of the control step (rad).
    pub angle: S,
    /// See [`Swing::back`].
    pub back: S,
}

impl<C: Real> Swing<C> {
    /// Of an object that is a sphere or a stick.
    pub(super) fn new(object: &Object, control_dt_s: f64) -> Self {
        let c = C::from_f64;
        let o = c(0.0);
        let Shape::Stick(Stick { upright, aside, range, start, springs_back_s, .. }) = &object.shape else {
            return Self { upright: [o; 3], aside: [o; 3], least: o, most: o, start: o, start_extent: o, back: o };
        };
        Self {
            upright: upright.map(c),
            aside: aside.map(c),
            least: c(range.min),
            most: c(range.max),
            start: c(start.min),
            start_extent: c(start.width()),
            back: c(springs_back_s.map_or(0.0, |seconds| control_dt_s / seconds)),
        }
    }
}

impl<T> Swing<T> {
    #[inline(always)]
    pub(super) fn map<U>(&self, f: &mut impl FnMut(&T) -> U) -> Swing<U> {
        Swing {
            upright: self.upright.each_ref().map(&mut *f),
            aside: self.aside.each_ref().map(&mut *f),
            least: f(&self.least),
            most: f(&self.most),
            start: f(&self.start),
            start_extent: f(&self.start_extent),
            back: f(&self.back),
        }
    }
}

impl<C: Real> SwingStep<C> {
    pub(super) fn new(step: &Step) -> Self {
        let c = C::from_f64;
        match step.action {
            Action::Swing { to, within } => Self { is_swing: c(1.0), to: c(to), within: c(within) },
            // Nothing is done by leaving it: it is never within.
            Action::Drive { .. } => Self { is_swing: c(1.0), to: c(0.0), within: c(-1.0) },
            _ => Self { is_swing: c(0.0), to: c(0.0), within: c(0.0) },
        }
    }
}

impl<T> SwingStep<T> {
    #[inline(always)]
    pub(super) fn map<U>(&self, f: &mut impl FnMut(&T) -> U) -> SwingStep<U> {
        SwingStep { is_swing: f(&self.is_swing), to: f(&self.to), within: f(&self.within) }
    }
}

impl<S: Scalar> Sticks<S> {
    /// Before the first episode of a task with so many spheres.
    #[inline(always)]
    pub(super) fn new(spheres: usize) -> Self {
        Self { angles: vec![S::zero(); spheres], held: S::zero() }
    }

    /// Every number, in a fixed order.
    #[inline(always)]
    pub(super) fn numbers(&mut self) -> impl Iterator<Item = &mut S> {
        let Self { angles, held } = self;
        angles.iter_mut().chain([held])
    }

    /// Takes over what became of the current stick; its knob is not held any more where the step is done.
    #[inline(always)]
    pub(super) fn update(&mut self, goal: &GoalSwing<S>, hold: &Hold<S>, done: S::Mask) {
        for (number, angle) in self.angles.iter_mut().enumerate() {
            let is_it = goal.is_swing & is_same(goal.knob, S::lit(number as f64));
            *angle = S::select(is_it, hold.angle, *angle);
        }
        self.held = hold.held.only(!done);
    }
}

/// Draws how sticks stand, where the mask is true.
#[inline(always)]
pub(super) fn draw_angles<S: Scalar>(
    task: &CompiledTask<S>,
    mask: S::Mask,
    counter: Counter<S::Word>,
    state: &mut TaskState<S>,
) {
    let Some(sticks) = &mut state.sticks else { return };
    for ((sphere, swing), angle) in task.spheres.iter().zip(&task.swings).zip(&mut sticks.angles) {
        let stream = S::Word::splat(STICK_STREAM + sphere.number);
        let [word, ..] = philox::<S>(Counter { stream, step: S::Word::splat(0), ..counter });
        *angle = S::select(mask, unit::<S>(word).mul_add(swing.start_extent, swing.start), *angle);
    }
}

/// How far the sphere of this number is off its place because it is a knob (m).
#[inline(always)]
pub(super) fn swung<S: Scalar>(task: &CompiledTask<S>, state: &TaskState<S>, number: S) -> Point<S> {
    let Some(sticks) = &state.sticks else { return [S::zero(); 3] };
    let row = |k: usize| {
        let Swing { upright: [a, b, c], aside: [d, e, f], .. } = task.swings[k];
        [a, b, c, d, e, f, sticks.angles[k]]
    };
    let [a, b, c, d, e, f, angle] = S::gather(task.swings.len(), row, number);
    arm([a, b, c], [d, e, f], angle)[0]
}

/// From the hinge to the middle of a knob at an angle (rad), and from there along its circle, as long (m); `upright` and `aside` are those
/// of [`Swing`].
#[inline(always)]
pub(crate) fn arm<S: Scalar>(upright: Point<S>, aside: Point<S>, angle: S) -> [Point<S>; 2] {
    let (sin, cos) = angle.sin_cos();
    [combine(upright, cos, aside, sin), combine(aside, cos, upright, -sin)]
}

/// `a * x + b * y`.
#[inline(always)]
fn combine<S: Scalar>(a: Point<S>, x: S, b: Point<S>, y: S) -> Point<S> {
    [0, 1, 2].map(|k| a[k].mul_add(x, b[k] * y))
}

impl<S: Scalar> GoalSwing<S> {
    /// Of step number `step`, whose object is the sphere of this number.
    #[inline(always)]
    pub(super) fn of(task: &CompiledTask<S>, state: &TaskState<S>, step: S, knob: S) -> Self {
        let entry = |k: usize| {
            let SwingStep { is_swing, to, within } = task.swing_steps[k];
            [is_swing, to, within]
        };
        let [is_swing, to, within] = S::gather(task.swing_steps.len(), entry, step);
        let mut is_swing = S::lit(0.5).lt(is_swing);
        if let Some(corrects) = state.corrects() {
            is_swing = is_swing & !corrects;
        }
        let angle = |k: usize| state.sticks.as_ref().map_or(S::zero(), |sticks| sticks.angles[k]);
        let row = |k: usize| {
            let Swing { upright: [a, b, c], aside: [d, e, f], least, most, back, .. } = task.swings[k];
            [a, b, c, d, e, f, least, most, angle(k), back]
        };
        let [a, b, c, d, e, f, least, most, angle, back] = S::gather(task.swings.len(), row, knob);
        let (upright, aside) = ([a, b, c], [d, e, f]);
        let (hinge, radius) = state.sphere(knob);
        Self { is_swing, knob, radius, hinge, upright, aside, least, most, to, within, angle, back }
    }

    /// See [`arm`].
    #[inline(always)]
    fn arm(&self, angle: S) -> [Point<S>; 2] {
        arm(self.upright, self.aside, angle)
    }

    /// From the middle of the knob to a point (m).
    #[inline(always)]
    fn off(&self, point: Point<S>, angle: S) -> Point<S> {
        difference(difference(point, self.hinge), self.arm(angle)[0])
    }

    /// Distance (m) from a point to the knob of a stick at this angle (rad): to its surface, zero within, or to its middle.
    #[inline(always)]
    pub(super) fn distance(&self, point: Point<S>, angle: S, to_surface: bool) -> S {
        let distance = norm(self.off(point, angle));
        if to_surface { (distance - self.radius).max(S::zero()) } else { distance }
    }

    /// How far (m) the knob of a stick at this angle (rad) must still go on its circle.
    #[inline(always)]
    pub fn left(&self, angle: S) -> S {
        ((self.to - angle).abs() * norm(self.upright)).only(self.is_swing)
    }

    /// From where the knob is to where it must be left (m).
    #[inline(always)]
    pub fn way_left(&self) -> Point<S> {
        let way = difference(self.arm(self.to)[0], self.arm(self.angle)[0]);
        way.map(|x| x.only(self.is_swing))
    }
}

impl<S: Scalar> Hold<S> {
    /// At the beginning of a control step.
    #[inline(always)]
    pub(super) fn new(state: &TaskState<S>, goal: Option<&GoalSwing<S>>) -> Self {
        let o = S::zero();
        Self { angle: goal.map_or(o, |goal| goal.angle), held: state.sticks.as_ref().map_or(o, |sticks| sticks.held) }
    }

    /// Counts a physics step that began with the pointer here, `share` of a control step; where `counts` is false nothing can be taken hold of. Tells where the
    /// knob is held, and where it was left at the angle that was asked for.
    #[inline(always)]
    pub(super) fn follow(
        &mut self,
        goal: &GoalSwing<S>,
        pointer: Point<S>,
        counts: S::Mask,
        share: f64,
    ) -> [S::Mask; 2] {
        let [out, along] = goal.arm(self.angle);
        let seen = difference(pointer, goal.hinge);
        let off = difference(seen, out);
        let is_held = goal.is_swing & counts & dot(off, off).lt(goal.radius * goal.radius);
        let was_held = goal.is_swing & S::lit(0.5).lt(self.held);
        let is_there = (goal.to - self.angle).abs().le(goal.within);
        // The pointer is no farther off than the knob is wide, which is less than the stick is long: this is more than zero.
        let outwards = S::select(is_held, dot(seen, out), S::lit(1.0));
        // Twice the tangent of half the angle between them: nearly that angle, and at most 2 rad.
        let tangent = dot(seen, along) * outwards.recip();
        let turn = (tangent + tangent) * (S::lit(1.0) + tangent.mul_add(tangent, S::lit(1.0)).sqrt()).recip();
        let turned = self.angle + turn;
        let turned = turned.max(goal.least).min(goal.most);
        let sprung = (goal.back * S::lit(-share)).max(S::lit(-1.0)).mul_add(self.angle, self.angle);
        self.angle = S::select(is_held, turned, sprung);
        self.held = S::indicator(is_held);
        [is_held, was_held & !is_held & is_there]
    }
}
