//! Trained policies.

use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

use myo::train::{Checkpoint, RunFolder};
use numpy::{PyArray2, PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::error::{self, compute};
use crate::process::pool;

/// A trained policy: the mean action for an observation.
#[pyclass(module = "myoenv", frozen)]
pub struct Policy {
    inner: Mutex<myo::train::Policy>,
    observation_names: Vec<String>,
    action_names: Vec<String>,
}

impl Policy {
    /// Wraps a policy.
    pub fn of(policy: myo::train::Policy) -> Self {
        let (observation_names, action_names) = (policy.observation_names().to_vec(), policy.action_names().to_vec());
        Self { inner: Mutex::new(policy), observation_names, action_names }
    }

    /// Works with the policy itself.
    pub fn with<T>(&self, work: impl FnOnce(&mut myo::train::Policy) -> T) -> T {
        work(&mut self.inner.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// The newest whole checkpoint of a run folder, or a checkpoint file.
pub fn checkpoint(path: &std::path::Path) -> PyResult<Checkpoint> {
    if path.is_file() {
        return Checkpoint::read(path).map_err(error::run);
    }
    let latest = RunFolder::open(path).map_err(error::run)?.latest_checkpoint().map_err(error::run)?;
    let none = || error::run(format!("{} has no checkpoint that can be used", path.display()));
    latest.checkpoint.ok_or_else(none)
}

#[pymethods]
impl Policy {
    /// The newest whole checkpoint of a run folder, or a checkpoint file.
    #[staticmethod]
    fn load(path: PathBuf) -> PyResult<Self> {
        Ok(Self::of(checkpoint(&path)?.policy()))
    }

    /// Mean actions `(rows, actions)` for observations `(rows, observations)`.
    fn act<'py>(
        &self,
        py: Python<'py>,
        observation: PyReadonlyArray2<'py, f32>,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let [rows, width] = [observation.shape()[0], observation.shape()[1]];
        let expected = self.observation_names.len();
        if width != expected {
            return Err(PyValueError::new_err(format!(
                "an observation has {width} entries, the policy knows {expected}"
            )));
        }
        let actions = PyArray2::zeros(py, [rows, self.action_names.len()], false);
        let from = observation.as_slice()?;
        // SAFETY: a new array.
        let to = unsafe { actions.as_slice_mut()? };
        let pool = pool()?;
        compute(py, || pool.install(|| self.with(|policy| policy.act_deterministic(from, to))))?;
        Ok(actions)
    }

    /// Names of the observations that it was trained on, in order.
    #[getter]
    fn observation_names(&self) -> Vec<String> {
        self.observation_names.clone()
    }

    /// Names of the actions, in order.
    #[getter]
    fn action_names(&self) -> Vec<String> {
        self.action_names.clone()
    }
}
