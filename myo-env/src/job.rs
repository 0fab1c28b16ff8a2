//! Work on consecutive blocks of environments: what one thread does of a step or a reset.

use crate::control::{Scratch, reseed, reset, step_and_autoreset};
use crate::parameters::World;
use crate::precision::Job;
use crate::rows::{MAX_LANES, flags_of, mask_from, read_rows, rows, write_rows};
use crate::state::EnvState;
use crate::storage::{Blocks, WORDS, load, store};
use crate::tables::Tables;
use crate::vector::{Autoreset, StepBuffers};
use myo_scalar::{Mask, Real, Scalar};

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
        let (mut env, mut ws, world) = (EnvState::<S>::new(tables), Scratch::<S>::new(tables), tables.splat::<S>());
        let nact = ws.ctrl.len();
        let Blocks { count, numbers, words, solver, .. } = self.storage;
        let blocks = numbers.chunks_exact_mut(count * S::LANES).zip(words.chunks_exact_mut(WORDS * S::LANES));
        for (block, ((numbers, words), solver)) in blocks.zip(solver.chunks_mut(S::LANES)).enumerate() {
            load(&mut env, numbers, words);
            let start = (block * S::LANES * nact).min(self.actions.len());
            read_rows(&self.actions[start..], &mut ws.ctrl);
            step_block(&world, self.autoreset, &mut env, &mut ws, block, &mut self.out);
            ws.physics.tally.take(tables.substeps as usize, solver);
            store(&mut env, numbers, words);
        }
    }
}

#[inline(always)]
fn step_block<S: Scalar>(
    world: &World<'_, S>,
    autoreset: Autoreset,
    env: &mut EnvState<S>,
    ws: &mut Scratch<S>,
    block: usize,
    out: &mut StepBuffers<'_>,
) {
    let outcome = step_and_autoreset(world, autoreset, env, ws);
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
        let (mut env, mut ws, world) = (EnvState::<S>::new(tables), Scratch::<S>::new(tables), tables.splat::<S>());
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
            reset(&world, mask, &mut env, &mut ws);
            store(&mut env, numbers, words);
            let nobs = ws.next_observation.len();
            let rows = rows!(self.observation, block, S::LANES, nobs);
            write_rows(&ws.next_observation, &[true; MAX_LANES], rows);
        }
    }
}
