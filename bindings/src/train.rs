//! Training: the loop is Python's, an update is Rust's.

use std::ffi::CString;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, TryLockError};

use myo::env::EnvConfig;
use myo::train::{Checkpoint, PpoConfig, RunFolder, RunWriter, UpdateMetrics};
use pyo3::exceptions::{PyFileExistsError, PyUserWarning, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::ThreadPool;

use crate::error::{self, BusyError, compute};
use crate::model::Model;
use crate::place::{Envs, Wish};
use crate::policy::Policy;
use crate::process::{Birthplace, own_pool, pool};
use crate::task::Task;

/// PPO on one task.
#[pyclass(module = "myoenv._native", frozen)]
pub struct Trainer {
    inner: Mutex<Inner>,
    born: Birthplace,
    columns: Vec<String>,
    backend: &'static str,
    device: Option<String>,
}

struct Inner {
    trainer: myo::train::Trainer,
    writer: Option<RunWriter>,
    pool: Arc<ThreadPool>,
}

impl Trainer {
    fn with<T>(&self, work: impl FnOnce(&mut Inner) -> PyResult<T>) -> PyResult<T> {
        self.born.check("the trainer")?;
        match self.inner.try_lock() {
            Ok(mut inner) => work(&mut inner),
            Err(TryLockError::Poisoned(poisoned)) => work(&mut poisoned.into_inner()),
            Err(TryLockError::WouldBlock) => Err(BusyError::new_err("another thread is using this trainer")),
        }
    }
}

/// Settings from JSON; what is not named keeps its default.
fn settings(json: &str) -> PyResult<PpoConfig> {
    let config: PpoConfig = serde_json::from_str(json).map_err(|error| {
        // Line and column are those of a text that the user never saw.
        let text = error.to_string();
        PyValueError::new_err(format!("bad training setting: {}", text.split(" at line ").next().unwrap_or(&text)))
    })?;
    config.validate().map_err(|error| PyValueError::new_err(format!("bad training setting: {error}")))?;
    Ok(config)
}

/// The newest checkpoint of a run that is whole, with a warning where newer ones are not; none where none was written yet.
fn newest_checkpoint(py: Python<'_>, run: &Path) -> PyResult<Option<Checkpoint>> {
    let latest = RunFolder::open(run).map_err(error::run)?.latest_checkpoint();
    if latest.checkpoint.is_none() && !latest.refused.is_empty() {
        return Err(error::run(format!("{} has no checkpoint that can be used; train it again", run.display())));
    }
    for (path, reason) in &latest.refused {
        let sentence = format!("{} cannot be used, an older checkpoint is: {reason}", path.display());
        PyErr::warn(py, &py.get_type::<PyUserWarning>(), &CString::new(sentence)?, 3)?;
    }
    Ok(latest.checkpoint)
}

#[pymethods]
impl Trainer {
    #[new]
    #[expect(clippy::too_many_arguments, reason = "named arguments in Python")]
    #[pyo3(signature = (task, model, *, config, seed, backend, device, threads, resume))]
    fn new(
        py: Python<'_>,
        task: &Task,
        model: &Model,
        config: &str,
        seed: u64,
        backend: &str,
        device: Option<String>,
        threads: Option<usize>,
        resume: Option<PathBuf>,
    ) -> PyResult<Self> {
        let (wish, config) = (Wish::new(backend, device)?, settings(config)?);
        let checkpoint = resume.map_or(Ok(None), |run| newest_checkpoint(py, &run))?;
        let pool = threads.map_or_else(pool, |threads| own_pool(Some(threads)))?;
        let envs = EnvConfig { num_envs: config.num_envs, seed, ..EnvConfig::default() };
        let (task, model) = (task.inner(), model.inner());
        let (backend, device, trainer) = compute(py, || {
            pool.install(|| {
                let env = wish.build(model, task, &envs)?;
                let (backend, device) = (env.backend(), env.device());
                let trainer = match (env, checkpoint) {
                    (Envs::Cpu(env), None) => myo::train::Trainer::new(env, config, seed),
                    (Envs::Gpu(env), None) => myo::train::Trainer::on_card(*env, config, seed),
                    (Envs::Cpu(env), Some(checkpoint)) => myo::train::Trainer::restore(env, &checkpoint),
                    (Envs::Gpu(env), Some(checkpoint)) => myo::train::Trainer::restore_on_card(*env, &checkpoint),
                };
                Ok::<_, PyErr>((backend, device, trainer.map_err(error::train)?))
            })
        })??;
        let columns = UpdateMetrics::columns(&trainer.spec().episode_names).map(String::from).collect();
        let inner = Mutex::new(Inner { trainer, writer: None, pool });
        Ok(Self { inner, born: Birthplace::here(), columns, backend, device })
    }

    /// Collects and learns once; returns what `metrics.csv` has as columns. Records it in the run folder, if there is one.
    fn update<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let row = self.with(|inner| {
            compute(py, || {
                let Inner { trainer, writer, pool } = inner;
                let metrics = pool.install(|| trainer.update()).map_err(error::train)?;
                writer.as_mut().map_or(Ok(()), |writer| writer.record(&metrics)).map_err(error::run)?;
                Ok(metrics.row())
            })?
        })?;
        let out = PyDict::new(py);
        self.columns.iter().zip(row).try_for_each(|(name, x)| out.set_item(name, x))?;
        Ok(out)
    }

    /// Makes a run folder, or goes on with it; `description` is the JSON that tells what is trained.
    #[pyo3(signature = (path, description, go_on))]
    fn record_in(&self, path: PathBuf, description: &str, go_on: bool) -> PyResult<()> {
        let description = serde_json::from_str(description).map_err(error::run)?;
        self.with(|inner| {
            let trainer = &inner.trainer;
            let names = &trainer.spec().episode_names;
            let writer = if go_on {
                RunWriter::resume(&path, trainer.env_steps(), names)
            } else {
                RunWriter::create(&path, description, trainer.config(), trainer.seed(), names)
            };
            inner.writer = Some(writer.map_err(|refusal| match refusal {
                myo::train::RunError::Exists { .. } => PyFileExistsError::new_err(refusal.to_string()),
                other => error::run(other),
            })?);
            Ok(())
        })
    }

    /// Leaves the run folder to others.
    fn stop_recording(&self) -> PyResult<()> {
        self.with(|inner| {
            inner.writer = None;
            Ok(())
        })
    }

    /// Writes a checkpoint into the run folder and returns its path; none without a folder.
    fn checkpoint(&self, py: Python<'_>) -> PyResult<Option<PathBuf>> {
        self.with(|inner| {
            compute(py, || {
                let Inner { trainer, writer, .. } = inner;
                writer.as_mut().map(|writer| writer.write_checkpoint(&trainer.save())).transpose()
            })?
            .map_err(error::run)
        })
    }

    /// Writes an evaluation, as JSON, into the run folder.
    fn record_evaluation(&self, evaluation: &str) -> PyResult<()> {
        let evaluation = serde_json::from_str(evaluation).map_err(error::run)?;
        self.with(|inner| match &inner.writer {
            Some(writer) => writer.folder().write_evaluation(&evaluation).map_err(error::run),
            None => Ok(()),
        })
    }

    /// A copy of the policy as it is now.
    fn policy(&self) -> PyResult<Policy> {
        self.with(|inner| Ok(Policy::of(inner.trainer.policy())))
    }

    #[getter]
    fn env_steps(&self) -> PyResult<u64> {
        self.with(|inner| Ok(inner.trainer.env_steps()))
    }

    #[getter]
    fn max_episode_steps(&self) -> PyResult<usize> {
        self.with(|inner| Ok(inner.trainer.spec().max_episode_steps))
    }

    #[getter]
    fn updates(&self) -> PyResult<u64> {
        self.with(|inner| Ok(inner.trainer.updates()))
    }

    #[getter]
    fn backend(&self) -> &str {
        self.backend
    }

    #[getter]
    fn device(&self) -> Option<&str> {
        self.device.as_deref()
    }
}

/// Runs the mean actions of a policy until so many fresh episodes ended; JSON as `evaluation.json` has it.
#[pyfunction]
#[pyo3(signature = (policy, task, model, *, episodes, num_envs, seed))]
pub fn evaluate(
    py: Python<'_>,
    policy: &Policy,
    task: &Task,
    model: &Model,
    episodes: usize,
    num_envs: usize,
    seed: u64,
) -> PyResult<String> {
    let config = EnvConfig { num_envs, seed, ..EnvConfig::default() };
    let (task, model, pool) = (task.inner(), model.inner(), pool()?);
    let evaluation = compute(py, || {
        pool.install(|| {
            let mut env = Wish::Cpu.build(model, task, &config)?.boxed();
            policy
                .with(|policy| myo::train::evaluate(policy, env.as_mut(), episodes, seed, |_| true))
                .map_err(error::train)
        })
    })??;
    serde_json::to_string(&evaluation).map_err(error::run)
}

/// `config.json` of a run folder.
#[pyfunction]
pub fn run_config(path: PathBuf) -> PyResult<String> {
    let folder = RunFolder::open(&path).map_err(error::run)?;
    serde_json::to_string(folder.config()).map_err(error::run)
}

/// The default settings of PPO, as JSON.
#[pyfunction]
pub fn default_settings() -> PyResult<String> {
    serde_json::to_string(&PpoConfig::default()).map_err(error::run)
}
