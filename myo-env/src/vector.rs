//! The vectorised environment: what a trainer sees of any backend.

use thiserror::Error;

use crate::config::BuildError;
use crate::control::explore::LEFT;
use crate::snapshot::Snapshot;
use myo_tasks::Task;
use std::ops::Range;

/// What happens when an episode ends, in the words of Gymnasium's `AutoresetMode`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Autoreset {
    /// The step that ends an episode already returns the first observation of the next one.
    #[default]
    SameStep,
    /// The step after the end ignores the action and returns the reset observation, reward 0.
    NextStep,
    /// The caller resets with a mask; stepping a finished environment is an error.
    Disabled,
}

/// Sizes and names that stay fixed for the life of an environment.
#[derive(Clone, Debug, PartialEq)]
pub struct EnvSpec {
    /// Number of environments.
    pub num_envs: usize,
    /// Names of the entries of one observation, in order; its length is the observation size.
    pub observation_names: Vec<String>,
    /// Names of the actuators, in order; its length is the action size. Actions lie in [-1, 1].
    pub action_names: Vec<String>,
    /// Names of the columns of one episode summary (see [`StepBuffers::episode`]), in order.
    pub episode_names: Vec<String>,
    /// Seconds of simulated time per control step.
    pub control_dt: f64,
    /// Control steps after which an episode is truncated; of the longest time limit where there are several layouts.
    pub max_episode_steps: usize,
    /// The same of each layout: environment `env` does the layout of number `env` modulo how many there are. Empty in environments
    /// that know of none.
    pub layout_limits: Vec<usize>,
    /// How finished environments start again.
    pub autoreset: Autoreset,
    /// The last so many environments begin their episodes in the middle of the task, see [`EnvConfig::exploring`](crate::EnvConfig).
    pub exploring: usize,
}

impl EnvSpec {
    /// Environments whose episodes are whole, from the first target to the last: the first so many.
    pub fn whole_episodes(&self) -> usize {
        self.num_envs - self.exploring
    }
    /// How many layouts there are, at least 1.
    pub fn layouts(&self) -> usize {
        self.layout_limits.len().max(1)
    }

    /// Control steps from one cut by the time limit to the next of the same environment, at least; 1 or more.
    pub fn steps_between_cuts(&self) -> usize {
        let share = if self.exploring > 0 { LEFT[0] } else { 1.0 };
        let shortest = self.layout_limits.iter().copied().min().unwrap_or(self.max_episode_steps);
        ((share * shortest as f64) as usize).max(1)
    }
    /// Number of entries of one observation.
    pub fn observation_size(&self) -> usize {
        self.observation_names.len()
    }
    /// Number of entries of one action.
    pub fn action_size(&self) -> usize {
        self.action_names.len()
    }
    /// Number of columns of one episode summary.
    pub fn episode_size(&self) -> usize {
        self.episode_names.len()
    }
    /// Bytes of actions and [`StepBuffers`] per environment.
    pub(crate) fn bytes_per_env(&self) -> usize {
        4 * (self.action_size() + 2 * self.observation_size() + self.episode_size() + 1) + 2
    }
}

/// Memory that the caller owns and one step writes; row-major, first axis `num_envs`.
pub struct StepBuffers<'a> {
    /// Next observation, `(num_envs, observation_size)`.
    pub observation: &'a mut [f32],
    /// Reward, `(num_envs)`.
    pub reward: &'a mut [f32],
    /// The task ended the episode (all targets done), `(num_envs)`.
    pub terminated: &'a mut [bool],
    /// The time limit ended the episode and the task did not, `(num_envs)`.
    pub truncated: &'a mut [bool],
    /// Last observation of the episode that just ended, `(num_envs, observation_size)`; rows of environments that
    /// did not end keep their old contents.
    pub final_observation: &'a mut [f32],
    /// Summary of the episode that just ended, `(num_envs, episode_size)`; rows of environments that did not end
    /// keep their old contents.
    pub episode: &'a mut [f32],
}

/// [`StepBuffers`] as vectors, for callers that have no memory of their own.
#[derive(Clone, Debug, Default)]
pub struct StepStorage {
    /// See [`StepBuffers::observation`].
    pub observation: Vec<f32>,
    /// See [`StepBuffers::reward`].
    pub reward: Vec<f32>,
    /// See [`StepBuffers::terminated`].
    pub terminated: Vec<bool>,
    /// See [`StepBuffers::truncated`].
    pub truncated: Vec<bool>,
    /// See [`StepBuffers::final_observation`].
    pub final_observation: Vec<f32>,
    /// See [`StepBuffers::episode`].
    pub episode: Vec<f32>,
}

impl StepStorage {
    /// Zeroed buffers of the right sizes.
    pub fn new(spec: &EnvSpec) -> Self {
        let n = spec.num_envs;
        Self {
            observation: vec![0.0; n * spec.observation_size()],
            reward: vec![0.0; n],
            terminated: vec![false; n],
            truncated: vec![false; n],
            final_observation: vec![0.0; n * spec.observation_size()],
            episode: vec![0.0; n * spec.episode_size()],
        }
    }

    /// The buffers to pass to [`VectorEnv::step`].
    pub fn buffers(&mut self) -> StepBuffers<'_> {
        StepBuffers {
            observation: &mut self.observation,
            reward: &mut self.reward,
            terminated: &mut self.terminated,
            truncated: &mut self.truncated,
            final_observation: &mut self.final_observation,
            episode: &mut self.episode,
        }
    }
}

/// Why an environment refused a call; the environment is unchanged.
#[derive(Debug, Error, Clone, PartialEq)]
#[non_exhaustive]
pub enum EnvError {
    /// A slice has the wrong length.
    #[error("{what} has {got} entries, expected {expected}")]
    WrongLength {
        /// Which argument.
        what: &'static str,
        /// Its length.
        got: usize,
        /// The right length.
        expected: usize,
    },
    /// An action is NaN or infinite.
    #[error("action {index} of environment {env} is {value}; actions must be finite")]
    NonFiniteAction {
        /// Environment.
        env: usize,
        /// Entry of the action.
        index: usize,
        /// Its value.
        value: f32,
    },
    /// With [`Autoreset::Disabled`]: a finished environment was stepped.
    #[error("environment {env} has finished its episode; reset it before the next step (autoreset is disabled)")]
    NeedsReset {
        /// Environment.
        env: usize,
    },
    /// Environments were asked for that there are not.
    #[error("environments {start}..{end} were asked for; there are {num_envs}, counted from 0")]
    NoSuchEnvironment {
        /// The first one.
        start: usize,
        /// The one after the last.
        end: usize,
        /// How many there are.
        num_envs: usize,
    },
    /// A share of the costs of movement is not one.
    #[error("the share of what movement costs is {share}; it must be from 0 to 1")]
    BadShare {
        /// What was given.
        share: f64,
    },
    /// The environments have no body and no task that could be looked at.
    #[error("there is nothing to see in these environments")]
    Unseen,
    /// A saved state does not belong to this environment.
    #[error("the saved environment state does not fit: {reason}")]
    BadState {
        /// What differs.
        reason: String,
    },
    /// The environment can do no other task.
    #[error("the task cannot take the place of the one before: {what}")]
    OtherTask {
        /// Why, as half a sentence.
        what: String,
    },
    /// The graphics card failed. After a loss of the device the environment is gone.
    #[cfg(feature = "gpu")]
    #[error(transparent)]
    Gpu(#[from] myo_gpu::GpuError),
}

impl EnvError {
    /// Of what [`Tables::set_task`](crate::Tables::set_task) says.
    pub(crate) fn other_task(error: BuildError) -> Self {
        Self::OtherTask {
            what: match error {
                BuildError::OtherStructure { what } => what,
                other => other.to_string(),
            },
        }
    }
}

/// Many independent copies of one task, stepped together.
///
/// The same seed and the same actions give the same results, bit for bit, at any number of threads.
pub trait VectorEnv: Send {
    /// Sizes and names.
    fn spec(&self) -> &EnvSpec;

    /// Starts fresh episodes where `mask` is true (everywhere without a mask) and writes all observations,
    /// `(num_envs, observation_size)`; rows outside the mask are the current observations.
    ///
    /// A seed restarts the random streams of all masked environments; without one they continue.
    fn reset(&mut self, seed: Option<u64>, mask: Option<&[bool]>, observation: &mut [f32]) -> Result<(), EnvError>;

    /// One control step of every environment. `actions` is `(num_envs, action_size)`, clipped to [-1, 1].
    fn step(&mut self, actions: &[f32], out: StepBuffers<'_>) -> Result<(), EnvError>;

    /// Some environments as they are now, for whoever looks on; nothing changes. Only what is asked for is copied: on a graphics
    /// card 4 bytes for each number of the state of each of these environments, with one wait.
    ///
    /// # Errors
    /// [`EnvError::NoSuchEnvironment`] where the range goes backwards or past the end, [`EnvError::Unseen`], the card failed.
    fn peek(&self, envs: Range<usize>) -> Result<Vec<Snapshot>, EnvError> {
        let _ = envs;
        Err(EnvError::Unseen)
    }

    /// Everything that the next steps depend on, as bytes with a checksum; [`VectorEnv::load_state`] continues bit for bit.
    /// Which episodes are over is part of it.
    fn save_state(&self) -> Result<Vec<u8>, EnvError>;

    /// Restores what [`VectorEnv::save_state`] returned for an environment of the same model, task and size.
    ///
    /// # Errors
    /// [`EnvError::BadState`] where the bytes are damaged or of something else; the environment is unchanged then.
    fn load_state(&mut self, state: &[u8]) -> Result<(), EnvError>;

    /// Goes on with another task of the same structure, whose numbers alone differ; nothing is compiled. Weights of the reward,
    /// dwell, forces, noise, fatigue, the time limit and where buttons are count from the next step on, where spheres are from an
    /// environment's next episode on. Observations of before are out of date: a [reset](Self::reset) of no environment gives the new ones.
    ///
    /// # Errors
    /// [`EnvError::OtherTask`] where the structure differs, values are out of bounds or the environment knows no tasks; it is
    /// unchanged then.
    fn set_task(&mut self, task: &Task) -> Result<(), EnvError> {
        self.set_tasks(std::slice::from_ref(task))
    }

    /// The same with several tasks of one structure: environment `env` does the task of number `env` modulo how many there are.
    /// More than one needs environments that were made with several layouts.
    ///
    /// # Errors
    /// As for [`set_task`](Self::set_task); there is no task, or more than environments.
    fn set_tasks(&mut self, tasks: &[Task]) -> Result<(), EnvError> {
        let _ = tasks;
        Err(EnvError::OtherTask { what: "these environments have no task".into() })
    }

    /// Lets only so much of what movements and errors cost count, from 0 to 1, from the next step on; all of it counts where this was
    /// never called. Neither saved states nor [other tasks](Self::set_tasks) change it. Environments where neither costs anything, or that
    /// are judged by code, need not do anything.
    ///
    /// # Errors
    /// [`EnvError::BadShare`], the card failed; it is unchanged then.
    fn set_cost_share(&mut self, share: f64) -> Result<(), EnvError> {
        let _ = share;
        Ok(())
    }
}
