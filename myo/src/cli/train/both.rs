//! Users of two layouts at once on a graphics card, for `myo compare`.

use std::path::PathBuf;

use myo::train::session::Goal;
use myo::{Device, MOST_AT_ONCE, User, batches};

use super::several::{self, Plan, Report, Several};
use super::{Ready, Training, TrainingOptions, warn_of_goal};
use crate::cli::backend::{self, BackendName};
use crate::cli::failure::{Failure, Result, complain};
use crate::cli::interrupt::Interrupt;
use crate::cli::scenario::Scenario;

/// A layout and the folder for its users.
pub struct Side {
    /// What they do.
    pub scenario: Scenario,
    /// It is made as `myo train --seeds` makes it.
    pub folder: PathBuf,
}

/// Trains so many users of each of two layouts at once, each as it would be trained alone, in folders as of `myo train --seeds`. False,
/// and nothing is done, where one layout is trained after the other: on the processor, for layouts of other structures, bodies or
/// time limits, or for more users than a card takes at once.
pub fn train_both(how: &TrainingOptions, sides: &[Side; 2], count: usize, interrupt: &Interrupt) -> Result<bool> {
    let config = how.learner.settings(&sides[0].scenario.usual_settings())?;
    let seeds = several::seeds(how.seed.unwrap_or(1), count as u64)?;
    let backend = how.physics.choice(BackendName::Auto)?;
    if !fit(sides, count)? || matches!(backend::device(&backend, config.num_envs)?, Device::Cpu) {
        return Ok(false);
    }
    let steps = myo::default_steps(sides[0].scenario.task.control_dt_s);
    let goal = Goal { until: how.until.unwrap_or_default(), steps: how.steps.unwrap_or(steps) };
    let users: Vec<(&Scenario, u64)> =
        sides.iter().flat_map(|side| seeds.clone().map(move |seed| (&side.scenario, seed))).collect();
    let prepare = || {
        let Some(device) = backend::device(&backend, config.num_envs)?.for_several(users.len())? else {
            return Ok(vec![]);
        };
        Ready::of_users(&device, &users, &config, goal)
    };
    let all = match prepare() {
        Err(Failure::Sentence(reason)) => {
            complain(&format!("warning: {reason}\nthe layouts are trained one after the other instead"));
            return Ok(false);
        }
        all => all?,
    };
    let Some(device) = all.first().map(|ready| ready.device.clone()) else { return Ok(false) };
    sides.iter().for_each(|side| warn_of_goal(&side.scenario, goal.until.share()));
    let trainings = sides.each_ref().map(|side| Training {
        scenario: &side.scenario,
        config: config.clone(),
        heritage: None,
        backend: backend.clone(),
        goal,
        checkpoint_every: how.checkpoint_every(),
    });
    let mut folders = Vec::new();
    for (side, training) in sides.iter().zip(&trainings) {
        let plan = Plan::new(seeds.clone(), training.description(&device), config.clone());
        folders.push(Several::create(&side.folder, plan, None)?);
    }
    let mut recorded = Vec::new();
    for (index, ready) in all.into_iter().enumerate() {
        let (side, seed) = (index / count, users[index].1);
        let path = folders[side].run_folder(seed);
        let ready = ready.called(format!("layout {}, seed {seed}", side + 1));
        recorded.push(trainings[side].recorded(ready, |make, _| Ok(make(&path)?))?);
    }
    let mut failures = Vec::new();
    Ready::run_all(recorded, interrupt, |index, outcome| {
        failures.extend(outcome.and_then(|outcome| folders[index / count].take(users[index].1, outcome)).err());
    });
    if let Some(failure) = failures.into_iter().next() {
        return Err(failure);
    }
    // Both are told where they were interrupted.
    let told: Vec<Result<()>> = folders.iter().map(|several| several.tell_all(Report::Nothing)).collect();
    told.into_iter().collect::<Result<()>>().map(|()| true)
}

/// Whether so many users of both fit into one batch.
fn fit(sides: &[Side; 2], count: usize) -> Result<bool> {
    let [a, b] = sides.each_ref().map(|side| &side.scenario);
    if 2 * count > MOST_AT_ONCE
        || a.task.model != b.task.model
        || a.task.body != b.task.body
        || a.own_model != b.own_model
    {
        return Ok(false);
    }
    let users = [a, b].map(|scenario| User { task: &scenario.task, seed: 0 });
    Ok(batches(&a.model, &users)?.len() == 1)
}
