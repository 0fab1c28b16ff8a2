//! Work on consecutive blocks of environments: what one thread does of a step or a reset.

use crate::control::{Scratch, reseed, reset, step_and_autoreset};
use crate::saved::Shape;
use crate::state::EnvState;
use crate::tables::Tables;
use crate::vector::{Autoreset, StepBuffers};
use myo_dynamics::SolverCount;
use myo_scalar::{Kernel, Level, Mask, Real, Scalar, Word, dispatch};

/// Most lanes that any level has.
const MAX_LANES: usize = 16;

/// A precision that environments can run in.
pub trait Backend: Real + Scalar<Const = Self> {
    /// Environments per value.
    fn lanes(level: Level) -> usize;
    /// Runs a job on the numbers of this precision.
    fn run<J: Job<Self>>(level: Level, job: J);
}

/// Generic work; `run` and all it calls must be inlined.
pub trait Job<C>: Send {
    /// Does it.
    fn run<S: Scalar<Const = C>>(self);
}

impl Backend for f64 {
    fn lanes(_: Level) -> usize {
        1
    }
    fn run<J: Job<Self>>(_: Level, job: J) {
        job.run::<Self>();
    }
}

impl Backend for f32 {
    fn lanes(level: Level) -> usize {
        level.lanes()
    }
    fn run<J: Job<Self>>(level: Level, job: J) {
        dispatch(level, OnLanes(job));
    }
}

struct OnLanes<J>(J);

impl<J: Job<f32>> Kernel for OnLanes<J> {
    type Output = ();
    #[inline(always)]
    fn run<S: Scalar<Const = f32>>(self) {
        self.0.run::<S>();
    }
}

/// States of all environments: blocks of `lanes` environments, each number of the state once per lane.
#[derive(Clone, Debug)]
pub struct Storage<C> {
    /// Environments per block.
    pub lanes: usize,
    num_envs: usize,
    count: usize,
    numbers: Vec<C>,
    words: Vec<u32>,
    /// Per environment; not part of its state.
    pub solver: Vec<SolverCount>,
}

/// Some consecutive blocks.
pub struct Blocks<'a, C> {
    /// Number of the first environment.
    pub first: usize,
    count: usize,
    numbers: &'a mut [C],
    words: &'a mut [u32],
    solver: &'a mut [SolverCount],
}

/// Integers per environment.
const WORDS: usize = EnvState::<f64>::WORDS;

impl<C: Real> Storage<C> {
    /// Zeros, with every environment's number set.
    pub fn new(lanes: usize, num_envs: usize, count: usize) -> Self {
        let nblock = num_envs.div_ceil(lanes);
        let mut words = vec![0; nblock * WORDS * lanes];
        for (block, words) in words.chunks_exact_mut(WORDS * lanes).enumerate() {
            for lane in 0..lanes {
                words[2 * lanes + lane] = (block * lanes + lane) as u32;
            }
        }
        let numbers = vec![C::default(); nblock * count * lanes];
        Self { lanes, num_envs, count, numbers, words, solver: vec![SolverCount::default(); num_envs] }
    }

    /// Number of blocks.
    pub fn nblock(&self) -> usize {
        self.words.len() / (WORDS * self.lanes)
    }

    /// Cuts into runs of `per_task` environments, a multiple of the lanes.
    pub fn split(&mut self, per_task: usize) -> impl Iterator<Item = Blocks<'_, C>> {
        let (count, numbers, words) = (self.count, &mut self.numbers, &mut self.words);
        let chunks = numbers.chunks_mut(per_task * count).zip(words.chunks_mut(per_task * WORDS));
        chunks.zip(self.solver.chunks_mut(per_task)).enumerate().map(move |(k, ((numbers, words), solver))| Blocks {
            first: k * per_task,
            count,
            numbers,
            words,
            solver,
        })
    }

    /// Index of entry `k` of an environment, in arrays with `count` entries per environment.
    fn index(&self, env: usize, k: usize, count: usize) -> usize {
        (env / self.lanes * count + k) * self.lanes + env % self.lanes
    }

    fn shape(&self) -> Shape {
        Shape::of::<C>(self.num_envs, self.count)
    }

    /// All states as bytes, independent of the number of lanes.
    pub fn save(&self) -> Vec<u8> {
        let number = |env, k| self.numbers[self.index(env, k, self.count)].to_f64();
        self.shape().save(number, |env, k| self.words[self.index(env, k, WORDS)])
    }

    /// Restores what [`Storage::save`] returned; says why it cannot.
    pub fn load(&mut self, bytes: &[u8]) -> Result<(), String> {
        let (shape, lanes, count) = (self.shape(), self.lanes, self.count);
        let index = |env: usize, k: usize, count: usize| (env / lanes * count + k) * lanes + env % lanes;
        let (numbers, words) = (&mut self.numbers, &mut self.words);
        let number = |env, k, x| numbers[index(env, k, count)] = C::from_f64(x);
        shape.load(bytes, number, |env, k, x| words[index(env, k, WORDS)] = x)
    }
}

#[inline(always)]
fn load<S: Scalar>(env: &mut EnvState<S>, numbers: &[S::Const], words: &[u32]) {
    for (x, from) in env.numbers().zip(numbers.chunks_exact(S::LANES)) {
        *x = S::load(from);
    }
    for (x, from) in env.words().into_iter().zip(words.chunks_exact(S::LANES)) {
        *x = S::Word::load(from);
    }
}

#[inline(always)]
fn store<S: Scalar>(env: &mut EnvState<S>, numbers: &mut [S::Const], words: &mut [u32]) {
    for (x, to) in env.numbers().zip(numbers.chunks_exact_mut(S::LANES)) {
        x.store(to);
    }
    for (x, to) in env.words().into_iter().zip(words.chunks_exact_mut(S::LANES)) {
        x.store(to);
    }
}

/// Truth values per environment to a mask; environments past the end are false.
#[inline(always)]
fn mask_from<S: Scalar>(flags: impl Iterator<Item = bool>) -> S::Mask {
    let mut numbers = [S::Const::default(); MAX_LANES];
    for (x, flag) in numbers.iter_mut().zip(flags) {
        *x = S::Const::from_f64(f64::from(u8::from(flag)));
    }
    S::lit(0.5).lt(S::load(&numbers))
}

/// A mask to truth values.
#[inline(always)]
fn flags_of<S: Scalar>(mask: S::Mask) -> [bool; MAX_LANES] {
    let mut numbers = [S::Const::default(); MAX_LANES];
    S::indicator(mask).store(&mut numbers);
    let mut flags = [false; MAX_LANES];
    for (flag, x) in flags.iter_mut().zip(numbers) {
        *flag = x.to_f64() > 0.5;
    }
    flags
}

/// Writes one row of `values` per environment where `which` says so; `rows` holds the environments of this block.
#[inline(always)]
fn write_rows<S: Scalar>(values: &[S], which: &[bool], rows: &mut [f32]) {
    let width = values.len();
    for (k, value) in values.iter().enumerate() {
        let mut numbers = [S::Const::default(); MAX_LANES];
        value.store(&mut numbers);
        for ((row, x), wanted) in rows.chunks_exact_mut(width).zip(numbers).zip(which) {
            if *wanted {
                row[k] = x.to_f64() as f32;
            }
        }
    }
}

/// Reads one row per environment into lanes.
#[inline(always)]
fn read_rows<S: Scalar>(rows: &[f32], values: &mut [S]) {
    let width = values.len();
    for (k, value) in values.iter_mut().enumerate() {
        let mut numbers = [S::Const::default(); MAX_LANES];
        for (x, row) in numbers.iter_mut().zip(rows.chunks_exact(width)) {
            *x = S::Const::from_f64(f64::from(row[k]));
        }
        *value = S::load(&numbers);
    }
}

/// The rows of block `block` in an array of `width` entries per environment.
macro_rules! rows {
    ($array:expr, $block:expr, $lanes:expr, $width:expr) => {{
        let start = $block * $lanes * $width;
        let end = (start + $lanes * $width).min($array.len());
        &mut $array[start..end]
    }};
}

/// A control step.
pub struct StepJob<'a, C> {
    /// Constants.
    pub tables: &'a Tables<C>,
    /// States.
    pub storage: Blocks<'a, C>,
    /// How finished environments start again.
    pub autoreset: Autoreset,
    /// Actions of these environments.
    pub actions: &'a [f32],
    /// Results of these environments.
    pub out: StepBuffers<'a>,
}

impl<C: Real> Job<C> for StepJob<'_, C> {
    #[inline(always)]
    fn run<S: Scalar<Const = C>>(mut self) {
        let tables = self.tables;
        let (mut env, mut ws) = (EnvState::<S>::new(tables), Scratch::<S>::new(tables));
        let nact = ws.ctrl.len();
        let Blocks { count, numbers, words, solver, .. } = self.storage;
        let blocks = numbers.chunks_exact_mut(count * S::LANES).zip(words.chunks_exact_mut(WORDS * S::LANES));
        for (block, ((numbers, words), solver)) in blocks.zip(solver.chunks_mut(S::LANES)).enumerate() {
            load(&mut env, numbers, words);
            let start = (block * S::LANES * nact).min(self.actions.len());
            read_rows(&self.actions[start..], &mut ws.ctrl);
            step_block(tables, self.autoreset, &mut env, &mut ws, block, &mut self.out);
            ws.physics.tally.take(tables.substeps as usize, solver);
            store(&mut env, numbers, words);
        }
    }
}

#[inline(always)]
fn step_block<S: Scalar>(
    tables: &Tables<S::Const>,
    autoreset: Autoreset,
    env: &mut EnvState<S>,
    ws: &mut Scratch<S>,
    block: usize,
    out: &mut StepBuffers<'_>,
) {
    let outcome = step_and_autoreset(tables, autoreset, env, ws);
    let (terminated, truncated) = (outcome.terminated, outcome.truncated);
    let ended = flags_of::<S>(terminated | truncated);
    let (nobs, nepisode) = (ws.observation.len(), ws.episode.len());
    write_rows(&ws.observation, &ended, rows!(out.final_observation, block, S::LANES, nobs));
    write_rows(&ws.episode, &ended, rows!(out.episode, block, S::LANES, nepisode));
    write_rows(&ws.next_observation, &[true; MAX_LANES], rows!(out.observation, block, S::LANES, nobs));
    write_rows(&[outcome.reward], &[true; MAX_LANES], rows!(out.reward, block, S::LANES, 1));
    let (terminated, truncated) = (flags_of::<S>(terminated), flags_of::<S>(truncated));
    let rows = rows!(out.terminated, block, S::LANES, 1);
    rows.copy_from_slice(&terminated[..rows.len()]);
    let rows = rows!(out.truncated, block, S::LANES, 1);
    rows.copy_from_slice(&truncated[..rows.len()]);
}

/// A reset.
pub struct ResetJob<'a, C> {
    /// Constants.
    pub tables: &'a Tables<C>,
    /// States.
    pub storage: Blocks<'a, C>,
    /// A seed to start from.
    pub seed: Option<u64>,
    /// Which of these environments; all without it.
    pub mask: Option<&'a [bool]>,
    /// Observations of these environments.
    pub observation: &'a mut [f32],
}

impl<C: Real> Job<C> for ResetJob<'_, C> {
    #[inline(always)]
    fn run<S: Scalar<Const = C>>(self) {
        let tables = self.tables;
        let (mut env, mut ws) = (EnvState::<S>::new(tables), Scratch::<S>::new(tables));
        let Blocks { count, numbers, words, .. } = self.storage;
        let blocks = numbers.chunks_exact_mut(count * S::LANES).zip(words.chunks_exact_mut(WORDS * S::LANES));
        for (block, (numbers, words)) in blocks.enumerate() {
            load(&mut env, numbers, words);
            let mask = match self.mask {
                None => S::Mask::splat(true),
                Some(mask) => mask_from::<S>(mask.iter().skip(block * S::LANES).copied()),
            };
            if let Some(seed) = self.seed {
                reseed(myo_scalar::seed_words(seed), mask, &mut env);
            }
            reset(tables, mask, &mut env, &mut ws);
            store(&mut env, numbers, words);
            let nobs = ws.next_observation.len();
            let rows = rows!(self.observation, block, S::LANES, nobs);
            write_rows(&ws.next_observation, &[true; MAX_LANES], rows);
        }
    }
}
