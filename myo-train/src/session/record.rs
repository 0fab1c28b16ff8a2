//! What a session leaves in its run folder.

use std::time::{Duration, Instant};

use crate::{RunError, RunFolder, RunWriter, Trainer, UpdateMetrics};

/// Time between two checkpoints: what a crash may cost.
const CHECKPOINT_EVERY: Duration = Duration::from_secs(30);

/// A run folder and what is in it already.
#[derive(Debug)]
pub struct Record {
    writer: RunWriter,
    last_checkpoint: Instant,
    /// Control steps that the newest checkpoint has seen; none before the first.
    saved: Option<u64>,
}

impl Record {
    /// Goes on with a folder whose newest checkpoint has seen `saved` control steps.
    pub fn new(writer: RunWriter, saved: Option<u64>) -> Self {
        Self { writer, last_checkpoint: Instant::now(), saved }
    }

    /// The folder.
    pub fn folder(&self) -> &RunFolder {
        self.writer.folder()
    }

    /// Hears of an update.
    pub fn hear(&mut self, metrics: &UpdateMetrics, trainer: &Trainer) -> Result<(), RunError> {
        self.writer.record(metrics)?;
        if self.last_checkpoint.elapsed() >= CHECKPOINT_EVERY {
            self.checkpoint(trainer)?;
        }
        Ok(())
    }

    /// Writes a checkpoint, unless the newest one is of this state: after a loss that one has the episodes, a new one
    /// would not.
    pub fn checkpoint(&mut self, trainer: &Trainer) -> Result<(), RunError> {
        let steps = Some(trainer.env_steps());
        if self.saved != steps {
            self.writer.write_checkpoint(&trainer.save())?;
            self.saved = steps;
        }
        self.last_checkpoint = Instant::now();
        Ok(())
    }

    /// Forgets what came after `env_steps`.
    pub fn go_back(&mut self, env_steps: u64) -> Result<(), RunError> {
        self.writer.go_back(env_steps)?;
        // What is there may be of that very state, but was written before the steps became shorter.
        self.saved = None;
        Ok(())
    }
}
