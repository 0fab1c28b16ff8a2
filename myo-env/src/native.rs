//! Control steps as machine code, made for one model and task.
//!
//! The recorded program of a control step runs on a block of environments; resets, which are rare, go through lanes as ever.

use crate::config::{BuildError, EnvConfig};
use crate::control::Judge;
use crate::record::{RESULT_ROWS, counted_step};
use crate::storage::WORDS;
use crate::tables::Tables;
use crate::vector::{Autoreset, EnvSpec};
use myo_dynamics::SolverCount;
use myo_native::{LANES, Memory, NativeError, Routine, View};
use myo_scalar::{Level, Real};
use std::sync::Arc;

/// Environments from which on compiling is worth it, where nobody says: it takes as long as some thousand control steps.
const WORTH_IT: usize = 256;
/// Operations beyond which compiling takes seconds.
const MOST_OPERATIONS: usize = 150_000;

/// Why there is no machine code of a model and task.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum NotCompiled {
    /// What touches is looked for one environment at a time.
    #[error(
        "contacts of meshes, and of boxes with anything but planes, spheres and capsules, are looked for one environment at a time"
    )]
    OneByOne,
    /// It would take long.
    #[error("a control step takes {operations} operations; at most {most} are compiled")]
    TooLarge {
        /// How many it takes.
        operations: usize,
        /// How many it may take.
        most: usize,
    },
    /// Lanes of another level were asked for.
    #[error("lanes of the level `{level}` are asked for, and machine code is AVX-512")]
    OtherLevel {
        /// Its name.
        level: &'static str,
    },
    /// There is none in double precision.
    #[error("environments in double precision are not compiled")]
    Double,
    /// The processor, or the system.
    #[error(transparent)]
    Native(#[from] NativeError),
}

/// Machine code of a control step, and the numbers of the task that it reads.
#[derive(Clone, Debug)]
pub struct NativeStep {
    routine: Arc<Routine>,
    /// Those that all share, or a column for each environment, block by block.
    parameters: Vec<f32>,
    /// Of a block; zero where all share them.
    own_rows: usize,
}

/// A block of environments, entry `row` of lane `lane` at `row * LANES + lane`.
pub struct NativeBlock<'a> {
    /// Numbers of the states.
    pub numbers: &'a mut [f32],
    /// Integers of the states.
    pub words: &'a mut [u32],
    /// Number of the first environment.
    pub first: usize,
}

/// What a control step reads and writes beside the state.
pub struct NativeRows {
    pub actions: Vec<f32>,
    pub observation: Vec<f32>,
    /// Where an episode ended.
    pub final_observation: Vec<f32>,
    /// Reward, terminated, truncated; and the summary where an episode ended.
    pub result: Vec<f32>,
    /// What the constraint solver did: rounds, steps left unsolved.
    pub counts: Vec<u32>,
    memory: Memory,
}

impl NativeRows {
    pub fn new<C: Real>(tables: &Tables<C>, nobs: usize, nepisode: usize) -> Self {
        let zeros = |rows: usize| vec![0.0; rows * LANES];
        Self {
            actions: zeros(tables.plan.nmuscle()),
            observation: zeros(nobs),
            final_observation: zeros(nobs),
            result: zeros(RESULT_ROWS + nepisode),
            counts: vec![0; 2 * LANES],
            memory: Memory::default(),
        }
    }
}

impl NativeRows {
    /// Adds what `steps` physics steps did to the counts of a block's environments.
    pub fn count(&self, steps: usize, solver: &mut [SolverCount]) {
        let (rounds, unsolved) = self.counts.split_at(LANES);
        SolverCount::add(solver, steps, [rounds, unsolved]);
    }
}

/// Whether to compile: what the configuration says, or whether it is worth it.
pub fn is_wanted(config: &EnvConfig) -> bool {
    config.native.unwrap_or(config.num_envs >= WORTH_IT)
}

/// Compiles a control step, for environments on lanes of a level.
pub fn compile(
    judge: &impl Judge,
    tables: &Tables<f64>,
    autoreset: Autoreset,
    level: Level,
) -> Result<Arc<Routine>, NotCompiled> {
    if level.lanes() != LANES {
        return Err(NotCompiled::OtherLevel { level: level.name() });
    }
    if tables.plan.touches_one_by_one() {
        return Err(NotCompiled::OneByOne);
    }
    let program = counted_step(judge, tables, autoreset);
    let (operations, most) = (program.operations(), MOST_OPERATIONS);
    if operations > most {
        return Err(NotCompiled::TooLarge { operations, most });
    }
    Ok(Arc::new(Routine::compile(&program)?))
}

/// Machine code if it is wanted and there can be any; where it was asked for by name, why there is none.
pub fn if_wanted(
    config: &EnvConfig,
    compile: impl FnOnce() -> Result<Result<Arc<Routine>, NotCompiled>, BuildError>,
) -> Result<Option<Arc<Routine>>, BuildError> {
    if !is_wanted(config) {
        return Ok(None);
    }
    match compile()? {
        Ok(routine) => Ok(Some(routine)),
        Err(reason) if config.native == Some(true) => Err(reason.into()),
        Err(_) => Ok(None),
    }
}

impl NativeStep {
    pub fn new<C: Real>(routine: Arc<Routine>, tables: &Tables<C>, spec: &EnvSpec) -> Self {
        let mut this = Self { routine, parameters: vec![], own_rows: 0 };
        this.take_parameters(tables, spec);
        this
    }

    /// The code, for other environments of the same model and task.
    pub fn routine(&self) -> Arc<Routine> {
        self.routine.clone()
    }

    /// Takes over the numbers of the task, which may have changed.
    pub fn take_parameters<C: Real>(&mut self, tables: &Tables<C>, spec: &EnvSpec) {
        let blocks = (0..spec.num_envs).step_by(LANES);
        self.own_rows = tables.own_rows();
        self.parameters = match self.own_rows {
            0 => tables.columns(0, LANES),
            _ => blocks.flat_map(|first| tables.columns(first, LANES)).collect(),
        };
    }

    /// A control step of a block. Bodies are judged, and nothing is reset.
    pub fn run(&self, block: NativeBlock<'_>, rows: &mut NativeRows) {
        let NativeBlock { numbers, words, first } = block;
        let parameters = match self.own_rows {
            0 => &self.parameters[..],
            own => &self.parameters[first * own..(first + LANES) * own],
        };
        debug_assert_eq!(words.len(), WORDS * LANES);
        let mut buffers = [
            View::NumbersMut(numbers),
            View::WordsMut(words),
            View::Numbers(parameters),
            View::Numbers(&rows.actions),
            View::NumbersMut(&mut rows.observation),
            View::NumbersMut(&mut rows.final_observation),
            View::NumbersMut(&mut rows.result),
            View::WordsMut(&mut rows.counts),
        ];
        self.routine.run(&mut buffers, &mut rows.memory);
    }
}
