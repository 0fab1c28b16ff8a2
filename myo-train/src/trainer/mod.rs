//! Proximal policy optimisation (Schulman et al. 2017, arXiv 1707.06347): one roll-out, one update, again.

mod host;

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use myo_env::{EnvSpec, GpuEnv, VectorEnv};
use myo_tasks::Task;

use crate::checkpoint::Checkpoint;
use crate::device::TrainingDevice;
use crate::gaussian::Spread;
use crate::gpu::{CardUpdate, Together};
use crate::inherit::{Heir, Inherited};
use crate::learn::{LearnStats, Optimizer};
use crate::metrics::{EpisodeSums, Episodes, UpdateMetrics};
use crate::networks::{ChunkWork, Lender, Networks};
use crate::normalizer::{Moments, Normalizer};
use crate::policy::check_names;
use crate::rollout::{Actor, evaluate};
use crate::{Policy, PpoConfig, TrainError};
use host::HostState;

/// Trains a policy in an environment.
///
/// The weights after a number of updates depend on the configuration, the seed and the environment alone, bit for bit on
/// one kind of processor: not on the number of threads, nor on whether training was stopped and resumed in between. Work
/// runs on the calling thread's rayon pool. On the graphics card they depend on the card and its driver as well.
pub struct Trainer {
    device: TrainingDevice,
    brain: Brain,
    /// What the host knows of the state of the training; all of it, unless that lives on the card.
    host_state: Mutex<HostState>,
    learning_rate: f64,
    updates: u64,
    wall_s: f64,
    inherited: Option<Inherited>,
    /// Share of what movement and errors cost that counts.
    cost_share: f64,
    /// Control steps between cuts of one environment that memory is laid out for, as far as an update goes.
    between_cuts: usize,
}

/// One of [several trainings](Trainer::several_on_card) on a card.
#[derive(Clone, Copy, Debug)]
pub enum Member<'a> {
    /// With a new policy.
    New {
        /// Its settings.
        config: &'a PpoConfig,
        /// Seed of everything random.
        seed: u64,
    },
    /// With a new policy and a task of its own, which has the structure of the environment's, see [`VectorEnv::set_task`].
    Of {
        /// The task.
        task: &'a Task,
        /// Its settings.
        config: &'a PpoConfig,
        /// Seed of everything random.
        seed: u64,
    },
    /// Goes on from a checkpoint.
    Resumed(&'a Checkpoint),
}

impl Member<'_> {
    fn config(&self) -> &PpoConfig {
        match self {
            Self::New { config, .. } | Self::Of { config, .. } => config,
            Self::Resumed(checkpoint) => &checkpoint.config,
        }
    }
}

/// What acting takes besides the weights.
struct Brain {
    spec: EnvSpec,
    config: PpoConfig,
    seed: u64,
    networks: Networks,
    normalizer: Normalizer,
    lender: Lender<ChunkWork>,
}

/// What an update tells, wherever it ran.
struct UpdateResult {
    learn: LearnStats,
    collect_s: f64,
    moments: Moments,
    episodes: EpisodeSums,
    noise_free: EpisodeSums,
    layouts: Vec<EpisodeSums>,
    /// Sum of the scaled rewards.
    reward_sum: f64,
    explained_variance: f64,
    spread: Spread,
}

impl Brain {
    fn actor<'a>(&'a self, parameters: &'a [f32]) -> Actor<'a> {
        let Self { networks, normalizer, lender, config, seed, .. } = self;
        Actor { networks, parameters, normalizer, lender, config, seed: *seed }
    }

    fn steps_per_update(&self) -> usize {
        self.config.steps_per_update(self.spec.control_dt)
    }

    /// Before an update of the first episode, begins the episodes of some environments anew, each environment's once. Otherwise
    /// those that all last to the time limit would begin and end together for ever, and an update learn from their beginnings
    /// alone, or from what comes after.
    fn stagger(&self, env: &mut dyn VectorEnv, update: u64, observation: &mut [f32]) -> Result<(), TrainError> {
        let turns = self.spec.max_episode_steps / self.steps_per_update();
        if !(1..turns as u64).contains(&update) {
            return Ok(());
        }
        let mask: Vec<bool> = (0..self.spec.num_envs).map(|env| (env % turns) as u64 == update).collect();
        Ok(env.reset(None, Some(&mask), observation)?)
    }
}

impl Trainer {
    /// A new policy; resets the environment with `seed`.
    pub fn new(env: Box<dyn VectorEnv>, config: PpoConfig, seed: u64) -> Result<Self, TrainError> {
        Self::start(TrainingDevice::on_host(env, &config)?, config, seed)
    }

    /// As [`Trainer::new`], with the policy acting and learning on the graphics card beside the environment; the host hears
    /// some hundred bytes per update. Same seed, same card and driver: same weights.
    pub fn on_card(env: GpuEnv, config: PpoConfig, seed: u64) -> Result<Self, TrainError> {
        Self::start(alone(env, &config)?, config, seed)
    }

    /// Several trainings on one card, one for every [group](myo_gpu::Gpu::in_groups) that `env` is for, which learn at the same
    /// time: none takes much longer than it would alone, and each comes to the same weights as on a card without groups. An
    /// [update](Self::update) waits until all others want one too or were dropped, so each belongs into a thread of its own.
    ///
    /// # Errors
    /// As many as there are groups must be given, with settings that differ in nothing but step sizes; otherwise as for
    /// [`Trainer::on_card`] and [`Trainer::restore_on_card`].
    pub fn several_on_card(env: GpuEnv, members: &[Member<'_>]) -> Result<Vec<Self>, TrainError> {
        let (groups, mut configs) = (env.gpu().groups(), members.iter().map(Member::config));
        let config = configs.next().filter(|_| members.len() == groups).ok_or_else(|| TrainError::Mismatch {
            what: "the number of trainings",
            got: members.len().to_string(),
            expected: groups.to_string(),
        })?;
        let common = |config: &PpoConfig| PpoConfig { learning_rate: 1.0, learning_rate_max: 1.0, ..config.clone() };
        if let Some(other) = configs.find(|&other| common(other) != common(config)) {
            let what = "the settings of trainings on one card";
            return Err(TrainError::Mismatch { what, got: format!("{other:?}"), expected: format!("{config:?}") });
        }
        let devices = TrainingDevice::on_card(env, config)?;
        let start = |(device, member): (_, &Member<'_>)| match member {
            Member::New { config, seed } => Self::start(device, (*config).clone(), *seed),
            Member::Of { task, config, seed } => {
                let mut device: TrainingDevice = device;
                let least = between_cuts(device.spec(), config);
                check_cuts(task, device.spec(), config, least)?;
                device.env_mut().set_task(task)?;
                Self::start(device, (*config).clone(), *seed)
            }
            Member::Resumed(checkpoint) => Self::resume(device, checkpoint),
        };
        devices.into_iter().zip(members).map(start).collect()
    }

    fn start(mut device: TrainingDevice, config: PpoConfig, seed: u64) -> Result<Self, TrainError> {
        let spec = device.spec().clone();
        let mut observation = vec![0.0; spec.num_envs * spec.observation_size()];
        device.env_mut().reset(Some(seed), None, &mut observation)?;
        let networks = Networks::new(&spec, &config);
        // The first roll-out is scaled by the first observations, so that the networks never see raw ones.
        let normalizer = first_scaling(&spec, &config, &observation)?;
        let learning_rate = config.learning_rate;
        let host_state = HostState {
            parameters: networks.initialize(seed, &config, spec.control_dt),
            optimizer: Optimizer { mean: vec![0.0; networks.len()], square: vec![0.0; networks.len()], steps: 0 },
            observation,
            normalizer: normalizer.clone(),
            learning_rate,
            updates: 0,
            wall_s: 0.0,
        };
        if let TrainingDevice::Card(card) = &mut device {
            card.set_weights(&host_state.parameters, &host_state.optimizer)?;
        }
        let between_cuts = between_cuts(&spec, &config);
        let brain = Brain { spec, config, seed, networks, normalizer, lender: Lender::new() };
        Ok(Self {
            device,
            brain,
            host_state: Mutex::new(host_state),
            learning_rate,
            updates: 0,
            wall_s: 0.0,
            inherited: None,
            cost_share: 1.0,
            between_cuts,
        })
    }

    /// Collects a batch of samples and learns from them.
    ///
    /// # Errors
    /// The environment fails or returns what is not finite, or learning diverges. The trainer is of no more use then; resume
    /// from a checkpoint.
    pub fn update(&mut self) -> Result<UpdateMetrics, TrainError> {
        let start = Instant::now();
        let result = match &mut self.device {
            TrainingDevice::Host(host) => {
                let host_state = self.host_state.get_mut().unwrap_or_else(PoisonError::into_inner);
                host.update(&self.brain, host_state, (self.updates, self.learning_rate))?
            }
            TrainingDevice::Card(card) => {
                let host_state = self.host_state.get_mut().unwrap_or_else(PoisonError::into_inner);
                self.brain.stagger(card.env_mut(), self.updates, &mut host_state.observation)?;
                card.update(&self.brain.normalizer, (self.brain.seed, self.updates), self.learning_rate)?.into()
            }
        };
        Ok(self.take_in(result, start))
    }

    /// As [`Trainer::update`], if `go_on` keeps saying so: on the processor it is asked before every control step and every
    /// minibatch, on the graphics card once, before the update. None when it said no; the trainer is as it was before then,
    /// bit for bit.
    ///
    /// # Errors
    /// As for [`Trainer::update`], or the environment cannot save its state or take it back.
    pub fn update_while(&mut self, go_on: &dyn Fn() -> bool) -> Result<Option<UpdateMetrics>, TrainError> {
        if !go_on() {
            return Ok(None);
        }
        let start = Instant::now();
        let TrainingDevice::Host(host) = &mut self.device else { return self.update().map(Some) };
        let host_state = self.host_state.get_mut().unwrap_or_else(PoisonError::into_inner);
        let result = host.update_while(&self.brain, host_state, (self.updates, self.learning_rate), go_on)?;
        Ok(result.map(|result| self.take_in(result, start)))
    }

    /// Takes in what an update that began at `start` came to.
    fn take_in(&mut self, result: UpdateResult, start: Instant) -> UpdateMetrics {
        let (learning_rate, mut result) = (self.learning_rate, result);
        result.learn.kl /= self.brain.config.exploration_steps(self.brain.spec.control_dt) as f64;
        self.learning_rate = adapted_rate(learning_rate, result.learn.kl, &self.brain.config);
        // Only now, so that one update sees one scaling.
        self.brain.normalizer.merge(&result.moments);
        self.updates += 1;
        let total_s = start.elapsed().as_secs_f64();
        self.wall_s += total_s;
        self.metrics(result, learning_rate, total_s)
    }

    fn metrics(&self, result: UpdateResult, learning_rate: f64, total_s: f64) -> UpdateMetrics {
        let (spec, config, spread) = (&self.brain.spec, &self.brain.config, &result.spread);
        // Of all noise in an action, not of its own draw alone.
        let held = config.exploration_steps(spec.control_dt) as f64;
        UpdateMetrics {
            env_steps: self.env_steps(),
            updates: self.updates,
            wall_s: self.wall_s,
            collect_s: result.collect_s,
            learn_s: total_s - result.collect_s,
            episodes: Episodes::new(&spec.episode_names, &result.episodes),
            noise_free: Episodes::new(&spec.episode_names, &result.noise_free),
            layouts: result.layouts.iter().map(|sums| Episodes::new(&spec.episode_names, sums)).collect(),
            reward_per_step: result.reward_sum / config.batch_size(spec.control_dt) as f64 / config.reward_scale,
            learn: result.learn,
            explained_variance: result.explained_variance,
            entropy: f64::from(spread.entropy) + 0.5 * spread.std.len() as f64 * held.ln(),
            action_std: spread.std.iter().map(|&s| f64::from(s)).sum::<f64>() / spread.std.len() as f64 * held.sqrt(),
            learning_rate,
            cost_share: self.cost_share,
        }
    }

    /// The state of the training on the host, read from the card where it lives there; and whether that could be done. If
    /// not, the card is lost, and the state is the one that was read last.
    fn host_state(&self) -> (MutexGuard<'_, HostState>, Result<(), TrainError>) {
        let mut host_state = self.host_state.lock().unwrap_or_else(PoisonError::into_inner);
        if let TrainingDevice::Card(card) = &self.device {
            let HostState { parameters, optimizer, observation, .. } = &mut *host_state;
            if let Err(error) = card.read_weights(parameters, optimizer, observation) {
                return (host_state, Err(error));
            }
        }
        host_state.normalizer.clone_from(&self.brain.normalizer);
        host_state.learning_rate = self.learning_rate;
        host_state.updates = self.updates;
        host_state.wall_s = self.wall_s;
        (host_state, Ok(()))
    }

    /// Those who learn together on the card, if it is on one.
    pub(crate) fn together(&self) -> Option<Arc<Together>> {
        match &self.device {
            TrainingDevice::Host(_) => None,
            TrainingDevice::Card(card) => Some(Arc::clone(card.together())),
        }
    }

    /// Control steps of all environments since the start.
    pub fn env_steps(&self) -> u64 {
        self.updates * self.brain.config.batch_size(self.brain.spec.control_dt) as u64
    }

    /// Updates since the start.
    pub fn updates(&self) -> u64 {
        self.updates
    }

    /// Seconds of training since the start, those before a resume included.
    pub fn wall_s(&self) -> f64 {
        self.wall_s
    }

    /// What a [warm start](Self::warm_start) took over.
    pub fn inherited(&self) -> Option<Inherited> {
        self.inherited
    }

    /// The environment's sizes and names.
    pub fn spec(&self) -> &EnvSpec {
        &self.brain.spec
    }

    /// The settings.
    pub fn config(&self) -> &PpoConfig {
        &self.brain.config
    }

    /// Step size of Adam in the next update.
    pub fn learning_rate(&self) -> f64 {
        self.learning_rate
    }

    /// The seed.
    pub fn seed(&self) -> u64 {
        self.brain.seed
    }

    /// A copy of the policy as it is now; after a loss of the card, as it was when it was last read from there.
    pub fn policy(&self) -> Policy {
        let Brain { spec, config, networks, normalizer, .. } = &self.brain;
        let mut host_state = self.host_state.lock().unwrap_or_else(PoisonError::into_inner);
        let is_read = match &self.device {
            TrainingDevice::Host(_) => true,
            TrainingDevice::Card(card) => card.read_parameters(&mut host_state.parameters).is_ok(),
        };
        if is_read {
            host_state.normalizer.clone_from(normalizer);
        }
        let names = (&spec.observation_names[..], &spec.action_names[..]);
        Policy::new(names, networks.clone(), config, host_state.parameters.clone(), host_state.normalizer.clone())
    }

    /// What the value network thinks of raw observations, `(rows, observations)`: scaled, discounted future reward.
    pub fn values(&self, observation: &[f32], value_out: &mut [f32]) {
        let mut x = vec![0.0; observation.len()];
        self.brain.normalizer.apply(observation, &mut x);
        evaluate(&self.brain.actor(&self.host_state().0.parameters), &x, value_out);
    }

    /// Everything that the next updates depend on.
    ///
    /// # Errors
    /// The graphics card is lost, and with it the state of the environments.
    pub fn save(&self) -> Result<Checkpoint, TrainError> {
        let (host_state, was_read) = self.host_state();
        was_read?;
        let (spec, config) = (&self.brain.spec, &self.brain.config);
        Ok(Checkpoint {
            config: config.clone(),
            control_dt: spec.control_dt,
            seed: self.brain.seed,
            updates: host_state.updates,
            wall_s: host_state.wall_s,
            learning_rate: host_state.learning_rate,
            observation_names: spec.observation_names.clone(),
            action_names: spec.action_names.clone(),
            parameters: host_state.parameters.clone(),
            optimizer: host_state.optimizer.clone(),
            normalizer: host_state.normalizer.clone(),
            observation: host_state.observation.clone(),
            env_state: self.device.env().save_state()?,
            session: None,
        })
    }

    /// Continues from a checkpoint in an environment of the same kind and size, bit for bit; with new episodes where the
    /// checkpoint was written without the state of the environment.
    pub fn restore(env: Box<dyn VectorEnv>, checkpoint: &Checkpoint) -> Result<Self, TrainError> {
        Self::resume(TrainingDevice::on_host(env, &checkpoint.config)?, checkpoint)
    }

    /// As [`Trainer::restore`], on the graphics card.
    pub fn restore_on_card(env: GpuEnv, checkpoint: &Checkpoint) -> Result<Self, TrainError> {
        Self::resume(alone(env, &checkpoint.config)?, checkpoint)
    }

    fn resume(device: TrainingDevice, checkpoint: &Checkpoint) -> Result<Self, TrainError> {
        let spec = device.spec();
        check_names("the list of observations", &spec.observation_names, &checkpoint.observation_names)?;
        check_names("the list of actions", &spec.action_names, &checkpoint.action_names)?;
        check_control_dt(spec, checkpoint)?;
        let mut trainer = Self::start(device, checkpoint.config.clone(), checkpoint.seed)?;
        trainer.load(checkpoint)?;
        Ok(trainer)
    }

    /// Takes over the state of a training with the same sizes.
    fn load(&mut self, checkpoint: &Checkpoint) -> Result<(), TrainError> {
        let host_state = self.host_state.get_mut().unwrap_or_else(PoisonError::into_inner);
        host_state.restore(checkpoint);
        if checkpoint.env_state.is_empty() {
            // Other episodes than those of the beginning.
            let seed = checkpoint.seed.wrapping_add(checkpoint.updates);
            self.device.env_mut().reset(Some(seed), None, &mut host_state.observation)?;
        } else {
            self.device.load(&checkpoint.env_state, &checkpoint.observation)?;
        }
        if let TrainingDevice::Card(card) = &mut self.device {
            card.set_weights(&host_state.parameters, &host_state.optimizer)?;
        }
        self.brain.normalizer.clone_from(&checkpoint.normalizer);
        self.learning_rate = checkpoint.learning_rate;
        self.updates = checkpoint.updates;
        self.wall_s = checkpoint.wall_s;
        Ok(())
    }

    /// Goes back to an earlier state of this training, and goes on from there with steps that are `factor` times as long
    /// as they were, and at most that factor of what they were allowed to become. The time spent is not given back.
    ///
    /// # Errors
    /// The environment refuses its state, or the card is lost.
    pub fn go_back(&mut self, checkpoint: &Checkpoint, factor: f64) -> Result<(), TrainError> {
        let wall_s = self.wall_s;
        self.load(checkpoint)?;
        self.wall_s = wall_s;
        let (config, before) = (&mut self.brain.config, &checkpoint.config);
        config.learning_rate_max = (before.learning_rate_max * factor).max(before.learning_rate_min);
        config.learning_rate = before.learning_rate.min(config.learning_rate_max);
        self.learning_rate =
            (checkpoint.learning_rate * factor).clamp(config.learning_rate_min, config.learning_rate_max);
        Ok(())
    }

    /// Lets steps become `factor` times as long as they were allowed to, but no longer than `most`.
    pub(crate) fn allow_longer_steps(&mut self, factor: f64, most: f64) {
        let allowed = &mut self.brain.config.learning_rate_max;
        *allowed = (*allowed * factor).min(most).max(*allowed);
    }

    /// Goes on with another task of the same structure, between two updates; see [`VectorEnv::set_task`]. Checkpoints of before are
    /// of the other task and do not fit any more.
    ///
    /// # Errors
    /// The environment refuses it, its time limit is too short for memory that was laid out for another, or the card is lost.
    pub fn set_task(&mut self, task: &Task) -> Result<(), TrainError> {
        check_cuts(task, &self.brain.spec, &self.brain.config, self.between_cuts)?;
        let env = self.device.env_mut();
        env.set_task(task)?;
        self.brain.spec = env.spec().clone();
        let host_state = self.host_state.get_mut().unwrap_or_else(PoisonError::into_inner);
        let none = vec![false; self.brain.spec.num_envs];
        Ok(self.device.env_mut().reset(None, Some(&none), &mut host_state.observation)?)
    }

    /// How much of what effort and acceleration cost counts.
    pub fn cost_share(&self) -> f64 {
        self.cost_share
    }

    /// Lets so much of what effort and acceleration cost count, from the next update on; see [`VectorEnv::set_cost_share`].
    ///
    /// # Errors
    /// It is not from 0 to 1, or the card is lost.
    pub fn set_cost_share(&mut self, share: f64) -> Result<(), TrainError> {
        self.device.env_mut().set_cost_share(share)?;
        self.cost_share = share;
        Ok(())
    }

    /// Begins with what another training learned instead of with nothing; to be called before the first update.
    ///
    /// Observations and actions are matched by name: what the other training did not know is ignored by the networks at
    /// first, and what it knew and is not there any more is left out. Where outputs are mapped to actions in another way, the
    /// last layer makes up for it, so that the policy acts as before. The scaling of observations starts from the other's
    /// and soon follows the new ones; Adam starts afresh.
    ///
    /// # Errors
    /// Hidden layers of other widths, no observation or action in common, or the card is lost.
    pub fn warm_start(&mut self, other: &Checkpoint) -> Result<Inherited, TrainError> {
        let host_state = self.host_state.get_mut().unwrap_or_else(PoisonError::into_inner);
        let heir = Heir { spec: &self.brain.spec, config: &self.brain.config, networks: &self.brain.networks };
        let inherited = heir.take(other, &mut host_state.parameters, &mut host_state.normalizer)?;
        self.brain.normalizer.clone_from(&host_state.normalizer);
        if let TrainingDevice::Card(card) = &mut self.device {
            card.set_weights(&host_state.parameters, &host_state.optimizer)?;
        }
        self.inherited = Some(inherited);
        Ok(inherited)
    }
}

impl From<CardUpdate> for UpdateResult {
    fn from(update: CardUpdate) -> Self {
        let CardUpdate { learn, collect_s, moments, episodes, noise_free, layouts, .. } = update;
        let (reward_sum, explained_variance) = (update.reward_sum, update.explained_variance);
        let spread = Spread::new(&update.log_std);
        Self { learn, collect_s, moments, episodes, noise_free, layouts, reward_sum, explained_variance, spread }
    }
}

/// Control steps between cuts of one environment, at least; more than an update has are all the same.
fn between_cuts(spec: &EnvSpec, config: &PpoConfig) -> usize {
    spec.steps_between_cuts().min(config.steps_per_update(spec.control_dt))
}

/// Refuses a task whose episodes are cut more often than the memory of a training is made for.
fn check_cuts(task: &Task, spec: &EnvSpec, config: &PpoConfig, least: usize) -> Result<(), TrainError> {
    let limit = task.time_limit_steps() as usize;
    let wanted = EnvSpec { max_episode_steps: limit, layout_limits: vec![limit], ..spec.clone() };
    if between_cuts(&wanted, config) >= least {
        return Ok(());
    }
    Err(TrainError::Mismatch {
        what: "the time limit in control steps",
        got: wanted.max_episode_steps.to_string(),
        expected: "one whose episodes are cut no more often within an update than those before".into(),
    })
}

/// Refuses to go on in steps of another length: the samples of an update would not be as many.
fn check_control_dt(spec: &EnvSpec, checkpoint: &Checkpoint) -> Result<(), TrainError> {
    let (got, expected) = (spec.control_dt, checkpoint.control_dt);
    if (got / expected - 1.0).abs() < 1e-6 {
        return Ok(());
    }
    let seconds = |dt: f64| format!("{dt} s");
    Err(TrainError::Mismatch { what: "the control step", got: seconds(got), expected: seconds(expected) })
}

/// The device of a training that has its card for itself.
fn alone(env: GpuEnv, config: &PpoConfig) -> Result<TrainingDevice, TrainError> {
    let mut devices = TrainingDevice::on_card(env, config)?;
    match (devices.pop(), devices.len()) {
        (Some(device), 0) => Ok(device),
        (_, others) => Err(TrainError::Mismatch {
            what: "the number of trainings",
            got: "1".into(),
            expected: format!("{}, one for each group of the card", others + 1),
        }),
    }
}

/// The scaling by the first observations.
fn first_scaling(spec: &EnvSpec, config: &PpoConfig, observation: &[f32]) -> Result<Normalizer, TrainError> {
    let (limit, floor) = (config.observation_clip, config.observation_std_floor);
    let mut normalizer = Normalizer::new(spec.observation_size(), limit, floor);
    let mut moments = Moments::new(spec.observation_size());
    normalizer.measure(observation, &mut moments);
    if let Some(index) = moments.non_finite() {
        let what = format!("observation \"{}\"", spec.observation_names[index]);
        return Err(TrainError::NonFiniteEnv { what, update: 0 });
    }
    normalizer.merge(&moments);
    Ok(normalizer)
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
        assert_eq!(adapted_rate(1e-2, 0.0, &config), 1e-2);
        assert_eq!(adapted_rate(1e-3, 0.1, &PpoConfig { kl_target: 0.0, ..config }), 1e-3);
    }
}
