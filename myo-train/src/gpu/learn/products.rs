//! The passes through both networks, layer by layer, by threads that each make their own entries.

use std::collections::HashMap;

use myo_gpu::{Access, Buffer, Gpu, GpuError, Kernel, Recipe};

use super::layers::{LayerRows, layers};
use super::layout::{Layout, Precision};
use super::memory::LearnMemory;
use crate::gpu::dense::{Dispatch, tile_for};
use crate::gpu::kernels::{prepare, table};
use crate::gpu::tile::Weights;
use crate::gpu::{Sizes, Tile};
use crate::networks::Networks;

/// The layers of both networks, and where their outputs lie.
#[derive(Debug)]
pub struct Products<'a> {
    gpu: &'a Gpu,
    sizes: &'a Sizes,
    layout: &'a Layout,
    layers: [Vec<LayerRows>; 2],
    /// One tile for all layers rather than the best for each.
    forced: Option<Tile>,
    /// Compiled kernels, forward and backward, by their tiles.
    compiled: HashMap<(bool, Tile), Kernel>,
}

/// Layers that are passed at once, with one tile.
#[derive(Debug)]
struct Level {
    layers: Vec<LayerRows>,
    tile: Tile,
}

impl<'a> Products<'a> {
    /// For these networks. `forced` takes one tile for all layers, for measurements.
    pub fn new(gpu: &'a Gpu, sizes: &'a Sizes, layout: &'a Layout, networks: &Networks, forced: Option<Tile>) -> Self {
        let layers = layers(networks, sizes.observations, Precision::Single);
        Self { gpu, sizes, layout, layers, forced, compiled: HashMap::new() }
    }

    /// First rows of the outputs of the policy and the value network, among the gradients.
    pub fn output_rows(&self) -> [usize; 2] {
        [0, 1].map(|net| self.layers[net][self.layers[net].len() - 1].z_row)
    }

    /// The layers of both networks that can be passed at once, from the first on.
    fn forward_levels(&self) -> Vec<Level> {
        let depth = self.layers.iter().map(Vec::len).max().unwrap_or(0);
        let level = |level: usize| {
            let layers: Vec<_> = self.layers.iter().filter_map(|layers| layers.get(level)).copied().collect();
            Level { tile: self.tile(layers.iter().map(|layer| layer.outputs)), layers }
        };
        (0..depth).map(level).collect()
    }

    /// The same on the way back, from the last to the second.
    fn backward_levels(&self) -> Vec<Level> {
        let depth = self.layers.iter().map(|layers| layers.len() - 1).max().unwrap_or(0);
        let level = |level: usize| {
            let layers: Vec<_> = (self.layers.iter())
                .filter(|layers| level + 1 < layers.len())
                .map(|layers| layers[layers.len() - 1 - level])
                .collect();
            Level { tile: self.tile(layers.iter().map(|layer| layer.inputs)), layers }
        };
        (0..depth).map(level).collect()
    }

    /// What the kernels are compiled from.
    pub fn recipes(&self) -> Vec<Recipe> {
        let forward = self.forward_levels().into_iter().map(|level| recipe(true, level.tile));
        forward.chain(self.backward_levels().into_iter().map(|level| recipe(false, level.tile))).collect()
    }

    /// From the gathered observations to the outputs of both networks.
    pub fn forward(&mut self, parameters: &Buffer<f32>, memory: &LearnMemory) -> Result<Vec<Dispatch>, GpuError> {
        let job = |layer: &LayerRows| {
            let LayerRows { inputs, outputs, weight, bias, x_row, z_row, hidden, .. } = *layer;
            [inputs, outputs, weight, bias, x_row, z_row, hidden.into()]
        };
        let buffers = [&memory.gradient, &memory.activation];
        let levels = self.forward_levels().into_iter();
        levels
            .map(|Level { layers, tile }| self.product(true, tile, layers.iter().map(job), parameters, &buffers))
            .collect()
    }

    /// From the gradients with respect to the outputs to those with respect to what went into every hidden layer.
    pub fn backward(&mut self, parameters: &Buffer<f32>, memory: &LearnMemory) -> Result<Vec<Dispatch>, GpuError> {
        let observations = self.sizes.observations;
        let job = |layer: &LayerRows| {
            let to = layer.x_row - observations;
            [layer.outputs, layer.inputs, layer.weight, 0, layer.z_row, to, 1]
        };
        let buffers = [&memory.gradient];
        let levels = self.backward_levels().into_iter();
        levels
            .map(|Level { layers, tile }| self.product(false, tile, layers.iter().map(job), parameters, &buffers))
            .collect()
    }

    fn tile(&self, outputs: impl Iterator<Item = usize>) -> Tile {
        self.forced.unwrap_or_else(|| tile_for(outputs.max().unwrap_or(1), self.layout.chunk))
    }

    /// One dispatch for jobs: inputs, outputs, weight, bias, first row in, first row out, hidden.
    fn product(
        &mut self,
        forward: bool,
        tile: Tile,
        jobs: impl Iterator<Item = [usize; 7]>,
        parameters: &Buffer<f32>,
        buffers: &[&Buffer<u32>],
    ) -> Result<Dispatch, GpuError> {
        let mut end = 0;
        let jobs: Vec<[u32; 8]> = jobs
            .map(|job| {
                end += tile.workgroups(job[1] as u32, self.layout.chunk as u32);
                let [inputs, outputs, weight, bias, from, to, hidden] = job.map(|x| x as u32);
                [end, inputs, outputs, weight, bias, from, to, hidden]
            })
            .collect();
        let table = table(self.gpu, "jobs", &jobs)?;
        let mut all = vec![parameters.binding(), table.binding()];
        all.extend(buffers.iter().map(|buffer| buffer.binding()));
        let shape = [jobs.len(), self.layout.chunk / 4, self.sizes.observations].map(|x| x as u32);
        let kernel = self.kernel(forward, tile)?;
        prepare(self.gpu, &kernel, &all, &shape, (end * tile.threads()) as usize)
    }

    fn kernel(&mut self, forward: bool, tile: Tile) -> Result<Kernel, GpuError> {
        if let Some(kernel) = self.compiled.get(&(forward, tile)) {
            return Ok(kernel.clone());
        }
        let kernel = self.gpu.kernel(&recipe(forward, tile))?;
        self.compiled.insert((forward, tile), kernel.clone());
        Ok(kernel)
    }
}

fn forward_text(tile: Tile) -> String {
    const FILES: &str = concat!(
        include_str!("product.wgsl"),
        include_str!("product_forward.wgsl"),
        include_str!("sigmoid.wgsl"),
        include_str!("job.wgsl")
    );
    [FILES, &tile.over_inputs(Weights::AsStored)].concat()
}

fn backward_text(tile: Tile) -> String {
    const FILES: &str =
        concat!(include_str!("product.wgsl"), include_str!("product_backward.wgsl"), include_str!("job.wgsl"));
    [FILES, &tile.over_inputs(Weights::Transposed)].concat()
}

fn recipe(forward: bool, tile: Tile) -> Recipe {
    use Access::{Read, ReadWrite, Uniform};
    let (what, text, access) = match forward {
        true => ("forward", forward_text(tile), vec![Read, Read, ReadWrite, ReadWrite, Uniform]),
        false => ("backward", backward_text(tile), vec![Read, Read, ReadWrite, Uniform]),
    };
    let label = format!("{what} {}x{}", tile.outputs, tile.columns);
    // SAFETY: the jobs are made from the layout that the buffers were made for, in this file; what lies beyond a job is
    // left out. Shared memory is written before it is read. Loops end after the jobs or the inputs.
    unsafe { Recipe::new(label, text, access).trusted() }
}

/// Both kernels.
#[cfg(test)]
pub fn texts(tile: Tile) -> Vec<String> {
    vec![forward_text(tile), backward_text(tile)]
}
