//! The folder of a training run.
//!
//! ```text
//! run/
//!   config.json       what was trained: the caller's description, the settings of PPO, the seed
//!   metrics.csv       one row per update, one named column per quantity
//!   tensorboard/      the same numbers as TensorBoard events
//!   checkpoints/      step_000001638400.ckpt, ...: the last few
//!   evaluation.json   results of the deterministic policy
//!   lock              held while someone trains here
//! ```

mod metrics_file;
mod writer;

use std::fs::{self, TryLockError};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::files::{IoError, write_json};
use crate::{Checkpoint, CheckpointError, Evaluation, PpoConfig};

pub use writer::{RunClaim, RunWriter};

/// The layout of run folders that this program knows.
const FORMAT: u32 = 1;

/// The file that describes a run.
const CONFIG: &str = "config.json";

/// The file that is locked while someone trains.
const LOCK: &str = "lock";

/// What `config.json` holds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunConfig {
    /// Layout of the run folder, 1.
    pub format: u32,
    /// The caller's description: task, model, backend.
    pub run: serde_json::Value,
    /// Settings of PPO.
    #[serde(deserialize_with = "crate::saved_settings")]
    pub ppo: PpoConfig,
    /// Seed of the training.
    pub seed: u64,
}

/// Why a run folder cannot be used.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RunError {
    /// The name is taken.
    #[error("{} exists already, and runs are never overwritten. Choose another folder, for example {}", path.display(), free.display())]
    Exists {
        /// The folder.
        path: PathBuf,
        /// A name that is not taken.
        free: PathBuf,
    },
    /// The folder is not there or holds no run.
    #[error("{} is not a run folder: it has no config.json", path.display())]
    NotARun {
        /// The folder.
        path: PathBuf,
    },
    /// A training was stopped while it made its folder.
    #[error(
        "{} holds nothing to go on with: the training that made it was stopped before it wrote config.json. Start it again \
         with this folder, or remove it",
        path.display()
    )]
    Unfinished {
        /// The folder.
        path: PathBuf,
    },
    /// The description, or the evaluation, cannot be read.
    #[error("cannot understand {}: {reason}", path.display())]
    BadConfig {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// Runs do not belong together.
    #[error("{reason}")]
    Incomparable {
        /// Why.
        reason: String,
    },
    /// Another process trains there.
    #[error("another process is training in {}", path.display())]
    Busy {
        /// The folder.
        path: PathBuf,
    },
    /// A file operation failed.
    #[error(transparent)]
    Io(#[from] IoError),
    /// The metrics are not those of this run, or were changed.
    #[error("cannot go on with {}: {reason}. Move it away, and a new table begins", path.display())]
    BadMetrics {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// A checkpoint cannot be written, or one that may be whole cannot be read.
    #[error("cannot use {}: {reason}", path.display())]
    Checkpoint {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: CheckpointError,
    },
}

/// A run folder for reading.
#[derive(Clone, Debug)]
pub struct RunFolder {
    path: PathBuf,
    config: RunConfig,
}

/// The newest checkpoint that can be read, and the newer ones that are damaged.
#[derive(Debug, Default)]
pub struct LatestCheckpoint {
    /// The checkpoint; none if there is none, or none is whole.
    pub checkpoint: Option<Checkpoint>,
    /// Files that were refused, newest first, with the reason.
    pub refused: Vec<(PathBuf, CheckpointError)>,
}

impl RunConfig {
    /// Refuses what no training could have begun with.
    fn check(&self) -> Result<(), String> {
        if self.format != FORMAT {
            return Err(format!("format is {}; this program knows run folders of format {FORMAT}", self.format));
        }
        self.ppo.validate().map_err(|error| error.to_string())
    }

    /// Refuses a checkpoint of another training. The bounds of the step size may have become narrower in the run.
    fn check_checkpoint(&self, checkpoint: &Checkpoint) -> Result<(), String> {
        let rates = (self.ppo.learning_rate, self.ppo.learning_rate_max);
        let mut ppo = checkpoint.config().clone();
        (ppo.learning_rate, ppo.learning_rate_max) = rates;
        let differ = |name: &str, here: &serde_json::Value, there: &serde_json::Value| {
            Err(format!("{name} is {here}, but {there} in its checkpoints; the settings of a run cannot be changed"))
        };
        if self.seed != checkpoint.seed() {
            return differ("seed", &self.seed.into(), &checkpoint.seed().into());
        }
        let [here, there] = [&self.ppo, &ppo].map(|ppo| serde_json::to_value(ppo).unwrap_or_default());
        let mut names = here.as_object().into_iter().flatten();
        names.find(|(name, value)| there[*name] != **value).map_or(Ok(()), |(name, x)| differ(name, x, &there[name]))
    }
}

impl RunFolder {
    /// Opens a run.
    ///
    /// # Errors
    /// No run is there, or its description is not one that a training could have begun with.
    pub fn open(path: &Path) -> Result<Self, RunError> {
        let file = path.join(CONFIG);
        let text = match fs::read(&file) {
            Err(source) if source.kind() == ErrorKind::NotFound => {
                let path = path.to_owned();
                let is_unfinished = path.join(LOCK).exists();
                return Err(if is_unfinished { RunError::Unfinished { path } } else { RunError::NotARun { path } });
            }
            text => text.map_err(|source| IoError::new("read", &file, source))?,
        };
        let config = serde_json::from_slice::<RunConfig>(&text).map_err(|error| error.to_string());
        let config = config.and_then(|config| config.check().map(|()| config));
        let config = config.map_err(|reason| RunError::BadConfig { path: file, reason })?;
        Ok(Self { path: path.to_owned(), config })
    }

    /// Where the run is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// What is trained.
    pub fn config(&self) -> &RunConfig {
        &self.config
    }

    /// The checkpoint files that the run wrote, newest first; not what else may lie beside them.
    ///
    /// # Errors
    /// The folder cannot be read.
    pub fn checkpoints(&self) -> Result<Vec<PathBuf>, IoError> {
        Ok(self.numbered_checkpoints()?.into_iter().map(|(_, path)| path).collect())
    }

    /// Control steps of all environments up to the newest checkpoint, damaged or not; 0 before the first.
    ///
    /// # Errors
    /// The folder cannot be read.
    pub fn env_steps(&self) -> Result<u64, IoError> {
        Ok(self.numbered_checkpoints()?.first().map_or(0, |(steps, _)| *steps))
    }

    /// Whether a process trains here now.
    pub fn is_training(&self) -> bool {
        // Shared, so that those who look do not see each other. Where nothing can be locked nobody knows.
        let lock = fs::File::open(self.path.join(LOCK));
        lock.is_ok_and(|lock| matches!(lock.try_lock_shared(), Err(TryLockError::WouldBlock)))
    }

    /// When something of it was last written: a row of metrics, a checkpoint, the evaluation, the description.
    ///
    /// # Errors
    /// The folder cannot be read.
    pub fn changed(&self) -> Result<SystemTime, IoError> {
        let files = [CONFIG, "metrics.csv", "evaluation.json", "checkpoints"].map(|name| self.path.join(name));
        let time = |path: &PathBuf| fs::metadata(path).and_then(|file| file.modified());
        let newest = files.iter().filter_map(|path| time(path).ok()).max();
        newest.map_or_else(|| time(&files[0]).map_err(|source| IoError::new("read", &files[0], source)), Ok)
    }

    /// Control steps and file of every checkpoint that the run wrote, newest first.
    ///
    /// # Errors
    /// The folder cannot be read.
    pub fn numbered_checkpoints(&self) -> Result<Vec<(u64, PathBuf)>, IoError> {
        let folder = self.path.join("checkpoints");
        let error = |source| IoError::new("read", &folder, source);
        let entries = match fs::read_dir(&folder) {
            Err(source) if source.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
            entries => entries.map_err(error)?,
        };
        let mut found = Vec::new();
        for entry in entries {
            let path = entry.map_err(error)?.path();
            found.extend(checkpoint_steps(&path).map(|steps| (steps, path)));
        }
        found.sort_by(|a, b| b.cmp(a));
        Ok(found)
    }

    fn checkpoint_path(&self, env_steps: u64) -> PathBuf {
        self.path.join("checkpoints").join(format!("step_{env_steps:012}.ckpt"))
    }

    /// The newest checkpoint that is whole.
    ///
    /// # Errors
    /// The folder or a checkpoint cannot be read, or is of a newer program: that says nothing against what it holds, and an
    /// older checkpoint in its place would undo what was learned since. And settings other than those of `config.json`.
    pub fn latest_checkpoint(&self) -> Result<LatestCheckpoint, RunError> {
        let mut latest = LatestCheckpoint::default();
        for path in self.checkpoints()? {
            match Checkpoint::read(&path) {
                Ok(checkpoint) => {
                    let same = self.config.check_checkpoint(&checkpoint);
                    let path = self.path.join(CONFIG);
                    same.map_err(|reason| RunError::BadConfig { path, reason })?;
                    latest.checkpoint = Some(checkpoint);
                    break;
                }
                Err(error) if error.is_damage() => latest.refused.push((path, error)),
                // A training that goes on removes old ones.
                Err(CheckpointError::Io(error)) if error.source.kind() == ErrorKind::NotFound => {}
                Err(CheckpointError::Io(error)) => return Err(error.into()),
                Err(reason) => return Err(RunError::Checkpoint { path, reason }),
            }
        }
        Ok(latest)
    }

    /// Writes `evaluation.json`.
    pub fn write_evaluation(&self, evaluation: &Evaluation) -> Result<(), RunError> {
        Ok(write_json(&self.evaluation_path(), evaluation)?)
    }

    /// Whether there is an evaluation; it is that of the newest checkpoint.
    ///
    /// # Errors
    /// The folder cannot be read.
    pub fn has_evaluation(&self) -> Result<bool, IoError> {
        let path = self.evaluation_path();
        path.try_exists().map_err(|source| IoError::new("read", &path, source))
    }

    /// The evaluation of the newest checkpoint, if it was made.
    ///
    /// # Errors
    /// It cannot be read, or is none.
    pub fn evaluation(&self) -> Result<Option<Evaluation>, RunError> {
        let path = self.evaluation_path();
        if !self.has_evaluation()? {
            return Ok(None);
        }
        let text = fs::read(&path).map_err(|source| IoError::new("read", &path, source))?;
        serde_json::from_slice(&text).map(Some).map_err(|error| RunError::BadConfig { path, reason: error.to_string() })
    }

    fn evaluation_path(&self) -> PathBuf {
        self.path.join("evaluation.json")
    }
}

/// Control steps in the name of a checkpoint, if it is one that a run gives.
fn checkpoint_steps(path: &Path) -> Option<u64> {
    let digits = path.file_name()?.to_str()?.strip_prefix("step_")?.strip_suffix(".ckpt")?;
    let is_ours = digits.len() >= 12 && digits.bytes().all(|digit| digit.is_ascii_digit());
    is_ours.then(|| digits.parse().ok())?
}
