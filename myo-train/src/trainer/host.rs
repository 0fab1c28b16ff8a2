//! Updates on the processor, which can be ended early.

use std::time::Instant;

use super::{Brain, UpdateResult};
use crate::device::Host;
use crate::gae::explained_variance;
use crate::learn::Optimizer;
use crate::normalizer::Normalizer;
use crate::{Checkpoint, TrainError};

/// The state of the training after some update.
pub struct HostState {
    pub parameters: Vec<f32>,
    pub optimizer: Optimizer,
    /// Current raw observations, `(envs, observations)`.
    pub observation: Vec<f32>,
    pub normalizer: Normalizer,
    pub learning_rate: f64,
    pub updates: u64,
    pub wall_s: f64,
}

impl HostState {
    /// Takes over the state in a checkpoint.
    pub fn restore(&mut self, checkpoint: &Checkpoint) {
        self.parameters.clone_from(&checkpoint.parameters);
        self.optimizer.clone_from(&checkpoint.optimizer);
        self.normalizer.clone_from(&checkpoint.normalizer);
        if !checkpoint.env_state.is_empty() {
            self.observation.clone_from(&checkpoint.observation);
        }
        self.learning_rate = checkpoint.learning_rate;
        self.updates = checkpoint.updates;
        self.wall_s = checkpoint.wall_s;
    }
}

/// What an update moves before it is done.
struct Undo {
    env_state: Vec<u8>,
    observation: Vec<f32>,
    parameters: Vec<f32>,
    optimizer: Optimizer,
}

impl Undo {
    fn new(host: &Host, state: &HostState) -> Result<Self, TrainError> {
        let HostState { parameters, optimizer, observation, .. } = state;
        Ok(Self {
            env_state: host.env.save_state()?,
            observation: observation.clone(),
            parameters: parameters.clone(),
            optimizer: optimizer.clone(),
        })
    }

    fn undo(self, host: &mut Host, state: &mut HostState) -> Result<(), TrainError> {
        let Self { env_state, observation, parameters, optimizer } = self;
        host.env.load_state(&env_state)?;
        (state.observation, state.parameters, state.optimizer) = (observation, parameters, optimizer);
        Ok(())
    }
}

impl Host {
    /// Collects a roll-out and learns from it, with the number of updates before this one and its step size.
    pub(super) fn update(
        &mut self,
        brain: &Brain,
        state: &mut HostState,
        address: (u64, f64),
    ) -> Result<UpdateResult, TrainError> {
        let whole = self.attempt(brain, state, address, &|| true)?;
        Ok(whole.expect("nothing ends it early"))
    }

    /// The same as long as `go_on` says so; else none, and everything is as it was before.
    pub(super) fn update_while(
        &mut self,
        brain: &Brain,
        state: &mut HostState,
        address: (u64, f64),
        go_on: &dyn Fn() -> bool,
    ) -> Result<Option<UpdateResult>, TrainError> {
        let undo = Undo::new(self, state)?;
        let result = self.attempt(brain, state, address, go_on)?;
        if result.is_none() {
            undo.undo(self, state)?;
        }
        Ok(result)
    }

    /// An update; none, and the state half-way, if `go_on` ended it.
    fn attempt(
        &mut self,
        brain: &Brain,
        state: &mut HostState,
        (update, learning_rate): (u64, f64),
        go_on: &dyn Fn() -> bool,
    ) -> Result<Option<UpdateResult>, TrainError> {
        let (start, Brain { config, networks, lender, .. }) = (Instant::now(), brain);
        brain.stagger(self.env.as_mut(), update, &mut state.observation)?;
        let (rollout, actor) = (&mut self.rollout, brain.actor(&state.parameters));
        let first_step = update * brain.steps_per_update() as u64;
        if !rollout.collect(self.env.as_mut(), &actor, first_step, &mut state.observation, go_on)? || !go_on() {
            return Ok(None);
        }
        rollout.evaluate(&actor);
        let collect_s = start.elapsed().as_secs_f64();
        rollout.estimate(config);
        let address = (brain.seed, update);
        let (parameters, optimizer) = (&mut state.parameters, &mut state.optimizer);
        let learn = self.learner.learn(
            networks,
            rollout,
            config,
            address,
            learning_rate,
            lender,
            parameters,
            optimizer,
            go_on,
        )?;
        Ok(learn.map(|learn| UpdateResult {
            learn,
            collect_s,
            moments: rollout.moments.clone(),
            episodes: rollout.episodes.clone(),
            noise_free: rollout.noise_free.clone(),
            layouts: rollout.layouts.clone(),
            reward_sum: rollout.reward.iter().map(|&r| f64::from(r)).sum(),
            explained_variance: explained_variance(&rollout.value[..rollout.reward.len()], &rollout.target),
            spread: networks.spread(&state.parameters),
        }))
    }
}
