//! Runs a session to its end and tells how it goes.

use std::sync::mpsc;
use std::time::Duration;

use indicatif::MultiProgress;
use myo::train::session::{Goal, News, Outcome};
use myo::train::{PpoConfig, RunWriter, Session};
use myo::{Backend, Device, Envs, ModelReach, Start, likely_cause};

use super::progress::Progress;
use crate::cli::failure::{Failure, Result, complain};
use crate::cli::interrupt::Interrupt;
use crate::cli::stage::Stage;

/// A training that is ready, and where.
pub struct Ready<'a> {
    /// What is trained.
    pub stage: &'a Stage,
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

    /// Trainings that run at once, if that is possible: on a graphics card that has room for all of them.
    pub fn several(
        stage: &'a Stage,
        backend: &Backend,
        config: &PpoConfig,
        starts: &[Start<'_>],
        goal: Goal,
    ) -> Result<Option<Vec<Self>>> {
        let prepare = || {
            let Some(env) = stage.env_for_several(backend, config, starts.len())? else { return Ok(None) };
            let (device, looks) = (env.device(), env.for_looks(&stage.model, &stage.task, 0)?);
            let sessions = env.sessions(looks, starts, goal)?;
            let ready = |session| Self { stage, device: device.clone(), session };
            Ok(Some(sessions.into_iter().map(ready).collect()))
        };
        prepare().or_else(|failure| match failure {
            Failure::Sentence(reason) => {
                complain(&format!("warning: {reason}\nthe seeds are trained one after the other instead"));
                Ok(None)
            }
            other => Err(other),
        })
    }

    /// The same with metrics, checkpoints and evaluation in a run folder.
    pub fn recorded_in(self, writer: RunWriter, checkpoint_every: Duration) -> Result<Self> {
        Ok(Self { session: self.session.recorded_in(writer)?.checkpoint_every(checkpoint_every), ..self })
    }

    /// Trains to the end.
    pub fn run(self, interrupt: &Interrupt) -> Result<Outcome> {
        let shown = Progress::new(&self.stage.task, self.session.goal().steps);
        self.run_showing(shown, interrupt)
    }

    /// Trains all to the end, which were made for several at once; `hear` hears of the end of each when it comes.
    pub fn run_all(all: Vec<Self>, interrupt: &Interrupt, mut hear: impl FnMut(u64, Result<Outcome>)) {
        let (bars, (tell, told)) = (MultiProgress::new(), mpsc::channel());
        std::thread::scope(|scope| {
            for ready in all {
                let (seed, limit, tell) = (ready.session.trainer().seed(), ready.session.goal().steps, tell.clone());
                let shown = Progress::among(&bars, seed, &ready.stage.task, limit);
                // Nobody stops listening before all have told.
                scope.spawn(move || tell.send((seed, ready.run_showing(shown, interrupt))).is_ok());
            }
            drop(tell);
            told.into_iter().for_each(|(seed, outcome)| hear(seed, outcome));
        });
    }

    fn run_showing(self, mut shown: Progress, interrupt: &Interrupt) -> Result<Outcome> {
        let Self { stage, mut session, .. } = self;
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
