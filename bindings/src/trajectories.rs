//! What a user does, physics step by physics step.

use std::path::PathBuf;

use myo::train::RunFolder;
use myo::{RunDescription, Trajectories, TrajectoryError, Values};
use numpy::IntoPyArray;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error;
use crate::policy::Policy;
use crate::process::pool;
use crate::signals::interruptible;

/// Columns of `episodes` episodes of each layout of a run, by their names.
#[pyfunction]
pub fn trajectories<'py>(
    py: Python<'py>,
    run: PathBuf,
    policy: &Policy,
    episodes: usize,
    seed: u64,
) -> PyResult<Bound<'py, PyDict>> {
    let run = RunDescription::of(&RunFolder::open(&run).map_err(error::run)?).map_err(error::run)?;
    let (body, layouts) = (run.body().map_err(error::task)?, run.layouts());
    let mut some: Vec<Trajectories> = vec![];
    let (done, raised) = interruptible(py, &*pool()?, |go_on| {
        policy.with(|policy| {
            myo::trajectories(policy, &body, &layouts, (episodes, seed), |more| {
                some.push(more);
                Ok::<bool, TrajectoryError>(go_on())
            })
        })
    })?;
    if let Some(raised) = raised {
        return Err(raised);
    }
    done.map_err(error::run)?;
    let mut whole = Trajectories::default();
    some.into_iter().for_each(|more| whole.append(more));
    let columns = PyDict::new(py);
    for column in whole.columns {
        match column.values {
            Values::Whole(all) => columns.set_item(column.name, all.into_pyarray(py))?,
            Values::Number(all) => columns.set_item(column.name, all.into_pyarray(py))?,
            Values::Text(all) => columns.set_item(column.name, all)?,
        }
    }
    Ok(columns)
}
