//! Seeds for single environments.

use crate::saved::{Saved, sign};
use crate::vector::EnvError;

/// Gives environments of a saved state seeds of their own, so that the next reset draws what the first environment of a
/// batch with that seed draws.
///
/// # Errors
/// The state is damaged or has no such environment; it is unchanged then.
pub fn reseed(state: &mut [u8], seeds: impl IntoIterator<Item = (usize, u64)>) -> Result<(), EnvError> {
    let seeds: Vec<(usize, u64)> = seeds.into_iter().collect();
    let Some(last) = seeds.iter().map(|(env, _)| *env).max() else { return Ok(()) };
    let saved = Saved::read(state).and_then(|saved| saved.with_env(last));
    let saved = saved.map_err(|reason| EnvError::BadState { reason })?;
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
