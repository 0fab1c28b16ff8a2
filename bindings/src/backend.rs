//! Choosing the backend that environments run on: the processor or a graphics card.

use std::error::Error;

use myo::env::{BuildError, EnvConfig};
use myo::gpu::{AdapterChoice, AdapterKind, GpuError, adapters};
use myo::model::Model;
use myo::tasks::Task;
use myo::train::PpoConfig;
use myo::{Device, Envs, auto_envs};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rayon::ThreadPool;

use crate::error;
use crate::process::check_gpu_process;

/// The backend that a caller asked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BackendChoice(myo::Backend);

impl From<myo::Backend> for BackendChoice {
    fn from(backend: myo::Backend) -> Self {
        Self(backend)
    }
}

impl BackendChoice {
    /// From the arguments `backend` and `device`.
    pub fn new(backend: &str, device: Option<String>) -> PyResult<Self> {
        match (backend, device) {
            ("cpu", Some(device)) => Err(PyValueError::new_err(format!(
                "device {device:?} names a graphics card, but backend \"cpu\" takes none; leave one of them out"
            ))),
            ("auto" | "gpu", Some(device)) => Ok(Self(myo::Backend::Gpu(AdapterChoice::Named(device)))),
            ("auto", None) => Ok(Self(myo::Backend::Auto)),
            ("cpu", None) => Ok(Self(myo::Backend::Cpu)),
            ("gpu", None) => Ok(Self(myo::Backend::Gpu(AdapterChoice::Hardware))),
            _ => Err(PyValueError::new_err(format!("backend is {backend:?}; it must be \"auto\", \"cpu\" or \"gpu\""))),
        }
    }

    /// Builds environments; with `auto`, what a graphics card refuses is built on the processor, with a warning.
    pub fn build(
        &self,
        py: Python<'_>,
        pool: &ThreadPool,
        (model, layouts): (&Model, &[Task]),
        config: &EnvConfig,
    ) -> PyResult<Envs> {
        self.build_by(py, pool, config.num_envs, |backend, notice| backend.build(model, layouts, config, notice))
    }

    /// The same to train in with these settings and this seed.
    pub fn build_for_training(
        &self,
        py: Python<'_>,
        pool: &ThreadPool,
        (model, layouts): (&Model, &[Task]),
        training: (&PpoConfig, u64),
    ) -> PyResult<Envs> {
        self.build_by(py, pool, training.0.num_envs, |backend, notice| {
            backend.build_for_training(model, layouts, training, notice)
        })
    }

    fn build_by(
        &self,
        py: Python<'_>,
        pool: &ThreadPool,
        num_envs: usize,
        build: impl FnOnce(&myo::Backend, &mut dyn FnMut(&dyn Error)) -> Result<Envs, BuildError> + Send,
    ) -> PyResult<Envs> {
        let mut notices = Vec::new();
        let built = error::compute(py, || {
            pool.install(|| {
                let mut notice =
                    |refusal: &dyn Error| notices.push(format!("{refusal}; the processor is taken instead"));
                Ok::<_, PyErr>(build(self.in_this_process(num_envs)?, &mut notice))
            })
        })?;
        notices.iter().try_for_each(|notice| error::warn(py, notice))?;
        built?.map_err(|refusal| match refusal {
            BuildError::Gpu(refusal) => no_card(&refusal),
            other => error::build(other),
        })
    }

    /// The device for so many environments.
    pub fn device(&self, num_envs: usize) -> PyResult<Device> {
        let mut silent = |_: &dyn Error| ();
        self.in_this_process(num_envs)?.device(num_envs, &mut silent).map_err(|refusal| no_card(&refusal))
    }

    /// The same choice without graphics cards where this process cannot have one.
    fn in_this_process(&self, num_envs: usize) -> PyResult<&myo::Backend> {
        match &self.0 {
            myo::Backend::Cpu => Ok(&self.0),
            myo::Backend::Auto if num_envs < auto_envs() || check_gpu_process().is_err() => Ok(&myo::Backend::Cpu),
            myo::Backend::Auto => Ok(&self.0),
            myo::Backend::Gpu(_) => check_gpu_process().map(|()| &self.0),
        }
    }
}

fn no_card(refusal: &GpuError) -> PyErr {
    match refusal {
        GpuError::OnlySoftware { found } => error::DeviceError::new_err(format!(
            "only a software adapter is there ({}), which computes on the processor; take backend=\"cpu\", or ask for the \
             adapter with device=\"0\"",
            found.join(", ")
        )),
        other => error::gpu(other),
    }
}

/// Graphics cards that answer, best first: `(name, kind)`, where kind is `discrete`, `integrated` or another word.
#[pyfunction]
pub fn devices(py: Python<'_>) -> PyResult<Vec<(String, String)>> {
    check_gpu_process()?;
    let found = error::compute(py, adapters)?;
    let word = |kind: AdapterKind| format!("{kind:?}").to_lowercase();
    Ok(found.into_iter().map(|adapter| (adapter.name.clone(), word(adapter.kind))).collect())
}
