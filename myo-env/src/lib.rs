//! Vectorised environment: observation, action, noise, reset.
//!
//! [`VectorEnv`] is what a trainer sees; [`CpuEnv`] runs it on SIMD lanes and threads, [`ReferenceEnv`] in double precision,
//! one environment at a time, with the plan that is compiled in the obvious way. Both evaluate the same generic code: one
//! control step is noise, activation, physics, task, reward, observation and autoreset of the whole environment. With the
//! feature `gpu` a `GpuEnv` runs it on a graphics card.
//!
//! ```
//! use myo_env::{CpuEnv, EnvConfig, StepStorage, VectorEnv};
//!
//! let task = myo_tasks::preset("pointing-single").unwrap();
//! let model = myo_model::Model::new(&myo_model::builtin(&task.model)?)?;
//! let mut env = CpuEnv::new(&model, &task, &EnvConfig { num_envs: 16, ..Default::default() })?;
//! let mut out = StepStorage::new(env.spec());
//! let relaxed = vec![-1.0; 16 * env.spec().action_size()];
//! env.step(&relaxed, out.buffers())?;
//! assert!(out.reward.iter().all(|r| r.is_finite()));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Actions lie in [-1, 1], one per muscle: -1 is no excitation, 1 is full (where a task's `control` is relative, what is added to the activation). A reset draws **everything** anew: pose,
//! velocities, activations, targets (fatigue, too, unless it lasts); phase and counters start at zero. The terminal observation is kept.
//!
//! What a task asks for stands in its script, or is code: [`Rules`] of one's own observe, judge and reward in its place.
//!
//! Who looks on takes a [`Snapshot`] of a few environments ([`VectorEnv::peek`]) and asks a [`Skeleton`] where everything is in it.
//!
//! This crate knows no neural network, no file, no picture and no Python.

mod batch;
mod check;
mod columns;
mod config;
mod control;
mod digits;
#[cfg(feature = "gpu")]
pub mod gpu;
mod job;
mod memory;
mod misjudge;
mod native;
mod observe;
mod parameters;
mod perceive;
mod precision;
pub mod record;
mod reseed;
mod rows;
mod rules;
mod saved;
mod single;
mod skeleton;
mod snapshot;
mod state;
mod storage;
mod tables;
mod trace;
mod vector;

pub use batch::{BatchEnv, CpuEnv, ReferenceEnv};
pub use columns::Column;
pub use config::{BuildError, EnvConfig, MOST_THREADS};
pub use control::{EPISODE_COLUMNS, TARGET_COLUMNS, excitation};
pub use digits::Digit;
#[cfg(feature = "gpu")]
pub use gpu::GpuEnv;
pub use memory::MOST_ENVS;
pub use native::NotCompiled;
pub use observe::ObservationPart;
pub use parameters::{Parameters, Poses, Start, World};
pub use precision::{Job, Precision};
pub use reseed::reseed;
pub use rules::{Ball, Moment, RULES_COLUMNS, Rules, Verdict};
pub use single::{Env, Step};
pub use skeleton::{Bone, MusclePose, ObjectPose, Role, Skeleton, SkeletonPose};
pub use snapshot::Snapshot;
pub use tables::Tables;
pub use trace::{TraceSample, TraceShape};
pub use vector::{Autoreset, EnvError, EnvSpec, StepBuffers, StepStorage, VectorEnv};
