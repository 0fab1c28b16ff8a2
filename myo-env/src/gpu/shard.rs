//! Environments that lie in one set of buffers.

use super::program::{Bound, Compiled, check_size};
use crate::config::BuildError;
use crate::control::{Judge, Script};
use crate::record::{self, RESET_BUFFERS, RESULT_ROWS, STEP_BUFFERS};
use crate::state::{EnvState, env_number};
use crate::tables::Tables;
use crate::vector::{Autoreset, EnvSpec};
use myo_gpu::{Batch, Buffer, Cached, Gpu, GpuError};
use myo_scalar::symbolic::Form;

/// Forms faster than loops over all tables, the fastest first, and the operations up to which they are: longer straight code outgrows the
/// instruction cache of graphics cards, and of longer code with loops over paths alone it is not known what NVIDIA's driver (580) makes
/// (`docs/performance.md`).
const FASTER_THAN_LOOPS: [(Form, usize); 2] = [(Form::Straight, 10_000), (Form::Paths, 30_000)];

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

impl Kernels {
    /// Records and compiles both, side by side.
    ///
    /// # Errors
    /// Kernels too large, refused, or the device lost.
    pub fn new(gpu: &Gpu, tables: &Tables<f64>, autoreset: Autoreset, form: Option<Form>) -> Result<Self, BuildError> {
        Self::judged_by(&Script, gpu, tables, autoreset, form)
    }

    /// The same under a judge.
    pub(super) fn judged_by(
        judge: &impl Judge,
        gpu: &Gpu,
        tables: &Tables<f64>,
        autoreset: Autoreset,
        form: Option<Form>,
    ) -> Result<Self, BuildError> {
        record::check(tables)?;
        let form = form.unwrap_or_else(|| {
            let operations = |form| record::step_by(judge, tables, autoreset, form).operations();
            let fitting = FASTER_THAN_LOOPS.into_iter().find(|&(form, most)| operations(form) <= most);
            fitting.map_or(Form::Loops, |(form, _)| form)
        });
        let (step, reset) = (record::step_by(judge, tables, autoreset, form), record::reset_by(judge, tables, form));
        [&step, &reset].into_iter().try_for_each(check_size)?;
        std::thread::scope(|scope| {
            let reset = scope.spawn(|| Compiled::new(gpu, "reset", &reset, &RESET_BUFFERS));
            let step = Compiled::new(gpu, "control step", &step, &STEP_BUFFERS)?;
            let reset = reset.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))?;
            Ok(Self { step, reset, form })
        })
    }

    /// Whether the kernel of a control step was found on disk or is there now.
    pub fn cached(&self) -> &Cached {
        self.step.cached()
    }

    /// Whether the kernels loop over tables.
    pub fn form(&self) -> Form {
        self.form
    }
}

/// Buffers of some environments. Entry `row` of environment `env` is at `row * num_envs + env`.
#[derive(Clone, Debug)]
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
    /// Reward, terminated (0 or 1), truncated (0 or 1); then the summaries of the episodes that ended last.
    pub result: Buffer<f32>,
    /// Numbers of the task, the same for all environments.
    pub parameters: Buffer<f32>,
    /// What the next reset does, bits of [`record`].
    pub command: Buffer<u32>,
    /// Seed of the next reset, low half first.
    pub seed: Buffer<u32>,
    step: Bound,
    /// The reset that ends a step: nobody asks for anything.
    unasked: Bound,
    reset: Bound,
}

impl Shard {
    /// Buffers for some environments; a reset must follow.
    ///
    /// # Errors
    /// No memory left, buffers too small for the kernels, or the device lost.
    pub(super) fn new(
        gpu: &Gpu,
        kernels: &Kernels,
        spec: &EnvSpec,
        count: usize,
        parameters: &[f32],
        first: usize,
        num_envs: usize,
    ) -> Result<Self, GpuError> {
        // Drivers want at least one entry, also for a model without muscles.
        let buffer = |label, rows: usize| gpu.buffer::<f32>(label, rows.saturating_mul(num_envs).max(1));
        let numbers = buffer("numbers", count)?;
        let words = gpu.buffer("words", EnvState::<f64>::WORDS.saturating_mul(num_envs))?;
        let actions = buffer("actions", spec.action_size())?;
        let observation = buffer("observation", spec.observation_size())?;
        let final_observation = buffer("final_observation", spec.observation_size())?;
        let result = buffer("result", RESULT_ROWS + spec.episode_size())?;
        let table = gpu.buffer("parameters", parameters.len())?;
        gpu.write(&table, 0, parameters)?;
        let (command, seed) = (gpu.buffer("command", num_envs)?, gpu.buffer("seed", 2)?);
        let names: Vec<u32> = (first..first + num_envs).map(|env| env_number(spec, env)).collect();
        gpu.write(&words, EnvState::<f64>::ENV_ROW * num_envs, &names)?;
        let (state, seen) = ([numbers.binding(), words.binding(), table.binding()], observation.binding());
        let step = [actions.binding(), seen, final_observation.binding(), result.binding()];
        let step = kernels.step.bind(gpu, &[&state[..], &step[..]].concat(), num_envs as u32)?;
        let silence = gpu.buffer::<u32>("silence", num_envs)?;
        let [unasked, reset] = [&silence, &command].map(|command| {
            let reset = [command.binding(), seen, seed.binding()];
            kernels.reset.bind(gpu, &[&state[..], &reset[..]].concat(), num_envs as u32)
        });
        let (unasked, reset) = (unasked?, reset?);
        Ok(Self {
            first,
            num_envs,
            numbers,
            words,
            actions,
            observation,
            final_observation,
            result,
            parameters: table,
            command,
            seed,
            step,
            unasked,
            reset,
        })
    }

    /// The part of a group.
    pub(super) fn of(&self, group: usize) -> Self {
        Self {
            numbers: self.numbers.of(group),
            words: self.words.of(group),
            actions: self.actions.of(group),
            observation: self.observation.of(group),
            final_observation: self.final_observation.of(group),
            result: self.result.of(group),
            parameters: self.parameters.of(group),
            command: self.command.of(group),
            seed: self.seed.of(group),
            ..self.clone()
        }
    }

    /// Adds a control step, with the resets that end it, to a batch.
    pub fn step(&self, batch: &mut Batch) {
        self.step.dispatch(batch);
        self.unasked.dispatch(batch);
    }

    /// Adds a reset, as `command` and `seed` say, to a batch.
    pub fn reset(&self, batch: &mut Batch) {
        self.reset.dispatch(batch);
    }
}
