//! States of environments as bytes, the same for every backend of one precision.

use crate::state::EnvState;
use myo_scalar::Real;

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
        let (header, rest) = bytes.split_at_checked(24).ok_or("it is shorter than its header")?;
        let names = ["environments", "numbers per environment", "bytes per number"];
        for ((name, want), got) in names.iter().zip(self.header()).zip(header.chunks_exact(8)) {
            let got = u64::from_le_bytes(got.try_into().expect("chunks of eight"));
            if got != want {
                return Err(format!("it has {got} {name}, this environment {want}"));
            }
        }
        let size = 8 * self.count + 4 * WORDS;
        if rest.len() != self.num_envs * size {
            return Err(format!("it has {} bytes, expected {}", bytes.len(), 24 + self.num_envs * size));
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
