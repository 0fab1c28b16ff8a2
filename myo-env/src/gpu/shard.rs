//! Environments that lie in one set of buffers.

use super::record::{self, RESET_BUFFERS, RESULT_ROWS, STEP_BUFFERS};
use crate::config::BuildError;
use crate::state::EnvState;
use crate::tables::Tables;
use crate::vector::{Autoreset, EnvSpec};
use myo_gpu::{Access, Batch, Bindings, Buffer, BufferRef, Gpu, GpuError, Kernel, Source};
use myo_scalar::symbolic::print::{ENTRY_POINT, Use};
use myo_scalar::symbolic::{Form, Program};

/// Threads of a workgroup.
const WORKGROUP: u32 = 64;
/// Operations above which tables become loops: the kernel outgrows the instruction cache of graphics cards.
const MAX_STRAIGHT: usize = 10_000;
/// Operations above which a driver takes minutes, whatever the form: Mesa's software driver took 54 s for a body of 1,560 muscles.
const MAX_OPERATIONS: usize = 20_000;

/// Choices that a caller need not make.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GpuOptions {
    /// What becomes of tables; straight code where it is short enough, if not given.
    pub form: Option<Form>,
    /// Greatest number of environments in one set of buffers.
    pub envs_per_shard: usize,
}

impl Default for GpuOptions {
    fn default() -> Self {
        Self { form: None, envs_per_shard: usize::MAX }
    }
}

/// Compiled kernels of one model and task.
#[derive(Clone, Debug)]
pub struct Kernels {
    step: Compiled,
    reset: Compiled,
    form: Form,
}

/// A kernel and the constants that it looks up.
#[derive(Clone, Debug)]
pub(crate) struct Compiled {
    pub kernel: Kernel,
    table: Option<Buffer<f32>>,
}

impl Kernels {
    /// Records and compiles both, side by side.
    ///
    /// # Errors
    /// Kernels too large, refused, or the device lost.
    pub fn new(gpu: &Gpu, tables: &Tables<f64>, autoreset: Autoreset, form: Option<Form>) -> Result<Self, BuildError> {
        let form = form.unwrap_or_else(|| {
            let straight = record::step(tables, autoreset, Form::Straight).operations();
            if straight > MAX_STRAIGHT { Form::Loops } else { Form::Straight }
        });
        let (step, reset) = (record::step(tables, autoreset, form), record::reset_program(tables, form));
        [&step, &reset].into_iter().try_for_each(check_size)?;
        std::thread::scope(|scope| {
            let reset = scope.spawn(|| Compiled::new(gpu, "reset", &reset, &RESET_BUFFERS));
            let step = Compiled::new(gpu, "control step", &step, &STEP_BUFFERS)?;
            let reset = reset.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))?;
            Ok(Self { step, reset, form })
        })
    }

    /// The kernel of a control step.
    pub fn step(&self) -> &Kernel {
        &self.step.kernel
    }

    /// The kernel of a reset.
    pub fn reset(&self) -> &Kernel {
        &self.reset.kernel
    }

    /// Whether the kernels loop over tables.
    pub fn form(&self) -> Form {
        self.form
    }
}

/// Refuses what would take a driver minutes.
fn check_size(program: &Program) -> Result<(), BuildError> {
    let (operations, most) = (program.operations(), MAX_OPERATIONS);
    if operations <= most { Ok(()) } else { Err(BuildError::TooLargeForGpu { operations, most }) }
}

impl Compiled {
    /// Compiles a program for its buffers, its table and the number of environments.
    pub fn new(gpu: &Gpu, label: &str, program: &Program, names: &[&str]) -> Result<Self, BuildError> {
        check_size(program)?;
        let printed = program.to_kernel(names, WORKGROUP);
        let access = |used: &Use| match used {
            Use::Read | Use::Table => Access::Read,
            Use::Write => Access::ReadWrite,
            Use::Environments => Access::Uniform,
        };
        let bindings: Vec<Access> = printed.bindings.iter().map(access).collect();
        let source = Source::Naga(Box::new(printed.module));
        // SAFETY: recorded programs access entry `row * environments + env` of a buffer, with `env` below the number of
        // environments and `row` below the rows that `Shard` makes room for, and entries of their own table; their loops
        // have constant bounds, and they divide no integers.
        let kernel = unsafe { gpu.compile_trusted(label, source, ENTRY_POINT, &bindings)? };
        let table = match &printed.table[..] {
            [] => None,
            constants => {
                let table = gpu.buffer("table", constants.len())?;
                gpu.write(&table, 0, constants)?;
                Some(table)
            }
        };
        Ok(Self { kernel, table })
    }

    /// Binds the program's buffers and the number of environments.
    pub fn bind(&self, buffers: &[BufferRef<'_>], environments: &Buffer<u32>) -> Result<Bindings, GpuError> {
        let table = self.table.as_ref().map(Buffer::binding);
        let all: Vec<BufferRef<'_>> = buffers.iter().copied().chain(table).chain([environments.binding()]).collect();
        self.kernel.bind(&all)
    }
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
        let (state, seen) = ([numbers.binding(), words.binding()], observation.binding());
        let step = [actions.binding(), seen, final_observation.binding(), episode.binding(), result.binding()];
        let step = kernels.step.bind(&[&state[..], &step[..]].concat(), &environments)?;
        let reset = [command.binding(), seen, seed.binding()];
        let reset = kernels.reset.bind(&[&state[..], &reset[..]].concat(), &environments)?;
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
        batch.dispatch(kernels.step(), &self.step, self.num_envs as u32);
    }

    /// Adds a reset, as `command` and `seed` say, to a batch.
    pub fn reset(&self, kernels: &Kernels, batch: &mut Batch) {
        batch.dispatch(kernels.reset(), &self.reset, self.num_envs as u32);
    }
}
