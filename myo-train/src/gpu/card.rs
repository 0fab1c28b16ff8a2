//! Training on the card: an environment, the policy, and learning, of which the host hears some hundred bytes per update.

use std::time::Instant;

use myo_env::{GpuEnv, VectorEnv};
use myo_gpu::{Commands, GpuError};

use super::buffers::ALL_FINITE;
use super::{DeviceLearner, DeviceRollout, Settings};
use crate::learn::{LearnStats, Optimizer};
use crate::metrics::EpisodeSums;
use crate::normalizer::{Moments, Normalizer};
use crate::{PpoConfig, TrainError};

/// Everything of a training that lives on the card.
pub(crate) struct Card {
    rollout: DeviceRollout,
    learner: DeviceLearner,
    gradient_steps: u64,
    log_std: std::ops::Range<usize>,
    readback: Readback,
    /// The next roll-out.
    next: Option<Commands>,
}

/// What is read after an update.
#[derive(Default)]
struct Readback {
    sums: Vec<f32>,
    wrong: [u32; 1],
    estimates: [f32; 4],
    metrics: Vec<f32>,
    log_std: Vec<f32>,
}

/// What one update tells.
pub(crate) struct CardUpdate {
    /// Means over the gradient steps.
    pub learn: LearnStats,
    /// Seconds until the roll-out was done.
    pub collect_s: f64,
    /// Of all raw observations of the roll-out.
    pub moments: Moments,
    /// Of the episodes that ended.
    pub episodes: EpisodeSums,
    /// Sum of the scaled rewards.
    pub reward_sum: f64,
    /// Of the targets by the values.
    pub explained_variance: f64,
    /// Logarithms of the standard deviations after the update.
    pub log_std: Vec<f32>,
}

impl Card {
    /// Memory and kernels for an environment; the networks have no weights yet. `log_std` is the place of the logarithms
    /// of the standard deviations among the parameters.
    pub fn new(env: GpuEnv, config: &PpoConfig, log_std: std::ops::Range<usize>) -> Result<Self, TrainError> {
        let rollout = DeviceRollout::new(env, config)?;
        let (gpu, sizes) = (rollout.gpu(), rollout.sizes());
        let learner = DeviceLearner::new(gpu, sizes, config, rollout.parameters(), rollout.buffers())?;
        let readback = Readback {
            sums: vec![0.0; rollout.buffers().sums.len()],
            metrics: vec![0.0; learner.metrics_len()],
            log_std: vec![0.0; log_std.len()],
            ..Readback::default()
        };
        Ok(Self { rollout, learner, gradient_steps: 0, log_std, readback, next: None })
    }

    /// The environment.
    pub fn env(&self) -> &GpuEnv {
        self.rollout.env()
    }

    /// The environment.
    pub fn env_mut(&mut self) -> &mut GpuEnv {
        self.rollout.env_mut()
    }

    /// Uploads the observations that the next update begins with, `(envs, observations)`.
    pub fn set_observation(&self, observation: &[f32]) -> Result<(), TrainError> {
        Ok(self.rollout.set_observation(observation)?)
    }

    /// Uploads parameters and Adam's memory.
    pub fn set_weights(&mut self, parameters: &[f32], optimizer: &Optimizer) -> Result<(), TrainError> {
        let (gpu, memory) = (self.rollout.gpu(), self.learner.memory());
        gpu.write(self.rollout.parameters(), 0, parameters)?;
        gpu.write(&memory.mean, 0, &optimizer.mean)?;
        gpu.write(&memory.square, 0, &optimizer.square)?;
        self.gradient_steps = optimizer.steps;
        Ok(())
    }

    /// Reads parameters, Adam's memory and the current raw observations, `(envs, observations)`. After an error, what was
    /// there is left untouched.
    pub fn read_weights(
        &self,
        parameters: &mut Vec<f32>,
        optimizer: &mut Optimizer,
        observation: &mut [f32],
    ) -> Result<(), TrainError> {
        let (memory, sizes) = (self.learner.memory(), self.rollout.sizes());
        let [mut weights, mut mean, mut square] = [(); 3].map(|()| vec![0.0; parameters.len()]);
        let mut columns = vec![0.0; observation.len()];
        self.rollout.gpu().read_many(&mut [
            self.rollout.parameters().part(0, &mut weights)?,
            memory.mean.part(0, &mut mean)?,
            memory.square.part(0, &mut square)?,
            self.env().shards()[0].observation.part(0, &mut columns)?,
        ])?;
        (*parameters, *optimizer) = (weights, Optimizer { mean, square, steps: self.gradient_steps });
        for (row, column) in columns.chunks_exact(sizes.envs).enumerate() {
            let out = observation[row..].iter_mut().step_by(sizes.observations);
            out.zip(column).for_each(|(out, x)| *out = *x);
        }
        Ok(())
    }

    /// Collects a roll-out and learns from it: two submissions, each made ready while the card is busy with the one before.
    pub fn update(
        &mut self,
        normalizer: &Normalizer,
        (seed, update): (u64, u64),
        learning_rate: f64,
    ) -> Result<CardUpdate, TrainError> {
        let (start, sizes) = (Instant::now(), *self.rollout.sizes());
        self.rollout.set_scaling(normalizer)?;
        self.rollout.set_clock(seed, update * sizes.steps as u64)?;
        let collected = self.next.take().map_or_else(|| collecting(&self.rollout), Ok)?.submit()?;

        let settings = Settings { seed, update, learning_rate, gradient_steps: self.gradient_steps };
        self.learner.prepare(&sizes, settings)?;
        let mut batch = self.rollout.gpu().batch();
        self.learner.record(&mut batch);
        let learning = batch.finish()?;
        let (buffers, memory, readback) = (self.rollout.buffers(), self.learner.memory(), &mut self.readback);
        let mut reads = [
            buffers.sums.part(0, &mut readback.sums)?,
            buffers.wrong.part(0, &mut readback.wrong)?,
            memory.estimate_sums.part(0, &mut readback.estimates)?,
            memory.metrics.part(0, &mut readback.metrics)?,
            self.rollout.parameters().part(self.log_std.start, &mut readback.log_std)?,
        ];
        let meanwhile = || {
            let next = collecting(&self.rollout)?;
            collected.wait()?;
            Ok::<_, GpuError>((next, start.elapsed().as_secs_f64()))
        };
        let (next, collect_s) = learning.submit_and_read(&mut reads, meanwhile)??;
        self.next = Some(next);
        self.gradient_steps += self.learner.layout().steps() as u64;
        self.result(normalizer, update, collect_s)
    }

    /// Makes sense of what was read.
    fn result(&self, normalizer: &Normalizer, update: u64, collect_s: f64) -> Result<CardUpdate, TrainError> {
        let (sizes, readback) = (self.rollout.sizes(), &self.readback);
        let (moments, rest) = readback.sums.split_at(2 * sizes.observations);
        let (episodes, rewards) = rest.split_at(sizes.episode_rows());
        let reward_sum: f64 = rewards.iter().map(|&sum| f64::from(sum)).sum();
        let names = &self.env().spec().observation_names;
        check(names, readback.wrong[0], reward_sum, update)?;
        let samples = sizes.steps * sizes.envs;
        Ok(CardUpdate {
            learn: self.learner.stats(&readback.metrics, update)?,
            collect_s,
            moments: normalizer.moments_from_f32(samples, moments),
            episodes: EpisodeSums::from_rows(episodes),
            reward_sum,
            explained_variance: explained_variance(readback.estimates, samples as f64),
            log_std: readback.log_std.clone(),
        })
    }
}

/// A roll-out, ready for the card: what changes from one to the next lies in buffers.
fn collecting(rollout: &DeviceRollout) -> Result<Commands, GpuError> {
    let mut batch = rollout.gpu().batch();
    rollout.record(&mut batch);
    batch.finish()
}

fn check(names: &[String], wrong: u32, reward_sum: f64, update: u64) -> Result<(), TrainError> {
    let non_finite = |what| Err(TrainError::NonFiniteEnv { what, update });
    match wrong {
        ALL_FINITE if reward_sum.is_finite() => Ok(()),
        ALL_FINITE => non_finite("reward".into()),
        index => non_finite(format!("observation \"{}\"", names[index as usize])),
    }
}

/// See [`crate::gae::explained_variance`]; from sums of advantages, which are the errors, of targets, and of their squares.
fn explained_variance(sums: [f32; 4], n: f64) -> f64 {
    let [error, target, error_squares, target_squares] = sums.map(|sum| f64::from(sum) / n);
    1.0 - (error_squares - error * error) / (target_squares - target * target)
}
