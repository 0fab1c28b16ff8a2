//! Training: one update at a time, so that the loop is Python's.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, TryLockError};

use myo::env::EnvConfig;
use myo::train::session::{End, Goal, News, Outcome, Progress};
use myo::train::{
    Checkpoint, Inherited, PpoConfig, RunClaim, RunError, RunFolder, RunWriter, Session as Inner, UpdateMetrics,
};
use myo::{Envs, ModelReach, Start, likely_cause};
use pyo3::exceptions::{PyFileExistsError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::ThreadPool;

use crate::backend::BackendChoice;
use crate::error::{self, BusyError, compute};
use crate::model::Model;
use crate::policy::{Policy, checkpoint};
use crate::process::{Birthplace, own_pool, pool};
use crate::signals::interruptible;
use crate::task::Task;

/// One training from start, or from a checkpoint, to its end.
#[pyclass(module = "myoenv._native", frozen)]
pub struct Session {
    live: Mutex<Option<Live>>,
    born: Birthplace,
    backend: &'static str,
    device: Option<String>,
    inherited: Option<Inherited>,
}

struct Live {
    session: Inner,
    pool: Arc<ThreadPool>,
    task: myo::tasks::Task,
    model: myo::model::Model,
    /// The run that it goes on with, until that is open for writing.
    claim: Option<RunClaim>,
}

impl Session {
    fn with<T>(&self, work: impl FnOnce(&mut Option<Live>) -> PyResult<T>) -> PyResult<T> {
        self.born.check("the training")?;
        match self.live.try_lock() {
            Ok(mut live) => work(&mut live),
            Err(TryLockError::Poisoned(poisoned)) => work(&mut poisoned.into_inner()),
            Err(TryLockError::WouldBlock) => Err(BusyError::new_err("another thread is using this training")),
        }
    }

    fn live<T>(&self, work: impl FnOnce(&mut Live) -> PyResult<T>) -> PyResult<T> {
        self.with(|live| work(live.as_mut().ok_or_else(over)?))
    }
}

fn over() -> PyErr {
    error::run("the training is over")
}

/// Settings from JSON; what is not named is as in `base`.
fn settings(json: &str, base: &PpoConfig) -> PyResult<PpoConfig> {
    let bad = |error: &dyn std::fmt::Display| {
        // Line and column are those of a text that the user never saw.
        let text = error.to_string();
        PyValueError::new_err(format!("bad training setting: {}", text.split(" at line ").next().unwrap_or(&text)))
    };
    let changes: serde_json::Map<String, serde_json::Value> = serde_json::from_str(json).map_err(|e| bad(&e))?;
    let mut table = serde_json::to_value(base).map_err(|e| bad(&e))?;
    changes.into_iter().for_each(|(name, value)| table[name] = value);
    let config: PpoConfig = serde_json::from_value(table).map_err(|e| bad(&e))?;
    config.validate().map_err(|e| bad(&e))?;
    Ok(config)
}

/// The newest checkpoint of a run that is whole, with a warning where newer ones are not; none where none was written yet.
fn newest_checkpoint(py: Python<'_>, run: &RunFolder) -> PyResult<Option<Checkpoint>> {
    let latest = run.latest_checkpoint().map_err(error::run)?;
    if latest.checkpoint.is_none() && !latest.refused.is_empty() {
        let run = run.path().display();
        return Err(error::run(format!("{run} has no checkpoint that can be used; train it again")));
    }
    for (path, reason) in &latest.refused {
        error::warn(py, &format!("{} cannot be used, an older checkpoint is: {reason}", path.display()))?;
    }
    Ok(latest.checkpoint)
}

/// A session in these environments.
fn open(
    env: Envs,
    (model, task): (&myo::model::Model, &myo::tasks::Task),
    start: Start<'_>,
    goal: Goal,
) -> PyResult<Inner> {
    let looks = env.for_looks(model, task, start.seed()).map_err(error::build)?;
    env.session(looks, start, goal).map_err(error::train)
}

#[pymethods]
impl Session {
    #[new]
    #[expect(clippy::too_many_arguments, reason = "named arguments in Python")]
    #[pyo3(signature = (task, model, *, config, seed, backend, device, threads, until, steps, resume, start_from))]
    fn new(
        py: Python<'_>,
        task: &Task,
        model: &Model,
        config: &str,
        seed: u64,
        backend: &str,
        device: Option<String>,
        threads: Option<usize>,
        until: Option<f64>,
        steps: u64,
        resume: Option<PathBuf>,
        start_from: Option<PathBuf>,
    ) -> PyResult<Self> {
        let choice = BackendChoice::new(backend, device)?;
        let other = start_from.map(|run| checkpoint(&run)).transpose()?;
        let base = other.as_ref().map_or_else(PpoConfig::default, |other| other.config().with_default_learning());
        let config = settings(config, &base)?;
        let claim = resume.map(|run| RunClaim::take(&run)).transpose().map_err(error::run)?;
        let again = claim.as_ref().map_or(Ok(None), |claim| newest_checkpoint(py, claim.folder()))?;
        let pool = threads.map_or_else(pool, |threads| own_pool(Some(threads)))?;
        let envs = EnvConfig { num_envs: config.num_envs, seed, ..EnvConfig::default() };
        let (task, model) = (task.inner().clone(), model.inner().clone());
        let env = choice.build(py, &pool, (&model, &task), &envs)?;
        let (device, goal) = (env.device(), Goal { until, steps });
        let new = Start::New { config: &config, seed, from: other.as_ref() };
        let start = again.as_ref().map_or(new, Start::Resumed);
        let session = compute(py, || pool.install(|| open(env, (&model, &task), start, goal)))??;
        let inherited = session.trainer().inherited();
        let live = Mutex::new(Some(Live { session, pool, task, model, claim }));
        let (backend, device) = (device.backend(), device.card().map(String::from));
        Ok(Self { live, born: Birthplace::here(), backend, device, inherited })
    }

    /// Makes a run folder, or goes on with it; `description` is the JSON that tells what is trained.
    #[pyo3(signature = (path, description, go_on))]
    fn record_in(&self, path: PathBuf, description: &str, go_on: bool) -> PyResult<()> {
        let description = serde_json::from_str(description).map_err(error::run)?;
        self.with(|live| {
            let Live { session, pool, task, model, claim } = live.take().ok_or_else(over)?;
            let trainer = session.trainer();
            let names = &trainer.spec().episode_names;
            let writer = if go_on {
                claim
                    .map_or_else(|| RunClaim::take(&path), Ok)
                    .and_then(|claim| claim.resume(trainer.env_steps(), names))
            } else {
                RunWriter::create(&path, description, trainer.config(), trainer.seed(), names)
            };
            let writer = writer.map_err(|refusal| match refusal {
                RunError::Exists { .. } => PyFileExistsError::new_err(refusal.to_string()),
                other => error::run(other),
            })?;
            let session = session.recorded_in(writer).map_err(error::run)?;
            *live = Some(Live { session, pool, task, model, claim: None });
            Ok(())
        })
    }

    /// One update, its record, and a look at the goal when it is time to.
    ///
    /// Keys: `metrics`, what `metrics.csv` has as columns, or None when the training went back to an earlier state or was
    /// interrupted in the update, of which nothing is left then; `news`, sentences; `end`, None until the training is over;
    /// `reason`, of the loss of a graphics card; `raised`, what a signal handler raised meanwhile, which is left to the caller.
    /// After an error the training is over and writes nothing more.
    fn advance<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.with(|slot| {
            // Put back only where all went well: weights that ran away must not become a checkpoint.
            let mut live = slot.take().ok_or_else(over)?;
            let Live { session, pool, .. } = &mut live;
            let (advanced, raised) = interruptible(py, pool, |go_on| session.advance(go_on))?;
            let progress = advanced.map_err(error::session)?;
            let live = slot.insert(live);
            let news = compute(py, || {
                progress.news.iter().map(|news| sentence(news, &live.task, &live.model)).collect::<PyResult<Vec<_>>>()
            })??;
            let out = PyDict::new(py);
            let names = &live.session.trainer().spec().episode_names;
            out.set_item("metrics", progress.metrics.as_ref().map(|m| metrics(py, names, m)).transpose()?)?;
            out.set_item("news", news)?;
            out.set_item("end", progress.end.as_ref().map(End::name))?;
            out.set_item("reason", reason(&progress))?;
            out.set_item("raised", raised)?;
            Ok(out)
        })
    }

    /// Closes the training after the `end` that `advance` told, or another: a last checkpoint, and, unless it was
    /// interrupted or lost, the evaluation. How it went as JSON, and what a signal handler raised meanwhile, which ends the
    /// evaluation and is left to the caller.
    fn conclude(&self, py: Python<'_>, end: &str) -> PyResult<(String, Option<PyErr>)> {
        let end = match end {
            "until" => End::Until,
            "interrupt" => End::Interrupted,
            "device_lost" => End::DeviceLost { reason: String::new() },
            _ => End::Steps,
        };
        let (outcome, raised) = self.with(|live| {
            let Live { session, pool, .. } = live.take().ok_or_else(over)?;
            let (outcome, raised) = interruptible(py, &pool, |go_on| session.conclude(end, go_on))?;
            Ok((outcome.map_err(error::session)?, raised))
        })?;
        Ok((serde_json::to_string(&table(&outcome)).map_err(error::run)?, raised))
    }

    /// Leaves the run folder to others. A training that is whole and was not concluded leaves a checkpoint there.
    fn leave(&self, py: Python<'_>) -> PyResult<()> {
        // A forked child leaves that to its parent.
        if !self.born.is_here() {
            return Ok(());
        }
        self.with(|live| match live.take() {
            None => Ok(()),
            Some(Live { session, pool, .. }) => {
                let concluded = compute(py, || pool.install(|| session.conclude(End::Interrupted, &|| true)))?;
                concluded.map(drop).map_err(error::session)
            }
        })
    }

    fn __reduce__(&self) -> PyResult<()> {
        Err(error::no_pickle("a training", "resume its run folder instead"))
    }

    /// A copy of the policy as it is now.
    fn policy(&self) -> PyResult<Policy> {
        self.live(|live| Ok(Policy::of(live.session.trainer().policy())))
    }

    #[getter]
    fn env_steps(&self) -> PyResult<u64> {
        self.live(|live| Ok(live.session.trainer().env_steps()))
    }

    /// Why there is nothing left to train, if so: `until` or `steps`.
    #[getter]
    fn over(&self) -> PyResult<Option<&'static str>> {
        self.live(|live| Ok(live.session.over().as_ref().map(End::name)))
    }

    /// Share of success that confirmed the goal, if an evaluation did.
    #[getter]
    fn confirmed_success(&self) -> PyResult<Option<f64>> {
        self.live(|live| Ok(live.session.confirmed().and_then(|evaluation| evaluation.success)))
    }

    /// Whether the run that is gone on with has the evaluation of its newest checkpoint.
    #[getter]
    fn is_evaluated(&self) -> PyResult<bool> {
        self.live(|live| {
            let claim = live.claim.as_ref();
            claim.map_or(Ok(false), |claim| claim.folder().has_evaluation().map_err(error::run))
        })
    }

    /// Control steps of the training that this one began with, if any.
    #[getter]
    fn inherited_env_steps(&self) -> Option<u64> {
        self.inherited.map(|inherited| inherited.env_steps)
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

fn metrics<'py>(py: Python<'py>, names: &[String], metrics: &UpdateMetrics) -> PyResult<Bound<'py, PyDict>> {
    let out = PyDict::new(py);
    UpdateMetrics::columns(names).zip(metrics.row()).try_for_each(|(name, x)| out.set_item(name, x))?;
    Ok(out)
}

fn reason(progress: &Progress) -> Option<&str> {
    match &progress.end {
        Some(End::DeviceLost { reason }) => Some(reason),
        _ => None,
    }
}

/// News, for people.
fn sentence(news: &News, task: &myo::tasks::Task, model: &myo::model::Model) -> PyResult<String> {
    Ok(match news {
        News::WentBack { .. } => news.to_string(),
        News::Flat { recent, .. } => {
            let reach = ModelReach::new(model).map_err(error::task)?;
            format!("{news}; {}", likely_cause(task, &reach, recent))
        }
    })
}

fn table(outcome: &Outcome) -> serde_json::Value {
    serde_json::json!({
        "stopped_by": outcome.end.name(),
        "env_steps": outcome.env_steps,
        "updates": outcome.updates,
        "wall_s": outcome.wall_s,
        "evaluation": outcome.evaluation,
        "checkpoint": outcome.checkpoint,
    })
}

/// `config.json` of a run folder.
#[pyfunction]
pub fn run_config(path: PathBuf) -> PyResult<String> {
    let folder = RunFolder::open(&path).map_err(error::run)?;
    serde_json::to_string(folder.config()).map_err(error::run)
}

/// A seed for the `number`-th evaluation of a training that is not the training's own.
#[pyfunction]
pub fn evaluation_seed(training_seed: u64, number: u64) -> u64 {
    myo::train::session::evaluation_seed(training_seed, number)
}

/// The default settings of PPO, as JSON.
#[pyfunction]
pub fn default_settings() -> PyResult<String> {
    serde_json::to_string(&PpoConfig::default()).map_err(error::run)
}
