//! Environments that Python's object and programs of XLA both step: locked, counted, and told when they are gone.

use std::hash::{BuildHasher, RandomState};
use std::ops::Range;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, TryLockError};
use std::time::Instant;

use myo::env::{EnvError, EnvSpec, Snapshot, StepBuffers, StepStorage, VectorEnv, reseed};
use myo::tasks::Task;
use pyo3::prelude::*;
use rayon::ThreadPool;

use crate::error::{BusyError, ClosedError};
use crate::process::Birthplace;

/// What Python's object and programs of XLA both step.
pub struct Batch {
    live: Mutex<Option<Live>>,
    born: Birthplace,
    /// Sizes and names.
    pub spec: EnvSpec,
}

/// Names one state of one batch: a random number of the batch, so that states of others are refused, and the number of its
/// resets and steps.
pub type Token = [i32; 2];

/// Environments that are open.
pub struct Live {
    env: Box<dyn VectorEnv>,
    pool: Arc<ThreadPool>,
    /// Of the present state.
    token: Token,
    /// Last observations of episodes that ended in the last step, `(num_envs, observation_size)`.
    pub final_observation: Vec<f32>,
    /// Their summaries, `(num_envs, episode_size)`.
    pub episode: Vec<f32>,
}

/// Where a step writes what it shows of all environments.
pub struct Shown<'a> {
    /// `(num_envs, observation_size)`.
    pub observation: &'a mut [f32],
    /// `(num_envs,)`.
    pub reward: &'a mut [f32],
    /// `(num_envs,)`.
    pub terminated: &'a mut [bool],
    /// `(num_envs,)`.
    pub truncated: &'a mut [bool],
}

impl Batch {
    /// Environments that this process made.
    pub fn new(env: Box<dyn VectorEnv>, pool: Arc<ThreadPool>) -> Self {
        let spec = env.spec().clone();
        let live = Live {
            final_observation: vec![0.0; spec.num_envs * spec.observation_size()],
            episode: vec![0.0; spec.num_envs * spec.episode_size()],
            env,
            pool,
            token: [RandomState::new().hash_one(0) as i32, 0],
        };
        Self { live: Mutex::new(Some(live)), born: Birthplace::here(), spec }
    }

    /// Frees the environments, after a step that is going on; in a forked child, there is nothing to free.
    pub fn close(&self) {
        if self.born.is_here() {
            drop(self.live.lock().unwrap_or_else(PoisonError::into_inner).take());
        }
    }

    /// Locks the environments, unless they are closed, busy, or of another process.
    pub fn open(&self) -> PyResult<Opened<'_>> {
        self.born.check("the environment")?;
        let guard = match self.live.try_lock() {
            Ok(guard) => guard,
            Err(TryLockError::Poisoned(poisoned)) => poisoned.into_inner(),
            Err(TryLockError::WouldBlock) => {
                return Err(BusyError::new_err("another thread is using this environment; give each thread its own"));
            }
        };
        if guard.is_none() {
            return Err(ClosedError::new_err("the environment is closed; make a new one"));
        }
        Ok(Opened(guard))
    }
}

/// Open environments, locked.
pub struct Opened<'a>(MutexGuard<'a, Option<Live>>);

impl Opened<'_> {
    /// The environments.
    pub fn live(&mut self) -> &mut Live {
        self.0.as_mut().expect("looked at when it was opened")
    }
}

impl Drop for Batch {
    fn drop(&mut self) {
        // In a forked child the threads are not there to be stopped.
        if !self.born.is_here() {
            std::mem::forget(self.live.get_mut().ok().and_then(Option::take));
        }
    }
}

impl Live {
    /// Names the present state.
    pub fn token(&self) -> Token {
        self.token
    }

    /// Refuses any state but the present one.
    pub fn check_token(&self, [batch, number]: Token) -> Result<(), String> {
        let [own, present] = self.token;
        if batch != own {
            return Err("this state is of other environments than these".into());
        }
        if number != present {
            return Err(format!(
                "this state is number {number}, the environments are at {present}: a state can be stepped once, and not \
                 after a reset"
            ));
        }
        Ok(())
    }

    /// Makes older states old.
    fn change(&mut self) {
        self.token[1] = self.token[1].checked_add(1).unwrap_or(0);
    }

    /// One control step of actions `(num_envs, action_size)`.
    pub fn step(&mut self, actions: &[f32], shown: Shown<'_>) -> Result<(), EnvError> {
        let Self { env, pool, final_observation, episode, .. } = self;
        let Shown { observation, reward, terminated, truncated } = shown;
        let out = StepBuffers { observation, reward, terminated, truncated, final_observation, episode };
        pool.install(|| env.step(actions, out))?;
        self.change();
        Ok(())
    }

    /// Starts episodes where `mask` says so, else everywhere; `seed` restarts the streams of the batch, `seeds` each one.
    pub fn reset(
        &mut self,
        seed: Option<u64>,
        seeds: Option<&[u64]>,
        mask: Option<&[bool]>,
        observation: &mut [f32],
    ) -> Result<(), EnvError> {
        let pool = Arc::clone(&self.pool);
        pool.install(|| {
            seeds.map_or(Ok(()), |seeds| self.reseed(seeds, mask))?;
            self.env.reset(seed, mask, observation)
        })?;
        self.change();
        Ok(())
    }

    /// Starts the streams of masked environments from seeds of their own.
    fn reseed(&mut self, seeds: &[u64], mask: Option<&[bool]>) -> Result<(), EnvError> {
        let mut state = self.env.save_state()?;
        let masked = |env: &usize| mask.is_none_or(|mask| mask[*env]);
        reseed(&mut state, (0..seeds.len()).filter(masked).map(|env| (env, seeds[env])))?;
        self.env.load_state(&state)
    }

    /// Seconds that each of so many steps takes.
    pub fn time_steps(&mut self, actions: &[f32], steps: usize) -> Result<Vec<f64>, EnvError> {
        let mut out = StepStorage::new(self.env.spec());
        let Self { env, pool, .. } = self;
        let step = |_| {
            let start = Instant::now();
            pool.install(|| env.step(actions, out.buffers())).map(|()| start.elapsed().as_secs_f64())
        };
        let times = (0..steps).map(step).collect();
        self.change();
        times
    }

    /// Goes on with another task of the same structure.
    pub fn set_task(&mut self, task: &Task) -> Result<(), EnvError> {
        let Self { env, pool, .. } = self;
        pool.install(|| env.set_task(task))?;
        self.change();
        Ok(())
    }

    /// Some environments as they are now.
    pub fn peek(&self, envs: Range<usize>) -> Result<Vec<Snapshot>, EnvError> {
        self.env.peek(envs)
    }

    /// Everything that the next steps depend on.
    pub fn save_state(&self) -> Result<Vec<u8>, EnvError> {
        self.env.save_state()
    }

    /// Goes back to what `save_state` returned.
    pub fn load_state(&mut self, state: &[u8]) -> Result<(), EnvError> {
        self.env.load_state(state)?;
        self.change();
        Ok(())
    }
}
