//! A few environments of a shard, without the others.

use super::shard::Shard;
use crate::snapshot::Snapshot;
use crate::storage::WORDS;
use crate::tables::Tables;
use myo_gpu::{Gpu, GpuError};
use std::ops::Range;

/// States of consecutive environments: entry `row` of the `k`-th at `row * num_envs + k`, as on the card.
pub struct Cells {
    num_envs: usize,
    numbers: Vec<f32>,
    words: Vec<u32>,
}

impl Cells {
    /// Copies environments of a shard, counted from its first one, with `count` numbers each: one run of neighbours per row, all
    /// with one submission.
    pub fn read(gpu: &Gpu, shard: &Shard, count: usize, envs: Range<usize>) -> Result<Self, GpuError> {
        let n = envs.len();
        let (mut numbers, mut words) = (vec![0.0; count * n], vec![0; WORDS * n]);
        if n > 0 {
            let at = |row: usize| row * shard.num_envs + envs.start;
            let numbers = numbers.chunks_exact_mut(n).enumerate().map(|(row, out)| shard.numbers.part(at(row), out));
            let words = words.chunks_exact_mut(n).enumerate().map(|(row, out)| shard.words.part(at(row), out));
            gpu.read_many(&mut numbers.chain(words).collect::<Result<Vec<_>, _>>()?)?;
        }
        Ok(Self { num_envs: n, numbers, words })
    }

    /// What a viewer sees of each environment.
    pub fn snapshots(&self, tables: &Tables<f64>) -> impl Iterator<Item = Snapshot> {
        let Self { num_envs, numbers, words } = self;
        let number = move |k: usize, row: usize| f64::from(numbers[row * num_envs + k]);
        let word = move |k: usize, row: usize| words[row * num_envs + k];
        (0..*num_envs).map(move |k| Snapshot::of(tables, |row| number(k, row), |row| word(k, row)))
    }
}
