//! Roll-outs on the card.

use myo_env::{GpuEnv, VectorEnv};
use myo_gpu::{Batch, Buffer, Gpu, GpuError, Recipe};

use super::buffers::{ALL_FINITE, RolloutBuffers};
use super::dense::{Columns, DenseKernels, Dispatch, Kind, Sampling};
use super::kernels::{self, Kernels, OBSERVE_WORKGROUP};
use super::network::{Activations, NetworkBuffers, Pass, chunk};
use super::sizes::Sizes;
use super::tile::Tile;
use crate::device::check_env;
use crate::networks::Networks;
use crate::normalizer::Normalizer;
use crate::{PpoConfig, TrainError};

/// An environment and a policy on one card, and the record of what they did.
///
/// [`DeviceRollout::record`] adds a whole roll-out to a batch: observations, actions, log-probabilities, values, rewards
/// and ends of episodes stay on the card, in [`DeviceRollout::buffers`].
pub struct DeviceRollout {
    env: GpuEnv,
    sizes: Sizes,
    parameters: Buffer<f32>,
    scaling: Buffer<f32>,
    clock: Buffer<u32>,
    buffers: RolloutBuffers,
    noise: Dispatch,
    steps: Vec<Step>,
    /// Keeps the observations after the last step.
    observe_last: Dispatch,
    value: Pass,
    sums: Vec<Dispatch>,
}

/// One control step: the policy acts, the environment steps, and its outcome is kept.
#[derive(Clone)]
struct Step {
    /// Keeps the observations that the policy sees.
    observe: Dispatch,
    policy: Pass,
    outcome: Dispatch,
}

/// What preparing a roll-out takes.
struct Parts<'a> {
    env: &'a GpuEnv,
    config: &'a PpoConfig,
    sizes: Sizes,
    networks: &'a Networks,
    parameters: &'a Buffer<f32>,
    scaling: &'a Buffer<f32>,
    clock: &'a Buffer<u32>,
    buffers: &'a RolloutBuffers,
    kernels: &'a Kernels,
    activations: &'a Activations,
}

impl DeviceRollout {
    /// Memory and kernels for roll-outs of [`PpoConfig::steps_per_update`] steps.
    ///
    /// # Errors
    /// Settings out of range, an environment that does not start its episodes again or is too large for one set of
    /// buffers, no memory left, or the card is lost.
    pub fn new(env: GpuEnv, config: &PpoConfig) -> Result<Self, TrainError> {
        Self::with_tile(env, config, None)
    }

    /// As [`DeviceRollout::new`], with one tile for all layers rather than the best for each: for measurements.
    ///
    /// # Errors
    /// As for [`DeviceRollout::new`].
    pub fn with_tile(env: GpuEnv, config: &PpoConfig, tile: Option<Tile>) -> Result<Self, TrainError> {
        check_env(&env, config)?;
        check_shards(&env)?;
        let (gpu, sizes) = (env.gpu().clone(), Sizes::new(env.spec(), config));
        let networks = Networks::new(env.spec(), config);
        let parameters = gpu.buffer("parameters", networks.len())?;
        let scaling = gpu.buffer("scaling", 2 * sizes.observations)?;
        let clock = gpu.buffer("clock", 4)?;
        let buffers = RolloutBuffers::new(&gpu, &sizes)?;
        let kernels = Kernels::new(&gpu)?;
        let activations = Activations::new(&gpu, &[&networks.policy, &networks.value], sizes.columns())?;
        let mut dense = DenseKernels::new(&gpu, tile);
        let parts = Parts {
            env: &env,
            config,
            sizes,
            networks: &networks,
            parameters: &parameters,
            scaling: &scaling,
            clock: &clock,
            buffers: &buffers,
            kernels: &kernels,
            activations: &activations,
        };
        let noise = parts.noise()?;
        let steps = (0..sizes.steps).map(|t| parts.step(&mut dense, t)).collect::<Result<_, GpuError>>()?;
        let observe_last = parts.observe(sizes.steps)?;
        let value = parts.value(&mut dense)?;
        let sums = parts.sums()?;
        Ok(Self { env, sizes, parameters, scaling, clock, buffers, noise, steps, observe_last, value, sums })
    }

    /// The roll-outs of one group, where the environment is of several: what is set and read here is that group's. Added to a
    /// batch for other groups as well, they are roll-outs of all of these.
    ///
    /// # Errors
    /// There is no such group, no memory left, or the card is lost.
    pub fn of(&self, group: usize) -> Result<Self, GpuError> {
        Ok(Self {
            env: self.env.of(group)?,
            sizes: self.sizes,
            parameters: self.parameters.of(group),
            scaling: self.scaling.of(group),
            clock: self.clock.of(group),
            buffers: self.buffers.of(group),
            noise: self.noise.clone(),
            steps: self.steps.clone(),
            observe_last: self.observe_last.clone(),
            value: self.value.clone(),
            sums: self.sums.clone(),
        })
    }

    /// The environment.
    pub fn env(&self) -> &GpuEnv {
        &self.env
    }

    /// The environment. Resetting or stepping it between two roll-outs is allowed.
    pub fn env_mut(&mut self) -> &mut GpuEnv {
        &mut self.env
    }

    /// The card.
    pub fn gpu(&self) -> &Gpu {
        self.env.gpu()
    }

    /// How the samples lie in the buffers.
    pub fn sizes(&self) -> &Sizes {
        &self.sizes
    }

    /// What the last roll-out wrote.
    pub fn buffers(&self) -> &RolloutBuffers {
        &self.buffers
    }

    /// Flat parameters of both networks and the spread, in the order of [`Checkpoint`](crate::Checkpoint).
    pub fn parameters(&self) -> &Buffer<f32> {
        &self.parameters
    }

    /// Uploads parameters; they count from the next batch on.
    ///
    /// # Errors
    /// More parameters than there are, or the card is lost.
    pub fn set_parameters(&self, parameters: &[f32]) -> Result<(), GpuError> {
        self.gpu().write(&self.parameters, 0, parameters)
    }

    /// Uploads the scaling of observations.
    ///
    /// # Errors
    /// More features than there are, or the card is lost.
    pub fn set_scaling(&self, normalizer: &Normalizer) -> Result<(), GpuError> {
        let (mean, inverse_std) = normalizer.scaling();
        self.gpu().write(&self.scaling, 0, mean)?;
        self.gpu().write(&self.scaling, mean.len(), inverse_std)
    }

    /// Says which noise the next roll-out draws: that of the control steps from `first_step` on. Also
    /// forgets observations that were not finite.
    ///
    /// # Errors
    /// The card is lost.
    pub fn set_clock(&self, seed: u64, first_step: u64) -> Result<(), GpuError> {
        let words = [seed, first_step].map(|x| [x as u32, (x >> 32) as u32]);
        self.gpu().write(&self.clock, 0, words.as_flattened())?;
        self.gpu().write(&self.buffers.wrong, 0, &[ALL_FINITE])
    }

    /// Uploads the observations that the next roll-out begins with, `(envs, observations)`.
    ///
    /// # Errors
    /// More observations than there are, or the card is lost.
    pub fn set_observation(&self, observation: &[f32]) -> Result<(), GpuError> {
        let width = self.sizes.observations;
        let columns: Vec<f32> =
            (0..width).flat_map(|row| observation.iter().skip(row).step_by(width).copied()).collect();
        self.gpu().write(&self.env.shards()[0].observation, 0, &columns)
    }

    /// Adds a roll-out from the environment's current observations to a batch.
    pub fn record(&self, batch: &mut Batch) {
        self.noise.add(batch);
        for step in &self.steps {
            step.observe.add(batch);
            step.policy.add(batch);
            self.step_env(batch);
            step.outcome.add(batch);
        }
        self.observe_last.add(batch);
        self.record_values(batch);
        self.sums.iter().for_each(|sums| sums.add(batch));
    }

    /// Adds one pass of the policy, that of the first step, alone: for measurements.
    pub fn record_policy(&self, batch: &mut Batch) {
        self.steps.iter().take(1).for_each(|step| step.policy.add(batch));
    }

    /// Adds the values of all observations of the record, alone.
    pub fn record_values(&self, batch: &mut Batch) {
        self.value.add(batch);
    }

    fn step_env(&self, batch: &mut Batch) {
        self.env.shards().iter().for_each(|shard| shard.step(batch));
    }
}

/// What the kernels of roll-outs are compiled from.
pub(super) fn recipes(gpu: &Gpu, sizes: &Sizes, networks: &Networks) -> Vec<Recipe> {
    let Networks { policy, value } = networks;
    let (dense, columns) = (DenseKernels::new(gpu, None), sizes.columns());
    let chunk = chunk(&[policy, value], columns);
    let acting = Pass::recipes(&dense, policy, sizes.padded, chunk, Kind::Sample);
    let judging = Pass::recipes(&dense, value, columns, chunk, Kind::Linear);
    [&kernels::recipes()[..], &acting, &judging].concat()
}

/// Refuses environments in several sets of buffers.
pub(super) fn check_shards(env: &GpuEnv) -> Result<(), TrainError> {
    let [first, _, ..] = env.shards() else { return Ok(()) };
    Err(TrainError::Mismatch {
        what: "the number of environments",
        got: env.spec().num_envs.to_string(),
        expected: format!("at most {}, which fit one set of buffers on the card", first.num_envs),
    })
}

impl Parts<'_> {
    fn shard(&self) -> &myo_env::gpu::Shard {
        &self.env.shards()[0]
    }

    fn noise(&self) -> Result<Dispatch, GpuError> {
        let Sizes { envs, padded, actions, noise_free, noise_steps, .. } = self.sizes;
        let samples = self.sizes.samples();
        let log_std = self.networks.log_std_range().start;
        let shape = [envs, padded, samples, actions, log_std, noise_free, noise_steps].map(|x| x as u32);
        let RolloutBuffers { action, log_prob, held, .. } = self.buffers;
        let (parameters, clock) = (self.parameters.binding(), self.clock.binding());
        let buffers = [parameters, clock, action.binding(), log_prob.binding(), held.binding()];
        self.kernels.prepare(&self.kernels.noise, &buffers, &shape, samples)
    }

    fn step(&self, dense: &mut DenseKernels, t: usize) -> Result<Step, GpuError> {
        Ok(Step { observe: self.observe(t)?, policy: self.policy(dense, t)?, outcome: self.outcome(t)? })
    }

    /// Keeps the observations before step `t`.
    fn observe(&self, t: usize) -> Result<Dispatch, GpuError> {
        let (shard, sizes) = (self.shard(), self.sizes);
        let (stepped, before) = (usize::from(t > 0), t.saturating_sub(1));
        let places = [sizes.envs, sizes.observations, sizes.columns(), t * sizes.padded, sizes.last_column(before)];
        let moments = [stepped, t * sizes.observe_chunks(), sizes.partial_moments()];
        let limit = (self.config.observation_clip as f32).to_bits();
        let shape: Vec<_> = places.into_iter().chain(moments).map(|x| x as u32).chain([limit]).collect();
        let buffers = [
            shard.observation.binding(),
            shard.final_observation.binding(),
            shard.result.binding(),
            self.scaling.binding(),
            self.buffers.observation.binding(),
            self.buffers.moments.binding(),
            self.buffers.wrong.binding(),
        ];
        let threads = sizes.observations * sizes.observe_chunks() * OBSERVE_WORKGROUP;
        self.kernels.prepare(&self.kernels.observe, &buffers, &shape, threads)
    }

    fn policy(&self, dense: &mut DenseKernels, t: usize) -> Result<Pass, GpuError> {
        let (sizes, first) = (self.sizes, t * self.sizes.padded);
        let buffers = NetworkBuffers {
            network: &self.networks.policy,
            parameters: self.parameters,
            first_parameter: self.networks.policy_range().start,
            activations: self.activations,
        };
        let sampling = Sampling {
            env_actions: &self.shard().actions,
            num_envs: sizes.envs,
            first_env: 0,
            log_std: self.networks.log_std_range().start,
            mapping: (self.config.action_offset as f32, self.config.action_scale as f32),
            held: Some(&self.buffers.held),
        };
        let x = Columns { buffer: &self.buffers.observation, stride: sizes.columns(), first };
        let y = Columns { buffer: &self.buffers.action, stride: sizes.samples(), first };
        Pass::new(dense, buffers, x, y, sizes.padded, Some(sampling))
    }

    fn outcome(&self, t: usize) -> Result<Dispatch, GpuError> {
        let (shard, sizes) = (self.shard(), self.sizes);
        let scale = (self.config.reward_scale as f32).to_bits();
        let shape = [sizes.envs as u32, (t * sizes.padded) as u32, sizes.summary as u32, scale];
        let buffers = [
            shard.result.binding(),
            self.buffers.reward.binding(),
            self.buffers.ended.binding(),
            self.buffers.episodes.binding(),
        ];
        self.kernels.prepare(&self.kernels.outcome, &buffers, &shape, sizes.envs * sizes.episode_rows())
    }

    fn value(&self, dense: &mut DenseKernels) -> Result<Pass, GpuError> {
        let buffers = NetworkBuffers {
            network: &self.networks.value,
            parameters: self.parameters,
            first_parameter: self.networks.value_range().start,
            activations: self.activations,
        };
        let columns = self.sizes.columns();
        let x = Columns { buffer: &self.buffers.observation, stride: columns, first: 0 };
        let y = Columns { buffer: &self.buffers.value, stride: columns, first: 0 };
        Pass::new(dense, buffers, x, y, columns, None)
    }

    fn sums(&self) -> Result<Vec<Dispatch>, GpuError> {
        let (sizes, buffers) = (self.sizes, self.buffers);
        let moments = 2 * sizes.observations;
        let counted = sizes.steps * sizes.observe_chunks();
        let (rows, noise_free) = (sizes.episode_rows(), sizes.noise_free);
        let rewards = moments + 2 * rows;
        let all = [
            (&buffers.moments, [moments, counted, sizes.partial_moments(), 0, 0, 1]),
            (&buffers.episodes, [rows, sizes.counted, sizes.envs, moments, noise_free, 1]),
            (&buffers.episodes, [rows, noise_free, sizes.envs, moments + rows, 0, 1]),
            (&buffers.reward, [sizes.steps, sizes.padded, sizes.padded, rewards, 0, 1]),
        ];
        let of_layout = |layout: usize| {
            // The first environment with noise that does this layout.
            let first = noise_free + (layout + sizes.layouts - noise_free % sizes.layouts) % sizes.layouts;
            let place = rewards + sizes.steps + layout * rows;
            (&buffers.episodes, [rows, sizes.counted, sizes.envs, place, first, sizes.layouts])
        };
        let sums = all.into_iter().chain((0..sizes.layouts).map(of_layout));
        sums.map(|(numbers, shape)| {
            let shape = shape.map(|x| x as u32);
            let buffers = [numbers.binding(), buffers.sums.binding()];
            let threads = (shape[0] * self.kernels.sums.workgroup_size()) as usize;
            self.kernels.prepare(&self.kernels.sums, &buffers, &shape, threads)
        })
        .collect()
    }
}
