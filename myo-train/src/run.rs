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

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::Write;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::files::{IoError, write_atomically};
use crate::tensorboard::EventFile;
use crate::{Checkpoint, CheckpointError, Evaluation, PpoConfig, UpdateMetrics};

/// Checkpoints kept; more than one, so that a damaged one does not end the run.
const CHECKPOINTS_KEPT: usize = 3;

/// What `config.json` holds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunConfig {
    /// Layout of the run folder, 1.
    pub format: u32,
    /// The caller's description: task, model, backend.
    pub run: serde_json::Value,
    /// Settings of PPO.
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
    /// The description cannot be read.
    #[error("cannot understand {}: {reason}", path.display())]
    BadConfig {
        /// The file.
        path: PathBuf,
        /// What is wrong.
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
    /// A checkpoint cannot be written.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
}

/// A run folder for reading.
#[derive(Clone, Debug)]
pub struct RunFolder {
    path: PathBuf,
    config: RunConfig,
}

/// The newest checkpoint that can be read, and the newer ones that cannot.
#[derive(Debug, Default)]
pub struct LatestCheckpoint {
    /// The checkpoint; none if there is none, or none is whole.
    pub checkpoint: Option<Checkpoint>,
    /// Files that were refused, newest first, with the reason.
    pub refused: Vec<(PathBuf, CheckpointError)>,
}

impl RunFolder {
    /// Opens a run.
    pub fn open(path: &Path) -> Result<Self, RunError> {
        let file = path.join("config.json");
        let text = match fs::read(&file) {
            Err(source) if source.kind() == std::io::ErrorKind::NotFound => {
                return Err(RunError::NotARun { path: path.to_owned() });
            }
            text => text.map_err(|source| IoError::new("read", &file, source))?,
        };
        let config = serde_json::from_slice(&text)
            .map_err(|error| RunError::BadConfig { path: file, reason: error.to_string() })?;
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

    /// Checkpoint files, newest first.
    pub fn checkpoints(&self) -> Vec<PathBuf> {
        let entries = fs::read_dir(self.path.join("checkpoints")).into_iter().flatten();
        let mut paths: Vec<_> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
        paths.retain(|path| path.extension().is_some_and(|extension| extension == "ckpt"));
        // Steps are written with leading zeros: the order of the names is that of the steps.
        paths.sort_by(|a, b| b.cmp(a));
        paths
    }

    /// The newest checkpoint that is whole.
    pub fn latest_checkpoint(&self) -> LatestCheckpoint {
        let mut latest = LatestCheckpoint::default();
        for path in self.checkpoints() {
            match Checkpoint::read(&path) {
                Ok(checkpoint) => {
                    latest.checkpoint = Some(checkpoint);
                    break;
                }
                Err(error) => latest.refused.push((path, error)),
            }
        }
        latest
    }

    /// Writes `evaluation.json`.
    pub fn write_evaluation(&self, evaluation: &Evaluation) -> Result<(), RunError> {
        Ok(write_json(&self.path.join("evaluation.json"), evaluation)?)
    }
}

/// A run folder in which training goes on; holds its lock.
#[derive(Debug)]
pub struct RunWriter {
    folder: RunFolder,
    metrics: MetricsFile,
    events: EventFile,
    /// Columns of the metrics.
    columns: Vec<String>,
    /// Unlocked when it is closed.
    _lock: File,
}

impl RunWriter {
    /// Makes a new folder; refuses one that exists.
    pub fn create(
        path: &Path,
        run: serde_json::Value,
        ppo: &PpoConfig,
        seed: u64,
        episode_names: &[String],
    ) -> Result<Self, RunError> {
        let error = |source| IoError::new("create", path, source);
        if let Some(parent) = path.parent() {
            fs::create_dir_all(parent).map_err(error)?;
        }
        match fs::create_dir(path) {
            Err(source) if source.kind() == std::io::ErrorKind::AlreadyExists => {
                return Err(RunError::Exists { path: path.to_owned(), free: free_name(path) });
            }
            made => made.map_err(error)?,
        }
        let lock = lock(path)?;
        let checkpoints = path.join("checkpoints");
        fs::create_dir(&checkpoints).map_err(|source| IoError::new("create", &checkpoints, source))?;
        let config = RunConfig { format: 1, run, ppo: ppo.clone(), seed };
        write_json(&path.join("config.json"), &config)?;
        let columns: Vec<String> = UpdateMetrics::columns(episode_names).map(String::from).collect();
        Ok(Self {
            metrics: MetricsFile::create(&path.join("metrics.csv"), &columns)?,
            events: EventFile::create(&path.join("tensorboard"))?,
            folder: RunFolder { path: path.to_owned(), config },
            columns,
            _lock: lock,
        })
    }

    /// Goes on with a run from `env_steps`, the step of the checkpoint that training resumes from (0 without one): what
    /// was recorded after it is cut off, so that the files end as if the run had never stopped.
    pub fn resume(path: &Path, env_steps: u64, episode_names: &[String]) -> Result<Self, RunError> {
        let folder = RunFolder::open(path)?;
        let lock = lock(path)?;
        let columns: Vec<String> = UpdateMetrics::columns(episode_names).map(String::from).collect();
        let (metrics, events) = cut(&folder, &columns, env_steps)?;
        Ok(Self { metrics, events, folder, columns, _lock: lock })
    }

    /// Cuts off what was recorded after `env_steps`, checkpoints included: training went back to that state.
    pub fn go_back(&mut self, env_steps: u64) -> Result<(), RunError> {
        (self.metrics, self.events) = cut(&self.folder, &self.columns, env_steps)?;
        Ok(())
    }

    /// The folder.
    pub fn folder(&self) -> &RunFolder {
        &self.folder
    }

    /// Appends one update to the metrics and to the TensorBoard events.
    pub fn record(&mut self, metrics: &UpdateMetrics) -> Result<(), RunError> {
        let row = metrics.row();
        assert_eq!(row.len(), self.columns.len(), "the episode columns changed during the run");
        self.metrics.append(&row)?;
        let tags = self.columns.iter().map(String::as_str).zip(row);
        Ok(self.events.write(metrics.env_steps, tags.skip(1))?)
    }

    /// Writes a checkpoint and removes all but the last few.
    pub fn write_checkpoint(&mut self, checkpoint: &Checkpoint) -> Result<PathBuf, RunError> {
        // What the checkpoint stands on must not be lost before it.
        self.metrics.sync()?;
        let path = checkpoint_path(&self.folder.path, checkpoint.env_steps());
        checkpoint.write(&path)?;
        for old in self.folder.checkpoints().into_iter().skip(CHECKPOINTS_KEPT) {
            fs::remove_file(&old).map_err(|source| IoError::new("remove", &old, source))?;
        }
        Ok(path)
    }
}

/// Removes what came after `env_steps`; the files that go on from there.
fn cut(folder: &RunFolder, columns: &[String], env_steps: u64) -> Result<(MetricsFile, EventFile), RunError> {
    let path = &folder.path;
    for file in folder.checkpoints() {
        if file > checkpoint_path(path, env_steps) {
            fs::remove_file(&file).map_err(|source| IoError::new("remove", &file, source))?;
        }
    }
    let metrics = MetricsFile::resume(&path.join("metrics.csv"), columns, env_steps)?;
    Ok((metrics, EventFile::resume(&path.join("tensorboard"), env_steps)?))
}

fn checkpoint_path(run: &Path, env_steps: u64) -> PathBuf {
    run.join("checkpoints").join(format!("step_{env_steps:012}.ckpt"))
}

/// Takes the lock of a run; the system gives it back when the process ends, however it ends.
fn lock(run: &Path) -> Result<File, RunError> {
    let path = run.join("lock");
    let error = |source| IoError::new("lock", &path, source);
    let file = OpenOptions::new().create(true).append(true).open(&path).map_err(error)?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => Err(RunError::Busy { path: run.to_owned() }),
        // A file system without locks must not forbid training.
        Err(TryLockError::Error(_)) => Ok(file),
    }
}

/// The first of `name-2`, `name-3`, ... that is not taken.
fn free_name(path: &Path) -> PathBuf {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let numbered = |n: u64| path.with_file_name(format!("{name}-{n}"));
    (2..).map(numbered).find(|path| !path.exists()).unwrap_or_else(|| numbered(2))
}

fn write_json(path: &Path, value: &impl Serialize) -> Result<(), IoError> {
    let mut text =
        serde_json::to_vec_pretty(value).map_err(|error| IoError::new("write", path, std::io::Error::other(error)))?;
    text.push(b'\n');
    write_atomically(path, &text)
}

/// One row per update, one column per quantity, as comma-separated values.
///
/// Text, because a table of a thousand rows and thirty columns is 300 kB, which every tool reads without a library, and
/// because a row can be appended with a single write: a process killed in the middle leaves at most one line without its
/// end, which resuming cuts off. The first column is the step, so rows can be matched with checkpoints. Numbers are
/// written with as few digits as give the same number back; NaN is an empty cell.
#[derive(Debug)]
struct MetricsFile {
    path: PathBuf,
    file: File,
}

impl MetricsFile {
    fn create(path: &Path, columns: &[String]) -> Result<Self, IoError> {
        write_atomically(path, format!("{}\n", columns.join(",")).as_bytes())?;
        Self::append_to(path)
    }

    fn append_to(path: &Path) -> Result<Self, IoError> {
        let file = OpenOptions::new().append(true).open(path).map_err(|source| IoError::new("open", path, source))?;
        Ok(Self { path: path.to_owned(), file })
    }

    /// Keeps the rows up to `env_steps`. A file that is missing or has other columns is started anew.
    fn resume(path: &Path, columns: &[String], env_steps: u64) -> Result<Self, IoError> {
        let text = fs::read_to_string(path).unwrap_or_default();
        let mut lines = text.split_inclusive('\n').filter(|line| line.ends_with('\n'));
        if lines.next().map(str::trim_end) != Some(&columns.join(",")) {
            return Self::create(path, columns);
        }
        let step = |line: &str| line.split(',').next().and_then(|cell| cell.parse::<u64>().ok());
        let header = columns.join(",") + "\n";
        let keep = lines.take_while(|line| step(line).is_some_and(|step| step <= env_steps));
        write_atomically(path, (header + &keep.collect::<String>()).as_bytes())?;
        Self::append_to(path)
    }

    fn append(&mut self, row: &[f64]) -> Result<(), IoError> {
        let cell = |x: &f64| if x.is_nan() { String::new() } else { x.to_string() };
        let line = row.iter().map(cell).collect::<Vec<_>>().join(",") + "\n";
        self.file.write_all(line.as_bytes()).map_err(|source| IoError::new("append to", &self.path, source))
    }

    fn sync(&self) -> Result<(), IoError> {
        self.file.sync_data().map_err(|source| IoError::new("write", &self.path, source))
    }
}
