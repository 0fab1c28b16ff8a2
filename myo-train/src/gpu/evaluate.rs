//! How well a policy does on fresh episodes, on the card.

use myo_env::gpu::Shard;
use myo_env::{GpuEnv, VectorEnv};
use myo_gpu::{Batch, Buffer, Gpu, GpuError};

use super::dense::{Columns, DenseKernels, Dispatch, GROUP, Sampling};
use super::kernels::{Kernels, OBSERVE_WORKGROUP};
use super::network::{Activations, NetworkBuffers, Pass};
use super::rollout::check_shards;
use crate::evaluate::{Evaluation, Tally, check};
use crate::{Policy, TrainError};

/// Control steps between two looks at what ended.
const STEPS: usize = 16;

/// Rows of an environment's result: reward, terminated, truncated.
const RESULT_ROWS: usize = 3;

/// Runs mean actions in an environment on the card; prepared once for policies of one kind, used again and again.
pub struct DeviceEvaluator {
    env: GpuEnv,
    parameters: Buffer<f32>,
    scaling: Buffer<f32>,
    observe: Dispatch,
    pass: Pass,
    /// Results and summaries of some steps, `(steps, rows, envs)`.
    results: Buffer<f32>,
    summaries: Buffer<f32>,
    layout: Layout,
}

/// What policies must have in common.
#[derive(Clone, Debug, PartialEq)]
struct Layout {
    networks: crate::networks::Networks,
    mapping: (f32, f32),
    limit: f32,
}

impl Layout {
    fn of(policy: &Policy) -> Self {
        let limit = policy.normalizer.parts().0;
        Self { networks: policy.networks.clone(), mapping: policy.mapping, limit }
    }
}

/// Buffers between observation and action.
struct Between {
    /// Normalised observations, `(observations, padded)`.
    observation: Buffer<f32>,
    /// Outputs of the policy, `(actions, padded)`.
    action: Buffer<f32>,
    /// Not of interest here.
    moments: Buffer<f32>,
    wrong: Buffer<u32>,
    padded: usize,
}

impl Between {
    fn new(gpu: &Gpu, envs: usize, observations: usize, actions: usize) -> Result<Self, GpuError> {
        let padded = envs.next_multiple_of(GROUP);
        Ok(Self {
            observation: gpu.buffer("observations", observations * padded)?,
            action: gpu.buffer("means", actions * padded)?,
            moments: gpu.buffer("moments", 2 * observations * envs.div_ceil(OBSERVE_WORKGROUP))?,
            wrong: gpu.buffer("wrong", 1)?,
            padded,
        })
    }
}

impl DeviceEvaluator {
    /// Memory and kernels for policies with the sizes, the mapping of actions and the clipping of observations of `policy`.
    ///
    /// # Errors
    /// An environment that does not fit the policy, does not start its episodes again or is too large for one set of
    /// buffers, no memory left, or the card is lost.
    pub fn new(env: GpuEnv, policy: &Policy) -> Result<Self, TrainError> {
        check(policy, env.spec())?;
        check_shards(&env)?;
        let (gpu, spec, layout) = (env.gpu().clone(), env.spec().clone(), Layout::of(policy));
        let between = Between::new(&gpu, spec.num_envs, spec.observation_size(), spec.action_size())?;
        let parameters = gpu.buffer("parameters", layout.networks.len())?;
        let scaling = gpu.buffer("scaling", 2 * spec.observation_size())?;
        let observe = observe(&gpu, &env.shards()[0], &between, &scaling, layout.limit)?;
        let pass = pass(&gpu, &env.shards()[0], &between, &parameters, &layout)?;
        let results = gpu.buffer("results", STEPS * RESULT_ROWS * spec.num_envs)?;
        let summaries = gpu.buffer("summaries", (STEPS * spec.episode_size() * spec.num_envs).max(1))?;
        Ok(Self { env, parameters, scaling, observe, pass, results, summaries, layout })
    }

    /// Evaluates the policies of one group, where the environment is of several.
    ///
    /// # Errors
    /// There is no such group, no memory left, or the card is lost.
    pub fn of(&self, group: usize) -> Result<Self, TrainError> {
        Ok(Self {
            env: self.env.of(group)?,
            parameters: self.parameters.of(group),
            scaling: self.scaling.of(group),
            observe: self.observe.clone(),
            pass: self.pass.clone(),
            results: self.results.of(group),
            summaries: self.summaries.of(group),
            layout: self.layout.clone(),
        })
    }

    /// The environment.
    pub fn env(&self) -> &GpuEnv {
        &self.env
    }

    /// As [`evaluate`](crate::evaluate), in this environment on the card; `progress` hears every 16 control steps.
    ///
    /// # Errors
    /// A policy of another kind than the first, or the card is lost.
    pub fn evaluate(
        &mut self,
        policy: &Policy,
        episodes: usize,
        seed: u64,
        mut progress: impl FnMut(usize) -> bool,
    ) -> Result<Evaluation, TrainError> {
        let spec = self.env.spec().clone();
        check(policy, &spec)?;
        self.check_layout(policy)?;
        self.upload(policy)?;
        let mut observation = vec![0.0; spec.num_envs * spec.observation_size()];
        self.env.reset(Some(seed), None, &mut observation)?;
        let mut tally = Tally::new(episodes, spec.num_envs);
        let mut results = vec![0.0; self.results.len()];
        let mut summaries = vec![0.0; self.summaries.len()];
        while !tally.is_full() {
            self.batch()
                .submit_and_read(&mut [self.results.part(0, &mut results)?, self.summaries.part(0, &mut summaries)?])?;
            count(&mut tally, spec.num_envs, spec.episode_size(), &results, &summaries);
            if !progress(tally.counted) {
                break;
            }
        }
        Ok(tally.evaluation(&spec))
    }

    fn check_layout(&self, policy: &Policy) -> Result<(), TrainError> {
        let (got, expected) = (Layout::of(policy), &self.layout);
        if got == *expected {
            return Ok(());
        }
        let (got, expected) = (format!("{got:?}"), format!("{expected:?}"));
        Err(TrainError::Mismatch { what: "the kind of the policy", got, expected })
    }

    fn upload(&self, policy: &Policy) -> Result<(), GpuError> {
        let (mean, inverse_std) = policy.normalizer.scaling();
        let gpu = self.env.gpu();
        gpu.write(&self.parameters, 0, &policy.parameters)?;
        gpu.write(&self.scaling, 0, mean)?;
        gpu.write(&self.scaling, mean.len(), inverse_std)
    }

    /// [`STEPS`] control steps, with copies of what they returned.
    fn batch(&self) -> Batch {
        let (shard, mut batch) = (&self.env.shards()[0], self.env.gpu().batch());
        let rows = shard.num_envs * self.env.spec().episode_size();
        for step in 0..STEPS {
            self.observe.add(&mut batch);
            self.pass.add(&mut batch);
            shard.step(&mut batch);
            let results = RESULT_ROWS * shard.num_envs;
            batch.copy(&shard.result, 0, &self.results, step * results, results);
            if rows > 0 {
                batch.copy(&shard.episode, 0, &self.summaries, step * rows, rows);
            }
        }
        batch
    }
}

/// Counts the episodes that ended in some steps.
fn count(tally: &mut Tally, envs: usize, width: usize, results: &[f32], summaries: &[f32]) {
    for (step, result) in results.chunks_exact(RESULT_ROWS * envs).enumerate() {
        let summaries = &summaries[step * width * envs..];
        for env in 0..envs {
            if result[envs + env] > 0.5 || result[2 * envs + env] > 0.5 {
                tally.add(env, (0..width).map(|row| summaries[row * envs + env]));
            }
        }
    }
}

/// Normalises the current observations.
fn observe(
    gpu: &Gpu,
    shard: &Shard,
    between: &Between,
    scaling: &Buffer<f32>,
    limit: f32,
) -> Result<Dispatch, GpuError> {
    let (kernels, features) = (Kernels::new(gpu)?, scaling.len() / 2);
    let chunks = shard.num_envs.div_ceil(OBSERVE_WORKGROUP);
    // No step came before, as far as last observations are concerned.
    let shape = [shard.num_envs, features, between.padded, 0, 0, 0, 0, chunks].map(|x| x as u32);
    let shape: Vec<_> = shape.into_iter().chain([limit.to_bits()]).collect();
    let buffers = [
        shard.observation.binding(),
        shard.final_observation.binding(),
        shard.result.binding(),
        scaling.binding(),
        between.observation.binding(),
        between.moments.binding(),
        between.wrong.binding(),
    ];
    kernels.prepare(&kernels.observe, &buffers, &shape, features * chunks * OBSERVE_WORKGROUP)
}

/// From normalised observations to the environment's actions.
fn pass(
    gpu: &Gpu,
    shard: &Shard,
    between: &Between,
    parameters: &Buffer<f32>,
    layout: &Layout,
) -> Result<Pass, GpuError> {
    let (network, padded) = (&layout.networks.policy, between.padded);
    let activations = Activations::new(gpu, &[network], padded)?;
    let first_parameter = layout.networks.policy_range().start;
    let buffers = NetworkBuffers { network, parameters, first_parameter, activations: &activations };
    let sampling = Sampling {
        env_actions: &shard.actions,
        num_envs: shard.num_envs,
        first_env: 0,
        log_std: layout.networks.log_std_range().start,
        mapping: layout.mapping,
        noisy: false,
    };
    let x = Columns { buffer: &between.observation, stride: padded, first: 0 };
    let y = Columns { buffer: &between.action, stride: padded, first: 0 };
    Pass::new(&mut DenseKernels::new(gpu, None), buffers, x, y, padded, Some(sampling))
}
