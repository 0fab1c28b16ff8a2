//! What the fingertip does with the current object between the ends of two control steps, to the physics step.
//!
//! Whether a dwell is over is judged at the ends of control steps. When the fingertip got there, and whether it pressed and
//! let go, is followed in between, so that movement times are as fine as the physics and know nothing of the control step.

use super::{CompiledTask, Goal, Point, TaskState, difference};
use myo_scalar::{Carried, Mask, Scalar, Visitor};

/// Contact of the fingertip with a box in a physics step.
#[derive(Clone, Copy, Debug)]
pub struct Contact<S: Scalar> {
    /// Where there is one.
    pub exists: S::Mask,
    /// Number of the box.
    pub number: S,
    /// Its force (N).
    pub force: S,
}

/// What the fingertip did with the current object, up to a physics step.
#[derive(Clone, Copy, Debug)]
pub struct Stay<S> {
    /// Physics steps inside the sphere or in contact with the button, without a break.
    pub held: S,
    /// Greatest force on the button within the control step (N).
    pub touch: S,
    /// Physics steps from the onset of the contact that first pressed the button, within the control step, until now; zero
    /// without one.
    pub pressed: S,
    /// One where the button was pressed, and let go within the control step.
    pub let_go: S,
    /// See [`TaskState::down`].
    pub down: S,
    /// See [`TaskState::old`].
    pub old: S,
    /// See [`TaskState::wrong`].
    pub wrong: S,
    /// Presses of buttons that were not asked for, within the control step.
    pub wrong_presses: S,
}

impl<S: Scalar> Stay<S> {
    /// At the beginning of a control step.
    #[inline(always)]
    pub fn new(state: &TaskState<S>) -> Self {
        let o = S::zero();
        let TaskState { held, down, old, wrong, .. } = *state;
        Self { held, touch: o, pressed: o, let_go: o, down, old, wrong, wrong_presses: o }
    }

    /// Counts a physics step that began with this fingertip and these contacts.
    #[inline(always)]
    pub fn follow(
        &mut self,
        task: &CompiledTask<S>,
        goal: &Goal<S>,
        fingertip: Point<S>,
        contacts: impl Iterator<Item = Contact<S>> + Clone,
    ) {
        let one = S::lit(1.0);
        let mut on = S::Mask::splat(false);
        if task.kinds.dwell {
            let [x, y, z] = difference(fingertip, goal.centre);
            on = x.mul_add(x, y.mul_add(y, z * z)).lt(goal.size * goal.size) & !goal.is_press;
        }
        let Some(button) = &goal.button else {
            self.held = (self.held + one).only(on);
            return;
        };
        let (touches, force) = touch(contacts.clone(), button.number);
        self.held = (self.held + one).only(on | touches);
        self.touch = self.touch.max(force);
        let mut presses = touches & button.shape.min_force.le(force);
        if task.kinds.release {
            presses = presses & !is_same(button.number, self.old);
        }
        let before = S::zero().lt(self.pressed);
        self.pressed = S::select(before, self.pressed + one, self.held.only(presses));
        if task.kinds.release {
            self.down = S::select(presses, one, self.down);
            let lets_go = S::lit(0.5).lt(self.down) & !touches;
            self.let_go = S::select(lets_go, one, self.let_go);
            self.down = S::select(lets_go, S::zero(), self.down);
            let (touches_old, _) = touch(contacts.clone(), self.old);
            self.old = S::select(touches_old, self.old, S::lit(-1.0));
            self.watch_others(task, button.number, contacts);
        }
    }

    /// Counts presses of boxes that are neither to be pressed nor still down from the step before. From the first one to where no such
    /// box is touched any more is one press.
    #[inline(always)]
    fn watch_others(&mut self, task: &CompiledTask<S>, number: S, contacts: impl Iterator<Item = Contact<S>> + Clone) {
        let old = self.old;
        let others =
            contacts.map(|c| Contact { exists: c.exists & !is_same(c.number, number) & !is_same(c.number, old), ..c });
        let mut touched = S::Mask::splat(false);
        for contact in others.clone() {
            touched = touched | contact.exists;
        }
        S::when(touched, &mut Wrong(self), |Wrong(stay)| {
            let mut pressed = S::Mask::splat(false);
            for contact in others {
                let [min_force] = S::gather(task.boxes.len(), |k| [task.boxes[k].min_force], contact.number);
                pressed = pressed | (contact.exists & min_force.le(contact.force));
            }
            let begins = pressed & stay.wrong.lt(S::lit(0.5));
            stay.wrong_presses += S::indicator(begins);
            stay.wrong = S::select(begins, S::lit(1.0), stay.wrong);
        });
        self.wrong = self.wrong.only(touched);
    }

    /// Physics steps from the arrival at the current object to the end of the control step: to where the last unbroken stay
    /// in the sphere began, or to the onset of the contact that pressed the button.
    #[inline(always)]
    pub fn since_arrival(&self) -> S {
        S::select(S::zero().lt(self.pressed), self.pressed, self.held)
    }
}

/// What a wrong press changes.
struct Wrong<'a, S>(&'a mut Stay<S>);

impl<S: Scalar> Carried<S> for Wrong<'_, S> {
    fn visit(&mut self, visitor: &mut impl Visitor<S>) {
        visitor.numbers([&mut self.0.wrong, &mut self.0.wrong_presses]);
    }
}

/// Whether the box of this number is touched, and how hard.
#[inline(always)]
fn touch<S: Scalar>(contacts: impl Iterator<Item = Contact<S>>, number: S) -> (S::Mask, S) {
    let (mut touches, mut force) = (S::Mask::splat(false), S::zero());
    for contact in contacts {
        let here = contact.exists & is_same(contact.number, number);
        touches = touches | here;
        force += contact.force.only(here);
    }
    (touches, force)
}

/// Whether two whole numbers are equal.
#[inline(always)]
fn is_same<S: Scalar>(a: S, b: S) -> S::Mask {
    (a - b).abs().lt(S::lit(0.5))
}
