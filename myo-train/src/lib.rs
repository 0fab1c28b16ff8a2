//! PPO, metrics, checkpoints, evaluation.
//!
//! [`Trainer`] collects experience in a [`VectorEnv`](myo_env::VectorEnv) and learns from it; [`Policy`] acts. Settings
//! are in [`PpoConfig`]. The crate knows nothing of muscles, tasks or the command line.
mod checkpoint;
mod config;
mod crc32c;
mod error;
mod evaluate;
mod files;
mod gae;
mod gaussian;
mod kernels;
mod learn;
mod metrics;
mod mlp;
mod networks;
mod normalizer;
mod policy;
mod random;
mod rollout;
mod run;
mod simd;
mod tensorboard;
mod trainer;

pub use checkpoint::{Checkpoint, CheckpointError};
pub use config::{ConfigError, PpoConfig};
pub use error::TrainError;
pub use evaluate::{Evaluation, TargetEvaluation, evaluate};
pub use files::IoError;
pub use learn::LearnStats;
pub use metrics::UpdateMetrics;
pub use mlp::{Mlp, MlpWork};
pub use normalizer::{Moments, Normalizer};
pub use policy::Policy;
pub use run::{LatestCheckpoint, RunConfig, RunError, RunFolder, RunWriter};
pub use tensorboard::EventFile;
pub use trainer::Trainer;
