//! What the fingertip does to buttons, in a physics step.
//!
//! A finger presses what it comes down on. Where it slides to afterwards, over a desk or from key to key, it presses nothing until it was
//! lifted: so it is on glass, and people lift their fingers.

use super::compile::NEVER_PRESSED_N;
use super::{CompiledTask, Goal, GoalButton, Point, Stay, is_same};
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
    /// Cosine of the angle between the force and the way out of the face of the box: 1 on the face, 0 on a side.
    pub facing: S,
}

impl<S: Scalar> Contact<S> {
    /// How hard it presses the face (N): to brush a side presses nothing.
    #[inline(always)]
    fn press(&self) -> S {
        self.force * self.facing.max(S::zero())
    }
}

/// What a physics step meant for the button that is asked for.
pub(super) struct Touched<S: Scalar> {
    /// The fingertip is on its face.
    pub on_face: S::Mask,
    /// It is pressed, and was not before.
    pub comes: S::Mask,
}

impl<S: Scalar> Stay<S> {
    /// Feels all contacts together.
    #[inline(always)]
    pub(super) fn feel(&mut self, task: &CompiledTask<S>, contacts: impl Iterator<Item = Contact<S>>) {
        let mut force = S::zero();
        for contact in contacts {
            force += contact.force.only(contact.exists);
        }
        self.touch = self.touch.max(force);
        if task.weights.contact_cost.is_some() {
            self.squared_force = force.mul_add(force, self.squared_force);
        }
    }

    /// Counts what these contacts mean for the button to be pressed and for all others; `bounce` is how many physics steps without contact it
    /// takes to let go.
    #[inline(always)]
    pub(super) fn press_button(
        &mut self,
        task: &CompiledTask<S>,
        goal: &Goal<S>,
        button: &GoalButton<S>,
        pointer: Point<S>,
        bounce: S,
        contacts: impl Iterator<Item = Contact<S>> + Clone,
    ) -> Touched<S> {
        let (touches, on_face, force) = touch(contacts.clone(), button.number);
        let mut comes = touches & button.min_force.le(force);
        if !task.kinds.release {
            return Touched { on_face, comes };
        }
        self.land(task, bounce, contacts.clone());
        if let Some(pauses) = goal.pauses {
            // What is touched before presses count must be let go before it can be pressed.
            self.landed = S::select(pauses, S::lit(-1.0), self.landed);
        }
        comes = comes & is_same(button.number, self.landed);
        if let Some(drag) = &button.drag {
            let is_on_handle = (drag.share(pointer) - self.value).abs().le(drag.half);
            comes = comes & (is_on_handle | !drag.is_drag);
        }
        self.landed = S::select(comes, S::lit(-1.0), self.landed);
        self.down = S::select(comes, bounce, self.down);
        self.release(button, pointer, touches, bounce);
        self.watch_others(task, button, contacts);
        Touched { on_face, comes }
    }

    /// Follows whether the fingertip is in the air, and on which box it comes down.
    #[inline(always)]
    fn land(&mut self, task: &CompiledTask<S>, bounce: S, contacts: impl Iterator<Item = Contact<S>> + Clone) {
        let mut touches = S::Mask::splat(false);
        for contact in contacts.clone() {
            touches = touches | contact.exists;
        }
        let lands = touches & self.grounded.lt(S::lit(0.5));
        S::when(lands, &mut Landing(self), |Landing(stay)| {
            stay.landed = S::select(lands, first_touched(task, contacts), stay.landed);
        });
        self.grounded = S::select(touches, bounce, self.grounded - S::lit(1.0)).max(S::zero());
        self.landed = S::select(S::lit(0.5).lt(self.grounded), self.landed, S::lit(-1.0));
    }

    /// What is down may be moved, and may be let go.
    #[inline(always)]
    fn release(&mut self, button: &GoalButton<S>, pointer: Point<S>, touches: S::Mask, bounce: S) {
        let is_down = S::lit(0.5).lt(self.down);
        self.down = S::select(touches, bounce, self.down - S::lit(1.0)).max(S::zero()).only(is_down);
        let mut counts = is_down & self.down.lt(S::lit(0.5));
        if let Some(drag) = &button.drag {
            let value = drag.share(pointer).clamp(0.0, 1.0);
            self.value = S::select(is_down & touches & drag.is_drag, value, self.value);
            counts = counts & ((drag.to - self.value).abs().le(drag.within) | !drag.is_drag);
        }
        self.let_go = S::select(counts, S::lit(1.0), self.let_go);
    }

    /// Counts presses of boxes that are not to be pressed.
    #[inline(always)]
    fn watch_others(
        &mut self,
        task: &CompiledTask<S>,
        button: &GoalButton<S>,
        contacts: impl Iterator<Item = Contact<S>> + Clone,
    ) {
        let may_err = S::zero().le(self.landed) & !is_meant(task, button, self.landed);
        S::when(may_err, &mut Landing(self), |Landing(stay)| {
            let [min_force] = S::gather(task.boxes.len(), |k| [task.boxes[k].min_force], stay.landed);
            let (touches, _, force) = touch(contacts, stay.landed);
            let errs = may_err & touches & min_force.le(force);
            stay.wrong_presses += S::indicator(errs);
            stay.landed = S::select(errs, S::lit(-1.0), stay.landed);
        });
    }
}

/// What the contacts of a fingertip that came down, or came down on what it should not, change.
struct Landing<'a, S>(&'a mut Stay<S>);

impl<S: Scalar> Carried<S> for Landing<'_, S> {
    fn visit(&mut self, visitor: &mut impl Visitor<S>) {
        let Stay { landed, wrong_presses, .. } = &mut *self.0;
        visitor.numbers([landed, wrong_presses]);
    }
}

/// Number of the box that the fingertip came down on. A finger presses one thing at a time: of those that it touches at once, the one on which
/// there is more force, and what can be pressed rather than what cannot.
#[inline(always)]
fn first_touched<S: Scalar>(task: &CompiledTask<S>, contacts: impl Iterator<Item = Contact<S>>) -> S {
    let (mut first, mut most) = (S::lit(-1.0), S::lit(-2.0));
    for contact in contacts {
        let [min_force] = S::gather(task.boxes.len(), |k| [task.boxes[k].min_force], contact.number);
        let force = S::select(min_force.lt(S::lit(NEVER_PRESSED_N)), contact.press(), S::lit(-1.0));
        let is_more = contact.exists & most.lt(force);
        first = S::select(is_more, contact.number, first);
        most = S::select(is_more, force, most);
    }
    first
}

/// Whether the box of this number may be pressed: it is the one to be pressed, one that may be pressed as well, or the one that
/// corrects.
#[inline(always)]
fn is_meant<S: Scalar>(task: &CompiledTask<S>, button: &GoalButton<S>, number: S) -> S::Mask {
    let mut is_meant = is_same(number, button.number);
    for &open in &button.open {
        is_meant = is_meant | is_same(number, open);
    }
    task.correction.map_or(is_meant, |correction| is_meant | is_same(number, correction))
}

/// Whether the box of this number is touched, whether on its face, and how hard that is pressed.
#[inline(always)]
fn touch<S: Scalar>(contacts: impl Iterator<Item = Contact<S>>, number: S) -> (S::Mask, S::Mask, S) {
    let (mut touches, mut on_face, mut force) = (S::Mask::splat(false), S::Mask::splat(false), S::zero());
    for contact in contacts {
        let here = contact.exists & is_same(contact.number, number);
        touches = touches | here;
        on_face = on_face | (here & S::zero().lt(contact.facing));
        force += contact.press().only(here);
    }
    (touches, on_face, force)
}
