//! One environment, for a first look, tests and renderings: the vector environment with the vectors taken off.

use crate::batch::CpuEnv;
use crate::config::{BuildError, EnvConfig};
use crate::rules::Rules;
use crate::snapshot::Snapshot;
use crate::vector::{Autoreset, EnvError, EnvSpec, StepStorage, VectorEnv};
use myo_model::Model;
use myo_tasks::Task;

/// One environment. It does not reset itself: after the end of an episode call [`Env::reset`].
pub struct Env {
    inner: CpuEnv,
    out: StepStorage,
}

/// What one step returned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step<'a> {
    /// Next observation.
    pub observation: &'a [f32],
    /// Reward.
    pub reward: f32,
    /// The task is done.
    pub terminated: bool,
    /// The time is up and the task is not done.
    pub truncated: bool,
}

fn config(seed: u64) -> EnvConfig {
    EnvConfig { num_envs: 1, seed, autoreset: Autoreset::Disabled, ..EnvConfig::default() }
}

impl Env {
    /// Builds the environment and starts its first episode.
    pub fn new(model: &Model, task: &Task, seed: u64) -> Result<Self, BuildError> {
        Ok(Self::start(CpuEnv::new(model, task, &config(seed))?, seed))
    }

    /// The same with rules of one's own in place of the task's script.
    ///
    /// # Errors
    /// As for [`CpuEnv::with_rules`].
    pub fn with_rules(model: &Model, task: &Task, rules: &impl Rules, seed: u64) -> Result<Self, BuildError> {
        Ok(Self::start(CpuEnv::with_rules(model, task, rules, &config(seed))?, seed))
    }

    fn start(mut inner: CpuEnv, seed: u64) -> Self {
        let mut out = StepStorage::new(inner.spec());
        inner.reset(Some(seed), None, &mut out.observation).expect("the storage was made to fit");
        Self { inner, out }
    }

    /// Sizes and names.
    pub fn spec(&self) -> &EnvSpec {
        self.inner.spec()
    }

    /// The current observation.
    pub fn observation(&self) -> &[f32] {
        &self.out.observation
    }

    /// The environment as it is now, for a [`Skeleton`](crate::Skeleton).
    pub fn peek(&self) -> Snapshot {
        let seen = self.inner.peek(0..1).ok().and_then(|mut seen| seen.pop());
        seen.expect("there is one environment")
    }

    /// Starts a fresh episode; a seed restarts the random stream, without one it continues.
    pub fn reset(&mut self, seed: Option<u64>) -> &[f32] {
        self.inner.reset(seed, None, &mut self.out.observation).expect("the storage was made to fit");
        &self.out.observation
    }

    /// One control step with one action per muscle in [-1, 1].
    pub fn step(&mut self, action: &[f32]) -> Result<Step<'_>, EnvError> {
        self.inner.step(action, self.out.buffers())?;
        let out = &self.out;
        Ok(Step {
            observation: &out.observation,
            reward: out.reward[0],
            terminated: out.terminated[0],
            truncated: out.truncated[0],
        })
    }
}
