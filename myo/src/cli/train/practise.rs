//! Users learn what a protocol asks of them.

use std::path::Path;

use myo::RunDescription;
use myo::train::session::{Goal, Until};
use myo::train::{Checkpoint, PpoConfig, RunFolder};

use super::several::{self, Several};
use super::{Train, Training, TrainingOptions, resume};
use crate::cli::backend::{BackendName, Options};
use crate::cli::failure::{Failure, Result};
use crate::cli::interrupt::Interrupt;
use crate::cli::run_folder::existing_checkpoint;
use crate::cli::scenario::Scenario;

/// Seconds between two checkpoints.
const CHECKPOINT_EVERY_S: f64 = 30.0;

/// What is practised, and by whom.
pub struct Practising<'a> {
    /// The tasks, and the body.
    pub scenario: &'a Scenario,
    /// Settings of the learner.
    pub config: PpoConfig,
    /// How many users, and the seed of the first one.
    pub users: (usize, u64),
    /// Control steps after which a training stops in any case; as usual without it.
    pub steps: Option<u64>,
    /// What computes the physics.
    pub physics: &'a Options,
}

/// Users who have learnt, in a folder as of `myo train --seeds`: those that are there already, and others who are trained to their
/// plateau first.
pub fn practise(what: &Practising<'_>, folder: &Path, interrupt: &Interrupt) -> Result<Vec<Checkpoint>> {
    practise_until(what, Until::Plateau, folder, interrupt)
}

/// The same with another goal.
pub fn practise_until(
    what: &Practising<'_>,
    until: Until,
    folder: &Path,
    interrupt: &Interrupt,
) -> Result<Vec<Checkpoint>> {
    let &Practising { scenario, ref config, users: (count, first), steps, physics } = what;
    let seeds = several::seeds(first, count as u64)?;
    let how = TrainingOptions {
        physics: physics.clone(),
        checkpoint_every_s: CHECKPOINT_EVERY_S,
        ..TrainingOptions::default()
    };
    let args = Train { how, silent: true, ..Train::default() };
    match Several::open(folder)? {
        Some(mut several) => {
            let plan = several.plan();
            if *seeds.start() < plan.first_seed || *seeds.start() > plan.last_seed.saturating_add(1) {
                return Err(Failure::sentence(format!(
                    "{} has trainings with seeds {} to {}, to which {first} does not join; name another folder, or take such a --seed",
                    folder.display(),
                    plan.first_seed,
                    plan.last_seed
                )));
            }
            several.extend_to(*seeds.end())?;
            if !several.left().is_empty() {
                resume::several(&args, several, interrupt)?;
            }
        }
        // Somebody else may have trained them, such as the Python package.
        None if seeds.clone().all(|seed| Several::run_folder_in(folder, seed).exists()) => {}
        None if folder.exists() => {
            return Err(Failure::sentence(format!(
                "{} has not all of the trainings with seeds {} to {}, nor a plan of them; train them as they were begun, remove the folder, or name another",
                folder.display(),
                seeds.start(),
                seeds.end()
            )));
        }
        None => {
            let steps = steps.unwrap_or_else(|| myo::default_steps(scenario.task.control_dt_s));
            let training = Training {
                scenario,
                config: config.clone(),
                heritage: None,
                backend: physics.choice(BackendName::Auto)?,
                goal: Goal { until, steps },
                checkpoint_every: args.how.checkpoint_every(),
            };
            training.several(&args, seeds.clone(), folder, interrupt)?;
        }
    }
    let user = |seed: u64| {
        let run = RunFolder::open(&Several::run_folder_in(folder, seed))?;
        same_layouts(&run, scenario)?;
        existing_checkpoint(&run)
    };
    seeds.map(user).collect()
}

/// Refuses users who practised something else: a program before this one may have asked otherwise.
fn same_layouts(run: &RunFolder, scenario: &Scenario) -> Result<()> {
    if RunDescription::of(run)?.layouts() == scenario.layouts {
        return Ok(());
    }
    let path = run.path().display();
    Err(Failure::sentence(format!(
        "the user in {path} practised other tasks than are asked for now; remove that folder, or name another"
    )))
}
