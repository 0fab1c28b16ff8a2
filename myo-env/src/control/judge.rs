//! Who judges a control step: the script of a task, or rules of one's own.

use super::{Outcome, Scratch, control_step, reset};
use crate::parameters::World;
use crate::state::EnvState;
use myo_scalar::Scalar;

/// Says what is observed, when an episode is over and what it was worth. Known when code is compiled, so that neither kind pays for
/// the other.
pub trait Judge: Send + Sync + 'static {
    /// One control step, actions in `ctrl`: noise, physics, judgement, reward, observation, summary.
    fn control_step<S: Scalar>(&self, world: &World<'_, S>, env: &mut EnvState<S>, ws: &mut Scratch<S>) -> Outcome<S>;

    /// Starts a new episode where the mask is true; observations of all follow in `next_observation`.
    fn reset<S: Scalar>(&self, world: &World<'_, S>, mask: S::Mask, env: &mut EnvState<S>, ws: &mut Scratch<S>);
}

/// The script of the task.
pub struct Script;

impl Judge for Script {
    #[inline(always)]
    fn control_step<S: Scalar>(&self, world: &World<'_, S>, env: &mut EnvState<S>, ws: &mut Scratch<S>) -> Outcome<S> {
        control_step(world, env, ws)
    }

    #[inline(always)]
    fn reset<S: Scalar>(&self, world: &World<'_, S>, mask: S::Mask, env: &mut EnvState<S>, ws: &mut Scratch<S>) {
        reset(world, mask, env, ws);
    }
}
