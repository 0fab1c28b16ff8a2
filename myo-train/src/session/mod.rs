//! A training from its start, or from a checkpoint, to its end: looks at the goal, records, goes back when learning runs
//! away, and tells when it leads nowhere.

mod balance;
mod curve;
mod events;
mod examiner;
mod looks;
mod means;
mod memory;
mod record;
mod recovery;
mod trend;
mod until;

use std::time::{Duration, Instant};

use myo_env::EnvError;
use myo_gpu::GpuError;

use crate::checkpoint::SessionState;
use crate::{Checkpoint, Evaluation, Policy, RunError, RunWriter, TrainError, Trainer, UpdateMetrics};
use record::Record;
use recovery::Recovery;

pub use events::{End, LeastLayout, News, Outcome, Progress, SessionError};
pub use examiner::{Examiner, evaluation_seed};
pub use means::{Bottleneck, EpisodeMeans};
pub(crate) use memory::Memory;
pub use trend::{Change, Trend};
pub use until::{Until, UntilError};

/// Episodes, of each layout, that confirm a quick look, and of the last evaluation.
const EPISODES: usize = 1000;
/// Fewer where there are many layouts: at most so many in all, or this many of each.
const EPISODES_IN_ALL: usize = 16_000;
const LEAST_EPISODES: usize = 100;

/// Share of training episodes that succeed from which on it needs no word if nothing improves.
const GOOD: f64 = 0.9;

/// When to stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    /// What ends it before the steps do.
    pub until: Until,
    /// After this many control steps of all environments in any case.
    pub steps: u64,
}

/// A training that is about to run.
pub struct Session {
    trainer: Trainer,
    examiner: Examiner,
    goal: Goal,
    memory: Memory,
    recovery: Recovery,
    record: Option<Record>,
    /// Whether trainer and record are in a state to go on from: the last update did not fail.
    is_sound: bool,
}

impl Session {
    /// Trains from the start to a goal, looking at it with `examiner`.
    ///
    /// # Errors
    /// The card is lost.
    pub fn new(mut trainer: Trainer, examiner: Examiner, goal: Goal) -> Result<Self, TrainError> {
        let (memory, recovery) = (Memory::new(&trainer), Recovery::new(trainer.save()?));
        trainer.set_cost_share(memory.share_that_counts())?;
        Ok(Self { trainer, examiner, goal, memory, recovery, record: None, is_sound: true })
    }

    /// Goes on with a training, which `trainer` was restored from `checkpoint` for: with the same goal as if it had never
    /// stopped, bit for bit. A goal that the checkpoint had reached but that is higher now is sought again.
    ///
    /// # Errors
    /// The card is lost.
    pub fn resume(
        mut trainer: Trainer,
        examiner: Examiner,
        goal: Goal,
        checkpoint: &Checkpoint,
    ) -> Result<Self, TrainError> {
        let bare = || Checkpoint { session: None, ..checkpoint.clone() };
        let (memory, recovery) = match &checkpoint.session {
            Some(SessionState { memory, good }) => {
                let good = good.as_ref().map_or_else(bare, |good| (**good).clone());
                (memory.clone(), Recovery::after(good, memory.tries))
            }
            None => (Memory::new(&trainer), Recovery::new(bare())),
        };
        trainer.set_cost_share(memory.share_that_counts())?;
        Ok(Self { trainer, examiner, goal, memory, recovery, record: None, is_sound: true })
    }

    /// The same with metrics, checkpoints and evaluation in a run folder. A warm start is written there at once: stopped
    /// before its first update, it goes on without the other run's folder.
    ///
    /// # Errors
    /// The folder cannot be written, or the card is lost.
    pub fn recorded_in(mut self, writer: RunWriter) -> Result<Self, SessionError> {
        // A training with updates behind it comes from a checkpoint.
        self.record = Some(Record::new(writer, self.trainer.updates() > 0));
        if self.trainer.inherited().is_some() {
            self.checkpoint()?;
        }
        Ok(self)
    }

    /// Writes a checkpoint whenever so much time has passed, rather than every 30 s; with zero after every update.
    pub fn checkpoint_every(mut self, time: Duration) -> Self {
        if let Some(record) = &mut self.record {
            record.every(time);
        }
        self
    }

    /// The learner.
    pub fn trainer(&self) -> &Trainer {
        &self.trainer
    }

    /// The goal.
    pub fn goal(&self) -> Goal {
        self.goal
    }

    /// Why there is nothing left to train, if so: the goal was confirmed, nothing improves any more, or the steps are used up.
    /// Only the last evaluation may be missing; see [`Session::conclude`].
    pub fn over(&self) -> Option<End> {
        let used_up = self.trainer.env_steps() >= self.goal.steps;
        match self.goal.until {
            Until::Success(_) if self.confirmed().is_some() => Some(End::Until),
            Until::Plateau if self.memory.has_settled() => Some(End::Plateau),
            _ if used_up && !self.look_is_due() => Some(End::Steps),
            _ => None,
        }
    }

    /// What the last doubling of training brought and what more would, if that can be told.
    pub fn trend(&self) -> Option<Trend> {
        self.memory.trend()
    }

    /// The evaluation that confirmed the goal, if one did.
    pub fn confirmed(&self) -> Option<&Evaluation> {
        let until = self.goal.until.share()?;
        self.memory.confirmed.as_ref().filter(|evaluation| reaches(evaluation, until))
    }

    /// One update, its record, and a look at the goal when it is time to. `go_on` is asked now and then and ends the
    /// training early, also in the middle of an [update](Trainer::update_while), of which nothing is left then. A training
    /// that is [over](Self::over) is left as it is; a look that an interrupt had cut off is made up for without an update.
    ///
    /// # Errors
    /// Training fails in a way that going back does not heal, or the record cannot be written. After an error the session
    /// can only be concluded.
    pub fn advance(&mut self, go_on: &dyn Fn() -> bool) -> Result<Progress, SessionError> {
        let attempt = self.attempt(go_on);
        self.is_sound = attempt.is_ok();
        match attempt {
            // The loss of a graphics card is an end, not an error: the run goes on from its newest checkpoint.
            Err(SessionError::Train(error)) => Ok(Progress { end: Some(lost(error)?), ..Progress::default() }),
            advanced => advanced,
        }
    }

    fn attempt(&mut self, go_on: &dyn Fn() -> bool) -> Result<Progress, SessionError> {
        let mut progress = Progress::default();
        if self.over().is_none() && !self.look_is_due() {
            match self.update(go_on)? {
                Updated::Forward(metrics) => progress.metrics = Some(metrics),
                Updated::Back(news) => progress.news.push(news),
                Updated::Interrupted => return Ok(self.tell(progress, Some(End::Interrupted))),
            }
        }
        // Going back is recorded at once, and nothing is looked at that was looked at before.
        if progress.news.is_empty() {
            progress.looks = self.look(go_on)?;
            progress.news.extend(self.flat());
            if self.record.as_ref().is_some_and(Record::is_due) {
                self.checkpoint()?;
            }
        }
        let end = if go_on() { self.over() } else { Some(End::Interrupted) };
        Ok(self.tell(progress, end))
    }

    /// Adds how it goes.
    fn tell(&self, progress: Progress, end: Option<End>) -> Progress {
        let steps_left = match self.goal.until {
            Until::Success(share) => self.memory.steps_to(share),
            Until::Plateau => self.trend().map(|trend| trend.steps_left()),
            Until::Off => None,
        };
        let least = self.memory.least().and_then(|(layout, curve)| Some((layout, curve.recent()?)));
        let bottleneck = least.and_then(|(_, recent)| recent.bottleneck());
        let least = least.and_then(|(layout, recent)| Some(LeastLayout { layout: layout?, success: recent.success }));
        let success = self.memory.curve.recent().map(|recent| recent.success);
        Progress { success, least, bottleneck, steps_left, end, ..progress }
    }

    /// The mean actions of the policy as it is on fresh episodes, those of the `number`-th evaluation; none if `go_on` ended it
    /// early. The training goes on as if nobody had asked.
    ///
    /// # Errors
    /// The card is lost.
    pub fn measure(
        &mut self,
        episodes: usize,
        number: u64,
        go_on: &dyn Fn() -> bool,
    ) -> Result<Option<Evaluation>, TrainError> {
        examine(&mut self.examiner, &mut self.trainer.policy(), episodes, number, go_on)
    }

    fn update(&mut self, go_on: &dyn Fn() -> bool) -> Result<Updated, SessionError> {
        let updated = self.trainer.update_while(go_on);
        if let Some(reason) = self.recovery.what_ran_away(&updated, self.trainer.config().kl_max) {
            return Ok(Updated::Back(self.go_back(reason)?));
        }
        let Some(metrics) = updated? else { return Ok(Updated::Interrupted) };
        self.recovery.went_well(&mut self.trainer, self.memory.learning_rate_max)?;
        self.memory.hear(&metrics, self.trainer.spec().num_envs);
        self.follow_costs()?;
        self.record.as_mut().map_or(Ok(()), |record| record.hear(&metrics))?;
        Ok(Updated::Forward(metrics))
    }

    /// Lets movement cost what the user can afford.
    fn follow_costs(&mut self) -> Result<(), TrainError> {
        let (config, control_dt) = (self.trainer.config(), self.trainer.spec().control_dt);
        if config.cost_ramp_s == 0.0 {
            return Ok(());
        }
        let newest = config.batch_size(control_dt) as u64;
        let growth = newest as f64 * control_dt / config.cost_ramp_s;
        self.memory.follow_costs(self.trainer.env_steps(), newest, growth);
        self.charge()
    }

    /// Has the environments charge the share of the costs that counts.
    fn charge(&mut self) -> Result<(), TrainError> {
        let share = self.memory.share_that_counts();
        if share == self.trainer.cost_share() { Ok(()) } else { self.trainer.set_cost_share(share) }
    }

    fn go_back(&mut self, reason: String) -> Result<News, SessionError> {
        let env_steps = self.trainer.env_steps();
        if !self.recovery.go_back(&mut self.trainer)? {
            return Err(SessionError::RanAway { reason });
        }
        let to_env_steps = self.trainer.env_steps();
        self.memory.go_back(to_env_steps);
        // The state gone back to is safe before those after it are removed.
        if let Some(record) = &mut self.record {
            record.changed();
        }
        self.checkpoint()?;
        self.record.as_mut().map_or(Ok(()), |record| record.go_back(to_env_steps))?;
        let learning_rate = self.trainer.learning_rate();
        Ok(News::WentBack { reason, env_steps, to_env_steps, learning_rate })
    }

    /// Tells once when nothing improves any more and the goal is out of sight.
    fn flat(&mut self) -> Option<News> {
        let success = self.memory.least_success()?;
        let enough = match self.goal.until {
            Until::Success(share) => self.memory.looks.threshold(share),
            Until::Plateau => GOOD,
            Until::Off => return None,
        };
        if self.memory.told_flat || success >= enough {
            return None;
        }
        let (layout, curve) = self.memory.least()?;
        let news = News::Flat {
            env_steps: curve.flat_for(self.trainer.spec().control_dt)?,
            layout,
            recent: curve.recent()?.clone(),
        };
        self.memory.told_flat = true;
        Some(news)
    }

    /// Whether to look at the goal now.
    fn look_is_due(&self) -> bool {
        let (steps, control_dt) = (self.trainer.env_steps(), self.trainer.spec().control_dt);
        let is_due = |until| self.memory.looks.is_due(until, steps, control_dt, self.memory.least_success());
        self.confirmed().is_none() && self.goal.until.share().is_some_and(is_due)
    }

    /// Whether the goal is reached, looked at when it is time to: quickly first, then on enough other episodes to be sure.
    /// A look that is cut off leaves nothing behind, so that it is taken again when the training goes on.
    fn look(&mut self, go_on: &dyn Fn() -> bool) -> Result<Vec<Evaluation>, SessionError> {
        let Some(until) = self.goal.until.share().filter(|_| self.look_is_due()) else { return Ok(Vec::new()) };
        let (mut policy, mut taken) = (self.trainer.policy(), Vec::new());
        for episodes in [self.examiner.quick_episodes(), self.episodes()] {
            let number = self.memory.evaluations + taken.len() as u64 + 1;
            let Some(evaluation) = self.evaluate(&mut policy, episodes, number, go_on)? else {
                return Ok(taken);
            };
            let is_reached = reaches(&evaluation, until);
            taken.push(evaluation);
            if !is_reached {
                break;
            }
            if taken.len() == 2 {
                self.memory.confirmed = taken.last().cloned();
            }
        }
        let cost = self.examiner.cost(self.examiner.quick_episodes());
        self.memory.looked(self.trainer.env_steps(), cost, &taken);
        if let Some(record) = &mut self.record {
            record.changed();
        }
        Ok(taken)
    }

    /// Episodes, of each layout, of an evaluation that counts.
    fn episodes(&self) -> usize {
        let share = EPISODES_IN_ALL / self.trainer.spec().layouts();
        EPISODES.min(share.max(LEAST_EPISODES))
    }

    /// An evaluation; none if it was ended early.
    fn evaluate(
        &mut self,
        policy: &mut Policy,
        episodes: usize,
        number: u64,
        go_on: &dyn Fn() -> bool,
    ) -> Result<Option<Evaluation>, TrainError> {
        let start = Instant::now();
        let evaluation = examine(&mut self.examiner, policy, episodes, number, go_on);
        self.memory.evaluation_s += start.elapsed().as_secs_f64();
        evaluation
    }

    /// Writes a checkpoint if the training is recorded and the newest one is of another state.
    fn checkpoint(&mut self) -> Result<(), SessionError> {
        let Some(record) = self.record.as_mut().filter(|record| record.has_changed()) else { return Ok(()) };
        let mut checkpoint = self.trainer.save()?;
        let (memory, tries) = (self.memory.clone(), self.recovery.tries());
        let good = self.recovery.good_unless(&checkpoint).map(|good| Box::new(good.clone()));
        checkpoint.session = Some(SessionState { memory: Memory { tries, ..memory }, good });
        Ok(record.checkpoint(&checkpoint)?)
    }

    /// Closes the training: a last checkpoint, and an evaluation that had no say in when to stop. After a loss
    /// of the card, or an error, the newest checkpoint is left as it is: the run goes on from there as if it had never
    /// stopped.
    ///
    /// # Errors
    /// As for [`Session::advance`].
    pub fn conclude(mut self, end: End, go_on: &dyn Fn() -> bool) -> Result<Outcome, SessionError> {
        let (end, evaluation) = match self.finish(&end, go_on) {
            Err(SessionError::Train(error)) => (lost(error)?, None),
            // Stopped in the last evaluation: the training is whole, its evaluation is not.
            Ok(None) if !matches!(end, End::Interrupted | End::DeviceLost { .. }) => (End::Interrupted, None),
            finished => (end, finished?),
        };
        let folder = self.record.as_ref().map(Record::folder);
        let checkpoint = folder.map(|folder| folder.checkpoints()).transpose().map_err(RunError::from)?;
        Ok(Outcome {
            end,
            evaluation,
            trend: self.trend(),
            env_steps: self.trainer.env_steps(),
            updates: self.trainer.updates(),
            wall_s: self.trainer.wall_s() + self.memory.evaluation_s,
            checkpoint: checkpoint.and_then(|files| files.into_iter().next()),
            run: folder.map(|folder| folder.path().to_owned()),
        })
    }

    /// The last checkpoint and evaluation; no evaluation where there is none to be had.
    fn finish(&mut self, end: &End, go_on: &dyn Fn() -> bool) -> Result<Option<Evaluation>, SessionError> {
        if !self.is_sound || matches!(end, End::DeviceLost { .. }) {
            return Ok(None);
        }
        self.checkpoint()?;
        if *end == End::Interrupted {
            return Ok(None);
        }
        // Of a number that is not used up: the same evaluation ends a training that went on from here.
        let number = self.memory.evaluations + 1;
        let evaluation = self.evaluate(&mut self.trainer.policy(), self.episodes(), number, go_on)?;
        if let (Some(record), Some(evaluation)) = (&self.record, &evaluation) {
            record.folder().write_evaluation(evaluation)?;
        }
        Ok(evaluation)
    }
}

/// Whether so many episodes succeed, in every layout.
fn reaches(evaluation: &Evaluation, until: f64) -> bool {
    evaluation.least_success().is_some_and(|success| success >= until)
}

/// An evaluation; none if it was ended early.
fn examine(
    examiner: &mut Examiner,
    policy: &mut Policy,
    episodes: usize,
    number: u64,
    go_on: &dyn Fn() -> bool,
) -> Result<Option<Evaluation>, TrainError> {
    let evaluation = examiner.evaluate(policy, episodes, number, go_on)?;
    Ok(Some(evaluation).filter(|_| go_on()))
}

/// What an update came to.
enum Updated {
    Forward(UpdateMetrics),
    Back(News),
    Interrupted,
}

/// The end that the loss of a graphics card is; other errors stay errors.
fn lost(error: TrainError) -> Result<End, TrainError> {
    match error {
        TrainError::Env(EnvError::Gpu(GpuError::DeviceLost { reason }))
        | TrainError::Gpu(GpuError::DeviceLost { reason }) => Ok(End::DeviceLost { reason }),
        other => Err(other),
    }
}
