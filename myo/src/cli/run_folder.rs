//! What commands need of a run folder.

use std::path::Path;

use myo::RunDescription;
use myo::tasks::Task;
use myo::train::{Checkpoint, RunFolder};

use super::failure::{Failure, Result, complain};
use super::output::{argument, command, grouped};

/// The task that was trained in a run folder.
pub fn run_task(path: &Path) -> Result<Task> {
    Ok(RunDescription::of(&RunFolder::open(path)?)?.task)
}

/// The newest checkpoint that is whole; refuses a run without one.
pub fn existing_checkpoint(run: &RunFolder) -> Result<Checkpoint> {
    newest_checkpoint(run)?.ok_or_else(|| {
        let next = command(&["train", "--resume", &argument(run.path())]);
        Failure::sentence(format!("{} has no checkpoint yet; go on with: {next}", run.path().display()))
    })
}

/// The newest checkpoint that is whole; tells about newer ones that are not. None if none was written yet.
pub fn newest_checkpoint(run: &RunFolder) -> Result<Option<Checkpoint>> {
    let latest = run.latest_checkpoint()?;
    for (path, reason) in &latest.refused {
        complain(&format!("warning: {} cannot be used: {reason}", path.display()));
    }
    match &latest.checkpoint {
        Some(checkpoint) if !latest.refused.is_empty() => {
            complain(&format!("the checkpoint of {} control steps is used instead", grouped(checkpoint.env_steps())));
        }
        None if !latest.refused.is_empty() => {
            let folder = run.path().display();
            return Err(Failure::sentence(format!("{folder} has no checkpoint that can be used; train it again")));
        }
        _ => {}
    }
    Ok(latest.checkpoint)
}
