//! What fingers do to buttons, in a physics step.
//!
//! A finger presses what it comes down on. Where it slides to afterwards, over a desk or from key to key, it presses nothing until it was
//! lifted: so it is on glass, and people lift their fingers.

use super::compile::NEVER_PRESSED_N;
use super::{CompiledTask, Goal, GoalButton, Point, Stay, is_same};
use myo_model::MOST_FINGERS;
use myo_scalar::{Carried, Mask, Scalar, Visitor};

/// Fingers that may press: the fingertip, and others.
pub const PRESSERS: usize = 1 + MOST_FINGERS;

/// What a finger does to boxes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pressing<S> {
    /// Number of the box that it came down on and may press; negative while it is in the air, and where it must be lifted first: it
    /// pressed that box since, rightly or wrongly, or touched it when presses did not count.
    pub landed: S,
    /// Physics steps without contact until it counts as lifted; zero while it is.
    pub grounded: S,
}

impl<S: Scalar> Pressing<S> {
    /// Nothing is touched.
    #[inline(always)]
    pub fn in_the_air() -> Self {
        Self { landed: S::lit(-1.0), grounded: S::zero() }
    }

    /// In the air again where the mask is true.
    #[inline(always)]
    pub(super) fn forget(&mut self, mask: S::Mask) {
        self.forget_landing(mask);
        self.grounded = self.grounded.only(!mask);
    }

    /// Must be lifted first where the mask is true.
    #[inline(always)]
    fn forget_landing(&mut self, mask: S::Mask) {
        self.landed = S::select(mask, S::lit(-1.0), self.landed);
    }

    /// Every number, in a fixed order.
    #[inline(always)]
    pub fn numbers(&mut self) -> [&mut S; 2] {
        let Self { landed, grounded } = self;
        [landed, grounded]
    }
}

/// The button that a finger is asked to press, by its number, negative for none, and its force (N).
#[derive(Clone, Copy)]
pub(super) struct Asked<'a, S: Scalar> {
    pub number: S,
    pub min_force: S,
    /// That of the step.
    pub button: &'a GoalButton<S>,
}

/// Contact of a finger with a box in a physics step.
#[derive(Clone, Copy, Debug)]
pub struct Contact<S: Scalar> {
    /// Where there is one.
    pub exists: S::Mask,
    /// Whose it is: 0, the fingertip's, or one more than the number of another finger.
    pub finger: usize,
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
    /// The finger, or all that are asked for, is on its face.
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

    /// Counts what these contacts mean for the buttons to be pressed and for all others; `bounce` is how many physics steps without contact it
    /// takes to let go.
    #[inline(always)]
    pub(super) fn press_buttons(
        &mut self,
        task: &CompiledTask<S>,
        goal: &Goal<S>,
        button: &GoalButton<S>,
        pointer: Point<S>,
        bounce: S,
        contacts: impl Iterator<Item = Contact<S>> + Clone,
    ) -> Touched<S> {
        if !task.kinds.release {
            let (touches, on_face, force) = touch(contacts.filter(|contact| contact.finger == 0), button.number);
            return Touched { on_face, comes: touches & button.min_force.le(force) };
        }
        let no = S::Mask::splat(false);
        let (mut any_asked, mut any_comes) = (no, no);
        let (mut all_on_face, mut all_hold) = (!no, !no);
        for finger in 0..task.pressers() {
            let own = contacts.clone().filter(move |contact| contact.finger == finger);
            let asked = goal.asked_of(button, finger, task.kinds.chord);
            let Touched { on_face, comes } = self.press_one(task, goal, (finger, asked), pointer, bounce, own);
            if !task.kinds.chord {
                return Touched { on_face, comes };
            }
            let is_asked = S::lit(-0.5).lt(asked.number);
            any_asked = any_asked | is_asked;
            any_comes = any_comes | comes;
            all_on_face = all_on_face & (on_face | !is_asked);
            all_hold = all_hold & (S::lit(0.5).lt(self.holds[finger]) | !is_asked);
        }
        Touched { on_face: all_on_face & any_asked, comes: any_comes & all_hold }
    }

    /// The same of one finger and the button that it is asked to press.
    #[inline(always)]
    fn press_one(
        &mut self,
        task: &CompiledTask<S>,
        goal: &Goal<S>,
        (finger, asked): (usize, Asked<'_, S>),
        pointer: Point<S>,
        bounce: S,
        contacts: impl Iterator<Item = Contact<S>> + Clone,
    ) -> Touched<S> {
        let (touches, on_face, force) = touch(contacts.clone(), asked.number);
        self.land(task, finger, bounce, contacts.clone());
        if let Some(pauses) = goal.pauses {
            // What is touched before presses count must be let go before it can be pressed.
            self.pressing[finger].forget_landing(pauses);
        }
        let mut comes = touches & asked.min_force.le(force) & is_same(asked.number, self.pressing[finger].landed);
        let drag = asked.button.drag.as_ref().filter(|_| finger == 0);
        if let Some(drag) = drag {
            let is_on_handle = (drag.share(pointer) - self.value).abs().le(drag.half);
            comes = comes & (is_on_handle | !drag.is_drag);
        }
        self.pressing[finger].forget_landing(comes);
        if task.kinds.chord {
            self.holds[finger] = S::select(comes, S::lit(1.0), self.holds[finger].only(touches));
        }
        if finger == 0 {
            self.down = S::select(comes, bounce, self.down);
            self.release(asked.button, pointer, touches, bounce);
        }
        self.watch_others(task, goal, (finger, asked.button), contacts);
        Touched { on_face, comes }
    }

    /// Follows whether a finger is in the air, and on which box it comes down.
    #[inline(always)]
    fn land(
        &mut self,
        task: &CompiledTask<S>,
        finger: usize,
        bounce: S,
        contacts: impl Iterator<Item = Contact<S>> + Clone,
    ) {
        let mut touches = S::Mask::splat(false);
        for contact in contacts.clone() {
            touches = touches | contact.exists;
        }
        let lands = touches & self.pressing[finger].grounded.lt(S::lit(0.5));
        S::when(lands, &mut Landing(self, finger), |Landing(stay, finger)| {
            let landed = &mut stay.pressing[*finger].landed;
            *landed = S::select(lands, first_touched(task, contacts), *landed);
        });
        let pressing = &mut self.pressing[finger];
        pressing.grounded = S::select(touches, bounce, pressing.grounded - S::lit(1.0)).max(S::zero());
        pressing.forget_landing(!S::lit(0.5).lt(pressing.grounded));
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
        goal: &Goal<S>,
        (finger, button): (usize, &GoalButton<S>),
        contacts: impl Iterator<Item = Contact<S>> + Clone,
    ) {
        let landed = self.pressing[finger].landed;
        let may_err = S::zero().le(landed) & !is_meant(task, goal, button, landed);
        S::when(may_err, &mut Landing(self, finger), |Landing(stay, finger)| {
            let landed = stay.pressing[*finger].landed;
            let [min_force] = S::gather(task.boxes.len(), |k| [task.boxes[k].min_force], landed);
            let (touches, _, force) = touch(contacts, landed);
            let errs = may_err & touches & min_force.le(force);
            stay.wrong_presses += S::indicator(errs);
            stay.pressing[*finger].forget_landing(errs);
        });
    }
}

/// What the contacts of a finger that came down, or came down on what it should not, change.
struct Landing<'a, S>(&'a mut Stay<S>, usize);

impl<S: Scalar> Carried<S> for Landing<'_, S> {
    fn visit(&mut self, visitor: &mut impl Visitor<S>) {
        let Self(Stay { pressing, wrong_presses, .. }, finger) = self;
        visitor.numbers([&mut pressing[*finger].landed, wrong_presses]);
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
fn is_meant<S: Scalar>(task: &CompiledTask<S>, goal: &Goal<S>, button: &GoalButton<S>, number: S) -> S::Mask {
    let mut is_meant = is_same(number, button.number);
    for other in goal.fingers.iter().filter_map(|finger| finger.button.as_ref()) {
        is_meant = is_meant | is_same(number, other.number);
    }
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
