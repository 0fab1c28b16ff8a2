//! Where everything of a minibatch lies in memory.

use crate::gpu::Sizes;
use crate::gpu::dense::GROUP;
use crate::networks::Networks;
use crate::{Mlp, PpoConfig};

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

/// Sizes of the update. Activations are `(rows, stride)`: observations, then every layer's outputs of the policy, then of
/// the value network. Gradients with respect to them lie in the same rows, less those of the observations, followed by
/// what is summed up per sample: gradients of the logarithms of the standard deviations, and four metrics.
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
    /// First row of the sums per sample, among the gradients.
    pub sums_row: usize,
}

impl Layout {
    /// For a roll-out; no buffer of activations exceeds `max_bytes`.
    pub fn new(sizes: &Sizes, networks: &Networks, config: &PpoConfig, max_bytes: u64) -> Self {
        let (samples, minibatches) = (sizes.samples(), config.minibatches);
        let block = block(samples, minibatches);
        let blocks = samples.div_ceil(block);
        let columns = blocks.div_ceil(minibatches) * block;
        let outputs = |net: &Mlp| net.layers().map(|[_, outputs, ..]| outputs).sum::<usize>();
        let sums_row = outputs(&networks.policy) + outputs(&networks.value);
        let (rows, gradient_rows) = (sizes.observations + sums_row, sums_row + sizes.actions + METRICS);
        let fitting = max_bytes as usize / 4 / rows.max(gradient_rows) / GROUP * GROUP;
        let chunk = columns.next_multiple_of(GROUP).min(CHUNK).min(fitting).max(GROUP);
        let (epochs, chunks) = (config.epochs, columns.div_ceil(chunk));
        Self { block, blocks, minibatches, epochs, chunk, chunks, rows, gradient_rows, sums_row }
    }

    /// Gradient steps of an update.
    pub fn steps(&self) -> usize {
        self.epochs * self.minibatches
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

    #[test]
    fn minibatches_share_all_blocks() {
        assert_eq!(block(16_384, 4), 16);
        assert_eq!(block(2048, 4), 8);
        assert_eq!(block(100, 4), 1);
        let sizes = Sizes {
            steps: 7,
            envs: 37,
            padded: 40,
            observations: 3,
            actions: 2,
            summary: 4,
            time_limit: 5,
            control_dt: 0.05,
        };
        let networks = Networks { policy: Mlp::new(3, &[5], 2), value: Mlp::new(3, &[4], 1) };
        let config = PpoConfig { num_envs: 37, steps_per_update: 7, minibatches: 3, ..PpoConfig::default() };
        let layout = Layout::new(&sizes, &networks, &config, 1000);
        assert_eq!((layout.block, layout.blocks, layout.rows, layout.gradient_rows), (1, 280, 15, 18));
        assert_eq!((layout.chunk, layout.chunks), (12, 94usize.div_ceil(12)));
        let blocks: Vec<_> = (0..layout.steps()).flat_map(|step| layout.range(step)).collect();
        assert_eq!(blocks, (0..config.epochs * 280).collect::<Vec<_>>());
    }
}
