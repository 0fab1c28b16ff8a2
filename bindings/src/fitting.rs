//! Which user moves as the people of recordings do.

use std::path::{Path, PathBuf};

use myo::RunDescription;
use myo::fitting::{Anybody, Candidate, FittedAmong, FittingError, comparable, practice};
use myo::protocol::Practice;
use myo::recordings::{Participant, Recordings};
use myo::train::{PpoConfig, RunFolder};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::error;
use crate::model::Model;
use crate::policy::checkpoint;
use crate::process::{own_pool, pool};
use crate::signals::interruptible;
use crate::task::Task;

/// Among whom is looked: of each delay (ms) with each stature (m), what its folder is called behind that of the user of the task, and its task as a text.
#[pyfunction]
pub fn fitting_candidates(
    task: &Task,
    vision_delay_ms: Vec<f64>,
    height_m: Vec<f64>,
) -> PyResult<Vec<(String, String)>> {
    let changed = |candidate: Candidate| (candidate.suffix(), changed(task, candidate).to_yaml());
    Ok(candidates(task, &vision_delay_ms, &height_m)?.into_iter().map(changed).collect())
}

fn candidates(task: &Task, vision_delay_ms: &[f64], height_m: &[f64]) -> PyResult<Vec<Candidate>> {
    Candidate::all(vision_delay_ms, height_m, task.inner().control_dt_s).map_err(|refusal| refused(&refusal))
}

fn changed(task: &Task, candidate: Candidate) -> myo::tasks::Task {
    let mut own = task.inner().clone();
    candidate.change(&mut own);
    own
}

/// The layouts in which the user of a task learns to be anybody, as texts of tasks.
#[pyfunction]
pub fn fitting_layouts(task: &Task) -> PyResult<Vec<String>> {
    Ok(practice(task.inner()).map_err(|refusal| refused(&refusal))?.iter().map(|layout| layout.to_yaml()).collect())
}

/// Settings with which it learns that, as JSON.
#[pyfunction]
pub fn fitting_settings(task: &Task) -> PyResult<String> {
    let learning = Practice::Pointing.learning(&PpoConfig::for_user(task.inner().user));
    serde_json::to_string(&learning).map_err(|refusal| refused(&refusal))
}

/// The people of a table (CSV), each for oneself or all together, and what is wrong with what they did.
fn people(table: &str, together: bool, model: &myo::model::Model) -> PyResult<Vec<Participant>> {
    let recordings = Recordings::read(table.as_bytes()).map_err(|refusal| refused(&refusal))?;
    let people = if together { recordings.as_one() } else { recordings }.participants;
    for person in &people {
        comparable(person, model).map_err(|refusal| refused(&refusal))?;
    }
    Ok(people)
}

/// Refuses a table whose people no user of this task can be fitted to.
#[pyfunction]
pub fn check_recordings(table: &str, together: bool, task: &Task, model: &Model) -> PyResult<()> {
    people(table, together, &model.of(task.inner())?).map(drop)
}

/// The user who comes nearest to each of the people of a table, as JSON. `runs` are the trainings of who learnt to be anybody, in the order of [`fitting_candidates`] of `task`, each in
/// [`fitting_layouts`] of its own.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "what Python's function takes")]
pub fn fit(
    py: Python<'_>,
    runs: Vec<Vec<PathBuf>>,
    task: &Task,
    model: &Model,
    among: (Vec<f64>, Vec<f64>),
    table: &str,
    together: bool,
    seed: u64,
    threads: Option<usize>,
) -> PyResult<String> {
    let people = people(table, together, &model.of(task.inner())?)?;
    let candidates = candidates(task, &among.0, &among.1)?;
    let learnt = |(candidate, runs): (Candidate, &Vec<PathBuf>)| {
        let own = changed(task, candidate);
        let training = |run: &PathBuf| same_layouts(run, &own).and_then(|()| checkpoint(run));
        let trainings = runs.iter().map(training).collect::<PyResult<Vec<_>>>()?;
        let anybody = Anybody::new(trainings, model.of(&own)?, own).map_err(|refusal| refused(&refusal))?;
        Ok((candidate, anybody))
    };
    let users = candidates.into_iter().zip(&runs).map(learnt).collect::<PyResult<Vec<_>>>()?;
    let pool = threads.map_or_else(pool, |threads| own_pool(Some(threads)))?;
    let (done, raised) = interruptible(py, &pool, |go_on| {
        let fitted = people.iter().map(|person| FittedAmong::of(&users, person, seed, go_on).map_err(Box::new));
        fitted.collect::<Result<Option<Vec<FittedAmong>>, Box<FittingError>>>()
    })?;
    if let Some(raised) = raised {
        return Err(raised);
    }
    serde_json::to_string(&done.map_err(|refusal| refused(&refusal))?).map_err(error::run)
}

/// Refuses who practised something else.
fn same_layouts(run: &Path, user: &myo::tasks::Task) -> PyResult<()> {
    let description = RunDescription::of(&RunFolder::open(run).map_err(error::run)?).map_err(error::run)?;
    if description.layouts() == practice(user).map_err(|refusal| refused(&refusal))? {
        return Ok(());
    }
    Err(PyValueError::new_err(format!(
        "the user in {} practised other tasks than are asked for now; remove that folder, or name another",
        run.display()
    )))
}

fn refused(refusal: &dyn std::fmt::Display) -> PyErr {
    PyValueError::new_err(refusal.to_string())
}
