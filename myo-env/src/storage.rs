//! Memory for the states of all environments.

use crate::config::BuildError;
use crate::memory;
use crate::saved::Saved;
use crate::state::{EnvState, env_number};
use crate::vector::EnvSpec;
use myo_dynamics::SolverCount;
use myo_scalar::{Real, Scalar, Word};

/// Integers per environment.
pub const WORDS: usize = EnvState::<f64>::WORDS;

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
    /// Numbers per environment.
    pub count: usize,
    /// Numbers of the states.
    pub numbers: &'a mut [C],
    /// Integers of the states.
    pub words: &'a mut [u32],
    /// What the constraint solver did.
    pub solver: &'a mut [SolverCount],
}

impl<C: Real> Storage<C> {
    /// Zeros, with every environment's number set.
    ///
    /// # Errors
    /// There is no memory for so many.
    pub fn new(lanes: usize, spec: &EnvSpec, count: usize) -> Result<Self, BuildError> {
        let num_envs = spec.num_envs;
        let nblock = num_envs.div_ceil(lanes);
        let numbers = memory::zeros(num_envs, nblock * count * lanes)?;
        let mut words: Vec<u32> = memory::zeros(num_envs, nblock * WORDS * lanes)?;
        for (block, words) in words.chunks_exact_mut(WORDS * lanes).enumerate() {
            for lane in 0..lanes {
                words[EnvState::<f64>::ENV_ROW * lanes + lane] = env_number(spec, block * lanes + lane);
            }
        }
        Ok(Self { lanes, num_envs, count, numbers, words, solver: memory::zeros(num_envs, num_envs)? })
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

    /// Number `k` of an environment.
    pub fn number(&self, env: usize, k: usize) -> f64 {
        self.numbers[self.index(env, k, self.count)].to_f64()
    }

    /// Integer `k` of an environment.
    pub fn word(&self, env: usize, k: usize) -> u32 {
        self.words[self.index(env, k, WORDS)]
    }

    /// Takes over a saved state of as many environments with as many numbers each.
    pub fn take(&mut self, saved: &Saved<'_>) {
        for env in 0..self.num_envs {
            for k in 0..self.count {
                let at = self.index(env, k, self.count);
                self.numbers[at] = C::from_f64(saved.number(env, k));
            }
            for k in 0..WORDS {
                let at = self.index(env, k, WORDS);
                self.words[at] = saved.word(env, k);
            }
        }
    }
}

/// Reads a block into lanes.
#[inline(always)]
pub fn load<S: Scalar>(env: &mut EnvState<S>, numbers: &[S::Const], words: &[u32]) {
    for (x, from) in env.numbers().zip(numbers.chunks_exact(S::LANES)) {
        *x = S::load(from);
    }
    for (x, from) in env.words().into_iter().zip(words.chunks_exact(S::LANES)) {
        *x = S::Word::load(from);
    }
}

/// Writes lanes to a block.
#[inline(always)]
pub fn store<S: Scalar>(env: &mut EnvState<S>, numbers: &mut [S::Const], words: &mut [u32]) {
    for (x, to) in env.numbers().zip(numbers.chunks_exact_mut(S::LANES)) {
        x.store(to);
    }
    for (x, to) in env.words().into_iter().zip(words.chunks_exact_mut(S::LANES)) {
        x.store(to);
    }
}
