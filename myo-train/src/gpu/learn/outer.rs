//! The gradients of the weights of both networks: products over samples.

use myo_gpu::{Access, Gpu, GpuError, Recipe};

use super::layers::{LayerRows, layers};
use super::layout::{Layout, METRICS, Precision};
use super::memory::LearnMemory;
use crate::gpu::dense::Dispatch;
use crate::gpu::kernels::{prepare, table};
use crate::gpu::{Sizes, Tile};
use crate::networks::Networks;

/// Workgroups that keep a large card busy.
const WORKGROUPS: usize = 512;

/// Samples that are worth a partial gradient of their own.
const SPLIT_MIN: usize = 128;

/// The tile for layers of at most so many inputs or outputs: as measured on an H200 (`benches/examples/gpu_learner.rs`, `tiles`).
/// Large ones fetch less, small ones give more workgroups.
fn tile_for(widest: usize, samples: usize) -> Tile {
    const SMALL: Tile = Tile::new(64, 64, 16, (4, 4));
    const MEDIUM: Tile = Tile::new(128, 64, 8, (8, 8));
    const LARGE: Tile = Tile::new(128, 128, 8, (8, 8));
    match (widest, samples) {
        (_, ..8192) => SMALL,
        (..256, _) => MEDIUM,
        _ => LARGE,
    }
}

/// Parts into which the columns of a chunk are split.
#[derive(Clone, Copy, Debug)]
pub struct Splits {
    /// How many.
    pub count: usize,
    /// Groups of four columns of each.
    groups: usize,
}

/// The products, and how they are divided among workgroups.
#[derive(Debug)]
pub struct Outer<'a> {
    gpu: &'a Gpu,
    layout: &'a Layout,
    networks: &'a Networks,
    sizes: &'a Sizes,
    tile: Tile,
}

impl<'a> Outer<'a> {
    /// For these networks. `forced` takes this tile rather than the best one, for measurements.
    pub fn new(
        gpu: &'a Gpu,
        sizes: &'a Sizes,
        layout: &'a Layout,
        networks: &'a Networks,
        forced: Option<Tile>,
    ) -> Self {
        let layers = layers(networks, sizes.observations, Precision::Single);
        let widest = layers.iter().flatten().map(|layer| layer.outputs).max().unwrap_or(1);
        let tile = forced.unwrap_or_else(|| tile_for(widest, layout.chunk));
        Self { gpu, layout, networks, sizes, tile }
    }

    /// How the columns are split.
    pub fn splits(&self) -> Splits {
        let tiles = self.jobs().last().map_or(1, |job| job[0] as usize);
        let count = WORKGROUPS.div_ceil(tiles).min(self.layout.chunk / SPLIT_MIN).max(1);
        let groups = (self.layout.chunk.div_ceil(4)).div_ceil(count).next_multiple_of(self.tile.depth as usize / 4);
        Splits { count: self.layout.chunk.div_ceil(4 * groups), groups }
    }

    /// The gradients of all parameters of a chunk, one dispatch for every chunk of a minibatch.
    pub fn dispatches(&self, memory: &LearnMemory) -> Result<Vec<Dispatch>, GpuError> {
        let (jobs, splits) = (self.jobs(), self.splits());
        let table = table(self.gpu, "jobs", &jobs)?;
        let tiles = jobs.last().map_or(0, |job| job[0] as usize);
        let kernel = self.gpu.kernel(&self.recipe())?;
        let [activation, gradient] = [memory.activation.binding(), memory.gradient.binding()];
        let buffers = [activation, gradient, table.binding(), memory.partial.binding()];
        let threads = tiles * splits.count * self.tile.threads() as usize;
        let chunk = |chunk: usize| {
            let length = self.networks.len() + METRICS;
            let places = [jobs.len(), self.layout.chunk / 4, splits.count, splits.groups, chunk * splits.count, length];
            prepare(self.gpu, &kernel, &buffers, &places.map(|x| x as u32), threads)
        };
        (0..self.layout.chunks).map(chunk).collect()
    }

    /// Tiles so far, inputs, outputs, first row of the input, first row of the gradient, weight, bias.
    fn jobs(&self) -> Vec<[u32; 8]> {
        let sums = |outputs, z_row, bias| LayerRows {
            inputs: 0,
            outputs,
            weight: bias,
            bias,
            x_row: 0,
            h_row: 0,
            z_row,
            hidden: false,
        };
        let actions = self.sizes.actions;
        let log_std = sums(actions, self.layout.sums_row, self.networks.log_std_range().start);
        let metrics = sums(METRICS, self.layout.sums_row + actions, self.networks.len());
        let mut end = 0;
        let job = |layer: &LayerRows| {
            end += self.tile.workgroups(layer.inputs.max(1) as u32, layer.outputs as u32);
            let LayerRows { inputs, outputs, weight, bias, x_row, z_row, .. } = *layer;
            let [inputs, outputs, x_row, z_row, weight, bias] =
                [inputs, outputs, x_row, z_row, weight, bias].map(|x| x as u32);
            [end, inputs, outputs, x_row, z_row, weight, bias, 0]
        };
        layers(self.networks, self.sizes.observations, Precision::Single)
            .iter()
            .flatten()
            .chain(&[log_std, metrics])
            .map(job)
            .collect()
    }

    /// What the kernel is compiled from.
    pub fn recipe(&self) -> Recipe {
        use Access::{Read, ReadWrite, Uniform};
        let label = format!("weight gradients {}x{}", self.tile.outputs, self.tile.columns);
        let access = [Read, Read, Read, ReadWrite, Uniform];
        // SAFETY: the jobs are made from the layout that the buffers were made for, in this file; what lies beyond a job is
        // left out. Shared memory is written before it is read. Loops end after the jobs or the samples.
        unsafe { Recipe::new(label, text(self.tile), access).trusted() }
    }
}

/// The kernel.
pub fn text(tile: Tile) -> String {
    [include_str!("outer.wgsl"), include_str!("job.wgsl"), &tile.over_samples()].concat()
}
