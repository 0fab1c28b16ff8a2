//! What a session leaves in its run folder.

use std::time::{Duration, Instant};

use crate::{Checkpoint, RunError, RunFolder, RunWriter, UpdateMetrics};

/// Time between two checkpoints, unless asked otherwise: what a crash may cost.
const CHECKPOINT_EVERY: Duration = Duration::from_secs(30);

/// A run folder and what is in it already.
#[derive(Debug)]
pub struct Record {
    writer: RunWriter,
    every: Duration,
    last_checkpoint: Instant,
    /// Whether the newest checkpoint is of an earlier state.
    changed: bool,
}

impl Record {
    /// Goes on with a folder; `is_saved` tells whether its newest checkpoint is of the present state.
    pub fn new(writer: RunWriter, is_saved: bool) -> Self {
        Self { writer, every: CHECKPOINT_EVERY, last_checkpoint: Instant::now(), changed: !is_saved }
    }

    /// Sets the time between two checkpoints.
    pub fn every(&mut self, time: Duration) {
        self.every = time;
    }

    /// The folder.
    pub fn folder(&self) -> &RunFolder {
        self.writer.folder()
    }

    /// Hears of an update.
    pub fn hear(&mut self, metrics: &UpdateMetrics) -> Result<(), RunError> {
        self.changed = true;
        self.writer.record(metrics)
    }

    /// Hears that the state is another than that of the newest checkpoint.
    pub fn changed(&mut self) {
        self.changed = true;
    }

    /// Whether the newest checkpoint is of an earlier state.
    pub fn has_changed(&self) -> bool {
        self.changed
    }

    /// Whether it is time for a checkpoint.
    pub fn is_due(&self) -> bool {
        self.changed && self.last_checkpoint.elapsed() >= self.every
    }

    /// Writes a checkpoint.
    pub fn checkpoint(&mut self, checkpoint: &Checkpoint) -> Result<(), RunError> {
        self.writer.write_checkpoint(checkpoint)?;
        self.changed = false;
        self.last_checkpoint = Instant::now();
        Ok(())
    }

    /// Forgets what came after `env_steps`.
    pub fn go_back(&mut self, env_steps: u64) -> Result<(), RunError> {
        self.writer.go_back(env_steps)
    }
}
