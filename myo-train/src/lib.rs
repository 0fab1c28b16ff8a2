//! PPO, metrics, checkpoints, evaluation.
//!
//! [`Trainer`] collects experience in a [`VectorEnv`](myo_env::VectorEnv) and learns from it, [`Policy`] acts,
//! [`evaluate`] tells how well, [`RunWriter`] keeps what happened; a [`Session`] joins them to a training that stops at its
//! goal, heals itself and tells where it leads. Every setting is in [`PpoConfig`]. The crate knows
//! nothing of muscles, tasks or the command line. In [`gpu`], the policy acts and learns on the graphics card beside the
//! environment, behind [`Trainer::on_card`]; [`gpu::DeviceEvaluator`] evaluates there.
//!
//! ```
//! use std::path::Path;
//!
//! use myo_env::VectorEnv;
//! use myo_train::session::{Examiner, Goal, Until};
//! use myo_train::{PpoConfig, RunWriter, Session, Trainer};
//!
//! fn train(
//!     training_env: Box<dyn VectorEnv>,
//!     fresh_env: Box<dyn VectorEnv>,
//! ) -> Result<(), Box<dyn std::error::Error>> {
//!     let (config, seed) = (PpoConfig::default(), 1);
//!     let trainer = Trainer::new(training_env, config, seed)?;
//!     let description = serde_json::json!({ "task": "pointing" });
//!     let run = RunWriter::create(Path::new("my-run"), description, trainer.config(), seed, trainer.spec())?;
//!     let goal = Goal { until: Until::Success(0.95), steps: 10_000_000 };
//!     let mut session = Session::new(trainer, Examiner::on_host(fresh_env, seed), goal)?.recorded_in(run)?;
//!     let end = loop {
//!         let progress = session.advance(&|| true)?;
//!         println!("{:?}", progress.success);
//!         if let Some(end) = progress.end {
//!             break end;
//!         }
//!     };
//!     println!("{:?}", session.conclude(end, &|| true)?.evaluation);
//!     Ok(())
//! }
//! ```
mod checkpoint;
mod config;
mod device;
mod error;
mod evaluate;
mod files;
mod gae;
mod gaussian;
pub mod gpu;
mod inherit;
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
pub mod session;
mod simd;
pub mod statistics;
mod tensorboard;
mod trainer;
mod weights;

pub use checkpoint::{Checkpoint, CheckpointError};
pub use config::{ConfigError, PpoConfig, saved_settings};
pub use error::TrainError;
pub use evaluate::{Evaluation, TargetEvaluation, evaluate};
pub use files::{IoError, write_whole};
pub use gae::advantages;
pub use inherit::Inherited;
pub use learn::LearnStats;
pub use metrics::{Episodes, FIRST_COLUMNS, LAST_COLUMNS, LAYOUT_COLUMN, UpdateMetrics};
pub use mlp::{Mlp, MlpWork};
pub use normalizer::{Moments, Normalizer};
pub use policy::Policy;
pub use run::{LatestCheckpoint, RunClaim, RunConfig, RunError, RunFolder, RunWriter};
pub use session::Session;
pub use tensorboard::EventFile;
pub use trainer::{Member, Trainer};
pub use weights::{LayerWeights, PolicyWeights, WeightsError};
