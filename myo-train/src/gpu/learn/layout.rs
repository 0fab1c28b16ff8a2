//! Where everything of a minibatch lies in memory.

use super::half::TILE_MAX;
use super::layers::layers;
use crate::PpoConfig;
use crate::gpu::Sizes;
use crate::gpu::dense::GROUP;
use crate::networks::Networks;

/// Most samples that go through the networks at a time.
const CHUNK: usize = 65_536;

/// Most neighbouring columns that stay together in the shuffle: 64 bytes of a row, so that gathering wastes no memory
/// transfers.
const BLOCK_MAX: usize = 16;

/// Blocks that every minibatch has at least, where there are enough samples; fewer would not mix.
const BLOCKS_MIN: usize = 64;

/// Sums over a minibatch besides the gradient: policy loss, divergence, samples cut off, squared error of the values.
pub const METRICS: usize = 4;

/// Rows of a gathered sample besides its action: old log-probability, advantage, target, weight.
pub const SCALARS: usize = 4;

/// Chunks in 16 bits are multiples of so many columns, which every workgroup's share divides.
pub const HALF_BLOCK: usize = 64;

/// What activations and their gradients are kept in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Precision {
    /// 32 bits: everywhere.
    Single,
    /// 16 bits, with sums in 32: for the matrix units of a card.
    Half,
}

impl Precision {
    /// Columns that lie side by side; chunks are multiples of it.
    fn group(self) -> usize {
        match self {
            Self::Single => GROUP,
            Self::Half => HALF_BLOCK,
        }
    }

    /// Rows of ones after what goes into a layer, of which the gradients of the biases come out.
    pub fn ones(self) -> usize {
        match self {
            Self::Single => 0,
            Self::Half => 1,
        }
    }

    /// Words of 32 bits that so many numbers take.
    pub fn words(self, numbers: usize) -> usize {
        match self {
            Self::Single => numbers,
            Self::Half => numbers.div_ceil(2),
        }
    }
}

/// Sizes of the update. Activations are `(rows, chunk)`: observations, then every layer's outputs of the policy, then of
/// the value network. Gradients with respect to them lie in the same rows, less those of the observations, followed by
/// what is summed up per sample: gradients of the logarithms of the standard deviations, and four metrics.
///
/// With 16 bits they are `(chunk / 16, rows, 16)`: matrices of 16 x 16 lie together. A row of ones follows what goes into a
/// layer, outputs of the networks and sums have buffers of their own, and after the last rows come those that a tile may
/// read beyond them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    /// Neighbouring columns that stay together in the shuffle.
    pub block: usize,
    /// Blocks of a roll-out.
    pub blocks: usize,
    /// Minibatches of a pass.
    pub minibatches: usize,
    /// Passes.
    pub epochs: usize,
    /// Columns that go through the networks at a time.
    pub chunk: usize,
    /// Such chunks in a minibatch.
    pub chunks: usize,
    /// Rows of activations.
    pub rows: usize,
    /// Rows of gradients.
    pub gradient_rows: usize,
    /// First row of the sums per sample, among the gradients, where they are kept in 32 bits.
    pub sums_row: usize,
    /// What both are kept in.
    pub precision: Precision,
}

impl Layout {
    /// For a roll-out; no buffer of activations exceeds `max_bytes`.
    pub fn new(sizes: &Sizes, networks: &Networks, config: &PpoConfig, max_bytes: u64, precision: Precision) -> Self {
        let (samples, minibatches) = (sizes.samples(), config.minibatches);
        let block = block(samples, minibatches);
        let blocks = samples.div_ceil(block);
        let columns = blocks.div_ceil(minibatches) * block;
        let layers = layers(networks, sizes.observations, precision);
        let all = || layers.iter().flatten();
        let sums_row = all().map(|layer| layer.outputs).sum();
        let (spare, gradient_rows) = match precision {
            Precision::Single => (0, sums_row + sizes.actions + METRICS),
            Precision::Half => (TILE_MAX, sums_row + TILE_MAX),
        };
        let ends = all().flat_map(|layer| [layer.x_row + layer.inputs, layer.h_row + layer.outputs]);
        let rows = ends.max().unwrap_or(0) + precision.ones() + spare;
        let group = precision.group();
        let fitting = max_bytes as usize / 4 / rows.max(gradient_rows) / group * group;
        let chunk = columns.next_multiple_of(group).min(CHUNK).min(fitting).max(group);
        let (epochs, chunks) = (config.epochs, columns.div_ceil(chunk));
        Self { block, blocks, minibatches, epochs, chunk, chunks, rows, gradient_rows, sums_row, precision }
    }

    /// Gradient steps of an update.
    pub fn steps(&self) -> usize {
        self.epochs * self.minibatches
    }

    /// By how much gradients are multiplied while they are kept in 16 bits, where those below 6e-8 would vanish: a
    /// sample's gradient is as small as a minibatch is large.
    pub fn gradient_scale(&self) -> f32 {
        match self.precision {
            Precision::Single => 1.0,
            Precision::Half => (self.chunk * self.chunks).next_power_of_two() as f32,
        }
    }

    /// The blocks of gradient step `step`, as places in the order of all passes.
    pub fn range(&self, step: usize) -> std::ops::Range<usize> {
        let (first, index) = (step / self.minibatches * self.blocks, step % self.minibatches);
        first + index * self.blocks / self.minibatches..first + (index + 1) * self.blocks / self.minibatches
    }
}

/// Neighbouring columns that stay together: a power of two.
fn block(samples: usize, minibatches: usize) -> usize {
    let fits = |block: &usize| samples >= block * minibatches * BLOCKS_MIN;
    std::iter::successors(Some(BLOCK_MAX), |block| Some(block / 2))
        .take_while(|&block| block > 1)
        .find(fits)
        .unwrap_or(1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Mlp;

    #[test]
    fn minibatches_share_all_blocks() {
        assert_eq!(block(16_384, 4), 16);
        assert_eq!(block(2048, 4), 8);
        assert_eq!(block(100, 4), 1);
        let sizes = Sizes {
            steps: 7,
            noise_steps: 1,
            envs: 37,
            counted: 37,
            noise_free: 0,
            layouts: 0,
            padded: 40,
            observations: 3,
            actions: 2,
            summary: 4,
            between_cuts: 5,
            control_dt: 0.05,
        };
        let networks = Networks { policy: Mlp::new(3, &[5], 2), value: Mlp::new(3, &[4], 1) };
        let config = PpoConfig { num_envs: 37, rollout_s: 0.35, minibatches: 3, ..PpoConfig::default() };
        let layout = Layout::new(&sizes, &networks, &config, 1000, Precision::Single);
        assert_eq!((layout.block, layout.blocks, layout.rows, layout.gradient_rows), (1, 280, 15, 18));
        assert_eq!((layout.chunk, layout.chunks), (12, 94usize.div_ceil(12)));
        let blocks: Vec<_> = (0..layout.steps()).flat_map(|step| layout.range(step)).collect();
        assert_eq!(blocks, (0..config.epochs * 280).collect::<Vec<_>>());
    }
}
