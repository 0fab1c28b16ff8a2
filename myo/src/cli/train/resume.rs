//! `myo train --resume`: goes on with a run, or with the runs of several seeds.

use std::path::{Path, PathBuf};

use myo::train::session::{End, Goal};
use myo::train::{Checkpoint, Evaluation, RunClaim, Session};
use myo::{Backend, RunDescription, Start, WarmStart};

use super::several::{Plan, Several};
use super::{Heritage, Ready, Train, Training, conclude, open_run};
use crate::cli::backend::{BackendName, device, sentence};
use crate::cli::failure::{Failure, Result, complain};
use crate::cli::interrupt::Interrupt;
use crate::cli::output::grouped;
use crate::cli::run_folder::newest_checkpoint;
use crate::cli::scenario::Scenario;

/// Goes on with what is in a folder.
pub fn run(args: &Train, path: &Path, interrupt: &Interrupt) -> Result<()> {
    match Several::open(path)? {
        Some(several) => self::several(args, several, interrupt),
        None => resume_run(args, path, None, |scenario, ready| conclude(args, scenario, ready, interrupt)),
    }
}

/// Goes on with the trainings of several seeds: with those that have begun, and with those that have not.
pub fn several(args: &Train, mut several: Several, interrupt: &Interrupt) -> Result<()> {
    several.aim(goal(args, &several.plan().run))?;
    let Plan { run, ppo, .. } = several.plan().clone();
    let scenario = Scenario::of(&run)?;
    let heritage = match (&run.from, several.from()?) {
        (Some(from), Some(checkpoint)) => Some(Heritage { run: from.run.clone(), checkpoint }),
        _ => None,
    };
    let training = Training {
        backend: backend_again(args, &run, ppo.num_envs)?,
        scenario: &scenario,
        config: ppo,
        heritage,
        goal: run.goal(),
        checkpoint_every: args.how.checkpoint_every(),
    };
    if let Some(all) = begun_at_once(&several, &training)? {
        return several.run_at_once(args.report(), all, interrupt);
    }
    several.run(args.report(), |seed, path| {
        if path.join("config.json").exists() {
            return resume_run(args, path, Some(&training), |_, ready| ready.run(interrupt));
        }
        training.ready(seed, |make, _| Ok(make(path)?))?.run(interrupt)
    })
}

/// The trainings that are left, ready to go on at once, if that is possible.
fn begun_at_once<'a>(several: &Several, training: &Training<'a>) -> Result<Option<Vec<Ready<'a>>>> {
    let begin = |seed: u64| {
        let path = several.run_folder(seed);
        let has_begun = path.join("config.json").exists();
        let claim = has_begun.then(|| RunClaim::take(&path)).transpose()?;
        let checkpoint = claim.as_ref().map(|claim| newest_checkpoint(claim.folder())).transpose()?.flatten();
        Ok((seed, path, claim, checkpoint))
    };
    let begun = several.left().into_iter().map(begin).collect::<Result<Vec<_>>>()?;
    // Stopped before its first checkpoint: the same beginning gives the same run.
    let starts: Vec<_> = (begun.iter())
        .map(|(seed, .., checkpoint)| checkpoint.as_ref().map_or_else(|| training.start(*seed), Start::Resumed))
        .collect();
    let Training { scenario, backend, config, goal, .. } = training;
    if starts.is_empty() {
        return Ok(None);
    }
    let Some(all) = Ready::several(scenario, backend, config, &starts, *goal)? else { return Ok(None) };
    drop(starts);
    let go_on = |(ready, (_, path, claim, _)): (Ready<'a>, (u64, PathBuf, Option<RunClaim>, _))| {
        let Some(mut claim) = claim else { return training.recorded(ready, |make, _| Ok(make(&path)?)) };
        RunDescription::aim(&mut claim, *goal)?;
        let trainer = ready.session.trainer();
        let writer = claim.resume(trainer.env_steps(), trainer.spec())?;
        tell(scenario, &path, &ready);
        ready.recorded_in(writer, training.checkpoint_every)
    };
    all.into_iter().zip(begun).map(go_on).collect::<Result<_>>().map(Some)
}

/// Says what goes on.
fn tell(scenario: &Scenario, path: &Path, ready: &Ready<'_>) {
    complain(&format!(
        "going on with {} in {} after {} control steps, on {}",
        scenario.title(),
        path.display(),
        grouped(ready.session.trainer().env_steps()),
        sentence(&ready.device)
    ));
}

/// Goes on with one run; `planned` tells what it has in common with others, if it is one of several.
fn resume_run<T>(
    args: &Train,
    path: &Path,
    planned: Option<&Training<'_>>,
    run_on: impl FnOnce(&Scenario, Ready<'_>) -> Result<T>,
) -> Result<T> {
    open_run(path)?;
    let mut claim = RunClaim::take(path)?;
    let run = claim.folder();
    let description = RunDescription::of(run)?;
    let goal = planned.map_or_else(|| goal(args, &description), |training| training.goal);
    let scenario = Scenario::of(&description)?;
    let (config, seed) = (run.config().ppo.clone(), run.config().seed);
    let env = scenario.training_env(&backend_again(args, &description, config.num_envs)?, &config, seed)?;
    let checkpoint = newest_checkpoint(run)?;
    // Stopped before its first checkpoint: the same beginning gives the same run.
    let own = match (&checkpoint, planned, &description.from) {
        (None, None, Some(from)) => Some(heritage_again(from)?),
        _ => None,
    };
    let heritage = own.as_ref().or_else(|| planned?.heritage.as_ref());
    let new = Start::New { config: &config, seed, from: heritage.map(|heritage| &heritage.checkpoint) };
    let ready = Ready::new(&scenario, env, checkpoint.as_ref().map_or(new, Start::Resumed), goal)?;
    if planned.is_none() && run.has_evaluation()? {
        refuse_if_over(path, &ready.session)?;
    }
    RunDescription::aim(&mut claim, goal)?;
    let trainer = ready.session.trainer();
    let writer = claim.resume(trainer.env_steps(), trainer.spec())?;
    tell(&scenario, path, &ready);
    run_on(&scenario, ready.recorded_in(writer, args.how.checkpoint_every())?)
}

/// The goal of a run, changed by the options of this command.
fn goal(args: &Train, run: &RunDescription) -> Goal {
    Goal { until: args.how.until.unwrap_or(run.until), steps: args.how.steps.unwrap_or(run.steps) }
}

/// Refuses a training whose end is recorded, and says what would make it go on.
fn refuse_if_over(path: &Path, session: &Session) -> Result<()> {
    let (path, done, limit) = (path.display(), session.trainer().env_steps(), session.goal().steps);
    let success = session.confirmed().and_then(Evaluation::least_success).unwrap_or_default();
    match session.over() {
        Some(End::Until) => Err(Failure::sentence(format!(
            "{path} has reached its goal with {:.1} % success; raise it with --until, or take --until off",
            100.0 * success
        ))),
        Some(End::Plateau) => Err(Failure::sentence(format!(
            "{path} has come to its plateau after {} control steps; to train on, take --until off and raise --steps",
            grouped(done)
        ))),
        Some(_) => Err(Failure::sentence(format!(
            "{path} has {} control steps, and its limit is {}; raise it with --steps",
            grouped(done),
            grouped(limit)
        ))),
        None => Ok(()),
    }
}

/// What a run that was stopped before its first checkpoint was to begin from.
fn heritage_again(from: &WarmStart) -> Result<Heritage> {
    let heritage = match from.run.is_file() {
        // Python takes checkpoints, too.
        true => Heritage { run: from.run.clone(), checkpoint: Checkpoint::read(&from.run)? },
        false => Heritage::open(&from.run)?,
    };
    from.check(&heritage.checkpoint)?;
    Ok(heritage)
}

/// The backend that a run continues on: the one it began on, unless another is asked for.
fn backend_again(args: &Train, description: &RunDescription, num_envs: usize) -> Result<Backend> {
    if args.how.physics.is_given() {
        return args.how.physics.choice(BackendName::Auto);
    }
    let backend = description.backend();
    if let (Backend::Gpu(_), Err(Failure::Sentence(reason))) = (&backend, device(&backend, num_envs)) {
        let device = description.device.as_deref().unwrap_or("a graphics card");
        return Err(Failure::sentence(format!(
            "the run began on {device}, which is not available now: {reason}. To go on elsewhere, add --backend cpu or --device"
        )));
    }
    Ok(backend)
}
