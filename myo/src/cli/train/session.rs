//! One training from start, or from a checkpoint, to its end.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use myo::env::EnvError;
use myo::gpu::GpuError;
use myo::train::{Evaluation, RunWriter, TrainError, Trainer, UpdateMetrics};

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
    /// Control steps that the newest checkpoint has seen; none before the first.
    saved: Option<u64>,
    /// Why the graphics card was lost.
    lost: Option<String>,
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
    /// The graphics card, and with it the episodes that were going on.
    DeviceLost,
}

impl End {
    /// Name in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Self::Until => "until",
            Self::Steps => "steps",
            Self::Interrupted => "interrupt",
            Self::DeviceLost => "device_lost",
        }
    }
}

/// How a training went.
pub struct Outcome {
    /// Why it ended.
    pub end: End,
    /// Why the graphics card was lost, if it was.
    pub lost: Option<String>,
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
            // A training with updates behind it comes from a checkpoint.
            saved: Some(trainer.env_steps()).filter(|_| trainer.updates() > 0),
            lost: None,
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
            (End::Interrupted | End::DeviceLost, _) => None,
            (_, Some(evaluation)) => Some(evaluation),
            _ => self.evaluate(EPISODES, interrupt)?,
        };
        if let (Some(writer), Some(evaluation)) = (&self.writer, &evaluation) {
            writer.folder().write_evaluation(evaluation)?;
        }
        let end = match end {
            // Stopped in the last evaluation: the training is whole, its evaluation is not.
            End::Until | End::Steps if evaluation.is_none() => End::Interrupted,
            end => end,
        };
        Ok(Outcome {
            end,
            evaluation,
            lost: self.lost,
            env_steps: self.trainer.env_steps(),
            updates: self.trainer.updates(),
            wall_s,
            checkpoint: self.writer.as_ref().and_then(|writer| writer.folder().checkpoints().into_iter().next()),
            run: self.writer.map(|writer| writer.folder().path().to_owned()),
        })
    }

    /// Updates until there is a reason to stop; with the evaluation that was the reason.
    fn train(&mut self, interrupt: &Interrupt) -> Result<(End, Option<Evaluation>)> {
        while self.trainer.env_steps() < self.steps {
            let metrics = match self.trainer.update() {
                Err(
                    TrainError::Env(EnvError::Gpu(GpuError::DeviceLost { reason }))
                    | TrainError::Gpu(GpuError::DeviceLost { reason }),
                ) => {
                    self.lost = Some(reason);
                    return Ok((End::DeviceLost, None));
                }
                updated => updated?,
            };
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
        let steps = Some(self.trainer.env_steps());
        // One that is there already is not written again: after a loss it has the episodes, a new one would not.
        if let (Some(writer), true) = (&mut self.writer, self.saved != steps) {
            writer.write_checkpoint(&self.trainer.save())?;
            self.saved = steps;
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

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::cli::train::settings;
    use myo::env::{CpuEnv, EnvConfig, EnvSpec, StepBuffers, VectorEnv};
    use myo::train::RunFolder;

    /// Environments on a graphics card that is lost after some steps.
    struct Doomed {
        env: CpuEnv,
        steps: usize,
    }

    fn lost() -> EnvError {
        EnvError::Gpu(GpuError::DeviceLost { reason: "unplugged".into() })
    }

    impl VectorEnv for Doomed {
        fn spec(&self) -> &EnvSpec {
            self.env.spec()
        }
        fn reset(
            &mut self,
            seed: Option<u64>,
            mask: Option<&[bool]>,
            out: &mut [f32],
        ) -> std::result::Result<(), EnvError> {
            self.env.reset(seed, mask, out)
        }
        fn step(&mut self, actions: &[f32], out: StepBuffers<'_>) -> std::result::Result<(), EnvError> {
            self.steps = self.steps.checked_sub(1).ok_or(lost())?;
            self.env.step(actions, out)
        }
        fn save_state(&self) -> std::result::Result<Vec<u8>, EnvError> {
            if self.steps == 0 { Err(lost()) } else { self.env.save_state() }
        }
        fn load_state(&mut self, state: &[u8]) -> std::result::Result<(), EnvError> {
            self.env.load_state(state)
        }
    }

    fn env(stage: &Stage) -> CpuEnv {
        CpuEnv::new(&stage.model, &stage.task, &EnvConfig { num_envs: 8, ..EnvConfig::default() }).unwrap()
    }

    /// Trains two updates in a folder, then is lost in the middle of the third.
    fn lose_device(stage: &Stage, folder: &Path) -> Outcome {
        let config = settings(Some(8), &["steps_per_update=4".into()]).unwrap();
        let env = Box::new(Doomed { env: env(stage), steps: 2 * 4 + 2 });
        let trainer = Trainer::new(env, config.clone(), 1).unwrap();
        let names = &trainer.spec().episode_names;
        let writer = RunWriter::create(folder, serde_json::Value::Null, &config, 1, names).unwrap();
        Session::new(stage, trainer, None, 1000).recorded_in(writer).run(&Interrupt::default()).unwrap()
    }

    #[test]
    fn a_lost_device_leaves_a_checkpoint_that_goes_on() {
        let stage = Stage::open("pointing-single").unwrap();
        let place = tempfile::tempdir().unwrap();
        let folder = place.path().join("run");
        let outcome = lose_device(&stage, &folder);
        assert_eq!((outcome.end, outcome.lost.as_deref()), (End::DeviceLost, Some("unplugged")));
        assert_eq!((outcome.env_steps, outcome.updates, outcome.evaluation), (2 * 8 * 4, 2, None));
        let checkpoint = outcome.checkpoint.unwrap();
        assert!(checkpoint.ends_with("checkpoints/step_000000000064.ckpt"), "{}", checkpoint.display());

        let latest = RunFolder::open(&folder).unwrap().latest_checkpoint().checkpoint.unwrap();
        let mut trainer = Trainer::restore(Box::new(env(&stage)), &latest).unwrap();
        trainer.update().unwrap();
        assert_eq!(trainer.env_steps(), 3 * 8 * 4);
    }

    #[test]
    fn a_checkpoint_with_its_episodes_is_kept_when_the_device_is_lost() {
        let stage = Stage::open("pointing-single").unwrap();
        let place = tempfile::tempdir().unwrap();
        let folder = place.path().join("run");
        let outcome = lose_device(&stage, &folder);
        let path = outcome.checkpoint.unwrap();
        let (whole, names) = {
            let latest = RunFolder::open(&folder).unwrap().latest_checkpoint().checkpoint.unwrap();
            let trainer = Trainer::restore(Box::new(env(&stage)), &latest).unwrap();
            (trainer.save(), trainer.spec().episode_names.clone())
        };
        whole.write(&path).unwrap();
        let written = std::fs::read(&path).unwrap();

        let env = Box::new(Doomed { env: env(&stage), steps: 2 });
        let trainer = Trainer::restore(env, &whole).unwrap();
        let writer = RunWriter::resume(&folder, trainer.env_steps(), &names).unwrap();
        let outcome = Session::new(&stage, trainer, None, 1000).recorded_in(writer).run(&Interrupt::default()).unwrap();
        assert_eq!(outcome.end, End::DeviceLost);
        assert!(written == std::fs::read(&path).unwrap());
    }
}
