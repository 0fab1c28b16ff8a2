//! Work on consecutive blocks of environments: what one thread does of a step or a reset.

use crate::control::{Judge, Outcome, Scratch, reseed, step_and_autoreset};
use crate::precision::{Job, Precision};
use crate::rows::{MAX_LANES, flags_of, mask_from, read_rows, rows, write_rows};
use crate::state::EnvState;
use crate::storage::{Blocks, WORDS, load, store};
use crate::tables::Tables;
use crate::vector::{Autoreset, StepBuffers};
use myo_scalar::{Level, Mask, Real, Scalar};

/// Runs jobs under one judge. The one call that is not known when code is compiled: what it runs steps many environments.
pub trait Runner<C>: Send + Sync {
    /// Runs a control step.
    fn step(&self, level: Level, job: StepJob<'_, C>);
    /// Runs a reset.
    fn reset(&self, level: Level, job: ResetJob<'_, C>);
}

impl<C: Precision, J: Judge> Runner<C> for J {
    fn step(&self, level: Level, job: StepJob<'_, C>) {
        C::run(level, Judged { judge: self, job });
    }
    fn reset(&self, level: Level, job: ResetJob<'_, C>) {
        C::run(level, Judged { judge: self, job });
    }
}

/// A job under a judge.
struct Judged<'a, J, W> {
    judge: &'a J,
    job: W,
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
    /// Where every physics step is written, if it is wanted.
    pub trace: Option<&'a mut [f32]>,
}

impl<C: Real, J: Judge> Job<C> for Judged<'_, J, StepJob<'_, C>> {
    #[inline(always)]
    fn run<S: Scalar<Const = C>>(self) {
        let Self { judge, mut job } = self;
        let tables = job.tables;
        let Blocks { first, count, numbers, words, solver } = job.storage;
        let (mut env, mut ws) = (EnvState::<S>::new(tables), Scratch::<S>::new(tables));
        let mut world = tables.world::<S>(first);
        let nact = ws.ctrl.len();
        ws.trace = job.trace.is_some().then(Vec::new);
        let blocks = numbers.chunks_exact_mut(count * S::LANES).zip(words.chunks_exact_mut(WORDS * S::LANES));
        for (block, ((numbers, words), solver)) in blocks.zip(solver.chunks_mut(S::LANES)).enumerate() {
            if block > 0 && tables.own_numbers {
                world = tables.world(first + block * S::LANES);
            }
            load(&mut env, numbers, words);
            ws.physics.forget_touches();
            let start = (block * S::LANES * nact).min(job.actions.len());
            read_rows(&job.actions[start..], &mut ws.ctrl);
            let outcome = step_and_autoreset(judge, &world, job.autoreset, &mut env, &mut ws);
            write_step(&outcome, &ws, block, &mut job.out);
            if let (Some(trace), Some(out)) = (&ws.trace, &mut job.trace) {
                write_rows(trace, &[true; MAX_LANES], rows!(out, block, S::LANES, trace.len()));
            }
            ws.physics.tally.take(tables.substeps as usize, solver);
            store(&mut env, numbers, words);
        }
    }
}

#[inline(always)]
fn write_step<S: Scalar>(outcome: &Outcome<S>, ws: &Scratch<S>, block: usize, out: &mut StepBuffers<'_>) {
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

impl<C: Real, J: Judge> Job<C> for Judged<'_, J, ResetJob<'_, C>> {
    #[inline(always)]
    fn run<S: Scalar<Const = C>>(self) {
        let Self { judge, job } = self;
        let tables = job.tables;
        let Blocks { first, count, numbers, words, .. } = job.storage;
        let (mut env, mut ws) = (EnvState::<S>::new(tables), Scratch::<S>::new(tables));
        let mut world = tables.world::<S>(first);
        let blocks = numbers.chunks_exact_mut(count * S::LANES).zip(words.chunks_exact_mut(WORDS * S::LANES));
        for (block, (numbers, words)) in blocks.enumerate() {
            if block > 0 && tables.own_numbers {
                world = tables.world(first + block * S::LANES);
            }
            load(&mut env, numbers, words);
            let mask = match job.mask {
                None => S::Mask::splat(true),
                Some(mask) => mask_from::<S>(mask.iter().skip(block * S::LANES).copied()),
            };
            if let Some(seed) = job.seed {
                reseed(myo_scalar::seed_words(seed), mask, &mut env);
            }
            judge.reset(&world, mask, &mut env, &mut ws);
            store(&mut env, numbers, words);
            let nobs = ws.next_observation.len();
            let rows = rows!(job.observation, block, S::LANES, nobs);
            write_rows(&ws.next_observation, &[true; MAX_LANES], rows);
        }
    }
}
