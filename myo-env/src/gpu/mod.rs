//! The environment on a graphics card: one thread per environment, two dispatches per control step, of which the second resets whose episode is over.
//!
//! Numbers stay on the card, entry `row` of environment `env` at `row * environments + env`. [`GpuEnv`] is the
//! [`VectorEnv`](crate::VectorEnv) that copies actions in and results out; [`Shard`]s are what a learner on the card works
//! with, without copies.

mod cells;
mod columns;
mod env;
mod physics;
mod program;
mod shard;
mod size;

pub use crate::record;
pub use env::GpuEnv;
pub use physics::PhysicsBench;
pub use shard::{GpuOptions, Kernels, Shard};
