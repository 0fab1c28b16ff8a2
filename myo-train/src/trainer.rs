//! Proximal policy optimisation (Schulman et al. 2017, arXiv 1707.06347): one roll-out, one update, again.

use std::time::Instant;

use myo_env::{EnvSpec, GpuEnv, VectorEnv};

use crate::checkpoint::Checkpoint;
use crate::collector::{Collector, check_env};
use crate::gae::explained_variance;
use crate::learn::{LearnStats, Learner, Optimizer};
use crate::metrics::UpdateMetrics;
use crate::networks::{ChunkWork, Lender, Networks};
use crate::normalizer::{Moments, Normalizer};
use crate::policy::check_names;
use crate::rollout::{Actor, Rollout, evaluate};
use crate::{Policy, PpoConfig, TrainError};

/// Borrows what acting needs, field by field, so that the rest of the trainer stays free.
macro_rules! actor {
    ($trainer:expr) => {
        Actor {
            networks: &$trainer.networks,
            parameters: &$trainer.parameters,
            normalizer: &$trainer.normalizer,
            lender: &$trainer.lender,
            config: &$trainer.config,
            seed: $trainer.seed,
        }
    };
}

/// Trains a policy in an environment.
///
/// The weights after a number of updates depend on the configuration, the seed and the environment alone, bit for bit on
/// one kind of processor: not on the number of threads, nor on whether training was stopped and resumed in between. Work
/// runs on the calling thread's rayon pool.
pub struct Trainer {
    collector: Collector,
    spec: EnvSpec,
    config: PpoConfig,
    seed: u64,
    networks: Networks,
    parameters: Vec<f32>,
    optimizer: Optimizer,
    normalizer: Normalizer,
    learning_rate: f64,
    updates: u64,
    wall_s: f64,
    /// Current raw observations, `(envs, observations)`.
    observation: Vec<f32>,
    rollout: Rollout,
    learner: Learner,
    lender: Lender<ChunkWork>,
}

impl Trainer {
    /// A new policy; resets the environment with `seed`.
    pub fn new(env: Box<dyn VectorEnv>, config: PpoConfig, seed: u64) -> Result<Self, TrainError> {
        check_env(env.as_ref(), &config)?;
        Self::start(Collector::Host(env), config, seed)
    }

    /// As [`Trainer::new`], with the policy acting on the graphics card beside the environment; learning stays on the
    /// processor. Same seed, same card and driver: same weights.
    pub fn on_card(env: GpuEnv, config: PpoConfig, seed: u64) -> Result<Self, TrainError> {
        Self::start(Collector::on_card(env, &config)?, config, seed)
    }

    fn start(mut collector: Collector, config: PpoConfig, seed: u64) -> Result<Self, TrainError> {
        let spec = collector.env().spec().clone();
        let mut observation = vec![0.0; spec.num_envs * spec.observation_size()];
        collector.env_mut().reset(Some(seed), None, &mut observation)?;
        let networks = Networks::new(&spec, &config);
        let mut trainer = Self {
            parameters: networks.initialize(seed, &config),
            optimizer: Optimizer { mean: vec![0.0; networks.len()], square: vec![0.0; networks.len()], steps: 0 },
            normalizer: Normalizer::new(spec.observation_size(), config.observation_clip, config.observation_std_floor),
            learning_rate: config.learning_rate,
            updates: 0,
            wall_s: 0.0,
            observation,
            rollout: Rollout::new(&spec, &config),
            learner: Learner::new(&networks, &config),
            lender: Lender::new(),
            collector,
            spec,
            config,
            seed,
            networks,
        };
        // The first roll-out is scaled by the first observations, so that the networks never see raw ones.
        let mut moments = Moments::new(trainer.spec.observation_size());
        trainer.normalizer.measure(&trainer.observation, &mut moments);
        if let Some(index) = moments.non_finite() {
            let what = format!("observation \"{}\"", trainer.spec.observation_names[index]);
            return Err(TrainError::NonFiniteEnv { what, update: 0 });
        }
        trainer.normalizer.merge(&moments);
        Ok(trainer)
    }

    /// Collects `num_envs * steps_per_update` samples and learns from them.
    ///
    /// After an error the trainer is of no more use; resume from a checkpoint.
    pub fn update(&mut self) -> Result<UpdateMetrics, TrainError> {
        let start = Instant::now();
        let actor = actor!(self);
        let first_step = self.updates * self.config.steps_per_update as u64;
        self.collector.collect(&actor, first_step, &mut self.rollout, &mut self.observation)?;
        let collect_s = start.elapsed().as_secs_f64();
        self.rollout.estimate(&self.config);

        let learn = self.learner.learn(
            &self.networks,
            &self.rollout,
            &self.config,
            (self.seed, self.updates),
            self.learning_rate,
            &self.lender,
            &mut self.parameters,
            &mut self.optimizer,
        )?;
        let learning_rate = self.learning_rate;
        self.learning_rate = adapted_rate(learning_rate, learn.kl, &self.config);
        // Only now, so that one update sees one scaling.
        self.normalizer.merge(&self.rollout.moments);
        self.updates += 1;
        let total_s = start.elapsed().as_secs_f64();
        self.wall_s += total_s;
        Ok(self.metrics(learn, learning_rate, collect_s, total_s - collect_s))
    }

    fn metrics(&self, learn: LearnStats, learning_rate: f64, collect_s: f64, learn_s: f64) -> UpdateMetrics {
        let (rollout, spread) = (&self.rollout, self.networks.spread(&self.parameters));
        let samples = rollout.reward.len();
        let reward_sum: f64 = rollout.reward.iter().map(|&r| f64::from(r)).sum();
        UpdateMetrics {
            env_steps: self.env_steps(),
            updates: self.updates,
            wall_s: self.wall_s,
            collect_s,
            learn_s,
            episodes: rollout.episodes.count,
            episode_means: self.spec.episode_names.iter().cloned().zip(rollout.episodes.means()).collect(),
            reward_per_step: reward_sum / samples as f64 / self.config.reward_scale,
            learn,
            explained_variance: explained_variance(&rollout.value[..samples], &rollout.target),
            entropy: spread.entropy.into(),
            action_std: spread.std.iter().map(|&s| f64::from(s)).sum::<f64>() / spread.std.len() as f64,
            learning_rate,
        }
    }

    /// Control steps of all environments since the start.
    pub fn env_steps(&self) -> u64 {
        self.updates * self.config.batch_size() as u64
    }

    /// Updates since the start.
    pub fn updates(&self) -> u64 {
        self.updates
    }

    /// The environment's sizes and names.
    pub fn spec(&self) -> &EnvSpec {
        &self.spec
    }

    /// The settings.
    pub fn config(&self) -> &PpoConfig {
        &self.config
    }

    /// The seed.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// A copy of the policy as it is now.
    pub fn policy(&self) -> Policy {
        let names = (&self.spec.observation_names[..], &self.spec.action_names[..]);
        Policy::new(names, self.networks.clone(), &self.config, self.parameters.clone(), self.normalizer.clone())
    }

    /// What the value network thinks of raw observations, `(rows, observations)`: scaled, discounted future reward.
    pub fn values(&self, observation: &[f32], value_out: &mut [f32]) {
        let mut x = vec![0.0; observation.len()];
        self.normalizer.apply(observation, &mut x);
        evaluate(&actor!(self), &x, value_out);
    }

    /// Everything that the next updates depend on. If the environment's state is lost, with the graphics card that held it,
    /// the training that continues begins with new episodes.
    pub fn save(&self) -> Checkpoint {
        Checkpoint {
            config: self.config.clone(),
            seed: self.seed,
            updates: self.updates,
            wall_s: self.wall_s,
            learning_rate: self.learning_rate,
            observation_names: self.spec.observation_names.clone(),
            action_names: self.spec.action_names.clone(),
            parameters: self.parameters.clone(),
            optimizer: self.optimizer.clone(),
            normalizer: self.normalizer.clone(),
            observation: self.observation.clone(),
            env_state: self.collector.env().save_state().unwrap_or_default(),
        }
    }

    /// Continues from a checkpoint in an environment of the same kind and size, bit for bit; with new episodes where the
    /// checkpoint was written without the state of the environment.
    pub fn restore(env: Box<dyn VectorEnv>, checkpoint: &Checkpoint) -> Result<Self, TrainError> {
        check_env(env.as_ref(), &checkpoint.config)?;
        Self::resume(Collector::Host(env), checkpoint)
    }

    /// As [`Trainer::restore`], on the graphics card.
    pub fn restore_on_card(env: GpuEnv, checkpoint: &Checkpoint) -> Result<Self, TrainError> {
        Self::resume(Collector::on_card(env, &checkpoint.config)?, checkpoint)
    }

    fn resume(collector: Collector, checkpoint: &Checkpoint) -> Result<Self, TrainError> {
        let spec = collector.env().spec();
        check_names("the list of observations", &spec.observation_names, &checkpoint.observation_names)?;
        check_names("the list of actions", &spec.action_names, &checkpoint.action_names)?;
        let mut trainer = Self::start(collector, checkpoint.config.clone(), checkpoint.seed)?;
        if checkpoint.env_state.is_empty() {
            // Other episodes than those of the beginning.
            let seed = checkpoint.seed.wrapping_add(checkpoint.updates);
            trainer.collector.env_mut().reset(Some(seed), None, &mut trainer.observation)?;
        } else {
            trainer.collector.load(&checkpoint.env_state, &checkpoint.observation)?;
            trainer.observation.clone_from(&checkpoint.observation);
        }
        trainer.updates = checkpoint.updates;
        trainer.wall_s = checkpoint.wall_s;
        trainer.learning_rate = checkpoint.learning_rate;
        trainer.parameters.clone_from(&checkpoint.parameters);
        trainer.optimizer.clone_from(&checkpoint.optimizer);
        trainer.normalizer.clone_from(&checkpoint.normalizer);
        Ok(trainer)
    }
}

/// Learning rate for the next update: lower when the policy moved too far, higher when it hardly moved.
fn adapted_rate(rate: f64, kl: f64, config: &PpoConfig) -> f64 {
    let rate = if config.kl_target == 0.0 {
        rate
    } else if kl > config.kl_target * config.kl_tolerance {
        rate / config.kl_factor
    } else if kl < config.kl_target / config.kl_tolerance {
        rate * config.kl_factor
    } else {
        rate
    };
    rate.clamp(config.learning_rate_min, config.learning_rate_max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn learning_rate_follows_the_divergence_within_its_bounds() {
        let config = PpoConfig::default();
        assert_eq!(adapted_rate(1e-3, 0.1, &config), 1e-3 / 1.5);
        assert_eq!(adapted_rate(1e-3, 0.001, &config), 1.5e-3);
        assert_eq!(adapted_rate(1e-3, config.kl_target, &config), 1e-3);
        assert_eq!(adapted_rate(1e-5, 0.1, &config), 1e-5);
        assert_eq!(adapted_rate(3e-3, 0.0, &config), 3e-3);
        assert_eq!(adapted_rate(1e-3, 0.1, &PpoConfig { kl_target: 0.0, ..config }), 1e-3);
    }
}
