//! Work on consecutive blocks of environments: what one thread does of a step or a reset.

use crate::control::{Judge, Outcome, Scratch, reseed, step_and_autoreset};
use crate::native::{NativeBlock, NativeRows, NativeStep};
use crate::precision::{Job, Precision};
use crate::record::RESULT_ROWS;
use crate::rows::{MAX_LANES, fill_columns, flags_of, mask_from, read_rows, rows, write_rows};
use crate::state::{EnvState, RESET_NOW};
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
    /// Machine code of the step, in place of lanes, and the row of [`EnvState::pending`].
    pub native: Option<(&'a NativeStep, usize)>,
    /// Where every physics step is written, if it is wanted.
    pub trace: Option<&'a mut [f32]>,
}

impl<C: Precision, J: Judge> Job<C> for Judged<'_, J, StepJob<'_, C>> {
    #[inline(always)]
    fn run<S: Scalar<Const = C>>(self) {
        let Self { judge, mut job } = self;
        if let Some((native, pending)) = job.native {
            return run_native::<C, S>(judge, native, pending, job);
        }
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

/// The same by machine code. What begins anew is reset on lanes, whose results are taken for it alone.
#[inline(always)]
fn run_native<C: Precision, S: Scalar<Const = C>>(
    judge: &impl Judge,
    native: &NativeStep,
    pending: usize,
    mut job: StepJob<'_, C>,
) {
    let tables = job.tables;
    let Blocks { first, count, numbers, words, solver } = job.storage;
    let (mut env, mut ws) = (EnvState::<S>::new(tables), Scratch::<S>::new(tables));
    let (nact, nenv) = (ws.ctrl.len(), job.out.reward.len().max(1));
    let mut rows = NativeRows::new(tables, job.out.observation.len() / nenv, job.out.episode.len() / nenv);
    let blocks = numbers.chunks_exact_mut(count * S::LANES).zip(words.chunks_exact_mut(WORDS * S::LANES));
    for (block, ((numbers, words), solver)) in blocks.zip(solver.chunks_mut(S::LANES)).enumerate() {
        let first = first + block * S::LANES;
        let start = (block * S::LANES * nact).min(job.actions.len());
        fill_columns(&job.actions[start..], &mut rows.actions, S::LANES);
        let narrow = C::narrow(numbers).expect("machine code is made for single precision");
        native.run(NativeBlock { numbers: narrow, words, first }, &mut rows);
        let outcome = take_rows(&rows, &mut ws);
        let again = S::lit(RESET_NOW - 0.5).lt(S::load(&numbers[pending * S::LANES..]));
        if again.any() {
            let world = tables.world::<S>(first);
            load(&mut env, numbers, words);
            ws.physics.forget_touches();
            judge.reset(&world, again, &mut env, &mut ws);
            store(&mut env, numbers, words);
            for (x, &ended) in ws.next_observation.iter_mut().zip(&ws.observation) {
                *x = S::select(again, *x, ended);
            }
        } else {
            ws.next_observation.clone_from(&ws.observation);
        }
        write_step(&outcome, &ws, block, &mut job.out);
        rows.count(tables.substeps as usize, solver);
    }
}

/// What machine code found, in lanes.
#[inline(always)]
fn take_rows<S: Scalar>(rows: &NativeRows, ws: &mut Scratch<S>) -> Outcome<S> {
    let wide = |lanes: &[f32]| {
        let mut numbers = [S::Const::default(); MAX_LANES];
        for (number, &lane) in numbers.iter_mut().zip(lanes) {
            *number = S::Const::from_f64(f64::from(lane));
        }
        S::load(&numbers)
    };
    let (flags, summary) = rows.result.split_at(RESULT_ROWS * S::LANES);
    ws.observation.clear();
    ws.observation.extend(rows.observation.chunks_exact(S::LANES).map(wide));
    ws.episode.clear();
    ws.episode.extend(summary.chunks_exact(S::LANES).map(wide));
    let [reward, terminated, truncated] = [0, 1, 2].map(|row| wide(&flags[row * S::LANES..(row + 1) * S::LANES]));
    let is_one = |x: S| S::lit(0.5).lt(x);
    Outcome { reward, terminated: is_one(terminated), truncated: is_one(truncated) }
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
