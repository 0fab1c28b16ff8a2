//! Where experience comes from: an environment with the policy on the processor, or both on the graphics card.

use myo_env::{Autoreset, GpuEnv, VectorEnv};

use crate::gpu::DeviceRollout;
use crate::rollout::{Actor, Rollout};
use crate::{PpoConfig, TrainError};

/// Collects roll-outs.
pub enum Collector {
    /// The policy acts on the processor.
    Host(Box<dyn VectorEnv>),
    /// The policy acts on the card.
    Card(Box<DeviceRollout>),
}

impl Collector {
    /// On the card that holds the environment.
    pub fn on_card(env: GpuEnv, config: &PpoConfig) -> Result<Self, TrainError> {
        Ok(Self::Card(Box::new(DeviceRollout::new(env, config)?)))
    }

    /// The environment.
    pub fn env(&self) -> &dyn VectorEnv {
        match self {
            Self::Host(env) => env.as_ref(),
            Self::Card(card) => card.env(),
        }
    }

    /// The environment.
    pub fn env_mut(&mut self) -> &mut dyn VectorEnv {
        match self {
            Self::Host(env) => env.as_mut(),
            Self::Card(card) => card.env_mut(),
        }
    }

    /// Continues from a saved state of the environment and the observations, `(envs, observations)`, that went with it.
    pub fn load(&mut self, state: &[u8], observation: &[f32]) -> Result<(), TrainError> {
        self.env_mut().load_state(state)?;
        match self {
            Self::Host(_) => Ok(()),
            // The environment works out its observations anew, which may change their last bits.
            Self::Card(card) => card.set_observation(observation),
        }
    }

    /// A roll-out from `observation`, the current raw observations, which become the next ones; with values.
    pub fn collect(
        &mut self,
        actor: &Actor<'_>,
        first_step: u64,
        rollout: &mut Rollout,
        observation: &mut [f32],
    ) -> Result<(), TrainError> {
        match self {
            Self::Host(env) => {
                rollout.collect(env.as_mut(), actor, first_step, observation)?;
                rollout.evaluate(actor);
                Ok(())
            }
            Self::Card(card) => card.collect(actor, first_step, rollout, observation),
        }
    }
}

/// Refuses settings out of range and environments that do not fit them.
pub fn check_env(env: &dyn VectorEnv, config: &PpoConfig) -> Result<(), TrainError> {
    config.validate()?;
    let spec = env.spec();
    let mismatch = |what, got: String, expected: String| Err(TrainError::Mismatch { what, got, expected });
    if spec.num_envs != config.num_envs {
        return mismatch("the number of environments", spec.num_envs.to_string(), config.num_envs.to_string());
    }
    if spec.autoreset != Autoreset::SameStep {
        return mismatch("the autoreset mode", format!("{:?}", spec.autoreset), "SameStep".into());
    }
    for (what, size) in
        [("the number of observations", spec.observation_size()), ("the number of actions", spec.action_size())]
    {
        if size == 0 {
            return mismatch(what, "0".into(), "at least 1".into());
        }
    }
    Ok(())
}
