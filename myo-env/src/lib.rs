//! Vectorised environment: observation, action, noise, reset.
mod vector;

pub use vector::{Autoreset, EnvError, EnvSpec, StepBuffers, StepStorage, VectorEnv};
