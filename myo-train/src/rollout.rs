//! Collecting experience: the policy acts in all environments for a few steps.

use myo_env::{EnvSpec, StepStorage, VectorEnv};
use rayon::prelude::*;

use crate::gaussian;
use crate::metrics::EpisodeSums;
use crate::networks::{CHUNK_ROWS, ChunkWork, Lender, Networks, noise_width};
use crate::normalizer::{Moments, Normalizer};
use crate::random::{Stream, fill_held, fill_normal};
use crate::{PpoConfig, TrainError};

/// The samples of one update; first axis time, second environment.
pub struct Rollout {
    /// Normalised observations, `(steps + 1, envs, observations)`; the last block follows the last action.
    pub observation: Vec<f32>,
    /// Outputs of the policy, `(steps, envs, actions)`, before they are mapped and clipped for the environment.
    pub action: Vec<f32>,
    /// Logarithms of their probability densities, `(steps, envs)`.
    pub log_prob: Vec<f32>,
    /// Scaled rewards, `(steps, envs)`.
    pub reward: Vec<f32>,
    /// Whether the episode ended with the step, `(steps, envs)`.
    pub ended: Vec<bool>,
    /// Values of the observations, `(steps + 1, envs)`.
    pub value: Vec<f32>,
    /// What the future was worth after the step, `(steps, envs)`; see [`crate::gae::advantages`].
    pub next_value: Vec<f32>,
    /// Advantages, `(steps, envs)`.
    pub advantage: Vec<f32>,
    /// Targets of the value network, `(steps, envs)`.
    pub target: Vec<f32>,
    /// Samples whose episode the time limit cut off, and their last observations, normalised.
    truncated: Vec<u32>,
    truncated_observation: Vec<f32>,
    truncated_value: Vec<f32>,
    /// An entry of a last observation that was not finite.
    bad_last: Option<usize>,
    /// Control steps.
    steps: usize,
    /// Draws that the noise of an action is the sum of.
    noise_steps: usize,
    /// Discount per control step, and decay of the advantage.
    decay: (f32, f32),
    /// Samples with which the task ended.
    terminated: Vec<u32>,
    env_action: Vec<f32>,
    step: StepStorage,
    /// One for each chunk of environments.
    chunk_moments: Vec<Moments>,
    /// Of all raw observations of the roll-out.
    pub moments: Moments,
    /// Of the whole episodes that ended, of environments that act with noise.
    pub episodes: EpisodeSums,
    /// Of those that act without.
    pub noise_free: EpisodeSums,
    /// As `episodes`, of each layout; empty where there is one.
    pub layouts: Vec<EpisodeSums>,
}

/// What the policy needs to act.
pub struct Actor<'a> {
    /// Networks.
    pub networks: &'a Networks,
    /// Their parameters.
    pub parameters: &'a [f32],
    /// Scaling of observations.
    pub normalizer: &'a Normalizer,
    /// Memory.
    pub lender: &'a Lender<ChunkWork>,
    /// Settings.
    pub config: &'a PpoConfig,
    /// Seed of the noise.
    pub seed: u64,
}

impl Rollout {
    /// Memory for [`PpoConfig::steps_per_update`] steps.
    pub fn new(spec: &EnvSpec, config: &PpoConfig) -> Self {
        let (steps, envs) = (config.steps_per_update(spec.control_dt), spec.num_envs);
        let (observations, actions) = (spec.observation_size(), spec.action_size());
        let samples = steps * envs;
        Self {
            observation: vec![0.0; (samples + envs) * observations],
            action: vec![0.0; samples * actions],
            log_prob: vec![0.0; samples],
            reward: vec![0.0; samples],
            ended: vec![false; samples],
            value: vec![0.0; samples + envs],
            next_value: vec![0.0; samples],
            advantage: vec![0.0; samples],
            target: vec![0.0; samples],
            truncated: Vec::with_capacity(samples),
            truncated_observation: Vec::new(),
            truncated_value: Vec::new(),
            bad_last: None,
            steps,
            noise_steps: config.exploration_steps(spec.control_dt),
            decay: (config.gamma(spec.control_dt) as f32, config.gae_lambda(spec.control_dt) as f32),
            terminated: Vec::with_capacity(samples),
            env_action: vec![0.0; envs * actions],
            step: StepStorage::new(spec),
            chunk_moments: vec![Moments::new(observations); envs.div_ceil(CHUNK_ROWS)],
            moments: Moments::new(observations),
            episodes: EpisodeSums::new(spec.episode_size()),
            noise_free: EpisodeSums::new(spec.episode_size()),
            layouts: vec![EpisodeSums::new(spec.episode_size()); told_layouts(spec)],
        }
    }

    /// Acts for [`PpoConfig::steps_per_update`] steps from `observation`, the current raw observations, and leaves the next
    /// ones there. `first_step` counts the control steps of one environment before. False if `go_on`, asked before every
    /// step, ended it early: the samples are of no use then.
    pub fn collect(
        &mut self,
        env: &mut dyn VectorEnv,
        actor: &Actor<'_>,
        first_step: u64,
        observation: &mut [f32],
        go_on: &dyn Fn() -> bool,
    ) -> Result<bool, TrainError> {
        let envs = env.spec().num_envs;
        self.truncated.clear();
        self.truncated_observation.clear();
        self.terminated.clear();
        self.moments.clear();
        self.episodes.clear();
        self.noise_free.clear();
        self.layouts.iter_mut().for_each(EpisodeSums::clear);
        self.bad_last = None;
        for t in 0..self.steps {
            if !go_on() {
                return Ok(false);
            }
            self.act(actor, t, first_step + t as u64, observation);
            env.step(&self.env_action, self.step.buffers())?;
            observation.copy_from_slice(&self.step.observation);
            self.record(actor, t * envs, env.spec());
        }
        let width = observation.len() / envs;
        let last = self.reward.len() * width;
        actor.normalizer.apply(observation, &mut self.observation[last..]);
        self.check(env.spec(), observation, first_step / self.steps as u64)?;
        Ok(true)
    }

    /// Normalises observations, samples actions. Chunks of environments in parallel.
    fn act(&mut self, actor: &Actor<'_>, t: usize, step: u64, observation: &[f32]) {
        let (n_obs, n_act) = (actor.networks.policy.inputs(), actor.networks.policy.outputs());
        let envs = observation.len() / n_obs;
        let spread = actor.networks.spread(actor.parameters);
        let parameters = &actor.parameters[actor.networks.policy_range()];
        let mapping = (actor.config.action_offset as f32, actor.config.action_scale as f32);
        let (noise_width, noise_free) = (noise_width(n_act), actor.config.noise_free_envs());
        let noise_steps = self.noise_steps;
        let at = t * envs;
        (observation.par_chunks(CHUNK_ROWS * n_obs))
            .zip(self.observation[at * n_obs..][..envs * n_obs].par_chunks_mut(CHUNK_ROWS * n_obs))
            .zip(self.action[at * n_act..][..envs * n_act].par_chunks_mut(CHUNK_ROWS * n_act))
            .zip(self.log_prob[at..][..envs].par_chunks_mut(CHUNK_ROWS))
            .zip(self.env_action.par_chunks_mut(CHUNK_ROWS * n_act))
            .zip(self.chunk_moments.par_iter_mut())
            .enumerate()
            .for_each(|(chunk, (((((raw, x), action), log_prob), env_action), moments))| {
                actor.lender.with(
                    || actor.networks.work(),
                    |work| {
                        moments.clear();
                        actor.normalizer.measure(raw, moments);
                        actor.normalizer.apply(raw, x);
                        let noise = &mut work.noise[..log_prob.len() * noise_width];
                        let first_block = chunk * CHUNK_ROWS * noise_width / 4;
                        let held = &mut work.held[..noise.len()];
                        fill_normal(actor.seed, Stream::Actions, step, first_block as u32, noise);
                        fill_held(actor.seed, (step, noise_steps), first_block as u32, held);
                        let quiet = noise_free.saturating_sub(chunk * CHUNK_ROWS) * noise_width;
                        noise.iter_mut().take(quiet).chain(held.iter_mut().take(quiet)).for_each(|noise| *noise = 0.0);
                        let mean = actor.networks.policy.forward(parameters, x, &mut work.policy);
                        gaussian::sample(
                            mean,
                            noise,
                            held,
                            noise_width,
                            &spread.std,
                            spread.log_peak,
                            mapping,
                            action,
                            env_action,
                            log_prob,
                        );
                    },
                );
            });
        for moments in &self.chunk_moments {
            self.moments.add(moments);
        }
    }

    /// Keeps what one step of the environment returned.
    fn record(&mut self, actor: &Actor<'_>, at: usize, spec: &EnvSpec) {
        let (envs, counted, noise_free) = (spec.num_envs, spec.whole_episodes(), actor.config.noise_free_envs());
        let (step, scale) = (&self.step, actor.config.reward_scale as f32);
        let (n_obs, n_episode) = (step.observation.len() / envs, step.episode.len() / envs);
        for env in 0..envs {
            let i = at + env;
            self.reward[i] = step.reward[env] * scale;
            self.ended[i] = step.terminated[env] || step.truncated[env];
            if !self.ended[i] {
                continue;
            }
            let summary = &step.episode[env * n_episode..][..n_episode];
            match env {
                _ if env < noise_free => self.noise_free.add(summary),
                _ if env < counted => {
                    self.episodes.add(summary);
                    let layout = env.checked_rem(self.layouts.len());
                    layout.into_iter().for_each(|layout| self.layouts[layout].add(summary));
                }
                _ => {}
            }
            if step.terminated[env] {
                self.terminated.push(i as u32);
            } else {
                self.truncated.push(i as u32);
                let start = self.truncated_observation.len();
                self.truncated_observation.resize(start + n_obs, 0.0);
                let last = &step.final_observation[env * n_obs..][..n_obs];
                actor.normalizer.apply(last, &mut self.truncated_observation[start..]);
                // Clipping hides NaN, so look before.
                self.bad_last = self.bad_last.or(last.iter().position(|x| !x.is_finite()));
            }
        }
    }

    fn check(&self, spec: &EnvSpec, observation: &[f32], update: u64) -> Result<(), TrainError> {
        let last = observation.iter().position(|x| !x.is_finite()).map(|i| i % spec.observation_size());
        if let Some(index) = self.moments.non_finite().or(last).or(self.bad_last) {
            let what = format!("observation \"{}\"", spec.observation_names[index]);
            return Err(TrainError::NonFiniteEnv { what, update });
        }
        if self.reward.iter().any(|r| !r.is_finite()) {
            return Err(TrainError::NonFiniteEnv { what: "reward".into(), update });
        }
        Ok(())
    }

    /// Values of all observations, and what the future was worth after every step.
    pub fn evaluate(&mut self, actor: &Actor<'_>) {
        let envs = self.value.len() - self.reward.len();
        evaluate(actor, &self.observation, &mut self.value);
        self.truncated_value.resize(self.truncated.len(), 0.0);
        evaluate(actor, &self.truncated_observation, &mut self.truncated_value);

        self.next_value.copy_from_slice(&self.value[envs..]);
        for &i in &self.terminated {
            self.next_value[i as usize] = 0.0;
        }
        for (&i, &value) in self.truncated.iter().zip(&self.truncated_value) {
            self.next_value[i as usize] = value;
        }
    }

    /// Advantages, within their bounds, and targets, from values and rewards. What is done without noise has no advantage: nothing else was tried.
    pub fn estimate(&mut self, config: &PpoConfig) {
        let envs = self.value.len() - self.reward.len();
        let value = &self.value[..self.reward.len()];
        crate::gae::advantages(
            envs,
            self.decay,
            &self.reward,
            value,
            &self.next_value,
            &self.ended,
            &mut self.advantage,
        );
        crate::gae::bound(&mut self.advantage, config.advantage_max as f32);
        for ((target, advantage), value) in self.target.iter_mut().zip(&self.advantage).zip(value) {
            *target = advantage + value;
        }
        let noise_free = config.noise_free_envs();
        self.advantage.chunks_exact_mut(envs).for_each(|step| step[..noise_free].fill(0.0));
    }
}

/// Layouts whose episodes are told apart: none where there is but one.
pub fn told_layouts(spec: &EnvSpec) -> usize {
    if spec.layouts() > 1 { spec.layouts() } else { 0 }
}

/// Values of normalised observations. Chunks of samples in parallel.
pub fn evaluate(actor: &Actor<'_>, observation: &[f32], value: &mut [f32]) {
    let width = actor.networks.value.inputs();
    let parameters = &actor.parameters[actor.networks.value_range()];
    observation.par_chunks(CHUNK_ROWS * width).zip(value.par_chunks_mut(CHUNK_ROWS)).for_each(|(x, value)| {
        actor.lender.with(
            || actor.networks.work(),
            |work| value.copy_from_slice(actor.networks.value.forward(parameters, x, &mut work.value)),
        );
    });
}
