//! What commands need of a run folder.

use std::path::Path;

use myo::tasks::Task;
use myo::train::{Checkpoint, RunFolder};
use myo::{RunDescription, layout_names};

use super::failure::{Failure, Result, complain};
use super::output::{argument, command, grouped, name};

/// The task that was trained in a run folder; the first of several layouts, of which the user is told.
pub fn run_task(path: &Path) -> Result<Task> {
    let run = RunDescription::of(&RunFolder::open(path)?)?;
    if !run.other_layouts.is_empty() {
        let names: Vec<String> = layout_names(&run.layouts()).iter().map(|layout| name(layout)).collect();
        complain(&format!("the first of {} layouts: {}", names.len(), names.join(", ")));
    }
    Ok(run.task)
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
