//! Trained policies.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

use myo::train::{Checkpoint, LayerWeights, PolicyWeights, RunFolder};
use numpy::ndarray::{ArrayD, IxDyn};
use numpy::{IntoPyArray, PyArray2, PyArrayMethods, PyReadonlyArray2, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

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

/// Arrays of weights by their names, as a caller passed them; taken out one by one.
struct Given<'py>(BTreeMap<String, PyReadonlyArrayDyn<'py, f32>>);

impl Given<'_> {
    /// An array of so many dimensions; its shape and, row by row, its numbers.
    fn take(&mut self, name: &str, rank: usize) -> PyResult<(Vec<usize>, Vec<f32>)> {
        let missing = || PyValueError::new_err(format!("the weights have no {name:?}"));
        let array = self.0.remove(name).ok_or_else(missing)?;
        if array.ndim() != rank {
            let sentence = format!("{name} has the shape {:?}, expected {rank} dimensions", array.shape());
            return Err(PyValueError::new_err(sentence));
        }
        Ok((array.shape().to_vec(), array.as_array().iter().copied().collect()))
    }

    fn list(&mut self, name: &str) -> PyResult<Vec<f32>> {
        Ok(self.take(name, 1)?.1)
    }

    fn number(&mut self, name: &str) -> PyResult<f32> {
        Ok(self.take(name, 0)?.1[0])
    }

    /// All layers, the width of each checked against the one before.
    fn layers(&mut self, observations: usize) -> PyResult<Vec<LayerWeights>> {
        let (mut layers, mut inputs) = (Vec::new(), observations);
        while self.0.contains_key(&format!("layers.{}.weight", layers.len())) {
            let name = format!("layers.{}", layers.len());
            let (shape, weight) = self.take(&format!("{name}.weight"), 2)?;
            let bias = self.list(&format!("{name}.bias"))?;
            if shape != [bias.len(), inputs] {
                let expected = [bias.len(), inputs];
                let sentence =
                    format!("{name}.weight has the shape {shape:?}, expected {expected:?} (outputs, inputs)");
                return Err(PyValueError::new_err(sentence));
            }
            inputs = bias.len();
            layers.push(LayerWeights { weight, bias });
        }
        Ok(layers)
    }
}

/// The arrays of Python's `Policy.weights`.
fn named(weights: PolicyWeights) -> Vec<(String, Vec<usize>, Vec<f32>)> {
    let of = |name: &str, numbers: Vec<f32>| (name.to_owned(), vec![numbers.len()], numbers);
    let one = |name: &str, number: f32| (name.to_owned(), Vec::new(), vec![number]);
    let mut out = vec![
        of("observation_mean", weights.observation_mean),
        of("observation_inverse_std", weights.observation_inverse_std),
        one("observation_limit", weights.observation_limit),
    ];
    for (k, LayerWeights { weight, bias }) in weights.layers.into_iter().enumerate() {
        let outputs = bias.len();
        out.push((format!("layers.{k}.weight"), vec![outputs, weight.len() / outputs], weight));
        out.push(of(&format!("layers.{k}.bias"), bias));
    }
    out.extend([one("action_offset", weights.action_offset), one("action_scale", weights.action_scale)]);
    out
}

#[pymethods]
impl Policy {
    /// The newest whole checkpoint of a run folder, or a checkpoint file.
    #[staticmethod]
    fn load(path: PathBuf) -> PyResult<Self> {
        Ok(Self::of(checkpoint(&path)?.policy()))
    }

    /// A policy of arrays as `weights` returns them.
    #[staticmethod]
    fn from_weights(
        weights: BTreeMap<String, PyReadonlyArrayDyn<'_, f32>>,
        observation_names: Vec<String>,
        action_names: Vec<String>,
    ) -> PyResult<Self> {
        let mut given = Given(weights);
        let weights = PolicyWeights {
            observation_mean: given.list("observation_mean")?,
            observation_inverse_std: given.list("observation_inverse_std")?,
            observation_limit: given.number("observation_limit")?,
            layers: given.layers(observation_names.len())?,
            action_offset: given.number("action_offset")?,
            action_scale: given.number("action_scale")?,
            observation_names,
            action_names,
        };
        if let Some(name) = given.0.keys().next() {
            return Err(PyValueError::new_err(format!("a policy has no weights {name:?}")));
        }
        let policy = myo::train::Policy::from_weights(&weights);
        Ok(Self::of(policy.map_err(|refusal| PyValueError::new_err(refusal.to_string()))?))
    }

    /// Everything that an action is computed from, by name; Python's `Policy.weights` describes it.
    fn weights<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let out = PyDict::new(py);
        for (name, shape, numbers) in named(self.with(|policy| policy.weights())) {
            let array = ArrayD::from_shape_vec(IxDyn(&shape), numbers).map_err(error::run)?;
            out.set_item(name, array.into_pyarray(py))?;
        }
        Ok(out)
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
