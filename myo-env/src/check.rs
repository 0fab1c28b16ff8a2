//! Whether a call is right, the same for every backend.

use crate::saved::{Header, Saved};
use crate::trace::TraceShape;
use crate::vector::{Autoreset, EnvError, EnvSpec, StepBuffers};
use std::ops::Range;

fn length(what: &'static str, got: usize, expected: usize) -> Result<(), EnvError> {
    if got == expected { Ok(()) } else { Err(EnvError::WrongLength { what, got, expected }) }
}

/// Arguments of a reset.
pub fn reset(spec: &EnvSpec, mask: Option<&[bool]>, observation: &[f32]) -> Result<(), EnvError> {
    length("observation", observation.len(), spec.num_envs * spec.observation_size())?;
    mask.map_or(Ok(()), |mask| length("mask", mask.len(), spec.num_envs))
}

/// Arguments of a step.
pub fn step(spec: &EnvSpec, actions: &[f32], out: &StepBuffers<'_>) -> Result<(), EnvError> {
    let (n, nact) = (spec.num_envs, spec.action_size());
    length("actions", actions.len(), n * nact)?;
    length("observation", out.observation.len(), n * spec.observation_size())?;
    length("reward", out.reward.len(), n)?;
    length("terminated", out.terminated.len(), n)?;
    length("truncated", out.truncated.len(), n)?;
    length("final_observation", out.final_observation.len(), n * spec.observation_size())?;
    length("episode", out.episode.len(), n * spec.episode_size())?;
    match actions.iter().position(|a| !a.is_finite()) {
        None => Ok(()),
        Some(at) => Err(EnvError::NonFiniteAction { env: at / nact, index: at % nact, value: actions[at] }),
    }
}

/// A share of what movement costs.
pub fn share(share: f64) -> Result<f64, EnvError> {
    if (0.0..=1.0).contains(&share) { Ok(share) } else { Err(EnvError::BadShare { share }) }
}

/// Memory for a trace.
pub fn trace(spec: &EnvSpec, shape: &TraceShape, trace: &[f32]) -> Result<(), EnvError> {
    length("trace", trace.len(), spec.num_envs * shape.len_per_env())
}

/// Environments to look at.
pub fn range(spec: &EnvSpec, envs: &Range<usize>) -> Result<(), EnvError> {
    let (&Range { start, end }, num_envs) = (envs, spec.num_envs);
    if start <= end && end <= num_envs { Ok(()) } else { Err(EnvError::NoSuchEnvironment { start, end, num_envs }) }
}

/// A saved state that can go on in an environment whose own states have this header.
pub fn state<'a>(bytes: &'a [u8], own: &Header) -> Result<Saved<'a>, EnvError> {
    let fitting = Saved::read(bytes).and_then(|saved| own.check(&saved.header).map(|()| saved));
    fitting.map_err(|reason| EnvError::BadState { reason })
}

/// With [`Autoreset::Disabled`]: environments that must be reset before the next step. What the states themselves say
/// ([`EnvState::pending`](crate::state::EnvState::pending)), kept where a step can ask without looking into them.
#[derive(Clone, Debug)]
pub struct Finished(Vec<bool>);

impl Finished {
    /// None yet.
    pub fn new(spec: &EnvSpec) -> Self {
        let watched = if spec.autoreset == Autoreset::Disabled { spec.num_envs } else { 0 };
        Self(vec![false; watched])
    }

    /// What a saved state says, whose number `pending` tells finished environments.
    ///
    /// # Errors
    /// There are such environments, and an environment that resets itself at once has no step for them.
    pub fn of(&self, saved: &Saved<'_>, pending: usize, spec: &EnvSpec) -> Result<Self, EnvError> {
        let is_finished = |env: usize| saved.number(env, pending) > 0.5;
        match (spec.autoreset, (0..spec.num_envs).find(|&env| is_finished(env))) {
            (Autoreset::SameStep, Some(env)) => Err(EnvError::BadState {
                reason: format!(
                    "its environment {env} has finished its episode, and this environment starts the next one in the same \
                     step; reset it before the state is saved"
                ),
            }),
            _ => Ok(Self((0..self.0.len()).map(is_finished).collect())),
        }
    }

    /// Refuses a step while there is one.
    pub fn check(&self) -> Result<(), EnvError> {
        self.0.iter().position(|&finished| finished).map_or(Ok(()), |env| Err(EnvError::NeedsReset { env }))
    }

    /// After a step.
    pub fn note(&mut self, terminated: &[bool], truncated: &[bool]) {
        for (finished, (&terminated, &truncated)) in self.0.iter_mut().zip(terminated.iter().zip(truncated)) {
            *finished = terminated || truncated;
        }
    }

    /// After a reset.
    pub fn reset(&mut self, mask: Option<&[bool]>) {
        for (env, finished) in self.0.iter_mut().enumerate() {
            *finished &= mask.is_some_and(|mask| !mask[env]);
        }
    }
}
