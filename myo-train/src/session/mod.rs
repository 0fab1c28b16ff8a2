//! A training from its start, or from a checkpoint, to its end: looks at the goal, records, goes back when learning runs
//! away, and tells when it leads nowhere.

mod curve;
mod examiner;
mod looks;
mod record;
mod recovery;

use std::fmt;
use std::path::PathBuf;
use std::time::Instant;

use myo_env::EnvError;
use myo_gpu::GpuError;
use thiserror::Error;

use crate::{Evaluation, Policy, RunError, RunWriter, TrainError, Trainer, UpdateMetrics};
use curve::Curve;
use looks::Looks;
use record::Record;
use recovery::Recovery;

pub use curve::Recent;
pub use examiner::{Examiner, evaluation_seed};

/// Episodes that confirm a quick look, and of the last evaluation.
const EPISODES: usize = 1000;

/// When to stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    /// When the deterministic policy succeeds in this share of fresh episodes, if at all.
    pub until: Option<f64>,
    /// After this many control steps of all environments in any case.
    pub steps: u64,
}

/// A training that is about to run.
pub struct Session {
    trainer: Trainer,
    examiner: Examiner,
    goal: Goal,
    looks: Option<Looks>,
    curve: Curve,
    recovery: Recovery,
    record: Option<Record>,
    told_flat: bool,
    /// Seconds of training, those before a resume included.
    training_s: f64,
    evaluation_s: f64,
    confirmed: Option<Evaluation>,
}

/// Why a training ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum End {
    /// The deterministic policy succeeds often enough.
    Until,
    /// The steps are used up.
    Steps,
    /// The caller wanted to.
    Interrupted,
    /// The graphics card was lost, and with it the episodes that were going on.
    DeviceLost {
        /// What the driver says.
        reason: String,
    },
}

impl End {
    /// Name in tables and JSON.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Until => "until",
            Self::Steps => "steps",
            Self::Interrupted => "interrupt",
            Self::DeviceLost { .. } => "device_lost",
        }
    }
}

/// Something that is worth a word.
#[derive(Clone, Debug, PartialEq)]
pub enum News {
    /// Learning ran away and goes on from an earlier state with shorter steps.
    WentBack {
        /// What was wrong.
        reason: String,
        /// Control steps at which it was noticed.
        env_steps: u64,
        /// Control steps of the state that it goes on from.
        to_env_steps: u64,
        /// Step size from there on.
        learning_rate: f64,
    },
    /// Nothing improves; told once.
    Flat {
        /// For how many control steps.
        env_steps: u64,
        /// What the episodes are like.
        recent: Recent,
    },
}

impl fmt::Display for News {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let million = |steps: &u64| *steps as f64 / 1e6;
        match self {
            Self::WentBack { reason, env_steps, to_env_steps, learning_rate } => write!(
                f,
                "training ran away after {:.2} M control steps: {reason}; it goes on from {:.2} M with steps of {learning_rate:.1e}",
                million(env_steps),
                million(to_env_steps)
            ),
            Self::Flat { env_steps, recent } => write!(
                f,
                "nothing has improved for {:.1} M control steps, success stays at {:.0} %",
                million(env_steps),
                100.0 * recent.success
            ),
        }
    }
}

/// What one [`Session::advance`] brought.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Progress {
    /// Of the update; none when the training went back, or the card was lost.
    pub metrics: Option<UpdateMetrics>,
    /// Mean success of recent training episodes, whose actions are noisy; none before the first ended.
    pub success: Option<f64>,
    /// Control steps that training may still take until the goal, judged by the learning curve.
    pub steps_left: Option<u64>,
    /// Looks that were taken at the deterministic policy.
    pub looks: Vec<Evaluation>,
    /// What is worth a word.
    pub news: Vec<News>,
    /// Set when the training is over.
    pub end: Option<End>,
}

/// How a training went.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Why it ended.
    pub end: End,
    /// Of the last policy on fresh episodes; none after an interrupt or a loss.
    pub evaluation: Option<Evaluation>,
    /// Control steps of all environments.
    pub env_steps: u64,
    /// Updates of the policy.
    pub updates: u64,
    /// Seconds of training and of the looks at the goal.
    pub wall_s: f64,
    /// The run folder, if the training was recorded.
    pub run: Option<PathBuf>,
    /// The newest checkpoint, if the training was recorded.
    pub checkpoint: Option<PathBuf>,
}

/// Why a training cannot go on.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SessionError {
    /// It failed.
    #[error(transparent)]
    Train(#[from] TrainError),
    /// Learning ran away from the same state again and again, with ever shorter steps.
    #[error(
        "training diverged {} times from the same state: {reason}. Start again with a lower learning_rate or kl_target",
        recovery::TRIES + 1
    )]
    RanAway {
        /// What was wrong the last time.
        reason: String,
    },
    /// It could not be recorded.
    #[error(transparent)]
    Run(#[from] RunError),
}

impl Session {
    /// Trains to a goal, looking at it with `examiner`.
    pub fn new(trainer: Trainer, examiner: Examiner, goal: Goal) -> Self {
        Self {
            looks: goal.until.map(|until| Looks::new(until, trainer.env_steps())),
            recovery: Recovery::new(&trainer),
            curve: Curve::new(first_whole_episodes(&trainer)),
            record: None,
            told_flat: false,
            training_s: 0.0,
            evaluation_s: 0.0,
            confirmed: None,
            trainer,
            examiner,
            goal,
        }
    }

    /// The same with metrics, checkpoints and evaluation in a run folder. A warm start is written there at once: stopped
    /// before its first update, it goes on without the other run's folder.
    ///
    /// # Errors
    /// The folder cannot be written.
    pub fn recorded_in(self, writer: RunWriter) -> Result<Self, RunError> {
        // A training with updates behind it comes from a checkpoint.
        let saved = Some(self.trainer.env_steps()).filter(|_| self.trainer.updates() > 0);
        let mut record = Record::new(writer, saved);
        if self.trainer.inherited().is_some() {
            record.checkpoint(&self.trainer)?;
        }
        Ok(Self { record: Some(record), ..self })
    }

    /// The learner.
    pub fn trainer(&self) -> &Trainer {
        &self.trainer
    }

    /// The goal.
    pub fn goal(&self) -> Goal {
        self.goal
    }

    /// One update, its record, and a look at the goal when it is time to. `go_on` is asked now and then and ends the
    /// training early.
    ///
    /// # Errors
    /// Training fails in a way that going back does not heal, or the record cannot be written. After an error the session
    /// is of no more use.
    pub fn advance(&mut self, go_on: &dyn Fn() -> bool) -> Result<Progress, SessionError> {
        match self.attempt(go_on) {
            // The loss of a graphics card is an end, not an error: a checkpoint can still be written.
            Err(SessionError::Train(error)) => Ok(Progress { end: Some(lost(error)?), ..Progress::default() }),
            advanced => advanced,
        }
    }

    fn attempt(&mut self, go_on: &dyn Fn() -> bool) -> Result<Progress, SessionError> {
        let updated = self.trainer.update();
        if let Some(reason) = self.recovery.what_ran_away(&updated, self.trainer.config().kl_max) {
            return self.go_back(reason);
        }
        let metrics = updated?;
        self.recovery.went_well(&self.trainer);
        self.training_s = metrics.wall_s;
        self.curve.hear(&metrics);
        self.record.as_mut().map_or(Ok(()), |record| record.hear(&metrics, &self.trainer))?;
        let looks = self.look(&metrics, go_on)?;
        Ok(Progress {
            success: self.success(),
            steps_left: self.looks.as_ref().and_then(|looks| self.curve.steps_to(looks.threshold())),
            news: self.flat().into_iter().collect(),
            end: self.end(go_on),
            metrics: Some(metrics),
            looks,
        })
    }

    fn end(&self, go_on: &dyn Fn() -> bool) -> Option<End> {
        if !go_on() {
            return Some(End::Interrupted);
        }
        let used_up = self.trainer.env_steps() >= self.goal.steps;
        self.confirmed.as_ref().map(|_| End::Until).or(used_up.then_some(End::Steps))
    }

    fn success(&self) -> Option<f64> {
        self.curve.recent().map(|recent| recent.success)
    }

    fn go_back(&mut self, reason: String) -> Result<Progress, SessionError> {
        let env_steps = self.trainer.env_steps();
        if !self.recovery.go_back(&mut self.trainer)? {
            return Err(SessionError::RanAway { reason });
        }
        let to_env_steps = self.trainer.env_steps();
        self.curve.cut(to_env_steps);
        if let Some(looks) = &mut self.looks {
            looks.gone_back(to_env_steps);
        }
        self.record.as_mut().map_or(Ok(()), |record| record.go_back(to_env_steps))?;
        let learning_rate = self.trainer.learning_rate();
        let news = vec![News::WentBack { reason, env_steps, to_env_steps, learning_rate }];
        Ok(Progress { success: self.success(), news, ..Progress::default() })
    }

    /// Tells once when nothing improves any more and the goal is out of sight.
    fn flat(&mut self) -> Option<News> {
        let far = self.looks.as_ref().zip(self.success()).is_some_and(|(looks, success)| success < looks.threshold());
        if self.told_flat || !far {
            return None;
        }
        let news = News::Flat { env_steps: self.curve.flat_for()?, recent: self.curve.recent()?.clone() };
        self.told_flat = true;
        Some(news)
    }

    /// Whether the goal is reached, looked at when it is time to: quickly first, then on enough other episodes to be sure.
    fn look(&mut self, metrics: &UpdateMetrics, go_on: &dyn Fn() -> bool) -> Result<Vec<Evaluation>, SessionError> {
        let (recent, mut taken) = (self.success(), Vec::new());
        if !self.looks.as_ref().is_some_and(|looks| looks.is_due(metrics, recent)) {
            return Ok(taken);
        }
        let mut policy = self.trainer.policy();
        for episodes in [self.examiner.quick_episodes(), EPISODES] {
            let Some(evaluation) = self.evaluate(&mut policy, episodes, go_on)? else { return Ok(taken) };
            let reached = evaluation.success >= self.goal.until;
            taken.push(evaluation);
            if !reached {
                break;
            }
            if taken.len() == 2 {
                self.confirmed = taken.last().cloned();
            }
        }
        let found = taken.last().and_then(|evaluation| evaluation.success);
        if let Some(looks) = &mut self.looks {
            let cost = self.examiner.cost(self.examiner.quick_episodes());
            looks.looked(metrics.env_steps, cost, found, recent);
        }
        Ok(taken)
    }

    /// An evaluation; none if it was ended early.
    fn evaluate(
        &mut self,
        policy: &mut Policy,
        episodes: usize,
        go_on: &dyn Fn() -> bool,
    ) -> Result<Option<Evaluation>, TrainError> {
        let start = Instant::now();
        let evaluation = self.examiner.evaluate(policy, episodes, go_on);
        self.evaluation_s += start.elapsed().as_secs_f64();
        Ok(Some(evaluation?).filter(|_| go_on()))
    }

    /// Closes the training: a last checkpoint, and, where it was not the goal that ended it, a last evaluation.
    ///
    /// # Errors
    /// As for [`Session::advance`].
    pub fn conclude(mut self, end: End, go_on: &dyn Fn() -> bool) -> Result<Outcome, SessionError> {
        self.record.as_mut().map_or(Ok(()), |record| record.checkpoint(&self.trainer))?;
        let wall_s = self.training_s + self.evaluation_s;
        let evaluation = match (&end, self.confirmed.take()) {
            (End::Interrupted | End::DeviceLost { .. }, _) => None,
            (_, Some(evaluation)) => Some(evaluation),
            _ => self.evaluate(&mut self.trainer.policy(), EPISODES, go_on)?,
        };
        if let (Some(record), Some(evaluation)) = (&self.record, &evaluation) {
            record.folder().write_evaluation(evaluation)?;
        }
        let end = match end {
            // Stopped in the last evaluation: the training is whole, its evaluation is not.
            End::Until | End::Steps if evaluation.is_none() => End::Interrupted,
            end => end,
        };
        let folder = self.record.as_ref().map(Record::folder);
        Ok(Outcome {
            end,
            evaluation,
            env_steps: self.trainer.env_steps(),
            updates: self.trainer.updates(),
            wall_s,
            checkpoint: folder.and_then(|folder| folder.checkpoints().into_iter().next()),
            run: folder.map(|folder| folder.path().to_owned()),
        })
    }
}

/// Control steps after which every environment has ended an episode.
fn first_whole_episodes(trainer: &Trainer) -> u64 {
    let spec = trainer.spec();
    trainer.env_steps() + (spec.num_envs * spec.max_episode_steps) as u64
}

/// The end that the loss of a graphics card is; other errors stay errors.
fn lost(error: TrainError) -> Result<End, TrainError> {
    match error {
        TrainError::Env(EnvError::Gpu(GpuError::DeviceLost { reason }))
        | TrainError::Gpu(GpuError::DeviceLost { reason }) => Ok(End::DeviceLost { reason }),
        other => Err(other),
    }
}
