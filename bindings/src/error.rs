//! Exceptions, one sentence each.

use std::any::Any;
use std::ffi::CString;
use std::panic::{AssertUnwindSafe, catch_unwind};

use myo::env::{BuildError, EnvError};
use myo::gpu::GpuError;
use myo::train::TrainError;
use myo::train::session::SessionError;
use pyo3::create_exception;
use pyo3::exceptions::{PyMemoryError, PyRuntimeError, PyTypeError, PyUserWarning, PyValueError};
use pyo3::prelude::*;

create_exception!(myoenv, TaskError, PyValueError, "A task or model that cannot be read, checked or simulated.");
create_exception!(myoenv, ActionError, PyValueError, "Actions of the wrong shape or type, or not finite.");
create_exception!(myoenv, ClosedError, PyRuntimeError, "An environment was used after it was closed.");
create_exception!(myoenv, ForkedError, PyRuntimeError, "An object was used in a process forked after it was made.");
create_exception!(myoenv, BusyError, PyRuntimeError, "Two threads used one object at the same time.");
create_exception!(
    myoenv,
    NeedsResetError,
    PyRuntimeError,
    "A finished environment was stepped, with autoreset disabled."
);
create_exception!(myoenv, DeviceError, PyRuntimeError, "A graphics card cannot be had, or failed.");
create_exception!(myoenv, TrainingError, PyRuntimeError, "Training cannot start or go on.");

/// Adds the exceptions to the module.
pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    let py = m.py();
    m.add("TaskError", py.get_type::<TaskError>())?;
    m.add("ActionError", py.get_type::<ActionError>())?;
    m.add("ClosedError", py.get_type::<ClosedError>())?;
    m.add("ForkedError", py.get_type::<ForkedError>())?;
    m.add("BusyError", py.get_type::<BusyError>())?;
    m.add("NeedsResetError", py.get_type::<NeedsResetError>())?;
    m.add("DeviceError", py.get_type::<DeviceError>())?;
    m.add("TrainingError", py.get_type::<TrainingError>())
}

/// Runs Rust code without the interpreter. A panic, which would be a mistake of this library, is an exception like others.
pub fn compute<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    py.detach(|| catch_unwind(AssertUnwindSafe(work))).map_err(|panic| panicked(&*panic))
}

/// What a panic left.
pub fn panicked(panic: &(dyn Any + Send)) -> PyErr {
    let text = panic.downcast_ref::<String>().map(String::as_str).or(panic.downcast_ref::<&str>().copied());
    PyRuntimeError::new_err(format!("internal error, please report it: {}", text.unwrap_or("no message")))
}

/// Something that lives with threads, locks and files of this process and cannot be written into a pickle.
pub fn no_pickle(what: &str, instead: &str) -> PyErr {
    PyTypeError::new_err(format!(
        "{what} cannot be pickled or copied: it lives with threads of this process; {instead}"
    ))
}

/// A warning, at the line that called the package.
pub fn warn(py: Python<'_>, sentence: &str) -> PyResult<()> {
    PyErr::warn(py, &py.get_type::<PyUserWarning>(), &CString::new(sentence)?, 3)
}

/// A task or model that cannot be used.
pub fn task(error: impl std::fmt::Display) -> PyErr {
    TaskError::new_err(error.to_string())
}

/// A refused call of an environment.
pub fn env(error: EnvError) -> PyErr {
    let text = error.to_string();
    match error {
        EnvError::NonFiniteAction { .. } | EnvError::WrongLength { .. } => ActionError::new_err(text),
        EnvError::NeedsReset { .. } => NeedsResetError::new_err(text),
        EnvError::Gpu(error) => gpu(&error),
        _ => PyValueError::new_err(text),
    }
}

/// An environment that cannot be built.
pub fn build(error: BuildError) -> PyErr {
    match error {
        BuildError::NoEnvironments | BuildError::TooManyEnvironments { .. } => PyValueError::new_err(error.to_string()),
        BuildError::OutOfMemory { .. } => PyMemoryError::new_err(error.to_string()),
        BuildError::Gpu(error) => gpu(&error),
        BuildError::TooLargeForGpu { .. }
        | BuildError::DriverBrokeDown { .. }
        | BuildError::MeshesOnGpu
        | BuildError::OutOfGpuMemory { .. } => DeviceError::new_err(error.to_string()),
        error => task(error),
    }
}

/// A graphics card that fails.
pub fn gpu(error: &GpuError) -> PyErr {
    DeviceError::new_err(error.to_string())
}

/// A training that cannot start or go on.
pub fn train(error: TrainError) -> PyErr {
    match error {
        TrainError::Env(error) => env(error),
        TrainError::Gpu(error) => gpu(&error),
        TrainError::Config(error) => PyValueError::new_err(error.to_string()),
        error => TrainingError::new_err(error.to_string()),
    }
}

/// A training that cannot go on or be recorded.
pub fn session(error: SessionError) -> PyErr {
    match error {
        SessionError::Train(error) => train(error),
        other => run(other),
    }
}

/// A run folder that cannot be used.
pub fn run(error: impl std::fmt::Display) -> PyErr {
    TrainingError::new_err(error.to_string())
}
