//! Python bindings: the compiled half of the package `myoenv`.
//!
//! - [`env`]: environments stepped side by side, arrays in and arrays out; [`batch`]: what is behind it, [`arrays`]: NumPy's
//! - [`train`]: PPO and run folders; [`policy`]: what they leave
//! - [`task`], [`model`]: tasks and the bodies that do them; [`space`]: what an observation can be
//! - [`backend`]: processor or graphics card; [`process`]: threads and forks; [`signals`]: Ctrl-C
//! - [`simulation`]: the body alone; [`bodies`]: many of them
//! - [`trajectories`]: what a user does, physics step by physics step
//! - [`files`]: files that are whole or not there
//! - [`xla`]: steps without Python, in programs of JAX
//! - [`peek`]: some environments at one moment, as arrays; [`picture`]: one of them drawn
//!
//! What Python users see is in `python/myoenv`; this half knows no Gymnasium. Three rules hold everywhere: the interpreter is
//! released while Rust computes, nothing a caller passes ends in a panic ([`error`]), and a process forked after threads were
//! started is refused ([`process`]).

mod arrays;
mod backend;
mod batch;
mod bodies;
mod env;
mod error;
mod files;
mod fitting;
mod model;
mod peek;
mod picture;
mod policy;
mod process;
mod signals;
mod simulation;
mod space;
mod task;
mod train;
mod trajectories;
mod xla;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

#[pymodule]
fn _native(m: &Bound<'_, PyModule>) -> PyResult<()> {
    error::register(m)?;
    myo::scalar::Level::detect().map_err(|error| PyValueError::new_err(error.to_string()))?;
    m.add("__version__", env!("CARGO_PKG_VERSION"))?;
    m.add_class::<task::Task>()?;
    m.add_class::<model::Model>()?;
    m.add_class::<env::Env>()?;
    m.add_class::<policy::Policy>()?;
    m.add_class::<train::Session>()?;
    m.add_class::<simulation::Simulation>()?;
    m.add_class::<bodies::Bodies>()?;
    m.add_function(wrap_pyfunction!(task::preset_names, m)?)?;
    m.add_function(wrap_pyfunction!(task::task_schema, m)?)?;
    m.add_function(wrap_pyfunction!(model::model_names, m)?)?;
    m.add_function(wrap_pyfunction!(backend::devices, m)?)?;
    m.add_function(wrap_pyfunction!(train::evaluation_seed, m)?)?;
    m.add_function(wrap_pyfunction!(train::run_config, m)?)?;
    m.add_function(wrap_pyfunction!(train::misfits, m)?)?;
    m.add_function(wrap_pyfunction!(trajectories::trajectories, m)?)?;
    m.add_function(wrap_pyfunction!(fitting::fitting_candidates, m)?)?;
    m.add_function(wrap_pyfunction!(fitting::fitting_layouts, m)?)?;
    m.add_function(wrap_pyfunction!(fitting::fitting_settings, m)?)?;
    m.add_function(wrap_pyfunction!(fitting::check_recordings, m)?)?;
    m.add_function(wrap_pyfunction!(fitting::fit, m)?)?;
    m.add_function(wrap_pyfunction!(train::compare, m)?)?;
    m.add_function(wrap_pyfunction!(train::trained_users, m)?)?;
    m.add_function(wrap_pyfunction!(train::train_at_once, m)?)?;
    m.add_function(wrap_pyfunction!(train::task_batches, m)?)?;
    m.add_function(wrap_pyfunction!(files::write_whole, m)?)?;
    m.add_function(wrap_pyfunction!(xla::xla_step_handler, m)?)?;
    m.add_function(wrap_pyfunction!(train::default_settings, m)?)
}
