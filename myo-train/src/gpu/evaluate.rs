//! How well a policy does on fresh episodes, on the card.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use myo_env::gpu::Shard;
use myo_env::gpu::record::RESULT_ROWS;
use myo_env::{GpuEnv, VectorEnv};
use myo_gpu::{Batch, Buffer, Gpu, GpuError, Recipe};
use myo_tasks::Task;

use super::ahead;
use super::dense::{Columns, DenseKernels, Dispatch, GROUP, Kind, Sampling};
use super::kernels::{self, OBSERVE_WORKGROUP, prepare};
use super::network::{Activations, NetworkBuffers, Pass, chunk};
use super::rollout::check_shards;
use super::together::{Together, Work};
use crate::evaluate::{Evaluation, Tally, check};
use crate::{Mlp, Policy, TrainError, Trainer};

/// Control steps between two looks at what ended.
const STEPS: usize = 16;

/// Runs mean actions in an environment on the card; prepared once for policies of one kind, used again and again.
pub struct DeviceEvaluator {
    group: usize,
    env: GpuEnv,
    parameters: Buffer<f32>,
    scaling: Buffer<f32>,
    observe: Dispatch,
    pass: Pass,
    /// What some steps returned, summaries included, `(steps, rows, envs)`; see [`Shard::result`].
    results: Buffer<f32>,
    layout: Layout,
    shared: Arc<Shared>,
}

/// What the evaluators of several groups share.
struct Shared {
    together: Arc<Together>,
    looks: Vec<Mutex<Look>>,
    /// The device for the groups that looked last.
    device: Mutex<Option<(Vec<usize>, Gpu)>>,
}

/// What is read after some steps of one group.
struct Look {
    source: Buffer<f32>,
    results: Vec<f32>,
    outcome: Result<(), GpuError>,
}

impl Shared {
    fn look(&self, group: usize) -> MutexGuard<'_, Look> {
        self.looks[group].lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn mismatch(trainings: usize, groups: usize) -> TrainError {
    let what = "the number of trainings whose policies are evaluated";
    TrainError::Mismatch { what, got: trainings.to_string(), expected: groups.to_string() }
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
    /// An environment that does not fit the policy, does not start its episodes again, is too large for one set of
    /// buffers or of several groups, no memory left, or the card is lost.
    pub fn new(env: GpuEnv, policy: &Policy) -> Result<Self, TrainError> {
        let mut all = Self::all(env, policy, Arc::new(Together::new(1)))?;
        Ok(all.remove(0))
    }

    /// Evaluators for [several trainings](crate::Trainer::several_on_card), whose policies are evaluated at the same time: one
    /// that evaluates waits until all others do or want to update.
    ///
    /// # Errors
    /// As for [`DeviceEvaluator::new`], but the environment must have a group for each of the trainings.
    pub fn several(env: GpuEnv, trainers: &[Trainer]) -> Result<Vec<Self>, TrainError> {
        let together = trainers.first().and_then(|trainer| Some((trainer, trainer.together()?)));
        let Some((trainer, together)) = together else {
            return Err(mismatch(trainers.len(), env.gpu().groups()));
        };
        Self::all(env, &trainer.policy(), together)
    }

    /// One for every group of the environment, who are as many as the members of `together`.
    fn all(env: GpuEnv, policy: &Policy, together: Arc<Together>) -> Result<Vec<Self>, TrainError> {
        check(policy, env.spec())?;
        check_shards(&env)?;
        if together.len() != env.gpu().groups() {
            return Err(mismatch(together.len(), env.gpu().groups()));
        }
        let (gpu, spec, layout) = (env.gpu().clone(), env.spec().clone(), Layout::of(policy));
        ahead::compile(recipes(&gpu, &layout.networks.policy, spec.num_envs), &gpu);
        let between = Between::new(&gpu, spec.num_envs, spec.observation_size(), spec.action_size())?;
        let parameters = gpu.buffer("parameters", layout.networks.len())?;
        let scaling = gpu.buffer("scaling", 2 * spec.observation_size())?;
        let observe = observe(&gpu, &env.shards()[0], &between, &scaling, layout.limit)?;
        let pass = pass(&gpu, &env.shards()[0], &between, &parameters, &layout)?;
        let results = gpu.buffer("results", STEPS * (RESULT_ROWS + spec.episode_size()) * spec.num_envs)?;
        let look =
            |group| Mutex::new(Look { source: results.of(group), results: vec![0.0; results.len()], outcome: Ok(()) });
        let groups = 0..gpu.groups();
        let shared = Arc::new(Shared { together, looks: groups.clone().map(look).collect(), device: Mutex::new(None) });
        let one = |group| {
            Ok(Self {
                group,
                env: env.of(group)?,
                parameters: parameters.of(group),
                scaling: scaling.of(group),
                observe: observe.clone(),
                pass: pass.clone(),
                results: results.clone(),
                layout: layout.clone(),
                shared: Arc::clone(&shared),
            })
        };
        groups.map(one).collect()
    }

    /// Goes on with another task of the same structure; see [`VectorEnv::set_task`].
    ///
    /// # Errors
    /// A task of another structure or out of bounds, or the card is lost.
    pub fn set_task(&mut self, task: &Task) -> Result<(), TrainError> {
        Ok(self.env.set_task(task)?)
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
        let mut tally = Tally::new(episodes, &spec);
        while !tally.is_full() {
            self.shared.together.meet(self.group, Work::Look, |groups| self.step(groups));
            let look = self.shared.look(self.group);
            look.outcome.clone()?;
            count(&mut tally, spec.num_envs, spec.episode_size(), &look.results);
            drop(look);
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

    /// Takes the steps of these groups, and reads what they returned.
    fn step(&self, groups: &[usize]) {
        // All that they belong to wait.
        let mut looks: Vec<_> = groups.iter().map(|&group| self.shared.look(group)).collect();
        let outcome = self.step_all(groups, &mut looks);
        looks.iter_mut().for_each(|look| look.outcome.clone_from(&outcome));
    }

    fn step_all(&self, groups: &[usize], looks: &mut [MutexGuard<'_, Look>]) -> Result<(), GpuError> {
        let mut device = self.shared.device.lock().unwrap_or_else(PoisonError::into_inner);
        let gpu = match device.take() {
            Some((last, gpu)) if last == groups => gpu,
            _ => self.env.gpu().for_groups(groups)?,
        };
        let mut reads = Vec::new();
        for look in looks {
            let Look { source, results, .. } = &mut **look;
            reads.push(source.part(0, results)?);
        }
        self.batch(&gpu).submit_and_read(&mut reads)?;
        *device = Some((groups.to_vec(), gpu));
        Ok(())
    }

    /// [`STEPS`] control steps, with copies of what they returned.
    fn batch(&self, gpu: &Gpu) -> Batch {
        let (shard, mut batch) = (&self.env.shards()[0], gpu.batch());
        let len = shard.result.len();
        for step in 0..STEPS {
            self.observe.add(&mut batch);
            self.pass.add(&mut batch);
            shard.step(&mut batch);
            batch.copy(&shard.result, 0, &self.results, step * len, len);
        }
        batch
    }
}

/// What the kernels of an evaluation in so many environments are compiled from.
pub(super) fn recipes(gpu: &Gpu, policy: &Mlp, envs: usize) -> Vec<Recipe> {
    let padded = envs.next_multiple_of(GROUP);
    let pass = Pass::recipes(&DenseKernels::new(gpu, None), policy, padded, chunk(&[policy], padded), Kind::Act);
    [vec![kernels::observe()], pass].concat()
}

/// Counts the episodes that ended in some steps.
fn count(tally: &mut Tally, envs: usize, width: usize, results: &[f32]) {
    for result in results.chunks_exact((RESULT_ROWS + width) * envs) {
        let (flags, summaries) = result.split_at(RESULT_ROWS * envs);
        for env in 0..envs {
            if flags[envs + env] > 0.5 || flags[2 * envs + env] > 0.5 {
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
    let (kernel, features) = (gpu.kernel(&kernels::observe())?, scaling.len() / 2);
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
    prepare(gpu, &kernel, &buffers, &shape, features * chunks * OBSERVE_WORKGROUP)
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
        held: None,
    };
    let x = Columns { buffer: &between.observation, stride: padded, first: 0 };
    let y = Columns { buffer: &between.action, stride: padded, first: 0 };
    Pass::new(&mut DenseKernels::new(gpu, None), buffers, x, y, padded, Some(sampling))
}
