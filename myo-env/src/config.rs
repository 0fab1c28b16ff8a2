//! What a caller chooses about a batch of environments, and why one cannot be built.

use crate::memory::MOST_ENVS;
use crate::native::NotCompiled;
use crate::vector::Autoreset;
use myo_dynamics::PlanError;
use myo_scalar::{Level, LevelError};
use myo_tasks::InvalidTask;
use thiserror::Error;

/// Most threads of one pool.
pub const MOST_THREADS: usize = 1024;

/// Choices that are not part of the task.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnvConfig {
    /// Number of environments.
    pub num_envs: usize,
    /// Seed of all random draws.
    pub seed: u64,
    /// How finished environments start again.
    pub autoreset: Autoreset,
    /// Threads of an own pool, 1 to [`MOST_THREADS`]; without it the caller's rayon pool is used.
    pub threads: Option<usize>,
    /// Instruction-set level; without it that of [`Level::detect`].
    pub level: Option<Level>,
    /// Whether control steps are machine code that is compiled for the model and task (AVX-512, on the CPU), 1.6 to 1.9 times as fast as lanes that go
    /// through their tables; results differ by rounding. Without it they are from 256 environments on, where there can be such code.
    pub native: Option<bool>,
    /// The last so many environments begin their episodes in the middle of the task, drawn anew each time: with any of the
    /// targets, as if those before it were done, with a tenth to a half of the time left, and in that of eight random poses from
    /// which the fingertip has the least way to go. Of episodes after a failure three of four begin with the target that was not
    /// done, in the best of 32 poses; after a success every other episode is a whole one. Exploring starts (Sutton and Barto 2018,
    /// section 5.3), for training alone.
    /// More than there are means all.
    pub exploring: usize,
}

impl Default for EnvConfig {
    fn default() -> Self {
        Self {
            num_envs: 1,
            seed: 0,
            autoreset: Autoreset::default(),
            threads: None,
            level: None,
            native: None,
            exploring: 0,
        }
    }
}

/// Why an environment cannot be built.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum BuildError {
    /// No environments.
    #[error("num_envs is 0; at least one environment is needed")]
    NoEnvironments,
    /// The model cannot be simulated.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// The body is not that of the task's user.
    #[error(
        "the task's user changes the model by: {}; the body that is given was changed by: {}. Make it with `task.embody(&description)`",
        change(task),
        change(body)
    )]
    OtherBody {
        /// In what the user's body differs from the model, as the task has it.
        task: String,
        /// The same of the body that was given.
        body: String,
    },
    /// The task has values out of bounds.
    #[error(transparent)]
    Task(#[from] InvalidTask),
    /// More boxes in one place than are simulated.
    #[error(
        "{contacts} boxes of the task stand so close together that the fingertip may touch them all at once; at most {most} are simulated: move them apart, or leave some out"
    )]
    Crowded {
        /// How many there are.
        contacts: usize,
        /// How many there may be.
        most: usize,
    },
    /// Rules of one's own that cannot judge as they are.
    #[error("the rules `{name}` {problem}")]
    Rules {
        /// Their name.
        name: String,
        /// What is wrong, as the rest of the sentence.
        problem: String,
    },
    /// An empty list of layouts.
    #[error("there is no layout; give at least one task")]
    NoLayouts,
    /// Layouts that no environment would do.
    #[error("{layouts} layouts need an environment each; there are {num_envs}")]
    IdleLayouts {
        /// How many layouts there are.
        layouts: usize,
        /// How many environments there are.
        num_envs: usize,
    },
    /// A task was to be exchanged for one that code would have to be compiled for.
    #[error("the task cannot take the place of the one before: {what}; make new environments")]
    OtherStructure {
        /// What differs, as half a sentence.
        what: String,
    },
    /// `MYO_LEVEL` asks for a level of instructions that there is not.
    #[error(transparent)]
    Level(#[from] LevelError),
    /// Machine code was asked for, and there is none.
    #[error("no machine code can be made: {0}; leave `native` out, or set it to false")]
    NotCompiled(#[from] NotCompiled),
    /// More environments than are numbered.
    #[error("{num_envs} environments are asked for; one batch has at most {MOST_ENVS}")]
    TooManyEnvironments {
        /// How many were asked for.
        num_envs: usize,
    },
    /// Not enough memory.
    #[error("{num_envs} environments need {bytes} bytes{}; take fewer", known(*.available))]
    OutOfMemory {
        /// How many were asked for.
        num_envs: usize,
        /// What they need.
        bytes: u64,
        /// What the machine has left, as far as it says so.
        available: Option<u64>,
    },
    /// Not enough memory on the graphics card.
    #[cfg(feature = "gpu")]
    #[error("{num_envs} environments need {bytes} bytes on {device}: {refusal}; take fewer")]
    OutOfGpuMemory {
        /// How many were asked for.
        num_envs: usize,
        /// What they need.
        bytes: u64,
        /// Name of the card.
        device: String,
        /// Where it ended.
        refusal: myo_gpu::GpuError,
    },
    /// The graphics card cannot run it.
    #[cfg(feature = "gpu")]
    #[error(transparent)]
    Gpu(#[from] myo_gpu::GpuError),
    /// The kernel would not fit a graphics card.
    #[cfg(feature = "gpu")]
    #[error(
        "model and task take {operations} operations in one kernel, more than the {most} that graphics drivers compile in \
         reasonable time; take the cpu backend, or simplify the model"
    )]
    TooLargeForGpu {
        /// Operations of the kernel.
        operations: usize,
        /// Most that are tried.
        most: usize,
    },
    /// The driver of the graphics card broke down over the kernel.
    #[cfg(feature = "gpu")]
    #[error(
        "the driver of the graphics card broke down over the {operations} operations that model and task take in one kernel \
         ({reason}); take the cpu backend, or simplify the model: fewer joints, muscles or contacts"
    )]
    DriverBrokeDown {
        /// Operations of the kernel.
        operations: usize,
        /// What the driver said.
        reason: String,
    },
    /// Convex meshes touch, or boxes anything but planes, spheres and capsules, which no kernel looks for.
    #[cfg(feature = "gpu")]
    #[error(
        "contacts of meshes, and of boxes with anything but planes, spheres and capsules, are not simulated on graphics cards; take the cpu backend, or import the body without contacts \
         (`myo model import --without-contacts`)"
    )]
    MeshesOnGpu,
    /// No threads, or more than any machine has use for: starting them would stall it.
    #[error("threads is {threads}; it must be from 1 to {MOST_THREADS}")]
    BadThreads {
        /// How many were asked for.
        threads: usize,
    },
    /// The thread pool could not be made.
    #[error("a pool of {threads} threads could not be started: {reason}")]
    Threads {
        /// How many were asked for.
        threads: usize,
        /// What the system said.
        reason: String,
    },
}

/// What a body differs in, for people.
fn change(words: &str) -> &str {
    if words.is_empty() { "nothing" } else { words }
}

/// Every layout needs an environment: number `env` does the task of number `env` modulo how many there are.
pub(crate) fn check_layouts(layouts: usize, num_envs: usize) -> Result<(), BuildError> {
    if layouts > num_envs { Err(BuildError::IdleLayouts { layouts, num_envs }) } else { Ok(()) }
}

fn known(available: Option<u64>) -> String {
    available
        .map_or_else(|| ", which the system refused".into(), |bytes| format!(", and this machine has {bytes} left"))
}
