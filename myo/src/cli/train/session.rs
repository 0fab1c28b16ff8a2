//! One training from start, or from a checkpoint, to its end.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use myo::train::{Evaluation, RunWriter, Trainer, UpdateMetrics};

use super::examiner::Examiner;
use super::progress::Progress;
use super::schedule::Schedule;
use crate::cli::failure::Result;
use crate::cli::interrupt::Interrupt;
use crate::cli::stage::Stage;

/// Time between two checkpoints: what a crash may cost.
const CHECKPOINT_EVERY: Duration = Duration::from_secs(30);

/// Episodes of a quick look.
const QUICK_EPISODES: usize = 256;

/// Episodes that confirm a quick look, and of the last evaluation.
const EPISODES: usize = 1000;

/// A training that is about to run.
pub struct Session<'a> {
    trainer: Trainer,
    examiner: Examiner<'a>,
    schedule: Option<Schedule>,
    until: Option<f64>,
    steps: u64,
    writer: Option<RunWriter>,
    last_checkpoint: Instant,
    progress: Progress,
    /// Seconds of training, those before a resume included.
    training_s: f64,
    evaluation_s: f64,
}

/// Why a training ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// The deterministic policy succeeds often enough.
    Until,
    /// The steps are used up.
    Steps,
    /// Ctrl-C.
    Interrupted,
}

impl End {
    /// Name in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Self::Until => "until",
            Self::Steps => "steps",
            Self::Interrupted => "interrupt",
        }
    }
}

/// How a training went.
pub struct Outcome {
    /// Why it ended.
    pub end: End,
    /// Of the last policy on fresh episodes; none after an interrupt.
    pub evaluation: Option<Evaluation>,
    /// Control steps of all environments.
    pub env_steps: u64,
    /// Updates of the policy.
    pub updates: u64,
    /// Seconds of training and of the looks at the goal.
    pub wall_s: f64,
    /// The run folder, if the training was recorded.
    pub run: Option<PathBuf>,
}

impl<'a> Session<'a> {
    /// Trains until the deterministic policy's success is `until`, at most to `steps` control steps in all.
    pub fn new(stage: &'a Stage, trainer: Trainer, until: Option<f64>, steps: u64) -> Self {
        Self {
            examiner: Examiner::new(stage, trainer.seed()),
            schedule: until.map(|until| Schedule::new(until, trainer.env_steps())),
            until,
            steps,
            writer: None,
            last_checkpoint: Instant::now(),
            progress: Progress::new(steps),
            training_s: 0.0,
            evaluation_s: 0.0,
            trainer,
        }
    }

    /// The same with metrics, checkpoints and evaluation in a run folder.
    pub fn recorded_in(self, writer: RunWriter) -> Self {
        Self { writer: Some(writer), ..self }
    }

    /// The seed of the training.
    pub fn seed(&self) -> u64 {
        self.trainer.seed()
    }

    /// The goal.
    pub fn until(&self) -> Option<f64> {
        self.until
    }

    /// Trains to the end.
    pub fn run(mut self, interrupt: &Interrupt) -> Result<Outcome> {
        let trained = self.train(interrupt);
        self.progress.finish();
        let (end, confirmed) = trained?;
        self.checkpoint()?;
        let wall_s = self.training_s + self.evaluation_s;
        let evaluation = match (end, confirmed) {
            (End::Interrupted, _) => None,
            (_, Some(evaluation)) => Some(evaluation),
            _ => self.evaluate(EPISODES, interrupt)?,
        };
        if let (Some(writer), Some(evaluation)) = (&self.writer, &evaluation) {
            writer.folder().write_evaluation(evaluation)?;
        }
        Ok(Outcome {
            // Stopped in the last evaluation: the training is whole, its evaluation is not.
            end: if evaluation.is_none() { End::Interrupted } else { end },
            evaluation,
            env_steps: self.trainer.env_steps(),
            updates: self.trainer.updates(),
            wall_s,
            run: self.writer.map(|writer| writer.folder().path().to_owned()),
        })
    }

    /// Updates until there is a reason to stop; with the evaluation that was the reason.
    fn train(&mut self, interrupt: &Interrupt) -> Result<(End, Option<Evaluation>)> {
        while self.trainer.env_steps() < self.steps {
            let metrics = self.trainer.update()?;
            self.training_s = metrics.wall_s;
            self.record(&metrics)?;
            let reached = self.look(&metrics, interrupt)?;
            if interrupt.wanted() {
                return Ok((End::Interrupted, None));
            }
            if reached.is_some() {
                return Ok((End::Until, reached));
            }
        }
        Ok((End::Steps, None))
    }

    fn record(&mut self, metrics: &UpdateMetrics) -> Result<()> {
        if let Some(writer) = &mut self.writer {
            writer.record(metrics)?;
        }
        if self.last_checkpoint.elapsed() >= CHECKPOINT_EVERY {
            self.checkpoint()?;
        }
        Ok(())
    }

    fn checkpoint(&mut self) -> Result<()> {
        if let Some(writer) = &mut self.writer {
            writer.write_checkpoint(&self.trainer.save())?;
        }
        self.last_checkpoint = Instant::now();
        Ok(())
    }

    /// Whether the goal is reached, looked at when it is time to: quickly first, then on enough episodes to be sure.
    fn look(&mut self, metrics: &UpdateMetrics, interrupt: &Interrupt) -> Result<Option<Evaluation>> {
        let due = self.schedule.as_mut().is_some_and(|schedule| schedule.is_due(metrics));
        let recent = self.schedule.as_ref().and_then(Schedule::recent_success);
        self.progress.show(metrics, recent.or_else(|| metrics.episode_mean("success")));
        if !due {
            return Ok(None);
        }
        let mut cost = 0;
        let mut reached = None;
        for episodes in [QUICK_EPISODES, EPISODES] {
            reached = self.evaluate(episodes, interrupt)?;
            cost += self.examiner.cost(episodes);
            reached = reached.filter(|evaluation| evaluation.success >= self.until);
            if reached.is_none() {
                break;
            }
        }
        if let Some(schedule) = &mut self.schedule {
            schedule.looked(metrics.env_steps, cost);
        }
        Ok(reached)
    }

    fn evaluate(&mut self, episodes: usize, interrupt: &Interrupt) -> Result<Option<Evaluation>> {
        let start = Instant::now();
        let evaluation = self.examiner.evaluate(&mut self.trainer.policy(), episodes, interrupt);
        self.evaluation_s += start.elapsed().as_secs_f64();
        evaluation
    }
}
