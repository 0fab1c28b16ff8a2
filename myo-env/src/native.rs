//! Control steps as machine code, made for one model and task.
//!
//! The recorded programs of step and reset, which cards run as kernels, run on one block of environments after the other.

use crate::config::{BuildError, EnvConfig};
use crate::control::Judge;
use crate::precision::Precision;
use crate::record::{OBSERVE, RESEED, RESET, RESULT_ROWS, counted_step, reset_by};
use crate::rows::{fill_columns, fill_rows, rows};
use crate::state::{RESET_NOW, StateRows};
use crate::storage::{Blocks, WORDS};
use crate::tables::Tables;
use crate::vector::{Autoreset, EnvSpec, StepBuffers};
use myo_dynamics::SolverCount;
use myo_native::{BLOCKS, LANES, Memory, NativeError, Routine, View};
use myo_scalar::Level;
use myo_scalar::symbolic::Form;
use std::sync::Arc;

/// Environments from which on compiling is worth it, where nobody says: it takes as long as some thousand control steps.
const WORTH_IT: usize = 256;

/// Why there is no machine code of a model and task.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum NotCompiled {
    /// What touches is looked for one environment at a time.
    #[error(
        "contacts of meshes, and of boxes with anything but planes, spheres and capsules, are looked for one environment at a time"
    )]
    OneByOne,
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

/// Machine code of control steps and resets.
#[derive(Debug)]
pub struct Routines {
    step: Routine,
    reset: Routine,
}

/// Machine code, and the numbers of the task that it reads.
#[derive(Clone, Debug)]
pub struct NativeCode {
    routines: Arc<Routines>,
    /// Those that all share, or a column for each environment, block by block.
    parameters: Vec<f32>,
    /// Of a block; zero where all share them.
    own_rows: usize,
    /// Physics steps of a control step.
    substeps: usize,
    /// Row of [`EnvState::pending`](crate::state::EnvState::pending).
    pending: usize,
}

/// What a control step reads and writes of a block beside the state: entry `row` of lane `lane` at `row * LANES + lane`.
struct Columns {
    actions: Vec<f32>,
    observation: Vec<f32>,
    /// Where an episode ended.
    final_observation: Vec<f32>,
    /// Reward, terminated, truncated; and the summary where an episode ended.
    result: Vec<f32>,
    /// What the constraint solver did: rounds, steps left unsolved.
    counts: [u32; 2 * LANES],
    /// What each environment is to do in a reset.
    command: [u32; LANES],
}

impl Columns {
    fn new(nact: usize, nobs: usize, nepisode: usize) -> Self {
        let zeros = |rows: usize| vec![0.0; rows * LANES];
        Self {
            actions: zeros(nact),
            observation: zeros(nobs),
            final_observation: zeros(nobs),
            result: zeros(RESULT_ROWS + nepisode),
            counts: [0; 2 * LANES],
            command: [0; LANES],
        }
    }

    fn result(&self, row: usize) -> &[f32] {
        &self.result[row * LANES..(row + 1) * LANES]
    }
}

/// Whether to compile: what the configuration says, or whether it is worth it.
pub fn is_wanted(config: &EnvConfig) -> bool {
    config.native.unwrap_or(config.num_envs >= WORTH_IT)
}

/// Compiles control steps and resets, for environments on lanes of a level.
pub fn compile(
    judge: &impl Judge,
    tables: &Tables<f64>,
    autoreset: Autoreset,
    level: Level,
) -> Result<Arc<Routines>, NotCompiled> {
    if Level::widest().lanes() != LANES {
        return Err(NativeError::Unsupported.into());
    }
    if level.lanes() != LANES {
        return Err(NotCompiled::OtherLevel { level: level.name() });
    }
    if tables.plan.touches_one_by_one() {
        return Err(NotCompiled::OneByOne);
    }
    let programs = [counted_step(judge, tables, autoreset), reset_by(judge, tables, Form::Straight)];
    let [step, reset] = programs.map(|program| Routine::compile(&program));
    Ok(Arc::new(Routines { step: step?, reset: reset? }))
}

/// Machine code if it is wanted and there can be any; where it was asked for by name, why there is none.
pub fn if_wanted(
    config: &EnvConfig,
    compile: impl FnOnce() -> Result<Result<Arc<Routines>, NotCompiled>, BuildError>,
) -> Result<Option<Arc<Routines>>, BuildError> {
    if !is_wanted(config) {
        return Ok(None);
    }
    match compile()? {
        Ok(routines) => Ok(Some(routines)),
        Err(reason) if config.native == Some(true) => Err(reason.into()),
        Err(_) => Ok(None),
    }
}

impl NativeCode {
    pub fn new<C: Precision>(routines: Arc<Routines>, tables: &Tables<C>, spec: &EnvSpec) -> Self {
        let (substeps, pending) = (tables.substeps as usize, StateRows::of(tables).pending);
        let mut this = Self { routines, parameters: vec![], own_rows: 0, substeps, pending };
        this.take_parameters(tables, spec);
        this
    }

    /// The code, for other environments of the same model and task.
    pub fn routines(&self) -> Arc<Routines> {
        self.routines.clone()
    }

    /// Takes over the numbers of the task, which may have changed.
    pub fn take_parameters<C: Precision>(&mut self, tables: &Tables<C>, spec: &EnvSpec) {
        let blocks = (0..spec.num_envs).step_by(LANES);
        self.own_rows = tables.own_rows();
        self.parameters = match self.own_rows {
            0 => tables.columns(0, LANES),
            _ => blocks.flat_map(|first| tables.columns(first, LANES)).collect(),
        };
    }

    /// The numbers of the task for the block that begins with environment `first`.
    fn parameters(&self, first: usize) -> &[f32] {
        match self.own_rows {
            0 => &self.parameters,
            own => &self.parameters[first * own..(first + LANES) * own],
        }
    }

    /// A control step, and the reset of what ended where that is part of it.
    pub fn step(&self, storage: Blocks<'_, f32>, actions: &[f32], out: &mut StepBuffers<'_>) {
        let n = out.reward.len().max(1);
        let [nact, nobs, nepisode] = [actions, &*out.observation, &*out.episode].map(|rows| rows.len() / n);
        let mut columns: [Columns; BLOCKS] = std::array::from_fn(|_| Columns::new(nact, nobs, nepisode));
        let mut memory = Memory::default();
        let Blocks { first, count, numbers, words, solver } = storage;
        let blocks = numbers.chunks_mut(BLOCKS * count * LANES).zip(words.chunks_mut(BLOCKS * WORDS * LANES));
        for (group, ((numbers, words), solver)) in blocks.zip(solver.chunks_mut(BLOCKS * LANES)).enumerate() {
            let place = |k: usize| group * BLOCKS + k;
            let mut blocks: Vec<Block<'_>> = numbers
                .chunks_exact_mut(count * LANES)
                .zip(words.chunks_exact_mut(WORDS * LANES))
                .zip(&mut columns)
                .enumerate()
                .map(|(k, ((numbers, words), columns))| {
                    let start = (place(k) * LANES * nact).min(actions.len());
                    fill_columns(&actions[start..], &mut columns.actions, LANES);
                    let parameters = self.parameters(first + place(k) * LANES);
                    Block { numbers, words, parameters, columns }
                })
                .collect();
            let mut views: Vec<_> = blocks.iter_mut().map(Block::of_step).collect();
            self.routines.step.run_blocks(&mut views, &mut memory);
            for (k, (mut block, solver)) in blocks.into_iter().zip(solver.chunks_mut(LANES)).enumerate() {
                if block.row(self.pending).iter().any(|&pending| f64::from(pending) > RESET_NOW - 0.5) {
                    block.columns.command.fill(0);
                    self.routines.reset.run(&mut block.of_reset(&[0; 2]), &mut memory);
                }
                write_step(block.columns, place(k), out);
                let (rounds, unsolved) = block.columns.counts.split_at(LANES);
                SolverCount::add(solver, self.substeps, [rounds, unsolved]);
            }
        }
    }

    /// New episodes where the mask says so, with a seed to start from if there is one; observations of all.
    pub fn reset(&self, storage: Blocks<'_, f32>, seed: Option<u64>, mask: Option<&[bool]>, observation: &mut [f32]) {
        let asked = if seed.is_some() { RESET | RESEED } else { RESET };
        let seed = seed.unwrap_or_default();
        let seed = [seed as u32, (seed >> 32) as u32];
        let Blocks { first, count, numbers, words, solver } = storage;
        let nobs = observation.len() / solver.len().max(1);
        let (mut columns, mut memory) = (Columns::new(0, nobs, 0), Memory::default());
        let blocks = numbers.chunks_exact_mut(count * LANES).zip(words.chunks_exact_mut(WORDS * LANES));
        for (number, (numbers, words)) in blocks.enumerate() {
            for (lane, command) in columns.command.iter_mut().enumerate() {
                let resets = mask.is_none_or(|mask| mask.get(number * LANES + lane).copied().unwrap_or(false));
                *command = if resets { asked } else { OBSERVE };
            }
            let parameters = self.parameters(first + number * LANES);
            let mut block = Block { numbers, words, parameters, columns: &mut columns };
            self.routines.reset.run(&mut block.of_reset(&seed), &mut memory);
            fill_rows(&columns.observation, LANES, |_| true, rows!(observation, number, LANES, nobs));
        }
    }
}

/// A block of environments.
struct Block<'a> {
    numbers: &'a mut [f32],
    words: &'a mut [u32],
    parameters: &'a [f32],
    columns: &'a mut Columns,
}

impl Block<'_> {
    /// A row of the state.
    fn row(&self, row: usize) -> &[f32] {
        &self.numbers[row * LANES..][..LANES]
    }

    /// What a control step reads and writes.
    fn of_step(&mut self) -> [View<'_>; 8] {
        let Self { numbers, words, parameters, columns } = self;
        [
            View::NumbersMut(numbers),
            View::WordsMut(words),
            View::Numbers(parameters),
            View::Numbers(&columns.actions),
            View::NumbersMut(&mut columns.observation),
            View::NumbersMut(&mut columns.final_observation),
            View::NumbersMut(&mut columns.result),
            View::WordsMut(&mut columns.counts),
        ]
    }

    /// What a reset reads and writes, which does what `command` says, and resets whose step ends with it.
    fn of_reset<'a>(&'a mut self, seed: &'a [u32; 2]) -> [View<'a>; 6] {
        let Self { numbers, words, parameters, columns } = self;
        [
            View::NumbersMut(numbers),
            View::WordsMut(words),
            View::Numbers(parameters),
            View::Words(&columns.command),
            View::NumbersMut(&mut columns.observation),
            View::Words(seed),
        ]
    }
}

/// What a block's step brought, to the rows of its environments.
fn write_step(columns: &Columns, block: usize, out: &mut StepBuffers<'_>) {
    let n = out.reward.len().max(1);
    let [nobs, nepisode] = [out.observation.len(), out.episode.len()].map(|entries| entries / n);
    let is_one = |row: usize, lane: usize| columns.result(row)[lane] > 0.5;
    let ended = |lane: usize| is_one(1, lane) || is_one(2, lane);
    let summary = &columns.result[RESULT_ROWS * LANES..];
    fill_rows(&columns.observation, LANES, |_| true, rows!(out.observation, block, LANES, nobs));
    fill_rows(&columns.final_observation, LANES, ended, rows!(out.final_observation, block, LANES, nobs));
    fill_rows(summary, LANES, ended, rows!(out.episode, block, LANES, nepisode));
    fill_rows(columns.result(0), LANES, |_| true, rows!(out.reward, block, LANES, 1));
    for (row, flags) in [(1, &mut *out.terminated), (2, &mut *out.truncated)] {
        let flags = rows!(flags, block, LANES, 1);
        flags.iter_mut().enumerate().for_each(|(lane, flag)| *flag = is_one(row, lane));
    }
}
