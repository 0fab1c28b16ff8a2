//! States of environments as bytes, the same for every backend of one precision.

use crate::state::EnvState;
use crate::tables::Tables;
use crate::vector::EnvError;
use myo_dynamics::State;
use myo_scalar::Real;
use myo_tasks::logic::TaskState;

/// Bytes before the first environment.
const HEADER: usize = 24;

/// Integers per environment.
const WORDS: usize = EnvState::<f64>::WORDS;

/// Sizes that a saved state must have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shape {
    /// Environments.
    pub num_envs: usize,
    /// Numbers per environment.
    pub count: usize,
    /// Bytes of a number while it is simulated; it is saved as `f64`.
    pub bytes: usize,
}

impl Shape {
    /// The shape for numbers of type `C`.
    pub fn of<C: Real>(num_envs: usize, count: usize) -> Self {
        Self { num_envs, count, bytes: size_of::<C>() }
    }

    fn header(self) -> [u64; 3] {
        [self.num_envs as u64, self.count as u64, self.bytes as u64]
    }

    /// Writes a state; `number` and `word` give entry `k` of an environment.
    pub fn save(self, number: impl Fn(usize, usize) -> f64, word: impl Fn(usize, usize) -> u32) -> Vec<u8> {
        let mut out: Vec<u8> = self.header().iter().flat_map(|x| x.to_le_bytes()).collect();
        for env in 0..self.num_envs {
            out.extend((0..self.count).flat_map(|k| number(env, k).to_le_bytes()));
            out.extend((0..WORDS).flat_map(|k| word(env, k).to_le_bytes()));
        }
        out
    }

    /// Hands a saved state's entries to `number` and `word`; says why it cannot, before it changes anything.
    pub fn load(
        self,
        bytes: &[u8],
        mut number: impl FnMut(usize, usize, f64),
        mut word: impl FnMut(usize, usize, u32),
    ) -> Result<(), String> {
        let (header, rest) = bytes.split_at_checked(HEADER).ok_or("it is shorter than its header")?;
        let names = ["environments", "numbers per environment", "bytes per number"];
        for ((name, want), got) in names.iter().zip(self.header()).zip(header.chunks_exact(8)) {
            let got = u64::from_le_bytes(got.try_into().expect("chunks of eight"));
            if got != want {
                return Err(format!("it has {got} {name}, this environment {want}"));
            }
        }
        let size = 8 * self.count + 4 * WORDS;
        if rest.len() != self.num_envs * size {
            return Err(format!("it has {} bytes, expected {}", bytes.len(), HEADER + self.num_envs * size));
        }
        for (env, entries) in rest.chunks_exact(size).enumerate() {
            let (numbers, words) = entries.split_at(8 * self.count);
            for (k, x) in numbers.chunks_exact(8).enumerate() {
                number(env, k, f64::from_le_bytes(x.try_into().expect("chunks of eight")));
            }
            for (k, x) in words.chunks_exact(4).enumerate() {
                word(env, k, u32::from_le_bytes(x.try_into().expect("chunks of four")));
            }
        }
        Ok(())
    }
}

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
    /// The state is not one of this model and task, or has no such environment.
    pub fn read(tables: &Tables<f64>, state: &[u8], env: usize) -> Result<Self, EnvError> {
        let mut read = EnvState::<f64>::new(tables);
        let count = read.numbers().count();
        let bytes = row(state, env)?;
        if bytes.len() != 8 * count + 4 * WORDS {
            return Err(EnvError::BadState { reason: "it is of another model or task".into() });
        }
        for (x, from) in read.numbers().zip(bytes.chunks_exact(8)) {
            *x = f64::from_le_bytes(from.try_into().expect("chunks of eight"));
        }
        Ok(Self { body: read.body, task: read.task })
    }
}

/// Gives environments of a saved state seeds of their own, so that the next reset draws what the first environment of a
/// batch with that seed draws.
///
/// # Errors
/// The state has no such environment.
pub fn reseed(state: &mut [u8], seeds: impl IntoIterator<Item = (usize, u64)>) -> Result<(), EnvError> {
    for (env, seed) in seeds {
        let range = row_range(state, env)?;
        let words = &mut state[range.end - 4 * WORDS..range.end];
        // Low and high half of the seed; environment, episode and step are zero.
        words.fill(0);
        words[..8].copy_from_slice(&seed.to_le_bytes());
    }
    Ok(())
}

fn row(state: &[u8], env: usize) -> Result<&[u8], EnvError> {
    Ok(&state[row_range(state, env)?])
}

/// Where an environment stands in a saved state.
fn row_range(state: &[u8], env: usize) -> Result<std::ops::Range<usize>, EnvError> {
    let bad = |reason: &str| EnvError::BadState { reason: reason.to_owned() };
    let count = state.get(8..16).ok_or_else(|| bad("it is shorter than its header"))?;
    let size = 8 * u64::from_le_bytes(count.try_into().expect("eight bytes")) as usize + 4 * WORDS;
    let start = HEADER + env * size;
    let range = start..start + size;
    if range.end > state.len() { Err(bad("it has no such environment")) } else { Ok(range) }
}
