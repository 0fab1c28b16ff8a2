//! Runs a session to its end and tells how it goes.

use myo::train::session::{Goal, News, Outcome};
use myo::train::{Checkpoint, Inherited, PpoConfig, RunWriter, Session, Trainer};
use myo::{Envs, ModelReach, Place, likely_cause};

use super::progress::Progress;
use crate::cli::failure::Result;
use crate::cli::interrupt::Interrupt;
use crate::cli::stage::Stage;

/// A training that is ready, and where.
pub struct Ready<'a> {
    stage: &'a Stage,
    /// Where it runs.
    pub place: Place,
    /// The training.
    pub session: Session,
}

impl<'a> Ready<'a> {
    /// A new training in these environments, or one that inherits from another.
    pub fn new(
        stage: &'a Stage,
        env: Envs,
        (config, seed): (PpoConfig, u64),
        from: Option<&Checkpoint>,
        goal: Goal,
    ) -> Result<(Self, Option<Inherited>)> {
        let (place, looks) = (env.place(), env.for_looks(&stage.model, &stage.task, seed)?);
        let mut trainer = env.train(config, seed)?;
        let inherited = from.map(|other| trainer.warm_start(other)).transpose()?;
        Ok((Self::of(stage, place, trainer, looks, goal)?, inherited))
    }

    /// A training that goes on from a checkpoint.
    pub fn again(stage: &'a Stage, env: Envs, checkpoint: &Checkpoint, goal: Goal) -> Result<Self> {
        let (place, looks) = (env.place(), env.for_looks(&stage.model, &stage.task, checkpoint.seed())?);
        Self::of(stage, place, env.go_on(checkpoint)?, looks, goal)
    }

    fn of(stage: &'a Stage, place: Place, trainer: Trainer, looks: Envs, goal: Goal) -> Result<Self> {
        let examiner = looks.examine(&trainer)?;
        Ok(Self { stage, place, session: Session::new(trainer, examiner, goal) })
    }

    /// The same with metrics, checkpoints and evaluation in a run folder.
    pub fn recorded_in(self, writer: RunWriter) -> Self {
        Self { session: self.session.recorded_in(writer), ..self }
    }

    /// Trains to the end.
    pub fn run(self, interrupt: &Interrupt) -> Result<Outcome> {
        let Self { stage, mut session, .. } = self;
        let mut shown = Progress::new(session.goal().steps);
        let go_on = || !interrupt.wanted();
        loop {
            let progress = session.advance(&go_on)?;
            shown.show(&progress);
            for news in &progress.news {
                shown.tell(&sentence(stage, news)?);
            }
            if let Some(end) = progress.end {
                drop(shown);
                return Ok(session.conclude(end, &go_on)?);
            }
        }
    }
}

/// News, for people.
fn sentence(stage: &Stage, news: &News) -> Result<String> {
    Ok(match news {
        News::WentBack { .. } => format!("warning: {news}"),
        News::Flat { recent, .. } => {
            let cause = likely_cause(&stage.task, &ModelReach::new(&stage.model)?, recent);
            format!("warning: {news}\n{cause}")
        }
    })
}
