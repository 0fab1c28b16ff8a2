//! Environments stepped side by side.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError, TryLockError};
use std::time::Instant;

use myo::env::{
    Autoreset, EnvConfig, EnvError, EnvSpec, Snapshot, StepBuffers, StepStorage, Tables, VectorEnv, reseed,
};
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use rayon::ThreadPool;

use crate::error::{self, BusyError, ClosedError, compute};
use crate::model::Model;
use crate::picture::Painter;
use crate::place::Wish;
use crate::process::{Birthplace, own_pool, pool};
use crate::space;
use crate::task::Task;
use crate::xla;

/// Copies of one task. All arrays have the environments as their first axis.
#[pyclass(module = "myoenv._native", frozen)]
pub struct Env {
    shared: Arc<Shared>,
    backend: &'static str,
    device: Option<String>,
    bounds: (Vec<f32>, Vec<f32>),
    /// In double precision, to read saved states with.
    tables: Tables<f64>,
    painter: Painter,
}

/// What Python's object and programs of XLA both step.
pub struct Shared {
    inner: Mutex<Option<Inner>>,
    born: Birthplace,
    /// Sizes and names.
    pub spec: EnvSpec,
}

/// Environments that are open.
pub struct Inner {
    env: Box<dyn VectorEnv>,
    pool: Arc<ThreadPool>,
    /// Number of the present state: every reset and step makes another one of it.
    present: i32,
    /// Last observations of episodes that ended in the last step, `(num_envs, observation_size)`.
    pub final_observation: Vec<f32>,
    /// Their summaries, `(num_envs, episode_size)`.
    pub episode: Vec<f32>,
    /// Arrays that every call writes anew; without them, each call makes its own.
    views: Option<Views>,
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

/// Arrays that are handed out again and again.
struct Views {
    observation: Py<PyArray2<f32>>,
    reward: Py<PyArray1<f32>>,
    terminated: Py<PyArray1<bool>>,
    truncated: Py<PyArray1<bool>>,
}

/// What a step writes.
struct Arrays<'py> {
    observation: Bound<'py, PyArray2<f32>>,
    reward: Bound<'py, PyArray1<f32>>,
    terminated: Bound<'py, PyArray1<bool>>,
    truncated: Bound<'py, PyArray1<bool>>,
}

/// Episodes that ended: their environments, last observations and summaries.
type Ended<'py> = (Bound<'py, PyArray1<i64>>, Bound<'py, PyArray2<f32>>, Bound<'py, PyArray2<f32>>);

/// Observation, reward, terminated, truncated, and the episodes that ended, if any.
type Stepped<'py> = (
    Bound<'py, PyArray2<f32>>,
    Bound<'py, PyArray1<f32>>,
    Bound<'py, PyArray1<bool>>,
    Bound<'py, PyArray1<bool>>,
    Option<Ended<'py>>,
);

impl<'py> Arrays<'py> {
    /// New zeros.
    fn new(py: Python<'py>, spec: &EnvSpec) -> Self {
        let n = spec.num_envs;
        Self {
            observation: PyArray2::zeros(py, [n, spec.observation_size()], false),
            reward: PyArray1::zeros(py, [n], false),
            terminated: PyArray1::zeros(py, [n], false),
            truncated: PyArray1::zeros(py, [n], false),
        }
    }

    fn of(py: Python<'py>, views: &Views) -> Self {
        Self {
            observation: views.observation.bind(py).clone(),
            reward: views.reward.bind(py).clone(),
            terminated: views.terminated.bind(py).clone(),
            truncated: views.truncated.bind(py).clone(),
        }
    }

    fn into_views(self) -> Views {
        Views {
            observation: self.observation.unbind(),
            reward: self.reward.unbind(),
            terminated: self.terminated.unbind(),
            truncated: self.truncated.unbind(),
        }
    }
}

impl Inner {
    fn arrays<'py>(&self, py: Python<'py>) -> Arrays<'py> {
        match &self.views {
            Some(views) => Arrays::of(py, views),
            None => Arrays::new(py, self.env.spec()),
        }
    }

    /// Number of the present state.
    pub fn present(&self) -> i32 {
        self.present
    }

    fn change(&mut self) {
        self.present = self.present.checked_add(1).unwrap_or(0);
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

    fn reset(
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

    /// The episodes that just ended.
    fn ended<'py>(&self, py: Python<'py>, terminated: &[bool], truncated: &[bool]) -> PyResult<Option<Ended<'py>>> {
        let over = |env: &usize| terminated[*env] || truncated[*env];
        let envs: Vec<usize> = (0..terminated.len()).filter(over).collect();
        if envs.is_empty() {
            return Ok(None);
        }
        let rows = |from: &[f32], width: usize| {
            let picked: Vec<f32> = envs.iter().flat_map(|env| &from[env * width..][..width]).copied().collect();
            picked.into_pyarray(py).reshape([envs.len(), width])
        };
        let spec = self.env.spec();
        let observation = rows(&self.final_observation, spec.observation_size())?;
        let episode = rows(&self.episode, spec.episode_size())?;
        let envs: Vec<i64> = envs.iter().map(|&env| env as i64).collect();
        Ok(Some((envs.into_pyarray(py), observation, episode)))
    }
}

impl Shared {
    /// Locks the environments, unless they are closed, busy, or of another process.
    pub fn open(&self) -> PyResult<Opened<'_>> {
        self.born.check("the environment")?;
        let guard = match self.inner.try_lock() {
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

impl Env {
    fn check_env(&self, env: usize) -> PyResult<()> {
        let n = self.shared.spec.num_envs;
        if env < n { Ok(()) } else { Err(PyValueError::new_err(format!("there is no environment {env}, only {n}"))) }
    }
}

/// Open environments, locked.
pub struct Opened<'a>(MutexGuard<'a, Option<Inner>>);

impl Opened<'_> {
    /// The environments.
    pub fn inner(&mut self) -> &mut Inner {
        self.0.as_mut().expect("looked at when it was opened")
    }
}

impl Drop for Shared {
    fn drop(&mut self) {
        // In a forked child the threads are not there to be stopped.
        if !self.born.is_here() {
            std::mem::forget(self.inner.get_mut().ok().and_then(Option::take));
        }
    }
}

#[pymethods]
impl Env {
    #[new]
    #[expect(clippy::too_many_arguments, reason = "named arguments in Python")]
    #[pyo3(signature = (task, model, num_envs, *, seed, autoreset, backend, device, threads, copy))]
    fn new(
        py: Python<'_>,
        task: &Task,
        model: &Model,
        num_envs: usize,
        seed: u64,
        autoreset: &str,
        backend: &str,
        device: Option<String>,
        threads: Option<usize>,
        copy: bool,
    ) -> PyResult<Self> {
        let wish = Wish::new(backend, device)?;
        let config = EnvConfig { num_envs, seed, autoreset: autoreset_mode(autoreset)?, ..EnvConfig::default() };
        let pool = threads.map_or_else(pool, |threads| own_pool(Some(threads)))?;
        let (task, model) = (task.inner(), model.inner());
        let built = compute(py, || pool.install(|| wish.build(model, task, &config)))??;
        let (backend, device) = (built.backend(), built.device());
        let env = built.boxed();
        let spec = env.spec().clone();
        let inner = Inner {
            env,
            pool,
            present: 0,
            final_observation: vec![0.0; num_envs * spec.observation_size()],
            episode: vec![0.0; num_envs * spec.episode_size()],
            views: (!copy).then(|| Arrays::new(py, &spec).into_views()),
        };
        let bounds = space::bounds(model, task, &spec.observation_names);
        Ok(Self {
            shared: Arc::new(Shared { inner: Mutex::new(Some(inner)), born: Birthplace::here(), spec }),
            backend,
            device,
            bounds,
            tables: Tables::new(model, task).map_err(error::build)?,
            painter: Painter::new(model, task).map_err(error::task)?,
        })
    }

    /// Starts episodes where `mask` says so, else everywhere; returns all observations.
    ///
    /// `seed` restarts the random streams of the batch, `seeds` gives each environment its own; without either they continue.
    #[pyo3(signature = (seed, seeds, mask))]
    fn reset<'py>(
        &self,
        py: Python<'py>,
        seed: Option<u64>,
        seeds: Option<Vec<u64>>,
        mask: Option<PyReadonlyArray1<'py, bool>>,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let mut opened = self.shared.open()?;
        let inner = opened.inner();
        let mask = mask.as_ref().map(PyReadonlyArray1::as_slice).transpose()?;
        if seeds.as_ref().is_some_and(|seeds| seeds.len() != self.shared.spec.num_envs) {
            return Err(PyValueError::new_err(format!(
                "there must be one seed for each of {} environments",
                self.shared.spec.num_envs
            )));
        }
        let observation = inner.arrays(py).observation;
        // SAFETY: a new array, or the one that the caller agreed to have overwritten.
        let rows = unsafe { observation.as_slice_mut()? };
        compute(py, || inner.reset(seed, seeds.as_deref(), mask, rows))?.map_err(error::env)?;
        Ok(observation)
    }

    /// One control step. `actions` is `(num_envs, action_size)` in [-1, 1].
    fn step<'py>(&self, py: Python<'py>, actions: PyReadonlyArray2<'py, f32>) -> PyResult<Stepped<'py>> {
        let mut opened = self.shared.open()?;
        let inner = opened.inner();
        let arrays = inner.arrays(py);
        let actions = actions.as_slice()?;
        // SAFETY: new arrays, or those that the caller agreed to have overwritten.
        let (observation, reward, terminated, truncated) = unsafe {
            (
                arrays.observation.as_slice_mut()?,
                arrays.reward.as_slice_mut()?,
                arrays.terminated.as_slice_mut()?,
                arrays.truncated.as_slice_mut()?,
            )
        };
        let shown = Shown { observation, reward, terminated, truncated };
        compute(py, || inner.step(actions, shown))?.map_err(error::env)?;
        let ended = {
            // SAFETY: nobody writes while the environment is locked.
            let flags = unsafe { (arrays.terminated.as_slice()?, arrays.truncated.as_slice()?) };
            inner.ended(py, flags.0, flags.1)?
        };
        Ok((arrays.observation, arrays.reward, arrays.terminated, arrays.truncated, ended))
    }

    /// Seconds that each of so many steps took without Python: what its overhead is measured against.
    fn time_steps<'py>(
        &self,
        py: Python<'py>,
        actions: PyReadonlyArray2<'py, f32>,
        steps: usize,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let mut opened = self.shared.open()?;
        let inner = opened.inner();
        inner.change();
        let Inner { env, pool, .. } = inner;
        let (actions, mut out) = (actions.as_slice()?, StepStorage::new(&self.shared.spec));
        let timed = compute(py, || {
            let step = |_| {
                let start = Instant::now();
                pool.install(|| env.step(actions, out.buffers())).map(|()| start.elapsed().as_secs_f64())
            };
            (0..steps).map(step).collect::<Result<Vec<f64>, _>>()
        })?;
        Ok(timed.map_err(error::env)?.into_pyarray(py))
    }

    /// Everything that the next steps depend on.
    fn save_state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let mut opened = self.shared.open()?;
        let env = &mut opened.inner().env;
        let state = compute(py, move || env.save_state())?.map_err(error::env)?;
        Ok(PyBytes::new(py, &state))
    }

    /// Goes back to what `save_state` returned, bit for bit.
    fn load_state(&self, py: Python<'_>, state: &[u8]) -> PyResult<()> {
        let mut opened = self.shared.open()?;
        let inner = opened.inner();
        compute(py, || inner.env.load_state(state))?.map_err(error::env)?;
        inner.change();
        Ok(())
    }

    /// Pictures of environments, `(height, width, 3)` of bytes each.
    fn render<'py>(
        &self,
        py: Python<'py>,
        envs: Vec<usize>,
        size: (usize, usize),
    ) -> PyResult<Vec<Bound<'py, PyArray3<u8>>>> {
        let mut opened = self.shared.open()?;
        let env = &mut opened.inner().env;
        envs.iter().try_for_each(|&env| self.check_env(env))?;
        let (width, height) = size;
        if !(16..=4096).contains(&width) || !(16..=4096).contains(&height) {
            return Err(PyValueError::new_err(format!(
                "a picture of {width} x {height} is asked for; sizes are 16 to 4096"
            )));
        }
        let pictures = compute(py, move || {
            let state = env.save_state()?;
            let paint =
                |&env: &usize| Ok(self.painter.paint(&Snapshot::read(&self.tables, &state, env)?, width, height));
            envs.iter().map(paint).collect::<Result<Vec<_>, EnvError>>()
        })?
        .map_err(error::env)?;
        pictures.into_iter().map(|picture| picture.into_pyarray(py).reshape([height, width, 3])).collect()
    }

    /// Frees the environments, after a step that is going on; a second time does nothing.
    fn close(&self, py: Python<'_>) {
        if self.shared.born.is_here() {
            let inner = py.detach(|| self.shared.inner.lock().unwrap_or_else(PoisonError::into_inner).take());
            drop(inner);
        }
    }

    /// A number by which programs of XLA know these environments.
    fn xla_id(&self) -> i64 {
        xla::id_of(&self.shared)
    }

    /// Number of the present state: every reset and step makes another one of it.
    #[getter]
    fn present(&self) -> PyResult<i32> {
        Ok(self.shared.open()?.inner().present)
    }

    #[getter]
    fn num_envs(&self) -> usize {
        self.shared.spec.num_envs
    }

    #[getter]
    fn observation_names(&self) -> Vec<String> {
        self.shared.spec.observation_names.clone()
    }

    #[getter]
    fn action_names(&self) -> Vec<String> {
        self.shared.spec.action_names.clone()
    }

    #[getter]
    fn episode_names(&self) -> Vec<String> {
        self.shared.spec.episode_names.clone()
    }

    #[getter]
    fn control_dt(&self) -> f64 {
        self.shared.spec.control_dt
    }

    #[getter]
    fn max_episode_steps(&self) -> usize {
        self.shared.spec.max_episode_steps
    }

    #[getter]
    fn backend(&self) -> &str {
        self.backend
    }

    #[getter]
    fn device(&self) -> Option<&str> {
        self.device.as_deref()
    }

    /// Least and greatest value of every entry of the observation.
    #[getter]
    fn observation_bounds<'py>(&self, py: Python<'py>) -> (Bound<'py, PyArray1<f32>>, Bound<'py, PyArray1<f32>>) {
        (PyArray1::from_slice(py, &self.bounds.0), PyArray1::from_slice(py, &self.bounds.1))
    }
}

fn autoreset_mode(word: &str) -> PyResult<Autoreset> {
    match word {
        "next_step" => Ok(Autoreset::NextStep),
        "same_step" => Ok(Autoreset::SameStep),
        "disabled" => Ok(Autoreset::Disabled),
        _ => Err(PyValueError::new_err(format!(
            "autoreset is {word:?}; it must be \"next_step\", \"same_step\" or \"disabled\""
        ))),
    }
}
