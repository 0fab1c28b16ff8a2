//! Runs a session to its end and tells how it goes.

use std::sync::mpsc;
use std::time::Duration;

use indicatif::MultiProgress;
use myo::train::session::{Goal, News, Outcome};
use myo::train::{PpoConfig, RunWriter, Session};
use myo::{Backend, Device, Envs, ModelReach, Start, User, likely_cause};

use super::progress::Progress;
use crate::cli::failure::{Failure, Result, complain};
use crate::cli::interrupt::Interrupt;
use crate::cli::scenario::Scenario;

/// A training that is ready, and where.
pub struct Ready<'a> {
    /// What is trained.
    pub scenario: &'a Scenario,
    /// Where it runs.
    pub device: Device,
    /// The training.
    pub session: Session,
    /// What it is called among several, unless by its seed.
    name: Option<String>,
}

impl<'a> Ready<'a> {
    /// A training in these environments.
    pub fn new(scenario: &'a Scenario, env: Envs, start: Start<'_>, goal: Goal) -> Result<Self> {
        let (device, looks) = (env.device(), env.for_looks(start.seed())?);
        Ok(Self { scenario, device, session: env.session(looks, start, goal)?, name: None })
    }

    /// Trainings that run at once, if that is possible: on a graphics card that has room for all of them.
    pub fn several(
        scenario: &'a Scenario,
        backend: &Backend,
        config: &PpoConfig,
        starts: &[Start<'_>],
        goal: Goal,
    ) -> Result<Option<Vec<Self>>> {
        let prepare = || {
            let Some(env) = scenario.env_for_several(backend, config, starts.len())? else { return Ok(None) };
            let (device, looks) = (env.device(), env.for_looks(0)?);
            let sessions = env.sessions(looks, starts, goal)?;
            let ready = |session| Self { scenario, device: device.clone(), session, name: None };
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

    /// Trainings of users that run at once, each of a layout of its own, on a card that is [for so
    /// many](Device::for_several).
    pub fn of_users(
        device: &Device,
        users: &[(&'a Scenario, u64)],
        config: &PpoConfig,
        goal: Goal,
    ) -> Result<Vec<Self>> {
        let Some(&(first, seed)) = users.first() else { return Ok(vec![]) };
        let task = std::slice::from_ref(&first.task);
        let env = Envs::for_training(device, &first.model, task, (config, seed))?;
        let looks = env.for_looks(seed)?;
        let wanted: Vec<User<'_>> = users.iter().map(|&(scenario, seed)| User { task: &scenario.task, seed }).collect();
        let sessions = env.sessions_of(looks, &wanted, config, goal)?.into_iter();
        let ready = |(session, &(scenario, _))| Self { scenario, device: device.clone(), session, name: None };
        Ok(sessions.zip(users).map(ready).collect())
    }

    /// The same with metrics, checkpoints and evaluation in a run folder.
    pub fn recorded_in(self, writer: RunWriter, checkpoint_every: Duration) -> Result<Self> {
        Ok(Self { session: self.session.recorded_in(writer)?.checkpoint_every(checkpoint_every), ..self })
    }

    /// Trains to the end.
    pub fn run(self, interrupt: &Interrupt) -> Result<Outcome> {
        let shown = Progress::new(&self.scenario.layouts, self.session.goal().steps);
        self.run_showing(shown, interrupt)
    }

    /// The same, called so among several that run at once.
    pub fn called(self, name: String) -> Self {
        Self { name: Some(name), ..self }
    }

    /// Trains all to the end, which were made for several at once; `hear` hears of the end of each, by its place among all, when
    /// it comes.
    pub fn run_all(all: Vec<Self>, interrupt: &Interrupt, mut hear: impl FnMut(usize, Result<Outcome>)) {
        let (bars, (tell, told)) = (MultiProgress::new(), mpsc::channel());
        std::thread::scope(|scope| {
            for (index, ready) in all.into_iter().enumerate() {
                let (seed, limit, tell) = (ready.session.trainer().seed(), ready.session.goal().steps, tell.clone());
                let name = ready.name.clone().unwrap_or_else(|| format!("seed {seed}"));
                let shown = Progress::among(&bars, &name, &ready.scenario.layouts, limit);
                // Nobody stops listening before all have told.
                scope.spawn(move || tell.send((index, ready.run_showing(shown, interrupt))).is_ok());
            }
            drop(tell);
            told.into_iter().for_each(|(index, outcome)| hear(index, outcome));
        });
    }

    fn run_showing(self, mut shown: Progress, interrupt: &Interrupt) -> Result<Outcome> {
        let Self { scenario, mut session, .. } = self;
        let go_on = || !interrupt.wanted();
        loop {
            let progress = session.advance(&go_on)?;
            shown.show(&progress);
            for news in &progress.news {
                shown.tell(&sentence(scenario, news)?);
            }
            if let Some(end) = progress.end {
                drop(shown);
                return Ok(session.conclude(end, &go_on)?);
            }
        }
    }
}

/// News, for people.
fn sentence(scenario: &Scenario, news: &News) -> Result<String> {
    Ok(match news {
        News::WentBack { .. } => format!("warning: {news}"),
        News::Flat { recent, layout, .. } => {
            let task = layout.and_then(|layout| scenario.layouts.get(layout)).unwrap_or(&scenario.task);
            let cause = likely_cause(task, &ModelReach::for_task(&scenario.model, task)?, recent);
            format!("warning: {news}\n{cause}")
        }
    })
}
