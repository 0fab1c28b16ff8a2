//! Where environments run: the processor or a graphics card.

use myo::env::{BuildError, CpuEnv, EnvConfig, GpuEnv, VectorEnv};
use myo::gpu::{Gpu, GpuError, Kind, Want, adapters};
use myo::model::Model;
use myo::tasks::Task;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::error;
use crate::process::check_gpu_process;

/// Environments per thread of the processor from which on `auto` takes a graphics card: that of the command line.
const AUTO_ENVS_PER_THREAD: usize = 64;

/// Environments of one backend.
pub enum Envs {
    /// On the processor.
    Cpu(Box<CpuEnv>),
    /// On a graphics card.
    Gpu(Box<GpuEnv>),
}

impl Envs {
    /// The environments, whatever they are.
    pub fn boxed(self) -> Box<dyn VectorEnv> {
        match self {
            Self::Cpu(env) => env,
            Self::Gpu(env) => env,
        }
    }

    /// `cpu` or `gpu`.
    pub fn backend(&self) -> &'static str {
        match self {
            Self::Cpu(_) => "cpu",
            Self::Gpu(_) => "gpu",
        }
    }

    /// Name of the graphics card, if it is one.
    pub fn device(&self) -> Option<String> {
        match self {
            Self::Cpu(_) => None,
            Self::Gpu(env) => Some(env.gpu().adapter().name.clone()),
        }
    }
}

/// What a caller asked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Wish {
    /// What is faster here.
    Auto,
    /// The processor.
    Cpu,
    /// This adapter.
    Gpu(Want),
}

impl Wish {
    /// From the arguments `backend` and `device`.
    pub fn new(backend: &str, device: Option<String>) -> PyResult<Self> {
        match (backend, device) {
            ("cpu", Some(device)) => Err(PyValueError::new_err(format!(
                "device {device:?} names a graphics card, but backend \"cpu\" takes none; leave one of them out"
            ))),
            ("auto" | "gpu", Some(device)) => Ok(Self::Gpu(Want::Named(device))),
            ("auto", None) => Ok(Self::Auto),
            ("cpu", None) => Ok(Self::Cpu),
            ("gpu", None) => Ok(Self::Gpu(Want::Hardware)),
            _ => Err(PyValueError::new_err(format!("backend is {backend:?}; it must be \"auto\", \"cpu\" or \"gpu\""))),
        }
    }

    /// Builds environments; with `auto`, what a graphics card refuses is built on the processor.
    pub fn build(&self, model: &Model, task: &Task, config: &EnvConfig) -> PyResult<Envs> {
        let Some(gpu) = self.open(config.num_envs)? else { return cpu(model, task, config) };
        match GpuEnv::new(&gpu, model, task, config) {
            Err(BuildError::TooLargeForGpu { .. } | BuildError::Gpu(_)) if *self == Self::Auto => {
                cpu(model, task, config)
            }
            built => Ok(Envs::Gpu(Box::new(built.map_err(error::build)?))),
        }
    }

    /// The graphics card, if one is taken for so many environments.
    fn open(&self, num_envs: usize) -> PyResult<Option<Gpu>> {
        let want = match self {
            Self::Cpu => return Ok(None),
            Self::Auto if num_envs < AUTO_ENVS_PER_THREAD * rayon::current_num_threads() => return Ok(None),
            Self::Auto => &Want::Hardware,
            Self::Gpu(want) => want,
        };
        let opened = check_gpu_process().and_then(|()| Gpu::open(want).map_err(|refusal| no_card(&refusal)));
        match opened {
            Err(_) if *self == Self::Auto => Ok(None),
            opened => opened.map(Some),
        }
    }
}

fn cpu(model: &Model, task: &Task, config: &EnvConfig) -> PyResult<Envs> {
    Ok(Envs::Cpu(Box::new(CpuEnv::new(model, task, config).map_err(error::build)?)))
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
    let word = |kind: Kind| format!("{kind:?}").to_lowercase();
    Ok(found.into_iter().map(|adapter| (adapter.name.clone(), word(adapter.kind))).collect())
}
