//! The vectorised environment on the CPU: lanes across environments, threads across blocks of lanes.

use crate::check::{self, Finished};
use crate::config::{BuildError, EnvConfig, MOST_THREADS, check_layouts};
use crate::control::{Judge, Own, Script, episode_names};
use crate::job::{ResetJob, Runner, StepJob};
use crate::memory;
use crate::native::{self, NativeCode, NotCompiled, Routines};
use crate::observe;
use crate::precision::Precision;
use crate::rules::{Outline, RULES_COLUMNS, Rules};
use crate::saved::Header;
use crate::snapshot::Snapshot;
use crate::state::StateRows;
use crate::storage::{Blocks, Storage, WORDS};
use crate::tables::Tables;
use crate::trace::TraceShape;
use crate::vector::{EnvError, EnvSpec, StepBuffers, VectorEnv};
use myo_dynamics::{Plan, SolverCount};
use myo_model::Model;
use myo_scalar::{Level, Real};
use myo_tasks::Task;
use rayon::ThreadPool;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Arc;

/// Environments in single precision, one per SIMD lane: the fast backend.
pub type CpuEnv = BatchEnv<f32>;

/// Environments in double precision, one at a time, with the exact plan: the reference that other backends are compared with.
pub type ReferenceEnv = BatchEnv<f64>;

/// Many copies of one task.
pub struct BatchEnv<C: Precision> {
    tables: Tables<C>,
    spec: EnvSpec,
    level: Level,
    storage: Storage<C>,
    rows: StateRows,
    finished: Finished,
    pool: Option<ThreadPool>,
    judge: Arc<dyn Runner<C>>,
    /// Machine code of control steps, in place of lanes.
    native: Option<NativeCode>,
}

impl<C: Precision> BatchEnv<C> {
    /// Builds the environments and resets them all.
    ///
    /// # Errors
    /// The task or model cannot be simulated, there is no memory for so many environments, or no such number of threads.
    pub fn new(model: &Model, task: &Task, config: &EnvConfig) -> Result<Self, BuildError> {
        Self::with_layouts(model, std::slice::from_ref(task), config)
    }

    /// The same with several layouts, tasks of one structure: environment `env` does the task of number `env` modulo how many
    /// there are.
    ///
    /// # Errors
    /// As for [`new`](Self::new); there is no task, or more than environments, or their structures differ.
    pub fn with_layouts(model: &Model, tasks: &[Task], config: &EnvConfig) -> Result<Self, BuildError> {
        check_count(config)?;
        check_layouts(tasks.len(), config.num_envs)?;
        let tables = Tables::of_layouts(model, tasks, None, &C::plan)?;
        let spec = spec(model, tasks, &tables, config);
        let recorded = || Tables::of_layouts(model, tasks, None, &Plan::specialised);
        let routines = compiled::<C>(&Script, recorded, config)?;
        Self::start(tables, spec, C::script(), routines, config)
    }

    /// The same with rules of one's own, which observe, judge and reward in place of the task's script.
    ///
    /// # Errors
    /// As for [`new`](Self::new); the rules contradict themselves, environments are to explore, or the task has a technique.
    pub fn with_rules(model: &Model, task: &Task, rules: &impl Rules, config: &EnvConfig) -> Result<Self, BuildError> {
        let (tables, spec) = ruled(model, task, rules, config, &C::plan)?;
        let recorded = || Ok(ruled(model, task, rules, config, &Plan::specialised)?.0);
        let judge = Own(rules.clone());
        let routines = compiled::<C>(&judge, recorded, config)?;
        Self::start(tables, spec, Arc::new(judge), routines, config)
    }

    /// Other environments of the same model, task and rules; nothing is compiled again. They start their episodes again as these do,
    /// whatever the configuration says.
    ///
    /// # Errors
    /// No environments, no memory left, no such number of threads, or fewer environments than layouts.
    pub fn sibling(&self, config: &EnvConfig) -> Result<Self, BuildError> {
        check_count(config)?;
        check_layouts(self.spec.layouts(), config.num_envs)?;
        self.tables.rules.as_ref().map_or(Ok(()), |rules| rules.check_config(config))?;
        let &EnvConfig { num_envs, exploring, .. } = config;
        let spec = EnvSpec { num_envs, exploring: exploring.min(num_envs), ..self.spec.clone() };
        let routines = self.native.as_ref().map(NativeCode::routines);
        Self::start(self.tables.clone(), spec, self.judge.clone(), routines, config)
    }

    /// Makes the environments and resets them.
    fn start(
        tables: Tables<C>,
        spec: EnvSpec,
        judge: Arc<dyn Runner<C>>,
        routines: Option<Arc<Routines>>,
        config: &EnvConfig,
    ) -> Result<Self, BuildError> {
        let level = config.level.map_or_else(Level::detect, Ok)?;
        let rows = StateRows::of(&tables);
        memory::check(config.num_envs, rows.count * size_of::<C>() + 4 * WORDS + spec.bytes_per_env())?;
        let storage = Storage::new(C::lanes(level), &spec, rows.count)?;
        let finished = Finished::new(&spec);
        let pool = config.threads.map(thread_pool).transpose()?;
        let native = routines.map(|routines| NativeCode::new(routines, &tables, &spec));
        let mut env = Self { tables, spec, level, storage, rows, finished, pool, judge, native };
        let mut observation = memory::zeros(config.num_envs, config.num_envs * env.spec.observation_size())?;
        env.reset(Some(config.seed), None, &mut observation).expect("the buffers were made to fit");
        Ok(env)
    }

    /// The compiled model and task.
    pub fn tables(&self) -> &Tables<C> {
        &self.tables
    }

    /// The instruction-set level in use.
    pub fn level(&self) -> Level {
        self.level
    }

    /// What the constraint solver did in each environment since it was built; resets and loaded states do not change it.
    pub fn solver_counts(&self) -> &[SolverCount] {
        &self.storage.solver
    }

    /// Sizes of what [`step_traced`](Self::step_traced) writes.
    pub fn trace_shape(&self) -> TraceShape {
        TraceShape::new(&self.tables.plan, self.tables.substeps, self.tables.timestep)
    }

    /// A [`step`](VectorEnv::step) that writes every physics step into `trace`, `(num_envs, samples, columns)` as
    /// [`trace_shape`](Self::trace_shape) says. Where an episode ends, the last of them is its last.
    ///
    /// # Errors
    /// As for [`step`](VectorEnv::step), or `trace` has another length.
    pub fn step_traced(&mut self, actions: &[f32], out: StepBuffers<'_>, trace: &mut [f32]) -> Result<(), EnvError> {
        check::trace(&self.spec, &self.trace_shape(), trace)?;
        self.run_step(actions, out, Some(trace))
    }

    fn run_step(&mut self, actions: &[f32], out: StepBuffers<'_>, trace: Option<&mut [f32]>) -> Result<(), EnvError> {
        check::step(&self.spec, actions, &out)?;
        self.finished.check()?;
        let (nobs, nact, nepisode) = (self.spec.observation_size(), self.spec.action_size(), self.spec.episode_size());
        let (per_task, traced) = (self.envs_per_task(), self.trace_shape().len_per_env());
        let (tables, level, autoreset) = (&self.tables, self.level, self.spec.autoreset);
        // Lanes alone write down what happens within a control step.
        let native = self.native.as_ref().filter(|_| trace.is_none());
        let StepBuffers { observation, reward, terminated, truncated, final_observation, episode } = out;
        let mut actions = actions.chunks(per_task * nact.max(1));
        let mut observation = observation.chunks_mut(per_task * nobs.max(1));
        let mut final_observation = final_observation.chunks_mut(per_task * nobs.max(1));
        let mut episode = episode.chunks_mut(per_task * nepisode);
        let mut trace = trace.map(|trace| trace.chunks_mut(per_task * traced));
        let rows = reward.chunks_mut(per_task).zip(terminated.chunks_mut(per_task)).zip(truncated.chunks_mut(per_task));
        let jobs: Vec<StepJob<'_, C>> = self
            .storage
            .split(per_task)
            .zip(rows)
            .map(|(storage, ((reward, terminated), truncated))| StepJob {
                tables,
                storage,
                autoreset,
                actions: actions.next().unwrap_or(&[]),
                trace: trace.as_mut().and_then(Iterator::next),
                out: StepBuffers {
                    observation: observation.next().unwrap_or(&mut []),
                    reward,
                    terminated,
                    truncated,
                    final_observation: final_observation.next().unwrap_or(&mut []),
                    episode: episode.next().unwrap_or(&mut []),
                },
            })
            .collect();
        run_all(self.pool.as_ref(), jobs, |job| match native {
            Some(native) => step_natively(native, job),
            None => self.judge.step(level, job),
        });
        self.finished.note(terminated, truncated);
        Ok(())
    }

    /// Whether control steps are machine code, see [`EnvConfig::native`].
    pub fn is_native(&self) -> bool {
        self.native.is_some()
    }

    /// Hands the numbers of the task to machine code.
    fn take_parameters(&mut self) {
        if let Some(native) = &mut self.native {
            native.take_parameters(&self.tables, &self.spec);
        }
    }

    /// Header of its states.
    fn header(&self) -> Header {
        Header::of::<C>(self.spec.num_envs, self.rows.count, &self.tables.identity)
    }

    /// Blocks per task: enough tasks to balance the threads, few enough to allocate scratch memory rarely.
    fn envs_per_task(&self) -> usize {
        let threads = self.pool.as_ref().map_or_else(rayon::current_num_threads, ThreadPool::current_num_threads);
        self.storage.nblock().div_ceil(4 * threads).max(1) * self.storage.lanes
    }
}

fn step_natively<C: Precision>(native: &NativeCode, mut job: StepJob<'_, C>) {
    native.step(narrow(job.storage), job.actions, &mut job.out);
}

/// States as machine code takes them.
fn narrow<C: Precision>(storage: Blocks<'_, C>) -> Blocks<'_, f32> {
    let Blocks { first, count, numbers, words, solver } = storage;
    let numbers = C::narrow(numbers).expect("machine code is made for single precision alone");
    Blocks { first, count, numbers, words, solver }
}

/// Machine code of control steps under a judge, if it is wanted and there can be any.
fn compiled<C: Precision>(
    judge: &impl Judge,
    tables: impl FnOnce() -> Result<Tables<f64>, BuildError>,
    config: &EnvConfig,
) -> Result<Option<Arc<Routines>>, BuildError> {
    native::if_wanted(config, || {
        let level = config.level.map_or_else(Level::detect, Ok)?;
        if C::narrow(&mut []).is_none() {
            return Ok(Err(NotCompiled::Double));
        }
        Ok(native::compile(judge, &tables()?, config.autoreset, level))
    })
}

/// Tables, sizes and names of environments with rules of one's own, if these do not contradict themselves.
pub fn ruled<C: Real>(
    model: &Model,
    task: &Task,
    rules: &impl Rules,
    config: &EnvConfig,
    plan: &dyn Fn(&Plan<f64>) -> Plan<C>,
) -> Result<(Tables<C>, EnvSpec), BuildError> {
    check_count(config)?;
    let (outline, tasks) = (Outline::of(rules), std::slice::from_ref(task));
    outline.check_config(config)?;
    let tables = Tables::of_layouts(model, tasks, Some(outline.clone()), plan)?;
    outline.check_count(rules, &tables)?;
    let spec = spec(model, tasks, &tables, config);
    outline.check_names(&spec)?;
    Ok((tables, spec))
}

impl EnvSpec {
    /// Sizes and names of environments for layouts, tasks of one structure, which need not be there.
    ///
    /// # Errors
    /// There are no such environments on any backend.
    pub fn of_layouts(model: &Model, tasks: &[Task], config: &EnvConfig) -> Result<Self, BuildError> {
        check_count(config)?;
        check_layouts(tasks.len(), config.num_envs)?;
        Ok(spec(model, tasks, &Tables::<f64>::with_layouts(model, tasks)?, config))
    }
}

/// Sizes and names.
pub fn spec<C: Real>(model: &Model, tasks: &[Task], tables: &Tables<C>, config: &EnvConfig) -> EnvSpec {
    let dofs: Vec<String> = tables.plan.dofs.iter().map(|dof| dof.name.clone()).collect();
    let mut names = observe::names(model, &tables.observation, &dofs, &tables.parameters.task.fingers);
    names.extend(tables.rules.iter().flat_map(|rules| rules.observed.iter().cloned()));
    EnvSpec {
        num_envs: config.num_envs,
        observation_names: names,
        action_names: model.muscles.iter().map(|m| m.name.clone()).collect(),
        episode_names: episode_columns(tables),
        control_dt: tasks.first().map_or(f64::NAN, |task| task.control_dt_s),
        max_episode_steps: longest_episode(tasks),
        layout_limits: layout_limits(tasks),
        autoreset: config.autoreset,
        exploring: config.exploring.min(config.num_envs),
    }
}

/// Names of the columns of an episode summary.
fn episode_columns<C: Real>(tables: &Tables<C>) -> Vec<String> {
    match &tables.rules {
        None => episode_names(tables.steps()),
        Some(_) => RULES_COLUMNS.iter().map(|column| column.name.to_owned()).collect(),
    }
}

/// Refuses an empty batch.
pub fn check_count(config: &EnvConfig) -> Result<(), BuildError> {
    if config.num_envs == 0 { Err(BuildError::NoEnvironments) } else { Ok(()) }
}

/// Control steps of the longest time limit.
pub fn longest_episode(tasks: &[Task]) -> usize {
    layout_limits(tasks).into_iter().max().unwrap_or(0)
}

/// Control steps of the time limit of each.
pub fn layout_limits(tasks: &[Task]) -> Vec<usize> {
    tasks.iter().map(|task| task.time_limit_steps() as usize).collect()
}

fn thread_pool(threads: usize) -> Result<ThreadPool, BuildError> {
    if !(1..=MOST_THREADS).contains(&threads) {
        return Err(BuildError::BadThreads { threads });
    }
    let built = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    built.map_err(|error| BuildError::Threads { threads, reason: error.to_string() })
}

/// Runs jobs on a pool, or on the caller's.
fn run_all<J: Send>(pool: Option<&ThreadPool>, jobs: Vec<J>, run: impl Fn(J) + Sync + Send) {
    match pool {
        Some(pool) => pool.install(|| jobs.into_par_iter().for_each(run)),
        None => jobs.into_par_iter().for_each(run),
    }
}

impl<C: Precision> VectorEnv for BatchEnv<C> {
    fn spec(&self) -> &EnvSpec {
        &self.spec
    }

    fn reset(&mut self, seed: Option<u64>, mask: Option<&[bool]>, observation: &mut [f32]) -> Result<(), EnvError> {
        check::reset(&self.spec, mask, observation)?;
        self.finished.reset(mask);
        let nobs = self.spec.observation_size();
        let per_task = self.envs_per_task();
        let (tables, level) = (&self.tables, self.level);
        let jobs: Vec<ResetJob<'_, C>> = self
            .storage
            .split(per_task)
            .zip(observation.chunks_mut(per_task * nobs))
            .map(|(storage, observation)| {
                let mask = mask.map(|mask| &mask[storage.first..storage.first + observation.len() / nobs.max(1)]);
                ResetJob { tables, storage, seed, mask, observation }
            })
            .collect();
        let native = self.native.as_ref();
        run_all(self.pool.as_ref(), jobs, |job| match native {
            Some(native) => native.reset(narrow(job.storage), job.seed, job.mask, job.observation),
            None => self.judge.reset(level, job),
        });
        Ok(())
    }

    fn step(&mut self, actions: &[f32], out: StepBuffers<'_>) -> Result<(), EnvError> {
        self.run_step(actions, out, None)
    }

    fn set_tasks(&mut self, tasks: &[Task]) -> Result<(), EnvError> {
        check_layouts(tasks.len(), self.spec.num_envs).map_err(EnvError::other_task)?;
        self.tables.set_tasks(tasks).map_err(EnvError::other_task)?;
        self.spec.max_episode_steps = longest_episode(tasks);
        self.spec.layout_limits = layout_limits(tasks);
        self.take_parameters();
        let n = self.spec.num_envs;
        self.reset(None, Some(&vec![false; n]), &mut vec![0.0; n * self.spec.observation_size()])
    }

    fn set_cost_share(&mut self, share: f64) -> Result<(), EnvError> {
        self.tables.set_cost_share(check::share(share)?);
        self.take_parameters();
        Ok(())
    }

    fn peek(&self, envs: Range<usize>) -> Result<Vec<Snapshot>, EnvError> {
        check::range(&self.spec, &envs)?;
        let (tables, storage) = (&self.tables, &self.storage);
        Ok(envs.map(|env| Snapshot::of(tables, |k| storage.number(env, k), |k| storage.word(env, k))).collect())
    }

    fn save_state(&self) -> Result<Vec<u8>, EnvError> {
        let storage = &self.storage;
        Ok(self.header().save(|env, k| storage.number(env, k), |env, k| storage.word(env, k)))
    }

    fn load_state(&mut self, state: &[u8]) -> Result<(), EnvError> {
        let saved = check::state(state, &self.header())?;
        self.finished = self.finished.of(&saved, self.rows.pending, &self.spec)?;
        self.storage.take(&saved);
        Ok(())
    }
}
