//! Simulated users made of muscle: describe a pointing or pressing task, train a muscle-driven arm on it, see how fast,
//! how accurately and with how much effort a person would do it.
//!
//! This crate is the front door: it re-exports the library, one module per crate, and its binary is the `myo` command.
//!
//! - [`scalar`]: the number types that the physics is written over
//! - [`muscle`]: Hill-type muscles
//! - [`model`]: descriptions of bodies, the built-in arm, MJCF
//! - [`mjcf`]: reader of MJCF
//! - [`dynamics`]: rigid-body physics
//! - [`tasks`]: what the simulated user has to do
//! - [`mod@env`]: the vectorised environment
//! - [`train`]: learning, evaluation, run folders
//! - [`gpu`]: graphics cards as compute devices
//!
//! ```
//! use myo::env::{CpuEnv, EnvConfig, StepStorage, VectorEnv};
//! use myo::model::{Model, builtin};
//!
//! let task = myo::tasks::preset("pointing").unwrap();
//! let model = task.embody(&builtin(&task.model)?)?;
//! let mut env = CpuEnv::new(&model, &task, &EnvConfig { num_envs: 16, seed: 1, ..EnvConfig::default() })?;
//!
//! // Actions lie in [-1, 1]: zero excites every muscle by half.
//! let actions = vec![0.0; 16 * env.spec().action_size()];
//! let mut out = StepStorage::new(env.spec());
//! env.reset(None, None, &mut out.observation)?;
//! env.step(&actions, out.buffers())?;
//! let mean = out.reward.iter().sum::<f32>() / 16.0;
//! println!("mean reward {mean:.3}");
//! assert!(mean < 0.0, "distance to the targets costs");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Tasks that no task file says are written as [`env::Rules`]: `examples/own_task.rs` is one, from its first line to its training.
//!
//! Beside them stands all of `myo-lab`, what its front doors share: [`Backend`], [`Device`] and [`Envs`], which choose between processor and
//! graphics card and train there; [`RunDescription`] and [`find_runs`]; [`ModelReach`], which lets the checks of a task ask a model; [`Comparison`]
//! and [`misfits`]; [`likely_cause`] and [`most_success`]; [`mod@picture`].
pub use myo_dynamics as dynamics;
pub use myo_env as env;
pub use myo_gpu as gpu;
pub use myo_measure as measure;
pub use myo_mjcf as mjcf;
pub use myo_model as model;
pub use myo_muscle as muscle;
pub use myo_scalar as scalar;
pub use myo_tasks as tasks;
pub use myo_train as train;

pub use myo_lab::*;

/// The example on the repository's front page compiles and runs.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
struct Readme;
