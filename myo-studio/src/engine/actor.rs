//! One simulated user at work, frame by frame: for replays, and for looking on while others train.

use myo_env::{Autoreset, CpuEnv, EnvConfig, EnvError, Skeleton, StepStorage, VectorEnv, excitation};
use myo_model::Model;
use myo_tasks::{Control, Task};
use myo_train::Policy;

use super::motion;
use crate::protocol::{MotionLayout, Refusal};

/// A user in an environment of its own, on the processor.
pub struct Actor {
    env: CpuEnv,
    skeleton: Skeleton,
    step: StepStorage,
    actions: Vec<f32>,
    /// Control steps since the episode began.
    steps: u32,
    control_dt: f64,
    control: Control,
    /// Mean squared control of the last action.
    effort: f64,
}

impl Actor {
    /// At the start of the first episode of a seed.
    ///
    /// # Errors
    /// The model or the task cannot be simulated.
    pub fn new(model: &Model, task: &Task, seed: u64) -> Result<Self, Refusal> {
        // The end of an episode is shown before the next one begins.
        let config = EnvConfig { num_envs: 1, seed, autoreset: Autoreset::NextStep, ..EnvConfig::default() };
        let mut env = CpuEnv::new(model, task, &config)?;
        let (skeleton, mut step) = (Skeleton::new(model, task)?, StepStorage::new(env.spec()));
        let (actions, control_dt) = (vec![0.0; env.spec().action_size()], env.spec().control_dt);
        env.reset(Some(seed), None, &mut step.observation)?;
        Ok(Self { env, skeleton, step, actions, steps: 0, control_dt, control: task.control, effort: 0.0 })
    }

    /// How the numbers of its frames lie.
    pub fn layout(&self) -> MotionLayout {
        motion::layout(&self.skeleton)
    }

    /// Time from one frame to the next (s).
    pub fn frame_s(&self) -> f64 {
        self.control_dt
    }

    /// Adds the frame of now.
    ///
    /// # Errors
    /// Never, for its own environment.
    pub fn push_frame(&self, numbers: &mut Vec<f32>) -> Result<(), EnvError> {
        let time_s = f64::from(self.steps) * self.control_dt;
        for moment in self.env.peek(0..1)? {
            motion::push_frame(&self.skeleton, &moment, time_s, numbers)?;
        }
        Ok(())
    }

    /// One control step under the mean actions of a policy; whether it ended the episode. The step after that begins the next one.
    ///
    /// # Errors
    /// The environment fails.
    ///
    /// # Panics
    /// If the policy is of another task.
    pub fn act(&mut self, policy: &mut Policy) -> Result<bool, EnvError> {
        let has_ended = self.step.terminated[0] || self.step.truncated[0];
        policy.act_deterministic(&self.step.observation, &mut self.actions);
        self.effort = self.asked()?;
        self.env.step(&self.actions, self.step.buffers())?;
        self.steps = if has_ended { 0 } else { self.steps + 1 };
        Ok(self.step.terminated[0] || self.step.truncated[0])
    }

    /// The step of the script that is to be done now; none where all are done.
    ///
    /// # Errors
    /// Never, for its own environment.
    pub fn current_step(&self) -> Result<Option<usize>, EnvError> {
        let moments = self.env.peek(0..1)?;
        moments.first().map_or(Ok(None), |moment| Ok(self.skeleton.pose(moment)?.step))
    }

    /// Mean squared control of the last action.
    pub const fn effort(&self) -> f64 {
        self.effort
    }

    /// Mean squared control that the actions ask for now.
    fn asked(&self) -> Result<f64, EnvError> {
        let moments = self.env.peek(0..1)?;
        let acts = moments.iter().flat_map(|moment| &moment.body.act);
        let control = |(&action, &act): (&f32, &f64)| excitation(self.control, f64::from(action), act);
        let squares = self.actions.iter().zip(acts).map(|pair| control(pair).powi(2));
        Ok(squares.sum::<f64>() / self.actions.len() as f64)
    }
}
