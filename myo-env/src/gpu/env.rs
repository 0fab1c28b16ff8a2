//! The vectorised environment on a graphics card, seen from the host.

use super::cells::Cells;
use super::columns::{HostColumns, transpose};
use super::shard::{GpuOptions, Kernels, Shard};
use super::size::{Counts, check_memory, portable_envs, without_memory};
use crate::batch;
use crate::check::{self, Finished};
use crate::config::{BuildError, EnvConfig, check_layouts};
use crate::control::{Judge, Own, Script};
use crate::record::{OBSERVE, RESEED, RESET, RESULT_ROWS};
use crate::rows::fill_rows;
use crate::rules::Rules;
use crate::saved::Header;
use crate::snapshot::Snapshot;
use crate::state::{EnvState, StateRows};
use crate::tables::Tables;
use crate::vector::{EnvError, EnvSpec, StepBuffers, VectorEnv};
use myo_dynamics::Plan;
use myo_gpu::{Gpu, GpuError};
use myo_model::Model;
use myo_tasks::Task;
use std::ops::Range;
use std::sync::Arc;

/// Integers per environment.
const WORDS: usize = EnvState::<f64>::WORDS;

/// Environments on a graphics card.
///
/// The same seed and actions give the same bits on the same card and driver.
///
/// On a device in [groups](Gpu::in_groups) there are as many environments for every group, those of each numbered from zero
/// on. They are worked with through [`GpuEnv::of`]; what is done to all at once is done to every group's in the same way.
pub struct GpuEnv {
    gpu: Gpu,
    kernels: Kernels,
    shards: Vec<Shard>,
    spec: EnvSpec,
    /// Numbers in the state of one environment.
    rows: StateRows,
    tables: Arc<Tables<f64>>,
    finished: Finished,
    scratch: HostColumns,
}

impl GpuEnv {
    /// Compiles the kernels, builds the environments and resets them all. `level` and `threads` of the configuration
    /// do not apply to a card.
    ///
    /// # Errors
    /// The task or model cannot be simulated, is too large for a kernel, or the card refuses.
    pub fn new(gpu: &Gpu, model: &Model, task: &Task, config: &EnvConfig) -> Result<Self, BuildError> {
        Self::with_options(gpu, model, task, config, &GpuOptions::default())
    }

    /// The same with options. No set of buffers holds more environments than every card allows.
    ///
    /// # Errors
    /// As for [`GpuEnv::new`].
    pub fn with_options(
        gpu: &Gpu,
        model: &Model,
        task: &Task,
        config: &EnvConfig,
        options: &GpuOptions,
    ) -> Result<Self, BuildError> {
        Self::with_layouts(gpu, model, std::slice::from_ref(task), config, options)
    }

    /// The same with several layouts, tasks of one structure: environment `env` does the task of number `env` modulo how many
    /// there are.
    ///
    /// # Errors
    /// As for [`GpuEnv::new`]; there is no task, or more than environments, or their structures differ.
    pub fn with_layouts(
        gpu: &Gpu,
        model: &Model,
        tasks: &[Task],
        config: &EnvConfig,
        options: &GpuOptions,
    ) -> Result<Self, BuildError> {
        batch::check_count(config)?;
        check_layouts(tasks.len(), config.num_envs)?;
        let tables = Tables::of_layouts(model, tasks, None, &Plan::specialised)?;
        let spec = batch::spec(model, tasks, &tables, config);
        Self::judged_by(&Script, gpu, tables, spec, (config, options))
    }

    /// The same with rules of one's own, which observe, judge and reward in place of the task's script. They are recorded here and now,
    /// and not asked again.
    ///
    /// # Errors
    /// As for [`GpuEnv::new`]; the rules contradict themselves, environments are to explore, or the task has a technique.
    pub fn with_rules(
        gpu: &Gpu,
        model: &Model,
        task: &Task,
        rules: &impl Rules,
        config: &EnvConfig,
    ) -> Result<Self, BuildError> {
        let (tables, spec) = batch::ruled(model, task, rules, config, &Plan::specialised)?;
        Self::judged_by(&Own(rules.clone()), gpu, tables, spec, (config, &GpuOptions::default()))
    }

    /// Compiles the kernels for a judge.
    fn judged_by(
        judge: &impl Judge,
        gpu: &Gpu,
        tables: Tables<f64>,
        spec: EnvSpec,
        (config, options): (&EnvConfig, &GpuOptions),
    ) -> Result<Self, BuildError> {
        let rows = StateRows::of(&tables);
        let counts = Counts { state: rows.count, task: tables.own_rows() };
        check_memory(gpu, &spec, counts)?;
        let kernels = Kernels::judged_by(judge, gpu, &tables, config.autoreset, options.form)?;
        let per_shard = portable_envs(&spec, counts).min(options.envs_per_shard.max(1));
        Self::start(gpu, kernels, spec, (rows, Arc::new(tables)), per_shard, config.seed)
    }

    /// Other environments of the same model and task, with the same kernels: nothing is compiled again. They start their
    /// episodes again as these do, whatever the configuration says.
    ///
    /// # Errors
    /// No environments, no memory left, or the device lost.
    pub fn sibling(&self, config: &EnvConfig) -> Result<Self, BuildError> {
        let &EnvConfig { num_envs, seed, exploring, .. } = config;
        batch::check_count(config)?;
        check_layouts(self.spec.layouts(), num_envs)?;
        self.tables.rules.as_ref().map_or(Ok(()), |rules| rules.check_config(config))?;
        let spec = EnvSpec { num_envs, exploring: exploring.min(num_envs), ..self.spec.clone() };
        let counts = self.counts();
        check_memory(&self.gpu, &spec, counts)?;
        let per_shard = portable_envs(&spec, counts);
        Self::start(&self.gpu, self.kernels.clone(), spec, (self.rows, self.tables.clone()), per_shard, seed)
    }

    /// The environments of one group: those of a device without groups. Other groups are left alone, and none see each other.
    ///
    /// # Errors
    /// There is no such group, no memory left, or the device lost.
    pub fn of(&self, group: usize) -> Result<Self, GpuError> {
        let Self { kernels, spec, rows, tables, .. } = self;
        Ok(Self {
            gpu: self.gpu.for_groups(&[group])?,
            kernels: kernels.clone(),
            shards: self.shards.iter().map(|shard| shard.of(group)).collect(),
            spec: spec.clone(),
            rows: *rows,
            tables: tables.clone(),
            finished: Finished::new(spec),
            scratch: HostColumns::default(),
        })
    }

    /// Makes the environments, in sets of `per_shard`, and resets them.
    fn start(
        gpu: &Gpu,
        kernels: Kernels,
        spec: EnvSpec,
        (rows, tables): (StateRows, Arc<Tables<f64>>),
        per_shard: usize,
        seed: u64,
    ) -> Result<Self, BuildError> {
        let counts = Counts { state: rows.count, task: tables.own_rows() };
        let shards = (0..spec.num_envs)
            .step_by(per_shard)
            .map(|first| {
                let num_envs = per_shard.min(spec.num_envs - first);
                Shard::new(gpu, &kernels, &spec, rows.count, &tables.columns(first, num_envs), first, num_envs)
            })
            .collect::<Result<Vec<_>, GpuError>>()
            .map_err(|error| without_memory(error, gpu, &spec, counts))?;
        let (gpu, finished) = (gpu.clone(), Finished::new(&spec));
        let scratch = HostColumns::default();
        let mut env = Self { gpu, kernels, shards, spec, rows, tables, finished, scratch };
        let started = env.start_episodes(Some(seed), None);
        started.map_err(|error| without_memory(error, &env.gpu, &env.spec, counts))?;
        Ok(env)
    }

    /// The card.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// The compiled kernels.
    pub fn kernels(&self) -> &Kernels {
        &self.kernels
    }

    /// The environments on the card, in order.
    pub fn shards(&self) -> &[Shard] {
        &self.shards
    }

    /// Resets on the card.
    fn start_episodes(&mut self, seed: Option<u64>, mask: Option<&[bool]>) -> Result<(), GpuError> {
        let asked = if seed.is_some() { RESET | RESEED } else { RESET };
        self.command(asked, seed.unwrap_or_default(), mask)
    }

    /// Puts other numbers of the same structure on the card.
    fn put(&mut self, tables: Tables<f64>) -> Result<(), EnvError> {
        for shard in &self.shards {
            self.gpu.write(&shard.parameters, 0, &tables.columns(shard.first, shard.num_envs))?;
        }
        self.tables = Arc::new(tables);
        Ok(())
    }

    /// Runs the reset kernel, with a command for the masked environments; the others only observe anew.
    fn command(&mut self, asked: u32, seed: u64, mask: Option<&[bool]>) -> Result<(), GpuError> {
        let mut batch = self.gpu.batch();
        for shard in &self.shards {
            let envs = shard.first..shard.first + shard.num_envs;
            let command: Vec<u32> = match mask {
                None => vec![asked; shard.num_envs],
                Some(mask) => mask[envs].iter().map(|&reset| if reset { asked } else { OBSERVE }).collect(),
            };
            self.gpu.write(&shard.command, 0, &command)?;
            self.gpu.write(&shard.seed, 0, &[seed as u32, (seed >> 32) as u32])?;
            shard.reset(&mut batch);
        }
        batch.submit()
    }
}

impl VectorEnv for GpuEnv {
    fn spec(&self) -> &EnvSpec {
        &self.spec
    }

    fn reset(&mut self, seed: Option<u64>, mask: Option<&[bool]>, observation: &mut [f32]) -> Result<(), EnvError> {
        check::reset(&self.spec, mask, observation)?;
        self.start_episodes(seed, mask)?;
        self.finished.reset(mask);
        let nobs = self.spec.observation_size();
        for shard in &self.shards {
            let n = shard.num_envs;
            let columns = &mut self.scratch.observation;
            columns.resize(nobs * n, 0.0);
            self.gpu.read(&shard.observation, 0, columns)?;
            fill_rows(columns, n, |_| true, &mut observation[shard.first * nobs..][..n * nobs]);
        }
        Ok(())
    }

    fn step(&mut self, actions: &[f32], mut out: StepBuffers<'_>) -> Result<(), EnvError> {
        check::step(&self.spec, actions, &out)?;
        self.finished.check()?;
        let nact = self.spec.action_size();
        for shard in &self.shards {
            let n = shard.num_envs;
            let columns = &mut self.scratch.actions;
            columns.resize(nact * n, 0.0);
            transpose(&actions[shard.first * nact..][..n * nact], n, nact, columns);
            self.gpu.write(&shard.actions, 0, columns)?;
        }
        for shard in &self.shards {
            run(&self.gpu, &self.spec, shard, &mut self.scratch, &mut out)?;
        }
        self.finished.note(out.terminated, out.truncated);
        Ok(())
    }

    fn set_tasks(&mut self, tasks: &[Task]) -> Result<(), EnvError> {
        check_layouts(tasks.len(), self.spec.num_envs).map_err(EnvError::other_task)?;
        let mut tables = (*self.tables).clone();
        tables.set_tasks(tasks).map_err(EnvError::other_task)?;
        self.put(tables)?;
        self.spec.max_episode_steps = batch::longest_episode(tasks);
        self.spec.layout_limits = batch::layout_limits(tasks);
        Ok(self.command(OBSERVE, 0, None)?)
    }

    fn set_cost_share(&mut self, share: f64) -> Result<(), EnvError> {
        let mut tables = (*self.tables).clone();
        tables.set_cost_share(check::share(share)?);
        self.put(tables)
    }

    fn peek(&self, envs: Range<usize>) -> Result<Vec<Snapshot>, EnvError> {
        check::range(&self.spec, &envs)?;
        let mut seen = Vec::with_capacity(envs.len());
        for shard in &self.shards {
            let from = |env: usize| env.clamp(shard.first, shard.first + shard.num_envs) - shard.first;
            let cells = Cells::read(&self.gpu, shard, self.rows.count, from(envs.start)..from(envs.end))?;
            seen.extend(cells.snapshots(&self.tables));
        }
        Ok(seen)
    }

    fn save_state(&self) -> Result<Vec<u8>, EnvError> {
        let (n, count) = (self.spec.num_envs, self.rows.count);
        let (mut numbers, mut words) = (vec![0.0; n * count], vec![0; n * WORDS]);
        for shard in &self.shards {
            let (first, size) = (shard.first, shard.num_envs);
            self.gpu.read_many(&mut [
                shard.numbers.part(0, &mut numbers[first * count..][..size * count])?,
                shard.words.part(0, &mut words[first * WORDS..][..size * WORDS])?,
            ])?;
        }
        let number = |env, k| f64::from(numbers[self.index(env, k, count)]);
        Ok(self.header().save(number, |env, k| words[self.index(env, k, WORDS)]))
    }

    fn load_state(&mut self, state: &[u8]) -> Result<(), EnvError> {
        let saved = check::state(state, &self.header())?;
        let finished = self.finished.of(&saved, self.rows.pending, &self.spec)?;
        let (n, count) = (self.spec.num_envs, self.rows.count);
        let (mut numbers, mut words) = (vec![0.0; n * count], vec![0; n * WORDS]);
        for env in 0..n {
            (0..count).for_each(|k| numbers[self.index(env, k, count)] = saved.number(env, k) as f32);
            (0..WORDS).for_each(|k| words[self.index(env, k, WORDS)] = saved.word(env, k));
        }
        for shard in &self.shards {
            let (first, size) = (shard.first, shard.num_envs);
            self.gpu.write(&shard.numbers, 0, &numbers[first * count..][..size * count])?;
            self.gpu.write(&shard.words, 0, &words[first * WORDS..][..size * WORDS])?;
        }
        self.finished = finished;
        Ok(self.command(OBSERVE, 0, None)?)
    }
}

impl GpuEnv {
    fn counts(&self) -> Counts {
        Counts { state: self.rows.count, task: self.tables.own_rows() }
    }

    /// Header of its states.
    fn header(&self) -> Header {
        Header::of::<f32>(self.spec.num_envs, self.rows.count, &self.tables.identity)
    }

    /// Index of entry `k` of an environment among the entries of all shards, `count` per environment.
    fn index(&self, env: usize, k: usize, count: usize) -> usize {
        let per_shard = self.shards[0].num_envs;
        let shard = &self.shards[env / per_shard];
        shard.first * count + k * shard.num_envs + (env - shard.first)
    }
}

/// Steps a shard and copies its results out.
fn run(
    gpu: &Gpu,
    spec: &EnvSpec,
    shard: &Shard,
    scratch: &mut HostColumns,
    out: &mut StepBuffers<'_>,
) -> Result<(), GpuError> {
    let (n, first) = (shard.num_envs, shard.first);
    let (nobs, nepisode) = (spec.observation_size(), spec.episode_size());
    scratch.observation.resize(nobs * n, 0.0);
    scratch.result.resize(RESULT_ROWS * n, 0.0);
    let mut batch = gpu.batch();
    shard.step(&mut batch);
    batch.submit_and_read(&mut [
        shard.observation.part(0, &mut scratch.observation)?,
        shard.result.part(0, &mut scratch.result)?,
    ])?;
    fill_rows(&scratch.observation, n, |_| true, &mut out.observation[first * nobs..][..n * nobs]);
    out.reward[first..first + n].copy_from_slice(&scratch.result[..n]);
    let flag = |row: usize, env: usize| scratch.result[row * n + env] > 0.5;
    for env in 0..n {
        out.terminated[first + env] = flag(1, env);
        out.truncated[first + env] = flag(2, env);
    }
    let ended = |env: usize| flag(1, env) || flag(2, env);
    if !(0..n).any(ended) {
        return Ok(());
    }
    scratch.final_observation.resize(nobs * n, 0.0);
    scratch.episode.resize(nepisode * n, 0.0);
    gpu.read_many(&mut [
        shard.final_observation.part(0, &mut scratch.final_observation)?,
        shard.result.part(RESULT_ROWS * n, &mut scratch.episode)?,
    ])?;
    fill_rows(&scratch.final_observation, n, ended, &mut out.final_observation[first * nobs..][..n * nobs]);
    fill_rows(&scratch.episode, n, ended, &mut out.episode[first * nepisode..][..n * nepisode]);
    Ok(())
}
