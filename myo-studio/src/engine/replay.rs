//! Episodes of users that were trained.

use std::path::Path;

use myo_lab::RunDescription;
use myo_model::Model;
use myo_tasks::{Pose, Task};
use myo_train::{Checkpoint, RunFolder};

use super::actor::Actor;
use crate::protocol::{MotionHeader, Refusal, Replay};

/// The episode as a motion.
///
/// # Errors
/// The run cannot be read, or has no such checkpoint.
pub fn replay(folder: &Path, asked: &Replay) -> Result<(MotionHeader, Vec<f32>), Refusal> {
    let run = RunFolder::open(folder)?;
    let description = RunDescription::of(&run)?;
    let model = description.body()?;
    let checkpoint = checkpoint(&run, asked)?;
    let (mut policy, mut actor) = (checkpoint.policy(), Actor::new(&model, &description.task, asked.seed.into())?);
    let mut numbers = Vec::new();
    actor.push_frame(&mut numbers)?;
    let mut has_ended = false;
    while !has_ended {
        has_ended = actor.act(&mut policy)?;
        actor.push_frame(&mut numbers)?;
    }
    Ok((header(&actor, checkpoint.env_steps()), numbers))
}

/// The user as it stands there at rest, with the objects of a task, as a motion of one frame.
///
/// # Errors
/// The task cannot be simulated.
pub fn moment(model: &Model, task: &Task) -> Result<(MotionHeader, Vec<f32>), Refusal> {
    let (actor, mut numbers) = (Actor::new(model, &at_rest(task), 1)?, Vec::new());
    actor.push_frame(&mut numbers)?;
    Ok((header(&actor, 0), numbers))
}

/// The same task, in which the arm hangs at first. How episodes begin is drawn at random: nobody stands like that before a layout.
pub fn at_rest(task: &Task) -> Task {
    let mut task = task.clone();
    task.reset.pose = Pose::Zero;
    task
}

fn header(actor: &Actor, env_steps: u64) -> MotionHeader {
    let layout = actor.layout();
    let (frame_s, frame_size) = (actor.frame_s(), layout.frame_size());
    MotionHeader { id: None, job: None, env_steps, frame_s, frame_size, layout }
}

/// The checkpoint that is asked for.
fn checkpoint(run: &RunFolder, asked: &Replay) -> Result<Checkpoint, Refusal> {
    let Some(env_steps) = asked.env_steps else {
        let none = || Refusal::sentence(format!("{} has no checkpoint yet; let it train for some seconds", asked.run));
        return run.latest_checkpoint()?.checkpoint.ok_or_else(none);
    };
    let named = format!("step_{env_steps:012}.ckpt");
    let paths = run.checkpoints()?;
    let path = paths.iter().find(|path| path.ends_with(&named));
    let path = path.ok_or_else(|| {
        Refusal::sentence(format!("{} has no checkpoint of {env_steps} control steps any more", asked.run))
    })?;
    Checkpoint::read(path).map_err(Refusal::from)
}
