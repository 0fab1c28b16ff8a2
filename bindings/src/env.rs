//! Environments stepped side by side.

use std::sync::{Arc, PoisonError, RwLock, RwLockReadGuard};

use myo::env::{Autoreset, EnvConfig, EnvError};
use myo::picture::Painter;
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use crate::arrays::{Arrays, Stepped, Views, ended};
use crate::backend::BackendChoice;
use crate::batch::{Batch, Shown, Token};
use crate::error::{self, compute};
use crate::model::Model;
use crate::peek::{fields, posed};
use crate::picture::pixels;
use crate::process::{own_pool, pool};
use crate::space;
use crate::task::{Task, inner};
use crate::xla;

/// Copies of one task, or of several layouts by turns. All arrays have the environments as their first axis.
#[pyclass(module = "myoenv._native", frozen)]
pub struct Env {
    batch: Arc<Batch>,
    /// Arrays that every call writes anew, while it has the batch locked; without them, each call makes its own.
    views: Option<Views>,
    backend: &'static str,
    device: Option<String>,
    model: myo::model::Model,
    scenery: RwLock<Scenery>,
}

/// What belongs to the task, or to the layouts.
struct Scenery {
    bounds: (Vec<f32>, Vec<f32>),
    /// One for each layout.
    painters: Vec<Painter>,
    max_episode_steps: usize,
}

impl Scenery {
    fn new(model: &myo::model::Model, layouts: &[myo::tasks::Task], names: &[String]) -> PyResult<Self> {
        let painter = |task| Painter::new(model, task).map_err(error::build);
        Ok(Self {
            bounds: space::bounds(model, layouts, names),
            painters: layouts.iter().map(painter).collect::<PyResult<_>>()?,
            max_episode_steps: layouts.iter().map(|task| task.time_limit_steps() as usize).max().unwrap_or(0),
        })
    }

    /// That of an environment.
    fn painter(&self, env: usize) -> &Painter {
        &self.painters[env % self.painters.len()]
    }
}

impl Env {
    fn arrays<'py>(&self, py: Python<'py>) -> Arrays<'py> {
        self.views.as_ref().map_or_else(|| Arrays::new(py, &self.batch.spec), |views| Arrays::of(py, views))
    }

    fn scenery(&self) -> RwLockReadGuard<'_, Scenery> {
        self.scenery.read().unwrap_or_else(PoisonError::into_inner)
    }
}

#[pymethods]
impl Env {
    #[new]
    #[expect(clippy::too_many_arguments, reason = "named arguments in Python")]
    #[pyo3(signature = (layouts, model, num_envs, *, seed, autoreset, backend, device, threads, copy))]
    fn new(
        py: Python<'_>,
        layouts: Vec<PyRef<'_, Task>>,
        model: &Model,
        num_envs: usize,
        seed: u64,
        autoreset: &str,
        backend: &str,
        device: Option<String>,
        threads: Option<usize>,
        copy: bool,
    ) -> PyResult<Self> {
        let choice = BackendChoice::new(backend, device)?;
        let config = EnvConfig { num_envs, seed, autoreset: autoreset_mode(autoreset)?, ..EnvConfig::default() };
        let pool = threads.map_or_else(pool, |threads| own_pool(Some(threads)))?;
        let layouts = inner(&layouts);
        let model = model.of_first(&layouts)?;
        let built = choice.build(py, &pool, (&model, &layouts), &config)?;
        let (taken, env) = (built.device(), built.boxed());
        let views = (!copy).then(|| Arrays::new(py, env.spec()).into_views());
        let scenery = Scenery::new(&model, &layouts, &env.spec().observation_names)?;
        Ok(Self {
            batch: Arc::new(Batch::new(env, pool)),
            views,
            backend: taken.backend(),
            device: taken.card().map(String::from),
            model,
            scenery: RwLock::new(scenery),
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
        let mut opened = self.batch.open()?;
        let live = opened.live();
        let mask = mask.as_ref().map(PyReadonlyArray1::as_slice).transpose()?;
        if seeds.as_ref().is_some_and(|seeds| seeds.len() != self.batch.spec.num_envs) {
            return Err(PyValueError::new_err(format!(
                "there must be one seed for each of {} environments",
                self.batch.spec.num_envs
            )));
        }
        let observation = self.arrays(py).observation;
        // SAFETY: a new array, or the one that the caller agreed to have overwritten.
        let rows = unsafe { observation.as_slice_mut()? };
        compute(py, || live.reset(seed, seeds.as_deref(), mask, rows))?.map_err(error::env)?;
        Ok(observation)
    }

    /// One control step. `actions` is `(num_envs, action_size)` in [-1, 1].
    fn step<'py>(&self, py: Python<'py>, actions: PyReadonlyArray2<'py, f32>) -> PyResult<Stepped<'py>> {
        let mut opened = self.batch.open()?;
        let live = opened.live();
        let arrays = self.arrays(py);
        let actions = arrays.apart(actions.as_slice()?);
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
        compute(py, || live.step(&actions, shown))?.map_err(error::env)?;
        let ended = {
            // SAFETY: nobody writes while the environment is locked.
            let flags = unsafe { (arrays.terminated.as_slice()?, arrays.truncated.as_slice()?) };
            ended(py, &self.batch.spec, live, flags.0, flags.1)?
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
        let mut opened = self.batch.open()?;
        let (live, actions) = (opened.live(), actions.as_slice()?);
        let timed = compute(py, || live.time_steps(actions, steps))?;
        Ok(timed.map_err(error::env)?.into_pyarray(py))
    }

    /// Everything that the next steps depend on.
    fn save_state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let mut opened = self.batch.open()?;
        let live = opened.live();
        let state = compute(py, move || live.save_state())?.map_err(error::env)?;
        Ok(PyBytes::new(py, &state))
    }

    /// Goes back to what `save_state` returned, bit for bit.
    fn load_state(&self, py: Python<'_>, state: &[u8]) -> PyResult<()> {
        let mut opened = self.batch.open()?;
        let live = opened.live();
        compute(py, || live.load_state(state))?.map_err(error::env)
    }

    /// Goes on with another task of the same structure; a reset of all must follow.
    fn set_task(&self, py: Python<'_>, task: &Task) -> PyResult<()> {
        let mut opened = self.batch.open()?;
        let live = opened.live();
        let scenery =
            Scenery::new(&self.model, std::slice::from_ref(task.inner()), &self.batch.spec.observation_names)?;
        compute(py, || live.set_task(task.inner()))?.map_err(error::env)?;
        *self.scenery.write().unwrap_or_else(PoisonError::into_inner) = scenery;
        Ok(())
    }

    /// The fields of `myoenv.Peek` for the environments from `start` up to `stop`, by name.
    fn peek<'py>(&self, py: Python<'py>, start: usize, stop: usize) -> PyResult<Bound<'py, PyDict>> {
        let mut opened = self.batch.open()?;
        let (live, scenery) = (opened.live(), self.scenery());
        let painters = &scenery.painters[..];
        let look = move || {
            let skeleton = |k: usize| painters[(start + k) % painters.len()].skeleton();
            live.peek(start..stop).and_then(|moments| posed(skeleton, moments))
        };
        let seen = compute(py, look)?;
        fields(py, painters[0].skeleton(), self.batch.spec.control_dt, &seen.map_err(error::env)?)
    }

    /// Pictures of the environments from `start` up to `stop`, `(height, width, 3)` of bytes each.
    fn render<'py>(
        &self,
        py: Python<'py>,
        start: usize,
        stop: usize,
        size: (usize, usize),
    ) -> PyResult<Vec<Bound<'py, PyArray3<u8>>>> {
        let mut opened = self.batch.open()?;
        let live = opened.live();
        let (width, height) = size;
        if !(16..=4096).contains(&width) || !(16..=4096).contains(&height) {
            return Err(PyValueError::new_err(format!(
                "a picture of {width} x {height} is asked for; sizes are 16 to 4096"
            )));
        }
        let pictures = compute(py, move || {
            let (moments, scenery) = (live.peek(start..stop)?, self.scenery());
            let paint = |(env, moment)| Ok(pixels(&scenery.painter(env).moment(moment)?, width, height));
            (start..).zip(&moments).map(paint).collect::<Result<Vec<_>, EnvError>>()
        })?
        .map_err(error::env)?;
        pictures.into_iter().map(|picture| picture.into_pyarray(py).reshape([height, width, 3])).collect()
    }

    /// Frees the environments, after a step that is going on; a second time does nothing.
    fn close(&self, py: Python<'_>) {
        py.detach(|| self.batch.close());
    }

    /// A number by which programs of XLA know these environments.
    fn xla_id(&self) -> i64 {
        xla::id_of(&self.batch)
    }

    /// Names the present state: a number of these environments, and one that every reset and step changes.
    #[getter]
    fn token(&self) -> PyResult<Token> {
        Ok(self.batch.open()?.live().token())
    }

    /// Refuses the token of any state but the present one.
    fn check_token(&self, token: Token) -> PyResult<()> {
        self.batch.open()?.live().check_token(token).map_err(PyValueError::new_err)
    }

    fn __reduce__(&self) -> PyResult<()> {
        let instead = "make another one, with save_state and load_state for its state";
        Err(error::no_pickle("an environment", instead))
    }

    #[getter]
    fn num_envs(&self) -> usize {
        self.batch.spec.num_envs
    }

    #[getter]
    fn observation_names(&self) -> Vec<String> {
        self.batch.spec.observation_names.clone()
    }

    #[getter]
    fn action_names(&self) -> Vec<String> {
        self.batch.spec.action_names.clone()
    }

    #[getter]
    fn episode_names(&self) -> Vec<String> {
        self.batch.spec.episode_names.clone()
    }

    #[getter]
    fn control_dt(&self) -> f64 {
        self.batch.spec.control_dt
    }

    #[getter]
    fn max_episode_steps(&self) -> usize {
        self.scenery().max_episode_steps
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
        let scenery = self.scenery();
        (PyArray1::from_slice(py, &scenery.bounds.0), PyArray1::from_slice(py, &scenery.bounds.1))
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
