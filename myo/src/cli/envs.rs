//! Environments where they were placed, and their trainers.

use myo::env::{CpuEnv, GpuEnv, VectorEnv};
use myo::train::{Checkpoint, PpoConfig, TrainError, Trainer};

/// Environments of one backend.
pub enum Envs {
    /// On the processor.
    Cpu(Box<CpuEnv>),
    /// On a graphics card.
    Gpu(Box<GpuEnv>),
}

impl Envs {
    /// The environments, whatever they are.
    pub fn as_mut(&mut self) -> &mut dyn VectorEnv {
        match self {
            Self::Cpu(env) => env.as_mut(),
            Self::Gpu(env) => env.as_mut(),
        }
    }

    /// A trainer with a new policy, which acts where the environments are.
    pub fn train(self, config: PpoConfig, seed: u64) -> Result<Trainer, TrainError> {
        match self {
            Self::Cpu(env) => Trainer::new(env, config, seed),
            Self::Gpu(env) => Trainer::on_card(*env, config, seed),
        }
    }

    /// A trainer that goes on from a checkpoint, of this backend or another.
    pub fn go_on(self, checkpoint: &Checkpoint) -> Result<Trainer, TrainError> {
        match self {
            Self::Cpu(env) => Trainer::restore(env, checkpoint),
            Self::Gpu(env) => Trainer::restore_on_card(*env, checkpoint),
        }
    }
}
