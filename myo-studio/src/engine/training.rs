//! A training in a run folder: begun, or taken up where it was stopped.

use std::path::{Path, PathBuf};

use myo_lab::{Backend, Device, Envs, RunDescription, Start, WarmStart, changed_settings, own_model, usual_settings};
use myo_model::Model;
use myo_tasks::Task;
use myo_train::session::{Goal, Session};
use myo_train::{Checkpoint, PpoConfig, RunClaim, RunFolder, RunWriter};

use crate::protocol::{Changes, Refusal};

/// A training that is ready to advance.
pub struct Training {
    /// The training.
    pub session: Session,
    /// What computes it.
    pub device: Device,
    /// What is trained.
    pub task: Task,
    /// The body that does it.
    pub model: Model,
}

/// What a new training begins with.
pub struct Beginning<'a> {
    /// What is trained.
    pub task: &'a Task,
    /// The body that does it.
    pub model: &'a Model,
    /// Where it runs.
    pub backend: &'a Backend,
    /// Settings of the learner that are not as they come.
    pub settings: &'a Changes,
    /// Seed of everything random.
    pub seed: u64,
    /// When to stop.
    pub goal: Goal,
    /// The user that goes on learning, if any.
    pub heir_to: Option<Heritage>,
}

/// A user that has learnt something already.
pub struct Heritage {
    /// Its run.
    pub run: PathBuf,
    /// What it has learnt.
    pub checkpoint: Checkpoint,
}

impl Heritage {
    /// The user of a run as it is by its newest checkpoint.
    ///
    /// # Errors
    /// There is no run or no checkpoint.
    pub fn of(run: PathBuf) -> Result<Self, Refusal> {
        let checkpoint = newest(&run)?;
        Ok(Self { run, checkpoint })
    }
}

impl Training {
    /// Begins a training in a new folder, or in that of the user itself, who goes on with another task: what was there is put aside
    /// until the new run is whole. `notice` hears why a card that is there is not used.
    ///
    /// # Errors
    /// The task cannot be simulated, the folder cannot be made, or the card is lost.
    pub fn begin(beginning: Beginning<'_>, folder: &Path, notice: &mut dyn FnMut(String)) -> Result<Self, Refusal> {
        let Beginning { task, model, backend, settings, seed, goal, heir_to } = beginning;
        let heritage = heir_to.as_ref().map(|heritage| &heritage.checkpoint);
        let base = heritage.map_or_else(
            || usual_settings(task.user, model),
            |checkpoint| checkpoint.config().with_learning_of(task.user),
        );
        let config = changed_settings(&base, super::jobs::changes(settings))?;
        let start = Start::New { config: &config, seed, from: heritage };
        let envs = build(backend, model, std::slice::from_ref(task), (&config, seed), notice)?;
        let (device, looks) = (envs.device(), envs.for_looks(seed)?);
        let session = envs.session(looks, start, goal)?;
        let is_own = heir_to.as_ref().is_some_and(|heritage| heritage.run == folder);
        let warm = heir_to.map(|Heritage { run, checkpoint }| WarmStart { run, env_steps: checkpoint.env_steps() });
        let description = RunDescription::new(task.clone(), own_model(&task.model)?, &device, goal, warm);
        let trainer = session.trainer();
        let run = serde_json::to_value(&description)?;
        let aside = if is_own { Some(Aside::put(folder)?) } else { None };
        let writer = RunWriter::create(folder, run, trainer.config(), trainer.seed(), trainer.spec())?;
        // A user that has learnt something already is written down at once.
        let session = session.recorded_in(writer)?;
        aside.map(|aside| aside.drop_for(folder)).transpose()?;
        Ok(Self { session, device, task: task.clone(), model: model.clone() })
    }

    /// Goes on with a run from its newest checkpoint; from its beginning where it was stopped before the first.
    ///
    /// # Errors
    /// The run cannot be read, others train there, or the device that it began on is not there.
    pub fn resume(folder: &Path, notice: &mut dyn FnMut(String)) -> Result<Self, Refusal> {
        let claim = RunClaim::take(folder)?;
        let run = claim.folder();
        let description = RunDescription::of(run)?;
        let (config, seed, goal) = (run.config().ppo.clone(), run.config().seed, description.goal());
        let model = description.body()?;
        let envs = build(&description.backend(), &model, &description.layouts(), (&config, seed), notice)?;
        let checkpoint = run.latest_checkpoint()?.checkpoint;
        let heritage = match (&checkpoint, &description.from) {
            (None, Some(from)) => {
                let checkpoint = newest(&from.run)?;
                from.check(&checkpoint)?;
                Some(checkpoint)
            }
            _ => None,
        };
        let new = Start::New { config: &config, seed, from: heritage.as_ref() };
        let (device, looks) = (envs.device(), envs.for_looks(seed)?);
        let session = envs.session(looks, checkpoint.as_ref().map_or(new, Start::Resumed), goal)?;
        let trainer = session.trainer();
        let writer = claim.resume(trainer.env_steps(), trainer.spec())?;
        Ok(Self { session: session.recorded_in(writer)?, device, task: description.task, model })
    }
}

/// A run that another takes the place of. Whatever goes wrong before the other is whole, this one is still there, under its own name with
/// `.before` behind it.
struct Aside {
    folder: PathBuf,
    /// Nobody else may train there meanwhile.
    _claim: RunClaim,
}

impl Aside {
    fn put(run: &Path) -> Result<Self, Refusal> {
        let claim = RunClaim::take(run)?;
        let mut name = run.file_name().unwrap_or_default().to_owned();
        name.push(".before");
        let folder = run.with_file_name(name);
        if folder.exists() {
            std::fs::remove_dir_all(&folder)?;
        }
        std::fs::rename(run, &folder)?;
        Ok(Self { folder, _claim: claim })
    }

    /// What people wrote down stays with the user.
    fn drop_for(self, run: &Path) -> Result<(), Refusal> {
        let note = self.folder.join(super::runs::NOTE);
        if note.exists() {
            std::fs::copy(&note, run.join(super::runs::NOTE))?;
        }
        Ok(std::fs::remove_dir_all(&self.folder)?)
    }
}

/// The newest checkpoint of a run.
fn newest(folder: &Path) -> Result<Checkpoint, Refusal> {
    let none = || Refusal::sentence(format!("{} has no checkpoint yet", folder.display()));
    RunFolder::open(folder)?.latest_checkpoint()?.checkpoint.ok_or_else(none)
}

fn build(
    backend: &Backend,
    model: &Model,
    layouts: &[Task],
    training: (&PpoConfig, u64),
    notice: &mut dyn FnMut(String),
) -> Result<Envs, Refusal> {
    let mut hear = |error: &dyn std::error::Error| notice(format!("{error}; the processor is taken instead"));
    Ok(backend.build_for_training(model, layouts, training, &mut hear)?)
}
