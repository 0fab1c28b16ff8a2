//! When the fingertip came to the current target, to the physics step.
//!
//! Whether a target is done is judged at the ends of control steps. When the fingertip got there is followed in between, so
//! that movement times are as fine as the physics and know nothing of the control step.

use super::{CompiledTask, Point, TargetKind, TaskState, difference};
use myo_scalar::{Mask, Scalar};

/// What counts as being on the current target; the same for a whole control step.
#[derive(Clone, Debug)]
pub struct Aim<S> {
    /// Centre and squared radius (m, m^2) of a sphere; the square is negative where the target is a button.
    sphere: Option<(Point<S>, S)>,
    /// Number of a button and the force (N) that counts as pressed; the number is negative where the target is a sphere.
    button: Option<(S, S)>,
}

/// Contact of the fingertip in a physics step.
#[derive(Clone, Copy, Debug)]
pub struct Contact<S: Scalar> {
    /// Where there is one.
    pub exists: S::Mask,
    /// Number of the button.
    pub button: S,
    /// Its force (N).
    pub force: S,
}

/// How long the fingertip has been on the current target, in physics steps.
#[derive(Clone, Copy, Debug)]
pub struct Stay<S> {
    /// Inside the sphere or in contact with the button, without a break.
    pub held: S,
    /// From the onset of the contact that first pressed the button, within the control step, until now; zero without one.
    pub pressed: S,
}

impl<S: Scalar> Aim<S> {
    /// At the current target.
    #[inline(always)]
    pub fn new(task: &CompiledTask<S>, state: &TaskState<S>) -> Self {
        let (mut spheres, mut number, mut min_force) = (false, S::lit(-1.0), S::zero());
        let mut square = state.current_size() * state.current_size();
        for (index, target) in task.targets.iter().enumerate() {
            let current = state.is_current(index);
            match target {
                TargetKind::Sphere(_) => spheres = true,
                TargetKind::Button(button) => {
                    square = S::select(current, S::lit(-1.0), square);
                    number = S::select(current, S::lit(button.number as f64), number);
                    min_force = S::select(current, button.min_force, min_force);
                }
            }
        }
        let buttons = task.buttons().next().is_some();
        Self { sphere: spheres.then(|| (state.centre(0), square)), button: buttons.then_some((number, min_force)) }
    }

    /// Whether presses are followed.
    #[inline(always)]
    pub fn has_buttons(&self) -> bool {
        self.button.is_some()
    }

    /// Counts a physics step that began with this fingertip and contact.
    #[inline(always)]
    pub fn follow(&self, fingertip: Point<S>, contact: &Contact<S>, stay: &mut Stay<S>) {
        let one = S::lit(1.0);
        let mut on = S::Mask::splat(false);
        if let Some((centre, square)) = self.sphere {
            let [x, y, z] = difference(fingertip, centre);
            on = x.mul_add(x, y.mul_add(y, z * z)).lt(square);
        }
        let Some((number, min_force)) = self.button else {
            stay.held = (stay.held + one).only(on);
            return;
        };
        let touches = contact.exists & (contact.button - number).abs().lt(S::lit(0.5));
        stay.held = (stay.held + one).only(on | touches);
        let presses = touches & min_force.le(contact.force);
        let before = S::zero().lt(stay.pressed);
        stay.pressed = S::select(before, stay.pressed + one, stay.held.only(presses));
    }
}

impl<S: Scalar> Stay<S> {
    /// Physics steps from the arrival at the current target to the end of the control step: to where the last unbroken stay
    /// in the sphere began, or to the onset of the contact that pressed the button.
    #[inline(always)]
    pub fn since_arrival(&self) -> S {
        S::select(S::zero().lt(self.pressed), self.pressed, self.held)
    }
}
