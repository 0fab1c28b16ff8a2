//! Where experience comes from and is learned from: on the processor, or all on the graphics card.

use myo_env::{Autoreset, EnvSpec, GpuEnv, VectorEnv};

use crate::gpu::Card;
use crate::learn::Learner;
use crate::networks::Networks;
use crate::rollout::Rollout;
use crate::{PpoConfig, TrainError};

/// An environment, and memory to learn from it.
pub enum TrainingDevice {
    /// The policy acts and learns on the processor.
    Host(Box<Host>),
    /// On the card.
    Card(Box<Card>),
}

/// What training on the processor works on.
pub struct Host {
    /// The environment.
    pub env: Box<dyn VectorEnv>,
    /// Samples of one update.
    pub rollout: Rollout,
    /// Memory of learning.
    pub learner: Learner,
}

impl TrainingDevice {
    /// On the processor.
    pub fn on_host(env: Box<dyn VectorEnv>, config: &PpoConfig) -> Result<Self, TrainError> {
        check_env(env.as_ref(), config)?;
        check_memory(env.spec(), config)?;
        let rollout = Rollout::new(env.spec(), config);
        let learner = Learner::new(&Networks::new(env.spec(), config), config, env.spec().control_dt);
        Ok(Self::Host(Box::new(Host { env, rollout, learner })))
    }

    /// On the card that holds the environment: one for every [group](myo_gpu::Gpu::in_groups) of it.
    pub fn on_card(env: GpuEnv, config: &PpoConfig) -> Result<Vec<Self>, TrainError> {
        check_env(&env, config)?;
        let log_std = Networks::new(env.spec(), config).log_std_range();
        let cards = Card::all(env, config, log_std)?;
        Ok(cards.into_iter().map(|card| Self::Card(Box::new(card))).collect())
    }

    /// The environment.
    pub fn env(&self) -> &dyn VectorEnv {
        match self {
            Self::Host(host) => host.env.as_ref(),
            Self::Card(card) => card.env(),
        }
    }

    /// The environment.
    pub fn env_mut(&mut self) -> &mut dyn VectorEnv {
        match self {
            Self::Host(host) => host.env.as_mut(),
            Self::Card(card) => card.env_mut(),
        }
    }

    /// Its sizes and names.
    pub fn spec(&self) -> &EnvSpec {
        self.env().spec()
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
}

/// Refuses settings that take more memory than there is: of the samples of an update, the parameters, Adam's memory and the
/// partial gradients, which are the most.
fn check_memory(spec: &EnvSpec, config: &PpoConfig) -> Result<(), TrainError> {
    let parameters = Networks::new(spec, config).len() as u64;
    let batch = config.batch_size(spec.control_dt);
    let (samples, columns) = (batch as u64, (batch + config.num_envs) as u64);
    let numbers = columns * spec.observation_size() as u64
        + samples * spec.action_size() as u64
        + parameters * (3 + Learner::gradient_parts(config, spec.control_dt) as u64);
    let bytes = numbers * size_of::<f32>() as u64;
    // The system is asked for it, and given it back: it would end the process if it had to refuse later.
    let is_there = usize::try_from(bytes).is_ok_and(|bytes| Vec::<u8>::new().try_reserve_exact(bytes).is_ok());
    if is_there { Ok(()) } else { Err(TrainError::Memory { bytes }) }
}

/// Refuses settings out of range and environments that do not fit them.
pub fn check_env(env: &dyn VectorEnv, config: &PpoConfig) -> Result<(), TrainError> {
    check_spec(env.spec(), config)
}

/// The same of environments that need not be there.
pub fn check_spec(spec: &EnvSpec, config: &PpoConfig) -> Result<(), TrainError> {
    config.validate_for(spec.control_dt)?;
    let mismatch = |what, got: String, expected: String| Err(TrainError::Mismatch { what, got, expected });
    if spec.num_envs != config.num_envs {
        return mismatch("the number of environments", spec.num_envs.to_string(), config.num_envs.to_string());
    }
    let exploring = config.envs(0).exploring;
    if spec.exploring != exploring {
        let expected = format!("{exploring}: make environments of `PpoConfig::envs`, or set exploring_starts to 0");
        return mismatch("the number of environments that explore", spec.exploring.to_string(), expected);
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
