//! Episodes of users that were trained.

use std::path::Path;

use myo_lab::RunDescription;
use myo_model::Model;
use myo_tasks::{Pose, Task};
use myo_train::{Checkpoint, RunFolder};

use super::actor::Actor;
use crate::protocol::{MotionHeader, Refusal, Replay};

/// Episodes that tell what a step costs, and their seed: none that anything was learnt or evaluated on.
const EFFORT_EPISODES: u32 = 64;
const EFFORT_SEED: u64 = 0x0e_ff04;

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

/// Mean squared control of each step of the script over fresh episodes, motor noise aside; none for steps that no episode comes to.
///
/// # Errors
/// The run cannot be read, or has no checkpoint.
pub fn efforts(folder: &Path, name: &str) -> Result<Vec<Option<f64>>, Refusal> {
    let run = RunFolder::open(folder)?;
    let description = RunDescription::of(&run)?;
    let asked = Replay { run: name.to_owned(), seed: 0, env_steps: None };
    let mut policy = checkpoint(&run, &asked)?.policy();
    let steps = description.task.flat()?.steps.len();
    let mut actor = Actor::new(&description.body()?, &description.task, EFFORT_SEED)?;
    let (mut sums, mut counts) = (vec![0.0; steps], vec![0_u32; steps]);
    for _ in 0..EFFORT_EPISODES {
        while let Some(step) = actor.current_step()? {
            let has_ended = actor.act(&mut policy)?;
            sums[step] += actor.effort();
            counts[step] += 1;
            if has_ended {
                break;
            }
        }
        // The step after the end begins the next episode.
        actor.act(&mut policy)?;
    }
    Ok(sums.into_iter().zip(counts).map(|(sum, count)| (count > 0).then(|| sum / f64::from(count))).collect())
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
    let kept = run.numbered_checkpoints()?;
    let (_, path) = kept.iter().find(|(steps, _)| *steps == env_steps).ok_or_else(|| {
        Refusal::sentence(format!("{} has no checkpoint of {env_steps} control steps any more", asked.run))
    })?;
    Checkpoint::read(path).map_err(Refusal::from)
}
