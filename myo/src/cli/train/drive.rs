//! Runs a session to its end and tells how it goes.

use std::time::Duration;

use myo::train::session::{Goal, News, Outcome};
use myo::train::{RunWriter, Session};
use myo::{Device, Envs, ModelReach, Start, likely_cause};

use super::progress::Progress;
use crate::cli::failure::Result;
use crate::cli::interrupt::Interrupt;
use crate::cli::stage::Stage;

/// A training that is ready, and where.
pub struct Ready<'a> {
    stage: &'a Stage,
    /// Where it runs.
    pub device: Device,
    /// The training.
    pub session: Session,
}

impl<'a> Ready<'a> {
    /// A training in these environments.
    pub fn new(stage: &'a Stage, env: Envs, start: Start<'_>, goal: Goal) -> Result<Self> {
        let (device, looks) = (env.device(), env.for_looks(&stage.model, &stage.task, start.seed())?);
        Ok(Self { stage, device, session: env.session(looks, start, goal)? })
    }

    /// The same with metrics, checkpoints and evaluation in a run folder.
    pub fn recorded_in(self, writer: RunWriter, checkpoint_every: Duration) -> Result<Self> {
        Ok(Self { session: self.session.recorded_in(writer)?.checkpoint_every(checkpoint_every), ..self })
    }

    /// Trains to the end.
    pub fn run(self, interrupt: &Interrupt) -> Result<Outcome> {
        let Self { stage, mut session, .. } = self;
        let mut shown = Progress::new(&stage.task, session.goal().steps);
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
