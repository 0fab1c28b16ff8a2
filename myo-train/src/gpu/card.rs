//! Training on the card: an environment, the policy, and learning, of which the host hears some hundred bytes per update.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use myo_env::{GpuEnv, VectorEnv};
use myo_gpu::{Buffer, Commands, Gpu, GpuError, Read};

use super::buffers::ALL_FINITE;
use super::together::{Together, Work};
use super::{DeviceLearner, DeviceRollout, LearnMemory, RolloutBuffers, Settings, ahead};
use crate::learn::{LearnStats, Optimizer};
use crate::metrics::EpisodeSums;
use crate::normalizer::{Moments, Normalizer};
use crate::{PpoConfig, TrainError};

/// Everything of a training that lives on the card.
///
/// Trainings of several [groups](Gpu::in_groups) learn in the same batches: an update begins when all of them want one, so each
/// belongs into a thread of its own. One that is dropped leaves the others.
pub(crate) struct Card {
    group: usize,
    rollout: DeviceRollout,
    memory: LearnMemory,
    gradient_steps: u64,
    shared: Arc<Shared>,
}

/// What the trainings on one device share.
struct Shared {
    together: Arc<Together>,
    lessons: Vec<Mutex<Lesson>>,
    next: Mutex<Option<Next>>,
}

/// One training's part of an update.
struct Lesson {
    learner: DeviceLearner,
    record: RolloutBuffers,
    parameters: Buffer<f32>,
    log_std: usize,
    settings: Settings,
    readback: Readback,
    /// Seconds until the roll-out was done, or why there was none.
    collect_s: Result<f64, GpuError>,
}

/// The next roll-out of these groups, and the device for them.
struct Next {
    groups: Vec<usize>,
    gpu: Gpu,
    collecting: Option<Commands>,
}

/// What is read after an update.
#[derive(Clone, Default)]
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
    /// Of the whole episodes that ended, of environments that act with noise.
    pub episodes: EpisodeSums,
    /// Of those that act without.
    pub noise_free: EpisodeSums,
    /// As `episodes`, of each layout; empty where there is one.
    pub layouts: Vec<EpisodeSums>,
    /// Sum of the scaled rewards.
    pub reward_sum: f64,
    /// Of the targets by the values.
    pub explained_variance: f64,
    /// Logarithms of the standard deviations after the update.
    pub log_std: Vec<f32>,
}

impl Card {
    /// Memory and kernels for an environment, a training for every group of its device; the networks have no weights yet.
    /// `log_std` is the place of the logarithms of the standard deviations among the parameters.
    pub fn all(env: GpuEnv, config: &PpoConfig, log_std: std::ops::Range<usize>) -> Result<Vec<Self>, TrainError> {
        ahead::compile(ahead::training(env.gpu(), env.spec(), config), env.gpu());
        let rollout = DeviceRollout::new(env, config)?;
        let (gpu, sizes) = (rollout.gpu(), rollout.sizes());
        let learner = DeviceLearner::new(gpu, sizes, config, rollout.parameters(), rollout.buffers())?;
        let readback = Readback {
            sums: vec![0.0; rollout.buffers().sums.len()],
            metrics: vec![0.0; learner.metrics_len()],
            log_std: vec![0.0; log_std.len()],
            ..Readback::default()
        };
        let settings = Settings { seed: 0, update: 0, learning_rate: 0.0, gradient_steps: 0 };
        let rollouts = (0..gpu.groups()).map(|group| rollout.of(group)).collect::<Result<Vec<_>, _>>()?;
        let lesson = |(group, rollout): (usize, &DeviceRollout)| Lesson {
            learner: learner.of(group),
            record: rollout.buffers().clone(),
            parameters: rollout.parameters().clone(),
            log_std: log_std.start,
            settings,
            readback: readback.clone(),
            collect_s: Ok(0.0),
        };
        let lessons: Vec<_> = rollouts.iter().enumerate().map(lesson).collect();
        let memories: Vec<_> = lessons.iter().map(|lesson| lesson.learner.memory().clone()).collect();
        let together = Arc::new(Together::new(lessons.len()));
        let lessons = lessons.into_iter().map(Mutex::new).collect();
        let shared = Arc::new(Shared { together, lessons, next: Mutex::new(None) });
        let card = |(group, (rollout, memory))| {
            let shared = Arc::clone(&shared);
            Self { group, rollout, memory, gradient_steps: 0, shared }
        };
        Ok(rollouts.into_iter().zip(memories).enumerate().map(card).collect())
    }

    /// Those who learn on the device.
    pub fn together(&self) -> &Arc<Together> {
        &self.shared.together
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
        let (gpu, memory) = (self.rollout.gpu(), &self.memory);
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
        let (memory, sizes) = (&self.memory, self.rollout.sizes());
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

    /// Reads parameters alone: a hundredth of all. After an error, what was there is left untouched.
    pub fn read_parameters(&self, parameters: &mut Vec<f32>) -> Result<(), TrainError> {
        let mut weights = vec![0.0; parameters.len()];
        self.rollout.gpu().read_many(&mut [self.rollout.parameters().part(0, &mut weights)?])?;
        *parameters = weights;
        Ok(())
    }

    /// Collects a roll-out and learns from it, as soon as all trainings on the device want to.
    pub fn update(
        &mut self,
        normalizer: &Normalizer,
        (seed, update): (u64, u64),
        learning_rate: f64,
    ) -> Result<CardUpdate, TrainError> {
        self.rollout.set_scaling(normalizer)?;
        self.rollout.set_clock(seed, update * self.rollout.sizes().steps as u64)?;
        let settings = Settings { seed, update, learning_rate, gradient_steps: self.gradient_steps };
        self.shared.lesson(self.group).settings = settings;
        self.shared.together.meet(self.group, Work::Update, |groups| self.teach(groups));
        let lesson = self.shared.lesson(self.group);
        self.gradient_steps += lesson.learner.layout().steps() as u64;
        self.result(normalizer, &lesson)
    }

    /// An update of several trainings.
    fn teach(&self, groups: &[usize]) {
        // All that they belong to wait.
        let mut lessons: Vec<_> = groups.iter().map(|&group| self.shared.lesson(group)).collect();
        let collect_s = self.update_all(groups, &mut lessons);
        lessons.iter_mut().for_each(|lesson| lesson.collect_s.clone_from(&collect_s));
    }

    /// Two submissions, each made ready while the card is busy with the one before. Returns the seconds until the first, the
    /// roll-out, was done.
    fn update_all(&self, groups: &[usize], lessons: &mut [MutexGuard<'_, Lesson>]) -> Result<f64, GpuError> {
        let start = Instant::now();
        let mut next = self.shared.next.lock().unwrap_or_else(PoisonError::into_inner);
        let Next { gpu, collecting, .. } = match next.take() {
            Some(next) if next.groups == groups => next,
            _ => Next { gpu: self.rollout.gpu().for_groups(groups)?, groups: groups.to_vec(), collecting: None },
        };
        let collected = collecting.map_or_else(|| self.collecting(&gpu), Ok)?.submit()?;

        let sizes = self.rollout.sizes();
        for lesson in lessons.iter_mut() {
            let Lesson { learner, settings, .. } = &mut **lesson;
            learner.prepare(sizes, *settings)?;
        }
        let mut batch = gpu.batch();
        lessons.iter().take(1).for_each(|lesson| lesson.learner.record(&mut batch));
        let learning = batch.finish()?;
        let mut reads = Vec::new();
        for lesson in lessons {
            reads.extend(lesson.reads()?);
        }
        let meanwhile = || {
            let collecting = self.collecting(&gpu)?;
            collected.wait()?;
            Ok::<_, GpuError>((collecting, start.elapsed().as_secs_f64()))
        };
        let (collecting, collect_s) = learning.submit_and_read(&mut reads, meanwhile)??;
        *next = Some(Next { groups: groups.to_vec(), gpu: gpu.clone(), collecting: Some(collecting) });
        Ok(collect_s)
    }

    /// A roll-out, ready for the card: what changes from one to the next lies in buffers.
    fn collecting(&self, gpu: &Gpu) -> Result<Commands, GpuError> {
        let mut batch = gpu.batch();
        self.rollout.record(&mut batch);
        batch.finish()
    }

    /// Makes sense of what was read.
    fn result(&self, normalizer: &Normalizer, lesson: &Lesson) -> Result<CardUpdate, TrainError> {
        let Lesson { learner, settings, readback, collect_s, .. } = lesson;
        let (sizes, update, collect_s) = (self.rollout.sizes(), settings.update, collect_s.clone()?);
        let [moments, episodes, noise_free, rewards, layouts] = sizes.split_sums(&readback.sums);
        let reward_sum: f64 = rewards.iter().map(|&sum| f64::from(sum)).sum();
        let names = &self.env().spec().observation_names;
        check(names, readback.wrong[0], reward_sum, update)?;
        let samples = sizes.steps * sizes.envs;
        Ok(CardUpdate {
            learn: learner.stats(&readback.metrics, update)?,
            collect_s,
            moments: normalizer.moments_from_f32(samples, moments),
            episodes: EpisodeSums::from_rows(episodes),
            noise_free: EpisodeSums::from_rows(noise_free),
            layouts: layouts.chunks_exact(sizes.episode_rows()).map(EpisodeSums::from_rows).collect(),
            reward_sum,
            explained_variance: explained_variance(readback.estimates, samples as f64),
            log_std: readback.log_std.clone(),
        })
    }
}

impl Drop for Card {
    fn drop(&mut self) {
        self.shared.together.leave(self.group);
    }
}

impl Shared {
    fn lesson(&self, group: usize) -> MutexGuard<'_, Lesson> {
        self.lessons[group].lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Lesson {
    /// What to read after it.
    fn reads(&mut self) -> Result<[Read<'_>; 5], GpuError> {
        let Self { learner, record, parameters, log_std, readback, .. } = self;
        let memory = learner.memory();
        Ok([
            record.sums.part(0, &mut readback.sums)?,
            record.wrong.part(0, &mut readback.wrong)?,
            memory.estimate_sums.part(0, &mut readback.estimates)?,
            memory.metrics.part(0, &mut readback.metrics)?,
            parameters.part(*log_std, &mut readback.log_std)?,
        ])
    }
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
