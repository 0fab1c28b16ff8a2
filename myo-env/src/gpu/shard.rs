//! Environments that lie in one set of buffers.

use super::record::{self, RESET_BUFFERS, RESULT_ROWS, STEP_BUFFERS};
use crate::config::BuildError;
use crate::state::EnvState;
use crate::tables::Tables;
use crate::vector::{Autoreset, EnvSpec};
use myo_gpu::{Access, Batch, Bindings, Buffer, Gpu, GpuError, Kernel, Source};
use myo_scalar::symbolic::Program;
use myo_scalar::symbolic::print::{ENTRY_POINT, Use};

/// Threads of a workgroup.
const WORKGROUP: u32 = 64;
/// Operations above which drivers take minutes.
const MAX_OPERATIONS: usize = 60_000;

/// Compiled kernels of one model and task.
#[derive(Clone, Debug)]
pub struct Kernels {
    /// A control step.
    pub step: Kernel,
    /// A reset.
    pub reset: Kernel,
}

impl Kernels {
    /// Records and compiles both, side by side.
    ///
    /// # Errors
    /// Kernels too large, refused, or the device lost.
    pub fn new(gpu: &Gpu, tables: &Tables<f64>, autoreset: Autoreset) -> Result<Self, BuildError> {
        std::thread::scope(|scope| {
            let reset = scope.spawn(|| compile(gpu, "reset", &record::reset_program(tables), &RESET_BUFFERS));
            let step = compile(gpu, "control step", &record::step(tables, autoreset), &STEP_BUFFERS)?;
            let reset = reset.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))?;
            Ok(Self { step, reset })
        })
    }
}

/// Compiles a program for its buffers and the number of environments.
pub(crate) fn compile(gpu: &Gpu, label: &str, program: &Program, names: &[&str]) -> Result<Kernel, BuildError> {
    let operations = program.operations();
    if operations > MAX_OPERATIONS {
        return Err(BuildError::TooLargeForGpu { operations, most: MAX_OPERATIONS });
    }
    let kernel = program.to_kernel(names, WORKGROUP);
    let access = |used: &Use| match used {
        Use::Read => Access::Read,
        Use::Write => Access::ReadWrite,
        Use::Environments => Access::Uniform,
    };
    let bindings: Vec<Access> = kernel.bindings.iter().map(access).collect();
    // SAFETY: recorded programs access entry `row * environments + env` of a buffer, with `env` below the number of
    // environments and `row` below the rows that `Shard` makes room for; their loops have constant bounds, and they
    // divide no integers.
    Ok(unsafe { gpu.compile_trusted(label, Source::Naga(Box::new(kernel.module)), ENTRY_POINT, &bindings)? })
}

/// Buffers of some environments. Entry `row` of environment `env` is at `row * num_envs + env`.
#[derive(Debug)]
pub struct Shard {
    /// Number of the first environment.
    pub first: usize,
    /// Number of environments.
    pub num_envs: usize,
    /// State of the environments: numbers.
    pub numbers: Buffer<f32>,
    /// State of the environments: integers.
    pub words: Buffer<u32>,
    /// Actions in [-1, 1] for the next step.
    pub actions: Buffer<f32>,
    /// Observations after the last step or reset.
    pub observation: Buffer<f32>,
    /// Last observations of the episodes that ended last.
    pub final_observation: Buffer<f32>,
    /// Summaries of the episodes that ended last.
    pub episode: Buffer<f32>,
    /// Reward, terminated (0 or 1), truncated (0 or 1).
    pub result: Buffer<f32>,
    /// What the next reset does: 1 resets, 2 reseeds.
    pub command: Buffer<u32>,
    /// Seed of the next reset, low half first.
    pub seed: Buffer<u32>,
    step: Bindings,
    reset: Bindings,
}

impl Shard {
    /// Buffers for some environments; a reset must follow.
    ///
    /// # Errors
    /// No memory left, or the device lost.
    pub fn new(
        gpu: &Gpu,
        kernels: &Kernels,
        spec: &EnvSpec,
        count: usize,
        first: usize,
        num_envs: usize,
    ) -> Result<Self, GpuError> {
        // Drivers want at least one entry, also for a model without muscles.
        let buffer = |label, rows: usize| gpu.buffer::<f32>(label, (rows * num_envs).max(1));
        let numbers = buffer("numbers", count)?;
        let words = gpu.buffer("words", EnvState::<f64>::WORDS * num_envs)?;
        let actions = buffer("actions", spec.action_size())?;
        let observation = buffer("observation", spec.observation_size())?;
        let final_observation = buffer("final_observation", spec.observation_size())?;
        let episode = buffer("episode", spec.episode_size())?;
        let result = buffer("result", RESULT_ROWS)?;
        let (command, seed) = (gpu.buffer("command", num_envs)?, gpu.buffer("seed", 2)?);
        let environments = gpu.buffer("environments", 1)?;
        gpu.write(&environments, 0, &[num_envs as u32])?;
        let names: Vec<u32> = (first..first + num_envs).map(|env| env as u32).collect();
        gpu.write(&words, EnvState::<f64>::ENV_ROW * num_envs, &names)?;
        let step = kernels.step.bind(&[
            numbers.binding(),
            words.binding(),
            actions.binding(),
            observation.binding(),
            final_observation.binding(),
            episode.binding(),
            result.binding(),
            environments.binding(),
        ])?;
        let reset = kernels.reset.bind(&[
            numbers.binding(),
            words.binding(),
            command.binding(),
            observation.binding(),
            seed.binding(),
            environments.binding(),
        ])?;
        Ok(Self {
            first,
            num_envs,
            numbers,
            words,
            actions,
            observation,
            final_observation,
            episode,
            result,
            command,
            seed,
            step,
            reset,
        })
    }

    /// Adds a control step to a batch.
    pub fn step(&self, kernels: &Kernels, batch: &mut Batch) {
        batch.dispatch(&kernels.step, &self.step, self.num_envs as u32);
    }

    /// Adds a reset, as `command` and `seed` say, to a batch.
    pub fn reset(&self, kernels: &Kernels, batch: &mut Batch) {
        batch.dispatch(&kernels.reset, &self.reset, self.num_envs as u32);
    }
}
