//! What can go wrong in training.

use myo_env::EnvError;
use thiserror::Error;

use crate::ConfigError;

/// Why training cannot start or go on.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum TrainError {
    /// A hyperparameter is out of range.
    #[error("bad training setting: {0}")]
    Config(#[from] ConfigError),
    /// The environment refused a call.
    #[error("the environment refused: {0}")]
    Env(#[from] EnvError),
    /// The graphics card failed. After a loss of the device, go on from a checkpoint.
    #[error(transparent)]
    Gpu(#[from] myo_gpu::GpuError),
    /// The environment does not fit the settings or the policy.
    #[error("the environment does not fit: {what} is {got}, expected {expected}")]
    Mismatch {
        /// Which property.
        what: &'static str,
        /// Of the environment.
        got: String,
        /// Of the settings or the policy.
        expected: String,
    },
    /// The memory that training takes is not there.
    #[error(
        "training with these settings takes {:.1} GB of memory, which cannot be had; lower num_envs, rollout_s, or the \
         widths of the networks",
        *bytes as f64 / 1e9
    )]
    Memory {
        /// What is needed at least.
        bytes: u64,
    },
    /// The environment returned a number that is not finite.
    #[error("the environment returned a NaN or infinite {what} in update {update}")]
    NonFiniteEnv {
        /// Which output: the reward or the name of an observation.
        what: String,
        /// Updates finished before.
        update: u64,
    },
    /// Learning ran away.
    #[error(
        "training diverged in update {update}: {what} is not finite. Go back to a checkpoint or start again with a lower \
         learning_rate or kl_target"
    )]
    Diverged {
        /// Which quantity.
        what: &'static str,
        /// Updates finished before.
        update: u64,
    },
    /// A checkpoint cannot be used.
    #[error(transparent)]
    Checkpoint(#[from] crate::CheckpointError),
}
