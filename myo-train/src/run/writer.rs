//! A run folder in which training goes on.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::thread;
use std::time::Duration;

use myo_env::EnvSpec;

use super::metrics_file::MetricsFile;
use super::{CONFIG, FORMAT, LOCK, RunConfig, RunError, RunFolder};
use crate::files::{IoError, remove_if_there, sync_folder, write_json};
use crate::tensorboard::EventFile;
use crate::{Checkpoint, CheckpointError, PpoConfig, UpdateMetrics};

/// Checkpoints kept; more than one, so that a damaged one does not end the run.
const CHECKPOINTS_KEPT: usize = 3;

/// How often a lock is tried again that is taken, and after what time.
const LOOKS: u32 = 10;
const MOMENT: Duration = Duration::from_millis(10);

/// A run in which no other process can train: what is read of it now still holds when training goes on.
#[derive(Debug)]
pub struct RunClaim {
    folder: RunFolder,
    lock: File,
}

impl RunClaim {
    /// Opens a run and takes its lock.
    ///
    /// # Errors
    /// As for [`RunFolder::open`], or another process trains there.
    pub fn take(path: &Path) -> Result<Self, RunError> {
        // No lock appears where there is no run.
        RunFolder::open(path)?;
        let lock = lock(path)?;
        // Whoever held it before may have changed the description.
        Ok(Self { folder: RunFolder::open(path)?, lock })
    }

    /// The run.
    pub fn folder(&self) -> &RunFolder {
        &self.folder
    }

    /// Changes the caller's description of the run, `run` in `config.json`; settings and seed stay.
    ///
    /// # Errors
    /// The file cannot be written; the old description is still there then.
    pub fn describe(&mut self, run: serde_json::Value) -> Result<(), RunError> {
        let config = RunConfig { run, ..self.folder.config.clone() };
        write_json(&self.folder.path.join(CONFIG), &config)?;
        self.folder.config = config;
        Ok(())
    }

    /// Goes on with the run from `env_steps`, the step of the checkpoint that training resumes from (0 without one): what
    /// was recorded after it is cut off, so that the files end as if the run had never stopped.
    ///
    /// # Errors
    /// A file cannot be read or written, or the metrics are not those of this run.
    pub fn resume(self, env_steps: u64, spec: &EnvSpec) -> Result<RunWriter, RunError> {
        let Self { folder, lock } = self;
        let columns = UpdateMetrics::columns(spec);
        let checkpoints = folder.path.join("checkpoints");
        fs::create_dir_all(&checkpoints).map_err(|source| IoError::new("create", &checkpoints, source))?;
        let (metrics, events) = cut(&folder, &columns, env_steps)?;
        // Where the last process was stopped between writing one and removing another.
        remove_older(&folder, env_steps)?;
        Ok(RunWriter { metrics, events, folder, columns, _lock: lock })
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
    /// Makes a new folder; refuses one that holds anything, but for what a training leaves that was stopped while it made
    /// its folder.
    ///
    /// # Errors
    /// The folder is taken or cannot be written.
    pub fn create(
        path: &Path,
        run: serde_json::Value,
        ppo: &PpoConfig,
        seed: u64,
        spec: &EnvSpec,
    ) -> Result<Self, RunError> {
        make_folder(path)?;
        let lock = lock(path)?;
        // Between the two, another process may have made a run of it.
        let file = path.join(CONFIG);
        if file.exists() {
            return Err(exists(path));
        }
        let config = RunConfig { format: FORMAT, run, ppo: ppo.clone(), seed };
        // First: a folder with a description can be gone on with, whatever else is missing.
        write_json(&file, &config)?;
        sync_folder(path.parent()).map_err(|source| IoError::new("create", path, source))?;
        RunClaim { folder: RunFolder { path: path.to_owned(), config }, lock }.resume(0, spec)
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
    ///
    /// # Errors
    /// A file cannot be written. What it holds of the row is cut off when the run goes on.
    ///
    /// # Panics
    /// If the episode columns are not those that the run began with.
    pub fn record(&mut self, metrics: &UpdateMetrics) -> Result<(), RunError> {
        let row = metrics.row();
        assert_eq!(row.len(), self.columns.len(), "the episode columns changed during the run");
        self.metrics.append(&row)?;
        let tags = self.columns.iter().map(String::as_str).zip(row);
        Ok(self.events.write(metrics.env_steps, tags.skip(1))?)
    }

    /// Writes a checkpoint and removes what it makes old: all but the last few before it, and the evaluation of another.
    ///
    /// # Errors
    /// A file cannot be written, or a weight is not finite.
    pub fn write_checkpoint(&mut self, checkpoint: &Checkpoint) -> Result<PathBuf, RunError> {
        // What the checkpoint stands on must not be lost before it.
        self.metrics.sync()?;
        let path = self.folder.checkpoint_path(checkpoint.env_steps());
        // Before: should that be all that is done, the evaluation is made again from its checkpoint.
        remove_if_there(&self.folder.evaluation_path())?;
        checkpoint.write(&path).map_err(|error| match error {
            CheckpointError::Io(error) => error.into(),
            reason => RunError::Checkpoint { path: path.clone(), reason },
        })?;
        remove_older(&self.folder, checkpoint.env_steps())?;
        Ok(path)
    }
}

/// Removes all checkpoints but that of `env_steps` and the last few before it.
fn remove_older(folder: &RunFolder, env_steps: u64) -> Result<(), RunError> {
    let mut older = folder.numbered_checkpoints()?;
    older.retain(|(steps, _)| *steps < env_steps);
    Ok(older.iter().skip(CHECKPOINTS_KEPT - 1).try_for_each(|(_, old)| remove_if_there(old))?)
}

/// Removes what came after `env_steps`; the files that go on from there.
fn cut(folder: &RunFolder, columns: &[String], env_steps: u64) -> Result<(MetricsFile, EventFile), RunError> {
    // Metrics first: should they be refused, nothing is lost.
    let metrics = MetricsFile::resume(&folder.path.join("metrics.csv"), columns, env_steps)?;
    for (_, file) in folder.numbered_checkpoints()?.into_iter().filter(|(steps, _)| *steps > env_steps) {
        remove_if_there(&folder.evaluation_path())?;
        remove_if_there(&file)?;
    }
    Ok((metrics, EventFile::resume(&folder.path.join("tensorboard"), env_steps)?))
}

/// Makes the folder of a run, or takes one that is as good as empty.
fn make_folder(path: &Path) -> Result<(), RunError> {
    let error = |source| IoError::new("create", path, source);
    if let Some(parent) = path.parent() {
        fs::create_dir_all(parent).map_err(error)?;
    }
    match fs::create_dir(path) {
        Err(source) if source.kind() == ErrorKind::AlreadyExists => {
            if is_vacant(path) {
                Ok(())
            } else {
                Err(exists(path))
            }
        }
        made => Ok(made.map_err(error)?),
    }
}

/// Whether a folder holds nothing, or what is there before a run's description is.
fn is_vacant(path: &Path) -> bool {
    let is_remnant = |name: &std::ffi::OsStr| name == LOCK || name == "config.json.part";
    fs::read_dir(path)
        .is_ok_and(|mut entries| entries.all(|entry| entry.is_ok_and(|entry| is_remnant(&entry.file_name()))))
}

fn exists(path: &Path) -> RunError {
    RunError::Exists { path: path.to_owned(), free: free_name(path) }
}

/// Takes the lock of a run; the system gives it back when the process ends, however it ends.
fn lock(run: &Path) -> Result<File, RunError> {
    let path = run.join(LOCK);
    let error = |source| IoError::new("lock", &path, source);
    let file = OpenOptions::new().create(true).append(true).open(&path).map_err(error)?;
    let mut taken = file.try_lock();
    for _ in 0..LOOKS {
        // Who only asks whether somebody trains holds it for a moment.
        let Err(TryLockError::WouldBlock) = taken else { break };
        thread::sleep(MOMENT);
        taken = file.try_lock();
    }
    match taken {
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
