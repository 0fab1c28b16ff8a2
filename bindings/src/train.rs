//! Training: one update at a time, so that the loop is Python's.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, TryLockError};

use myo::env::EnvSpec;
use myo::model::ModelDescription;
use myo::tasks::User as TaskUser;
use myo::train::session::{End, Goal, News, Outcome, Progress, Until, UntilError};
use myo::train::{
    Checkpoint, PpoConfig, RunClaim, RunError, RunFolder, RunWriter, Session as Inner, Trainer, UpdateMetrics,
};
use myo::{
    Comparison, Envs, Group, ModelReach, ProgressLine, RunDescription, Setting, Start, User, WarmStart, likely_cause,
    usual_settings,
};
use pyo3::exceptions::{PyFileExistsError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::ThreadPool;

use crate::backend::BackendChoice;
use crate::error::{self, BusyError, DeviceError, compute};
use crate::model::Model;
use crate::policy::{Policy, checkpoint};
use crate::process::{Birthplace, own_pool, pool};
use crate::signals::interruptible;
use crate::task::{Task, inner};

/// One training from start, or from a checkpoint, to its end.
#[pyclass(module = "myoenv._native", frozen)]
pub struct Session {
    live: Mutex<Option<Live>>,
    born: Birthplace,
    description: RunDescription,
    config: PpoConfig,
    seed: u64,
}

struct Live {
    session: Inner,
    pool: Arc<ThreadPool>,
    layouts: Vec<myo::tasks::Task>,
    model: myo::model::Model,
    line: ProgressLine,
    /// The run being resumed, until it is open for writing.
    claim: Option<RunClaim>,
}

/// What a training needs, from its arguments or from its run folder.
struct Setup {
    /// The task, or several layouts.
    layouts: Vec<myo::tasks::Task>,
    model: myo::model::Model,
    /// The body, unless it comes with the program.
    own_model: Option<ModelDescription>,
    config: PpoConfig,
    seed: u64,
    goal: Goal,
    choice: BackendChoice,
    pool: Arc<ThreadPool>,
    /// What it began from, and the networks of that, unless it has a checkpoint of its own.
    from: Option<WarmStart>,
    other: Option<Checkpoint>,
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

    /// Records the training in the folder that `open` opens, if any; `open` is given the claim on the run being resumed.
    fn record(
        &self,
        open: impl FnOnce(Option<RunClaim>, &Trainer) -> Result<Option<RunWriter>, RunError>,
    ) -> PyResult<()> {
        self.with(|live| {
            let Live { session, pool, layouts, model, line, claim } = live.take().ok_or_else(over)?;
            let writer = open(claim, session.trainer()).map_err(|refusal| match refusal {
                RunError::Exists { .. } => PyFileExistsError::new_err(refusal.to_string()),
                other => error::run(other),
            })?;
            let session = match writer {
                Some(writer) => session.recorded_in(writer).map_err(error::run)?,
                None => session,
            };
            *live = Some(Live { session, pool, layouts, model, line, claim: None });
            Ok(())
        })
    }

    fn live<T>(&self, work: impl FnOnce(&mut Live) -> PyResult<T>) -> PyResult<T> {
        self.with(|live| work(live.as_mut().ok_or_else(over)?))
    }
}

/// What a training is for: `plateau`, a share of success, or `off`.
fn goal_of(until: &str) -> PyResult<Until> {
    until.parse().map_err(|refusal: UntilError| PyValueError::new_err(format!("until is {until}; {refusal}")))
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
fn open(env: Envs, start: Start<'_>, goal: Goal) -> PyResult<Inner> {
    let looks = env.for_looks(start.seed()).map_err(error::build)?;
    env.session(looks, start, goal).map_err(error::train)
}

fn threads_or_all(threads: Option<usize>) -> PyResult<Arc<ThreadPool>> {
    threads.map_or_else(pool, |threads| own_pool(Some(threads)))
}

impl Setup {
    /// Builds environments and opens the training in them.
    fn open(self, py: Python<'_>, claim: Option<RunClaim>, again: Option<&Checkpoint>) -> PyResult<Session> {
        let Self { layouts, model, own_model, config, seed, goal, choice, pool, from, other } = self;
        let env = choice.build_for_training(py, &pool, (&model, &layouts), (&config, seed))?;
        let Some((task, others)) = layouts.split_first() else {
            return Err(PyValueError::new_err("there is no layout"));
        };
        let description = RunDescription {
            other_layouts: others.to_vec(),
            ..RunDescription::new(task.clone(), own_model, &env.device(), goal, from)
        };
        let new = Start::New { config: &config, seed, from: other.as_ref() };
        let start = again.map_or(new, Start::Resumed);
        let session = compute(py, || pool.install(|| open(env, start, goal)))??;
        let line = ProgressLine::new(&layouts, session.goal().steps);
        let live = Mutex::new(Some(Live { session, pool, layouts, model, line, claim }));
        Ok(Session { live, born: Birthplace::here(), description, config, seed })
    }
}

/// The networks that a run was to begin with, for a run that was stopped before its first checkpoint.
fn other_again(from: &WarmStart) -> PyResult<Checkpoint> {
    let other = checkpoint(&from.run)?;
    from.check(&other).map_err(error::run)?;
    Ok(other)
}

#[pymethods]
impl Session {
    /// A new training. `start_from` is a run folder or a checkpoint.
    #[new]
    #[expect(clippy::too_many_arguments, reason = "named arguments in Python")]
    #[pyo3(signature = (layouts, model, *, config, seed, backend, device, threads, until, steps, start_from))]
    fn new(
        py: Python<'_>,
        layouts: Vec<PyRef<'_, Task>>,
        model: &Model,
        config: &str,
        seed: u64,
        backend: &str,
        device: Option<String>,
        threads: Option<usize>,
        until: &str,
        steps: u64,
        start_from: Option<PathBuf>,
    ) -> PyResult<Self> {
        let other = start_from.as_deref().map(checkpoint).transpose()?;
        let began = |other: &Checkpoint| Some(WarmStart { run: start_from?, env_steps: other.env_steps() });
        let layouts = inner(&layouts);
        let user = layouts.first().map_or_else(TaskUser::default, |task| task.user);
        let body = model.of_first(&layouts)?;
        let base =
            other.as_ref().map_or_else(|| usual_settings(user, &body), |other| other.config().with_learning_of(user));
        let setup = Setup {
            model: body,
            own_model: layouts.first().and_then(|task| model.unless_built_in(&task.model)),
            layouts,
            config: settings(config, &base)?,
            seed,
            goal: Goal { until: goal_of(until)?, steps },
            choice: BackendChoice::new(backend, device)?,
            pool: threads_or_all(threads)?,
            from: other.as_ref().and_then(began),
            other,
        };
        setup.open(py, None, None)
    }

    /// Continues the training of a run folder: on the device where it began, unless a backend or a device is given, and with
    /// its own `until` and `steps`, unless others are given.
    #[staticmethod]
    #[pyo3(signature = (run, *, backend, device, threads, until, steps))]
    fn resume(
        py: Python<'_>,
        run: PathBuf,
        backend: Option<&str>,
        device: Option<String>,
        threads: Option<usize>,
        until: Option<&str>,
        steps: Option<u64>,
    ) -> PyResult<Self> {
        let claim = RunClaim::take(&run).map_err(error::run)?;
        let run = RunDescription::of(claim.folder()).map_err(error::run)?;
        let again = newest_checkpoint(py, claim.folder())?;
        let began_on = if backend.is_none() && device.is_none() { run.device.clone() } else { None };
        let choice = match (backend, device) {
            (None, None) => run.backend().into(),
            (backend, device) => BackendChoice::new(backend.unwrap_or("auto"), device)?,
        };
        let other = run.from.as_ref().filter(|_| again.is_none()).map(other_again).transpose()?;
        let setup = Setup {
            model: run.body().map_err(error::task)?,
            config: claim.folder().config().ppo.clone(),
            seed: claim.folder().config().seed,
            goal: Goal { until: until.map_or(Ok(run.until), goal_of)?, steps: steps.unwrap_or(run.steps) },
            choice,
            pool: threads_or_all(threads)?,
            layouts: run.layouts(),
            own_model: run.model,
            from: run.from,
            other,
        };
        let session = setup.open(py, Some(claim), again.as_ref());
        session.map_err(|refusal| match began_on {
            Some(device) if refusal.is_instance_of::<DeviceError>(py) => DeviceError::new_err(format!(
                "the run began on {device}, which cannot be had now: {}; to go on elsewhere, name a backend or a device",
                refusal.value(py)
            )),
            _ => refusal,
        })
    }

    /// What is trained, on what, until when: the parts `run`, `ppo` and `seed` of `config.json`.
    fn description(&self) -> PyResult<String> {
        let Self { description, config, seed, .. } = self;
        serde_json::to_string(&serde_json::json!({ "run": description, "ppo": config, "seed": seed }))
            .map_err(error::run)
    }

    /// Makes a run folder, where metrics, checkpoints and the evaluation are kept.
    fn record_in(&self, path: PathBuf) -> PyResult<()> {
        let description = serde_json::to_value(&self.description).map_err(error::run)?;
        self.record(|_, trainer| {
            RunWriter::create(&path, description, trainer.config(), trainer.seed(), trainer.spec()).map(Some)
        })
    }

    /// Records in the run folder that it was resumed from, and keeps the goal that it has now there.
    fn record_on(&self) -> PyResult<()> {
        let goal = self.description.goal();
        self.record(|claim, trainer| {
            let Some(mut claim) = claim else { return Ok(None) };
            RunDescription::aim(&mut claim, goal)?;
            claim.resume(trainer.env_steps(), trainer.spec()).map(Some)
        })
    }

    /// One update, its record, and a look at the goal when it is time to.
    ///
    /// Keys: `metrics`, what `metrics.csv` has as columns, or None when the training went back to an earlier state or was
    /// interrupted in the update, of which nothing is left then; `line`, how it goes, or None likewise; `news`, sentences; `end`, None until the training is over;
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
                progress
                    .news
                    .iter()
                    .map(|news| sentence(news, &live.layouts, &live.model))
                    .collect::<PyResult<Vec<_>>>()
            })??;
            let out = PyDict::new(py);
            let spec = live.session.trainer().spec();
            out.set_item("metrics", progress.metrics.as_ref().map(|m| metrics(py, spec, m)).transpose()?)?;
            out.set_item("line", live.line.after(&progress))?;
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
            "plateau" => End::Plateau,
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

    /// Why there is nothing left to train, if so: `until`, `plateau` or `steps`.
    #[getter]
    fn over(&self) -> PyResult<Option<&'static str>> {
        self.live(|live| Ok(live.session.over().as_ref().map(End::name)))
    }

    /// Share of success that confirmed the goal, if an evaluation did.
    #[getter]
    fn confirmed_success(&self) -> PyResult<Option<f64>> {
        self.live(|live| Ok(live.session.confirmed().and_then(|evaluation| evaluation.success)))
    }

    /// Whether the run being resumed has the evaluation of its newest checkpoint.
    #[getter]
    fn is_evaluated(&self) -> PyResult<bool> {
        self.live(|live| {
            let claim = live.claim.as_ref();
            claim.map_or(Ok(false), |claim| claim.folder().has_evaluation().map_err(error::run))
        })
    }
}

fn metrics<'py>(py: Python<'py>, spec: &EnvSpec, metrics: &UpdateMetrics) -> PyResult<Bound<'py, PyDict>> {
    let out = PyDict::new(py);
    UpdateMetrics::columns(spec).into_iter().zip(metrics.row()).try_for_each(|(name, x)| out.set_item(name, x))?;
    Ok(out)
}

fn reason(progress: &Progress) -> Option<&str> {
    match &progress.end {
        Some(End::DeviceLost { reason }) => Some(reason),
        _ => None,
    }
}

/// News, for people.
fn sentence(news: &News, layouts: &[myo::tasks::Task], model: &myo::model::Model) -> PyResult<String> {
    Ok(match news {
        News::WentBack { .. } => news.to_string(),
        News::Flat { recent, layout, .. } => {
            let task = &layouts[layout.unwrap_or(0)];
            let reach = ModelReach::for_task(model, task).map_err(error::task)?;
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
        "trend": outcome.trend,
        "evaluation": outcome.evaluation,
        "checkpoint": outcome.checkpoint,
    })
}

/// How a training of several went as JSON, or what went wrong.
type Told = (Option<String>, String);

/// Users of one batch of tasks and seeds, trained at once on a graphics card without run folders: for each, how it went, and what was
/// trained, as JSON, or what went wrong. And what a signal handler raised meanwhile, which is left to the caller.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "named arguments in Python")]
#[pyo3(signature = (tasks, model, seeds, *, config, device, until, steps))]
pub fn train_at_once(
    py: Python<'_>,
    tasks: Vec<PyRef<'_, Task>>,
    model: &Model,
    seeds: Vec<u64>,
    config: &str,
    device: Option<String>,
    until: &str,
    steps: u64,
) -> PyResult<(Vec<Told>, Option<PyErr>)> {
    let tasks = inner(&tasks);
    let users: Vec<User<'_>> = tasks.iter().zip(&seeds).map(|(task, &seed)| User { task, seed }).collect();
    let user = tasks.first().map_or_else(TaskUser::default, |task| task.user);
    let body = model.of_first(&tasks)?;
    let config = settings(config, &usual_settings(user, &body))?;
    let goal = Goal { until: goal_of(until)?, steps };
    let device = BackendChoice::new("gpu", device)?.device(config.num_envs)?;
    let (outcomes, raised) =
        interruptible(py, &*pool()?, |go_on| myo::train_at_once(&device, &body, &users, &config, goal, go_on))?;
    let describe = |user: &User<'_>| {
        let own_model = model.unless_built_in(&user.task.model);
        let run = RunDescription::new(user.task.clone(), own_model, &device, goal, None);
        serde_json::json!({ "run": run, "ppo": config, "seed": user.seed })
    };
    let told = outcomes.map_err(error::run)?.into_iter().zip(&users).map(|(outcome, user)| match outcome {
        Ok(outcome) => {
            let mut table = table(&outcome);
            table["description"] = describe(user);
            (Some(table.to_string()), String::new())
        }
        Err(error) => (None, error.to_string()),
    });
    Ok((told.collect(), raised))
}

/// Which of these tasks users can do at once on a graphics card: batches of their numbers.
#[pyfunction]
pub fn task_batches(tasks: Vec<PyRef<'_, Task>>, model: &Model) -> PyResult<Vec<Vec<usize>>> {
    let tasks = inner(&tasks);
    let users: Vec<User<'_>> = tasks.iter().map(|task| User { task, seed: 0 }).collect();
    myo::batches(&model.of_first(&tasks)?, &users).map_err(error::build)
}

/// `config.json` of a run folder, refused if no training could have begun with it.
#[pyfunction]
pub fn run_config(path: PathBuf) -> PyResult<String> {
    let folder = RunFolder::open(&path).map_err(error::run)?;
    RunDescription::of(&folder).map_err(error::run)?;
    serde_json::to_string(folder.config()).map_err(error::run)
}

/// What users of two layouts allow to say, from two groups as JSON; JSON with the sentences.
#[pyfunction]
pub fn compare(first: &str, second: &str) -> PyResult<String> {
    let group = |text: &str| serde_json::from_str::<Group>(text).map_err(error::run);
    let comparison = Comparison::new(&group(first)?, &group(second)?);
    let mut result = serde_json::to_value(&comparison).map_err(error::run)?;
    result["sentences"] = comparison.sentences().collect();
    Ok(result.to_string())
}

/// The users of some runs of one layout, as JSON for [`compare`].
#[pyfunction]
pub fn trained_users(name: String, runs: Vec<PathBuf>) -> PyResult<String> {
    let folders: Result<Vec<_>, _> = runs.iter().map(|path| RunFolder::open(path)).collect();
    let group = Group::of_runs(name, &folders.map_err(error::run)?).map_err(error::run)?;
    serde_json::to_string(&group).map_err(error::run)
}

/// What keeps the user of a run from doing another task, as half sentences; none if it can.
#[pyfunction]
pub fn misfits(py: Python<'_>, run: PathBuf, task: &Task, model: &Model) -> PyResult<Vec<String>> {
    let trained = RunDescription::of(&RunFolder::open(&run).map_err(error::run)?).map_err(error::run)?;
    let body = trained.body().map_err(error::task)?;
    let own_model = model.unless_built_in(&task.inner().model);
    let own = Setting { task: &trained.task, model: &body, own_model: trained.model.as_ref() };
    let there = model.of(task.inner())?;
    let other = Setting { task: task.inner(), model: &there, own_model: own_model.as_ref() };
    let misfits = compute(py, || myo::misfits(own, other))?.map_err(error::build)?;
    Ok(misfits.iter().map(ToString::to_string).collect())
}

/// A seed for the `number`-th evaluation of a training that is not the training's own.
#[pyfunction]
pub fn evaluation_seed(training_seed: u64, number: u64) -> u64 {
    myo::train::session::evaluation_seed(training_seed, number)
}

/// The settings of PPO that users of a kind learn with, as JSON.
#[pyfunction]
pub fn default_settings(user: &str) -> PyResult<String> {
    let named = TaskUser::ALL.into_iter().find(|kind| kind.name() == user);
    let user = named.ok_or_else(|| {
        let known = TaskUser::ALL.map(TaskUser::name).join(" or ");
        PyValueError::new_err(format!("there is no user {user:?}; it must be {known}"))
    })?;
    serde_json::to_string(&PpoConfig::for_user(user)).map_err(error::run)
}
