//! The vectorised environment on the CPU: lanes across environments, threads across blocks of lanes.

use crate::check::{self, Finished};
use crate::config::{BuildError, EnvConfig, MOST_THREADS};
use crate::control::episode_names;
use crate::job::{ResetJob, StepJob};
use crate::memory;
use crate::observe;
use crate::precision::Precision;
use crate::saved::Header;
use crate::state::StateRows;
use crate::storage::{Storage, WORDS};
use crate::tables::Tables;
use crate::vector::{EnvError, EnvSpec, StepBuffers, VectorEnv};
use myo_dynamics::SolverCount;
use myo_model::Model;
use myo_scalar::{Level, Real};
use myo_tasks::Task;
use rayon::ThreadPool;
use rayon::prelude::*;

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
}

impl<C: Precision> BatchEnv<C> {
    /// Builds the environments and resets them all.
    ///
    /// # Errors
    /// The task or model cannot be simulated, there is no memory for so many environments, or no such number of threads.
    pub fn new(model: &Model, task: &Task, config: &EnvConfig) -> Result<Self, BuildError> {
        if config.num_envs == 0 {
            return Err(BuildError::NoEnvironments);
        }
        let tables = C::tables(model, task)?;
        let level = config.level.map_or_else(Level::detect, Ok)?;
        let spec = spec(model, task, &tables, config);
        let rows = StateRows::of(&tables);
        memory::check(config.num_envs, rows.count * size_of::<C>() + 4 * WORDS + spec.bytes_per_env())?;
        let storage = Storage::new(C::lanes(level), &spec, rows.count)?;
        let finished = Finished::new(&spec);
        let pool = config.threads.map(thread_pool).transpose()?;
        let mut env = Self { tables, spec, level, storage, rows, finished, pool };
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

/// Sizes and names.
pub fn spec<C: Real>(model: &Model, task: &Task, tables: &Tables<C>, config: &EnvConfig) -> EnvSpec {
    let dofs: Vec<String> = tables.plan.dofs.iter().map(|dof| dof.name.clone()).collect();
    EnvSpec {
        num_envs: config.num_envs,
        observation_names: observe::names(model, task, &dofs),
        action_names: model.muscles.iter().map(|m| m.name.clone()).collect(),
        episode_names: episode_names(tables.steps()),
        control_dt: task.control_dt_s,
        max_episode_steps: task.time_limit_steps() as usize,
        autoreset: config.autoreset,
        exploring: config.exploring.min(config.num_envs),
    }
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
        run_all(self.pool.as_ref(), jobs, |job| C::run(level, job));
        Ok(())
    }

    fn step(&mut self, actions: &[f32], out: StepBuffers<'_>) -> Result<(), EnvError> {
        check::step(&self.spec, actions, &out)?;
        self.finished.check()?;
        let (nobs, nact, nepisode) = (self.spec.observation_size(), self.spec.action_size(), self.spec.episode_size());
        let per_task = self.envs_per_task();
        let (tables, level, autoreset) = (&self.tables, self.level, self.spec.autoreset);
        let StepBuffers { observation, reward, terminated, truncated, final_observation, episode } = out;
        let mut actions = actions.chunks(per_task * nact.max(1));
        let mut observation = observation.chunks_mut(per_task * nobs.max(1));
        let mut final_observation = final_observation.chunks_mut(per_task * nobs.max(1));
        let mut episode = episode.chunks_mut(per_task * nepisode);
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
        run_all(self.pool.as_ref(), jobs, |job| C::run(level, job));
        self.finished.note(terminated, truncated);
        Ok(())
    }

    fn set_task(&mut self, task: &Task) -> Result<(), EnvError> {
        self.tables.set_task(task).map_err(EnvError::other_task)?;
        self.spec.max_episode_steps = task.time_limit_steps() as usize;
        let n = self.spec.num_envs;
        self.reset(None, Some(&vec![false; n]), &mut vec![0.0; n * self.spec.observation_size()])
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
