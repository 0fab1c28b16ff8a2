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
}

/// What the fingertip did with the current object, up to a physics step.
#[derive(Clone, Copy, Debug)]
pub struct Stay<S> {
    /// Physics steps inside the sphere or in contact with the button, or with the knob held, without a break; of what is followed, all
    /// those inside. Whole numbers, so that no rounding adds up.
    pub held: S,
    /// Greatest force on the button within the control step (N).
    pub touch: S,
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
        let TaskState { held, down, old, wrong, .. } = *state;
        let value = goal.drag().map_or(o, |drag| drag.value);
        let steering = state.steering.map_or_else(Steering::new, |steering| Steering { exits: o, ..steering });
        Self {
            held,
            touch: o,
            pressed: o,
            let_go: o,
            down,
            old,
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
        let (touches, force) = touch(contacts.clone(), button.number);
        self.stay(goal, on | touches);
        self.touch = self.touch.max(force);
        let mut presses = touches & button.min_force.le(force);
        if task.kinds.release {
            presses = presses & !is_same(button.number, self.old);
        }
        if let Some(drag) = &button.drag {
            let is_on_handle = (drag.share(pointer) - self.value).abs().le(drag.half);
            presses = presses & (is_on_handle | !drag.is_drag);
        }
        let counts = presses | (inside & self.counts(goal, share));
        self.press(S::select(arrives, one, self.held.only(counts)));
        if task.kinds.release {
            self.down = S::select(presses, one, self.down);
            self.release(button, pointer, touches);
            let (touches_old, _) = touch(contacts.clone(), self.old);
            self.old = S::select(touches_old, self.old, S::lit(-1.0));
            self.watch_others(task, button, contacts.clone());
        }
        if let Some(is_lit) = goal.is_lit {
            self.rest(is_lit, contacts);
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
    fn release(&mut self, button: &GoalButton<S>, pointer: Point<S>, touches: S::Mask) {
        let is_down = S::lit(0.5).lt(self.down);
        let mut counts = is_down & !touches;
        if let Some(drag) = &button.drag {
            let value = drag.share(pointer).clamp(0.0, 1.0);
            self.value = S::select(is_down & touches & drag.is_drag, value, self.value);
            counts = counts & ((drag.to - self.value).abs().le(drag.within) | !drag.is_drag);
        }
        self.let_go = S::select(counts, S::lit(1.0), self.let_go);
        self.down = S::select(is_down & !touches, S::zero(), self.down);
    }

    /// What was pressed before the step counts must be let go before it can be pressed for it; the press was a wrong one.
    #[inline(always)]
    fn rest(&mut self, is_lit: S::Mask, contacts: impl Iterator<Item = Contact<S>>) {
        let mut touched = S::lit(-1.0);
        for contact in contacts {
            touched = S::select(contact.exists, contact.number, touched);
        }
        let is_new = !is_lit & S::lit(0.5).lt(self.wrong) & self.old.lt(S::zero());
        self.old = S::select(is_new, touched, self.old);
    }

    /// Counts presses of boxes that are neither to be pressed nor still down from the step before. From the first one to where no such
    /// box is touched any more is one press.
    #[inline(always)]
    fn watch_others(
        &mut self,
        task: &CompiledTask<S>,
        button: &GoalButton<S>,
        contacts: impl Iterator<Item = Contact<S>> + Clone,
    ) {
        // A closure for both loops would not be inlined.
        let old = self.old;
        let mut touched = S::Mask::splat(false);
        for contact in contacts.clone() {
            touched = touched | is_other(task, button, old, &contact);
        }
        S::when(touched, &mut Wrong(self), |Wrong(stay)| {
            let mut pressed = S::Mask::splat(false);
            for contact in contacts {
                let [min_force] = S::gather(task.boxes.len(), |k| [task.boxes[k].min_force], contact.number);
                pressed = pressed | (is_other(task, button, old, &contact) & min_force.le(contact.force));
            }
            let begins = pressed & stay.wrong.lt(S::lit(0.5));
            stay.wrong_presses += S::indicator(begins);
            stay.wrong = S::select(begins, S::lit(1.0), stay.wrong);
        });
        self.wrong = self.wrong.only(touched);
    }

    /// Physics steps from the arrival at the current object until now: that of [`pressed`](Self::pressed), and where nothing counted yet,
    /// that of the last stay without a break.
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
