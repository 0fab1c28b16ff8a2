//! Arrays of NumPy that a step writes.

use std::borrow::Cow;

use myo::env::EnvSpec;
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::batch::Live;

/// Arrays that are handed out again and again.
pub struct Views {
    observation: Py<PyArray2<f32>>,
    reward: Py<PyArray1<f32>>,
    terminated: Py<PyArray1<bool>>,
    truncated: Py<PyArray1<bool>>,
}

/// What a step writes.
pub struct Arrays<'py> {
    pub observation: Bound<'py, PyArray2<f32>>,
    pub reward: Bound<'py, PyArray1<f32>>,
    pub terminated: Bound<'py, PyArray1<bool>>,
    pub truncated: Bound<'py, PyArray1<bool>>,
}

/// Episodes that ended: their environments, last observations and summaries.
pub type Ended<'py> = (Bound<'py, PyArray1<i64>>, Bound<'py, PyArray2<f32>>, Bound<'py, PyArray2<f32>>);

/// Observation, reward, terminated, truncated, and the episodes that ended, if any.
pub type Stepped<'py> = (
    Bound<'py, PyArray2<f32>>,
    Bound<'py, PyArray1<f32>>,
    Bound<'py, PyArray1<bool>>,
    Bound<'py, PyArray1<bool>>,
    Option<Ended<'py>>,
);

impl<'py> Arrays<'py> {
    /// New zeros.
    pub fn new(py: Python<'py>, spec: &EnvSpec) -> Self {
        let n = spec.num_envs;
        Self {
            observation: PyArray2::zeros(py, [n, spec.observation_size()], false),
            reward: PyArray1::zeros(py, [n], false),
            terminated: PyArray1::zeros(py, [n], false),
            truncated: PyArray1::zeros(py, [n], false),
        }
    }

    /// Those that are handed out again.
    pub fn of(py: Python<'py>, views: &Views) -> Self {
        Self {
            observation: views.observation.bind(py).clone(),
            reward: views.reward.bind(py).clone(),
            terminated: views.terminated.bind(py).clone(),
            truncated: views.truncated.bind(py).clone(),
        }
    }

    /// Actions that do not share memory with these arrays: copied if they do, as those that a caller computed in place of
    /// the observations that were handed out.
    pub fn apart<'a>(&self, actions: &'a [f32]) -> Cow<'a, [f32]> {
        let read = actions.as_ptr_range();
        let read = read.start as usize..read.end as usize;
        let within = |start: usize, bytes: usize| start < read.end && read.start < start + bytes;
        let n = self.reward.len();
        let shared = within(self.observation.data() as usize, size_of::<f32>() * self.observation.len())
            || within(self.reward.data() as usize, size_of::<f32>() * n)
            || within(self.terminated.data() as usize, n)
            || within(self.truncated.data() as usize, n);
        if shared { Cow::Owned(actions.to_vec()) } else { Cow::Borrowed(actions) }
    }

    /// To hand them out again.
    pub fn into_views(self) -> Views {
        Views {
            observation: self.observation.unbind(),
            reward: self.reward.unbind(),
            terminated: self.terminated.unbind(),
            truncated: self.truncated.unbind(),
        }
    }
}

/// The episodes that ended in the last step, by its flags.
pub fn ended<'py>(
    py: Python<'py>,
    spec: &EnvSpec,
    live: &Live,
    terminated: &[bool],
    truncated: &[bool],
) -> PyResult<Option<Ended<'py>>> {
    let over = |env: &usize| terminated[*env] || truncated[*env];
    let envs: Vec<usize> = (0..terminated.len()).filter(over).collect();
    if envs.is_empty() {
        return Ok(None);
    }
    let rows = |from: &[f32], width: usize| {
        let picked: Vec<f32> = envs.iter().flat_map(|env| &from[env * width..][..width]).copied().collect();
        picked.into_pyarray(py).reshape([envs.len(), width])
    };
    let observation = rows(&live.final_observation, spec.observation_size())?;
    let episode = rows(&live.episode, spec.episode_size())?;
    let envs: Vec<i64> = envs.iter().map(|&env| env as i64).collect();
    Ok(Some((envs.into_pyarray(py), observation, episode)))
}
