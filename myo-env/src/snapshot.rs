//! Looking into saved states, and seeds for single environments.

use crate::saved::{Saved, sign};
use crate::state::EnvState;
use crate::tables::Tables;
use crate::vector::EnvError;
use myo_dynamics::State;
use myo_tasks::logic::TaskState;

/// Body and task of one environment, read from a saved state: for pictures and for looking inside.
#[derive(Clone, Debug)]
pub struct Snapshot {
    /// The body.
    pub body: State<f64>,
    /// Targets and counters.
    pub task: TaskState<f64>,
}

impl Snapshot {
    /// Environment `env` of a state that [`VectorEnv::save_state`](crate::VectorEnv::save_state) returned.
    ///
    /// # Errors
    /// The state is damaged, is not one of this model and task, or has no such environment.
    pub fn read(tables: &Tables<f64>, state: &[u8], env: usize) -> Result<Self, EnvError> {
        let saved = read(state, env)?;
        let mut read = EnvState::<f64>::new(tables);
        if saved.header.identity != tables.identity || saved.header.count != read.numbers().count() {
            return Err(EnvError::BadState { reason: "it is of another model or task".into() });
        }
        for (k, x) in read.numbers().enumerate() {
            *x = saved.number(env, k);
        }
        Ok(Self { body: read.body, task: read.task })
    }
}

/// Gives environments of a saved state seeds of their own, so that the next reset draws what the first environment of a
/// batch with that seed draws.
///
/// # Errors
/// The state is damaged or has no such environment; it is unchanged then.
pub fn reseed(state: &mut [u8], seeds: impl IntoIterator<Item = (usize, u64)>) -> Result<(), EnvError> {
    let seeds: Vec<(usize, u64)> = seeds.into_iter().collect();
    let Some(last) = seeds.iter().map(|(env, _)| *env).max() else { return Ok(()) };
    let saved = read(state, last)?;
    let ranges: Vec<_> = seeds.iter().map(|(env, seed)| (saved.words_in(state.len(), *env), *seed)).collect();
    for (range, seed) in ranges {
        let words = &mut state[range];
        // Low and high half of the seed; environment, episode and step are zero.
        words.fill(0);
        words[..8].copy_from_slice(&seed.to_le_bytes());
    }
    sign(state);
    Ok(())
}

/// A whole state that has this environment.
fn read(state: &[u8], env: usize) -> Result<Saved<'_>, EnvError> {
    let saved = Saved::read(state).map_err(|reason| EnvError::BadState { reason })?;
    let n = saved.header.num_envs;
    if env < n {
        Ok(saved)
    } else {
        Err(EnvError::BadState { reason: format!("it has no environment {env}, only {n}") })
    }
}
