//! What the fingertip does with the current object between the ends of two control steps, to the physics step.
//!
//! When the fingertip got there, how long it stayed, and whether it pressed and let go, is followed at every physics step. So what
//! counts, and when the fingertip came for it, knows nothing of the control step; only the next step of the task waits for its end.

use super::{CompiledTask, Goal, GoalButton, Hold, Point, Steering, TaskState, difference, dot, is_same};
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

/// What the fingertip did with the current object, up to a physics step.
#[derive(Clone, Copy, Debug)]
pub struct Stay<S> {
    /// Physics steps inside the sphere or in contact with the face of the button, or with the knob held, without a break; of what is followed, all
    /// those inside. Whole numbers, so that no rounding adds up.
    pub held: S,
    /// Greatest force on the face of the button within the control step (N).
    pub touch: S,
    /// Sum over the physics steps of the control step of the squared force of all contacts (N^2), where that costs something; else zero.
    pub squared_force: S,
    /// Physics steps from the arrival for what first counted within the control step until now, zero where nothing did: from the onset
    /// of the contact that pressed the button, from the beginning of the stay that completed the dwell, from the end of a way or of a
    /// swing, or from the first entry into what is followed.
    pub pressed: S,
    /// One where the button was pressed, and let go within the control step.
    pub let_go: S,
    /// See [`TaskState::down`].
    pub down: S,
    /// See [`TaskState::old`].
    pub old: S,
    /// See [`TaskState::old_down`].
    pub old_down: S,
    /// See [`TaskState::wrong`].
    pub wrong: S,
    /// Presses of buttons that were not asked for, within the control step.
    pub wrong_presses: S,
    /// Where the current handle stands, as a share of its way.
    pub value: S,
    /// How far the current way has been gone.
    pub steering: Steering<S>,
    /// How the current stick stands.
    pub hold: Hold<S>,
    /// Physics steps of the control step that have passed.
    pub passed: S,
    /// See [`TaskState::cursor`]; zeros where there is none.
    pub cursor: [S; 2],
}

impl<S: Scalar> Stay<S> {
    /// At the beginning of a control step.
    #[inline(always)]
    pub fn new(state: &TaskState<S>, goal: &Goal<S>) -> Self {
        let o = S::zero();
        let TaskState { held, down, old, old_down, wrong, .. } = *state;
        let value = goal.drag().map_or(o, |drag| drag.value);
        let steering = state.steering.map_or_else(Steering::new, |steering| Steering { exits: o, ..steering });
        Self {
            held,
            touch: o,
            squared_force: o,
            pressed: o,
            let_go: o,
            down,
            old,
            old_down,
            wrong,
            wrong_presses: o,
            value,
            steering,
            hold: Hold::new(state, goal.swing.as_ref()),
            passed: o,
            cursor: state.cursor.unwrap_or([o; 2]),
        }
    }

    /// Counts a physics step that began with the pointer here and these contacts; `share` of a control step is a physics step.
    #[inline(always)]
    pub fn follow(
        &mut self,
        task: &CompiledTask<S>,
        goal: &Goal<S>,
        pointer: Point<S>,
        share: f64,
        contacts: impl Iterator<Item = Contact<S>> + Clone,
    ) {
        let one = S::lit(1.0);
        if task.weights.contact_cost.is_some() {
            self.feel(contacts.clone());
        }
        let mut inside = S::Mask::splat(false);
        if task.kinds.dwell {
            let off = difference(pointer, goal.centre_after(self.passed * S::lit(share)));
            inside = dot(off, off).lt(goal.size * goal.size) & !goal.is_press;
            if let Some(is_lit) = goal.is_lit {
                inside = inside & is_lit;
            }
        }
        if task.kinds.motion {
            self.passed += one;
        }
        let mut arrives = S::Mask::splat(false);
        if let Some(steer) = &goal.steer {
            arrives = self.steering.follow(steer, pointer);
            if let Some(is_lit) = goal.is_lit {
                arrives = arrives & is_lit;
            }
            inside = inside & !steer.is_steer;
        }
        let mut on = inside;
        if let Some(swing) = &goal.swing {
            let [is_held, is_left] = self.hold.follow(swing, pointer, goal.lit());
            inside = inside & !swing.is_swing;
            on = is_held | inside;
            arrives = arrives | is_left;
        }
        let Some(button) = &goal.button else {
            self.stay(goal, on);
            let stayed = self.held.only(inside & self.counts(goal, share));
            self.press(S::select(arrives, one, stayed));
            return;
        };
        let (touches, on_face, force) = touch(contacts.clone(), button.number);
        let bounce = task.bounce * S::lit(share).recip();
        self.stay(goal, on | on_face);
        self.touch = self.touch.max(force);
        let mut presses = touches & button.min_force.le(force);
        if task.kinds.release {
            let rival = self.watch_others(task, goal, button, [force, bounce], contacts.clone());
            presses = presses & !is_same(button.number, self.old) & rival.le(force);
            if let Some(pauses) = goal.pauses {
                presses = presses & !pauses;
            }
        }
        if let Some(drag) = &button.drag {
            let is_on_handle = (drag.share(pointer) - self.value).abs().le(drag.half);
            presses = presses & (is_on_handle | !drag.is_drag);
        }
        // Who bounces off what is down did not come for it a second time.
        let comes = presses & self.down.lt(S::lit(0.5));
        let counts = comes | (inside & self.counts(goal, share));
        self.press(S::select(arrives, one, self.held.only(counts)));
        if task.kinds.release {
            self.down = S::select(presses, bounce, self.down);
            self.release(button, pointer, touches, bounce);
            let (touches_old, ..) = touch(contacts.clone(), self.old);
            self.old_down = still_down(self.old_down, touches_old, bounce);
            self.old = S::select(S::lit(0.5).lt(self.old_down), self.old, S::lit(-1.0));
        }
        if let Some(is_lit) = goal.is_lit {
            let was_wrong = !is_lit & S::lit(0.5).lt(self.wrong);
            self.rest(was_wrong, bounce, contacts.clone());
        }
        if let Some(pauses) = goal.pauses {
            self.rest(pauses, bounce, contacts);
        }
    }

    /// Counts a physics step on the object; being off it starts the count anew, but where all the time inside is added up.
    #[inline(always)]
    fn stay(&mut self, goal: &Goal<S>, on: S::Mask) {
        let left = goal.follows.map_or(S::zero(), |follows| self.held.only(follows));
        self.held = S::select(on, self.held + S::lit(1.0), left);
    }

    /// Where being inside a sphere now is what counts: it completes the dwell, or is the first that there is of what is followed.
    #[inline(always)]
    fn counts(&self, goal: &Goal<S>, share: f64) -> S::Mask {
        let is_over = goal.is_stayed(self.held, share);
        match goal.follows {
            Some(follows) => (follows & self.held.lt(S::lit(1.5))) | (!follows & is_over),
            None => is_over,
        }
    }

    /// Counts the physics steps since what was first done within the control step; `since` it where that is now.
    #[inline(always)]
    fn press(&mut self, since: S) {
        let before = S::zero().lt(self.pressed);
        self.pressed = S::select(before, self.pressed + S::lit(1.0), since);
    }

    /// What is down may be moved, and may be let go.
    #[inline(always)]
    fn release(&mut self, button: &GoalButton<S>, pointer: Point<S>, touches: S::Mask, bounce: S) {
        let is_down = S::lit(0.5).lt(self.down);
        self.down = still_down(self.down, touches, bounce);
        let mut counts = is_down & self.down.lt(S::lit(0.5));
        if let Some(drag) = &button.drag {
            let value = drag.share(pointer).clamp(0.0, 1.0);
            self.value = S::select(is_down & touches & drag.is_drag, value, self.value);
            counts = counts & ((drag.to - self.value).abs().le(drag.within) | !drag.is_drag);
        }
        self.let_go = S::select(counts, S::lit(1.0), self.let_go);
    }

    /// What is touched before presses count must be let go before it can be pressed.
    #[inline(always)]
    fn rest(&mut self, too_early: S::Mask, bounce: S, contacts: impl Iterator<Item = Contact<S>>) {
        let mut touched = S::lit(-1.0);
        for contact in contacts {
            touched = S::select(contact.exists, contact.number, touched);
        }
        let is_new = too_early & S::zero().le(touched) & self.old.lt(S::zero());
        self.old = S::select(is_new, touched, self.old);
        self.old_down = S::select(is_new, bounce, self.old_down);
    }

    /// Counts presses of boxes that are neither to be pressed nor still down from the step before, and tells the greatest force (N) on any
    /// box that can be pressed, but the one to be pressed. From the first press to where no such box was touched for so long is one press.
    ///
    /// A finger presses one thing at a time: between two keys, the one on which there is more force, and the one to be pressed where there
    /// is as much on both. `force` is that on the button to be pressed, `bounce` how many physics steps it takes to let go.
    #[inline(always)]
    fn watch_others(
        &mut self,
        task: &CompiledTask<S>,
        goal: &Goal<S>,
        button: &GoalButton<S>,
        [force, bounce]: [S; 2],
        contacts: impl Iterator<Item = Contact<S>> + Clone,
    ) -> S {
        // A closure for both loops would not be inlined.
        let old = self.old;
        let (mut touched, mut is_beside) = (S::Mask::splat(false), S::Mask::splat(false));
        for contact in contacts.clone() {
            touched = touched | is_other(task, button, old, &contact);
            is_beside = is_beside | (contact.exists & !is_same(contact.number, button.number));
        }
        let mut beside = Beside { stay: self, rival: S::zero() };
        S::when(is_beside, &mut beside, |Beside { stay, rival }| {
            let mut pressed = S::Mask::splat(false);
            for contact in contacts {
                let [min_force] = S::gather(task.boxes.len(), |k| [task.boxes[k].min_force], contact.number);
                let press = contact.press();
                let is_pressed = contact.exists & min_force.le(press);
                *rival = (*rival).max(press.only(is_pressed & !is_same(contact.number, button.number)));
                pressed = pressed | (is_other(task, button, old, &contact) & is_pressed & force.lt(press));
            }
            let mut begins = pressed & stay.wrong.lt(S::lit(0.5));
            if let Some(pauses) = goal.pauses {
                begins = begins & !pauses;
            }
            stay.wrong_presses += S::indicator(begins);
            stay.wrong = S::select(begins, bounce, stay.wrong);
        });
        let rival = beside.rival;
        self.wrong = still_down(self.wrong, touched, bounce);
        rival
    }

    /// Adds up what is felt of all contacts.
    #[inline(always)]
    fn feel(&mut self, contacts: impl Iterator<Item = Contact<S>>) {
        let mut force = S::zero();
        for contact in contacts {
            force += contact.force.only(contact.exists);
        }
        self.squared_force = force.mul_add(force, self.squared_force);
    }

    /// Physics steps from the arrival at the current object until now: that of [`pressed`](Self::pressed), and where nothing counted yet,
    /// that of the last stay without a break.
    #[inline(always)]
    pub fn since_arrival(&self) -> S {
        S::select(S::zero().lt(self.pressed), self.pressed, self.held)
    }
}

/// Physics steps until what is down counts as let go: `bounce` of them while it is touched, and then one fewer each; zero of what is not
/// down.
#[inline(always)]
fn still_down<S: Scalar>(left: S, touches: S::Mask, bounce: S) -> S {
    let is_down = S::lit(0.5).lt(left);
    S::select(touches, bounce, left - S::lit(1.0)).max(S::zero()).only(is_down)
}

/// What contacts beside the button change.
struct Beside<'a, S> {
    stay: &'a mut Stay<S>,
    /// Greatest force on a box that is pressed and is not the one to be pressed (N).
    rival: S,
}

impl<S: Scalar> Carried<S> for Beside<'_, S> {
    fn visit(&mut self, visitor: &mut impl Visitor<S>) {
        visitor.numbers([&mut self.stay.wrong, &mut self.stay.wrong_presses, &mut self.rival]);
    }
}

/// Where a contact is with a box that is neither to be pressed nor `old`, still down from the step before.
#[inline(always)]
fn is_other<S: Scalar>(task: &CompiledTask<S>, button: &GoalButton<S>, old: S, contact: &Contact<S>) -> S::Mask {
    contact.exists & !is_meant(task, button, contact.number) & !is_same(contact.number, old)
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
