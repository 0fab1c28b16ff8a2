//! What the fingertip does with the current object between the ends of two control steps, to the physics step.
//!
//! When the fingertip got there, how long it stayed, and whether it pressed and let go, is followed at every physics step. So what
//! counts, and when the fingertip came for it, knows nothing of the control step; only the next step of the task waits for its end.

use super::{
    CompiledTask, Contact, Goal, Hold, Landmarks, PRESSERS, Point, Pressing, Ride, Steering, TaskState, Tracking,
    difference, dot, fingers,
};
use myo_scalar::{Mask, Scalar};

/// What the fingertip did with the current object, up to a physics step.
#[derive(Clone, Copy, Debug)]
pub struct Stay<S> {
    /// Physics steps inside the sphere or in contact with the face of the button, or with the knob held, without a break; of what is followed, all
    /// those inside, and of what is tracked, all. Whole numbers, so that no rounding adds up.
    pub held: S,
    /// How well what is to be tracked was, within the control step; zeros where nothing is.
    pub tracking: Tracking<S>,
    /// Greatest force on the fingertip within the control step (N), whatever it touches.
    pub touch: S,
    /// Sum over the physics steps of the control step of the squared force of all contacts (N^2), where that costs something; else zero.
    pub squared_force: S,
    /// Physics steps from the arrival for what first counted within the control step until now, zero where nothing did: from the onset
    /// of the contact that pressed the button, from the beginning of the stay that completed the dwell, from the end of a way, of a swing
    /// or of a drive, or from the first entry into what is followed.
    pub pressed: S,
    /// One where the button was pressed, and let go within the control step.
    pub let_go: S,
    /// See [`TaskState::down`].
    pub down: S,
    /// See [`TaskState::pressing`]; in the air where there are fewer.
    pub pressing: [Pressing<S>; PRESSERS],
    /// See [`TaskState::holds`]; zeros where there are fewer.
    pub holds: [S; PRESSERS],
    /// Presses of buttons that were not asked for, within the control step.
    pub wrong_presses: S,
    /// Where the current handle stands, as a share of its way.
    pub value: S,
    /// How far the current way has been gone.
    pub steering: Steering<S>,
    /// How the current stick stands.
    pub hold: Hold<S>,
    /// Where the current vehicle is.
    pub ride: Ride<S>,
    /// See [`TaskState::open`]; zero where nothing is to be pinched.
    pub open: S,
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
        let TaskState { held, down, .. } = *state;
        let mut pressing = [Pressing::in_the_air(); PRESSERS];
        for (now, before) in pressing.iter_mut().zip(&state.pressing) {
            *now = *before;
        }
        let mut holds = [o; PRESSERS];
        for (now, before) in holds.iter_mut().zip(&state.holds) {
            *now = *before;
        }
        let value = goal.drag().map_or(o, |drag| drag.value);
        let steering = state.steering.map_or_else(Steering::new, |steering| Steering { exits: o, ..steering });
        Self {
            held,
            tracking: Tracking::new(),
            touch: o,
            squared_force: o,
            pressed: o,
            let_go: o,
            down,
            pressing,
            holds,
            wrong_presses: o,
            value,
            steering,
            hold: Hold::new(state, goal.swing.as_ref()),
            ride: Ride::new(goal.drive.as_ref()),
            open: state.open.unwrap_or(o),
            passed: o,
            cursor: state.cursor.unwrap_or([o; 2]),
        }
    }

    /// Counts a physics step that began with the body and the pointer here and these contacts; `share` of a control step is a physics step.
    #[inline(always)]
    pub fn follow(
        &mut self,
        task: &CompiledTask<S>,
        goal: &Goal<S>,
        body: &Landmarks<S>,
        pointer: Point<S>,
        share: f64,
        contacts: impl Iterator<Item = Contact<S>> + Clone,
    ) {
        let one = S::lit(1.0);
        if task.is_felt() {
            self.feel(task, contacts.clone());
        }
        let mut inside = S::Mask::splat(false);
        let mut tracks_now = S::Mask::splat(false);
        if task.kinds.dwell {
            let off = difference(pointer, goal.centre_after(self.passed * S::lit(share)));
            inside = dot(off, off).lt(goal.size * goal.size) & !goal.is_press;
            if let Some(is_lit) = goal.is_lit {
                inside = inside & is_lit;
            }
            if let Some(tracks) = goal.tracks {
                tracks_now = tracks & goal.lit();
                self.tracking.count(tracks_now, inside, dot(off, off));
            }
            inside = inside & self.fingers(task, goal, body, inside, share);
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
        if task.kinds.track {
            on = on | tracks_now;
        }
        if let Some(swing) = &goal.swing {
            let [is_held, is_left] = self.hold.follow(swing, pointer, goal.lit(), share);
            inside = inside & !swing.is_swing;
            on = is_held | inside;
            arrives = arrives | is_left;
        }
        if let (Some(drive), Some(control_s)) = (&goal.drive, task.control_s) {
            arrives = arrives | self.ride.follow(drive, &self.hold, control_s * S::lit(share)) & goal.lit();
        }
        let mut comes = S::Mask::splat(false);
        if let Some(button) = &goal.button {
            let bounce = task.bounce * S::lit(share).recip();
            let touched = self.press_buttons(task, goal, button, pointer, bounce, contacts);
            on = on | touched.on_face;
            comes = touched.comes;
        }
        self.stay(goal, on);
        let counts = comes | (inside & self.counts(goal, share));
        self.press(S::select(arrives, one, self.held.only(counts)));
    }

    /// Where other fingers do what they are asked for, and follows whether they are open for a pinch; `inside` is where the pointer is.
    #[inline(always)]
    fn fingers(
        &mut self,
        task: &CompiledTask<S>,
        goal: &Goal<S>,
        body: &Landmarks<S>,
        inside: S::Mask,
        share: f64,
    ) -> S::Mask {
        let mut all = fingers::others_inside(goal, body, self.passed * S::lit(share));
        if let Some(pinch) = &goal.pinch {
            let away = pinch.away(body, task.fingers.len());
            let gap = dot(away, away).sqrt();
            self.open = fingers::opened(pinch, gap, self.open, inside);
            all = all & fingers::is_pinched(pinch, gap, self.open);
        }
        all
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

    /// Physics steps from the arrival at the current object until now: that of [`pressed`](Self::pressed), and where nothing counted yet,
    /// that of the last stay without a break.
    #[inline(always)]
    pub fn since_arrival(&self) -> S {
        S::select(S::zero().lt(self.pressed), self.pressed, self.held)
    }
}
