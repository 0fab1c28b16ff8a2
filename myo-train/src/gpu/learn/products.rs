//! The matrix products of both networks, layer by layer: forward, backward, and gradients of the weights.

use std::collections::HashMap;

use myo_gpu::{Access, Buffer, Gpu, GpuError, Kernel, Source};

use super::layout::{Layout, METRICS};
use super::memory::LearnMemory;
use crate::gpu::dense::{Dispatch, tile_for};
use crate::gpu::kernels::prepare;
use crate::gpu::{Sizes, Tile};
use crate::networks::Networks;

/// The tile of the gradients of weights, for layers of at most so many inputs or outputs: as measured on an H200
/// (`examples/gpu_learner.rs`, `tiles`). Large ones fetch less, small ones give more workgroups.
fn outer_tile(widest: usize, samples: usize) -> Tile {
    const SMALL: Tile = Tile::new(64, 64, 16, (4, 4));
    const MEDIUM: Tile = Tile::new(128, 64, 8, (8, 8));
    const LARGE: Tile = Tile::new(128, 128, 8, (8, 8));
    match (widest, samples) {
        (_, ..8192) => SMALL,
        (..256, _) => MEDIUM,
        _ => LARGE,
    }
}

/// Tiles for all products alike rather than the best for each: for measurements.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tiles {
    /// Of layers, forward and backward.
    pub layers: Option<Tile>,
    /// Of gradients of weights: inputs, outputs, samples.
    pub weights: Option<Tile>,
}

/// Workgroups that keep a large card busy.
const WORKGROUPS: usize = 512;

/// Samples that are worth a partial gradient of their own.
const SPLIT_MIN: usize = 128;

/// A layer among both networks.
#[derive(Clone, Copy, Debug)]
struct Layer {
    inputs: usize,
    outputs: usize,
    weight: usize,
    bias: usize,
    /// First row of its input among the activations.
    x_row: usize,
    /// First row of its outputs among the gradients.
    z_row: usize,
    hidden: bool,
}

/// Parts into which the columns of a chunk are split.
#[derive(Clone, Copy, Debug)]
pub struct Splits {
    /// How many.
    pub count: usize,
    /// Groups of four columns of each.
    groups: usize,
}

/// The layers of both networks, and where their outputs lie.
#[derive(Debug)]
pub struct Products<'a> {
    gpu: &'a Gpu,
    sizes: &'a Sizes,
    layout: &'a Layout,
    networks: &'a Networks,
    layers: [Vec<Layer>; 2],
    tiles: Tiles,
    outer: Tile,
    /// Compiled kernels, forward and backward, by their tiles.
    compiled: HashMap<(bool, Tile), Kernel>,
}

impl<'a> Products<'a> {
    /// For these networks.
    pub fn new(gpu: &'a Gpu, sizes: &'a Sizes, layout: &'a Layout, networks: &'a Networks, tiles: Tiles) -> Self {
        let widest = [&networks.policy, &networks.value].into_iter().flat_map(|net| net.layers()).map(|layer| layer[1]);
        let widest = widest.max().unwrap_or(1);
        let outer = tiles.weights.unwrap_or_else(|| outer_tile(widest, layout.chunk));
        let mut z_row = 0;
        let nets = [(&networks.policy, networks.policy_range()), (&networks.value, networks.value_range())];
        let layers = nets.map(|(net, range)| {
            let (mut x_row, last) = (0, net.layers().count() - 1);
            let place = |(index, [inputs, outputs, weight, bias]): (usize, [usize; 4])| {
                let (weight, bias) = (range.start + weight, range.start + bias);
                let layer = Layer { inputs, outputs, weight, bias, x_row, z_row, hidden: index < last };
                x_row = sizes.observations + z_row;
                z_row += outputs;
                layer
            };
            net.layers().enumerate().map(place).collect()
        });
        Self { gpu, sizes, layout, networks, layers, tiles, outer, compiled: HashMap::new() }
    }

    /// First rows of the outputs of the policy and the value network, among the gradients.
    pub fn output_rows(&self) -> [usize; 2] {
        [0, 1].map(|net| self.layers[net][self.layers[net].len() - 1].z_row)
    }

    /// How the columns are split for the gradients of the weights.
    pub fn splits(&self) -> Splits {
        let tiles = self.outer_jobs().last().map_or(1, |job| job[0] as usize);
        let count = WORKGROUPS.div_ceil(tiles).min(self.layout.chunk / SPLIT_MIN).max(1);
        let groups = (self.layout.chunk.div_ceil(4)).div_ceil(count).next_multiple_of(self.outer.depth as usize / 4);
        Splits { count: self.layout.chunk.div_ceil(4 * groups), groups }
    }

    /// From the gathered observations to the outputs of both networks.
    pub fn forward(&mut self, parameters: &Buffer<f32>, memory: &LearnMemory) -> Result<Vec<Dispatch>, GpuError> {
        let depth = self.layers.iter().map(Vec::len).max().unwrap_or(0);
        let mut level = |level: usize| {
            let layers: Vec<_> = self.layers.iter().filter_map(|layers| layers.get(level)).copied().collect();
            let tile = self.tile(layers.iter().map(|layer| layer.outputs));
            let job = |layer: &Layer| {
                let Layer { inputs, outputs, weight, bias, x_row, z_row, hidden } = *layer;
                [inputs, outputs, weight, bias, x_row, z_row, hidden.into()]
            };
            let buffers = [&memory.gradient, &memory.activation];
            self.product(true, tile, layers.iter().map(job), parameters, &buffers)
        };
        (0..depth).map(&mut level).collect()
    }

    /// From the gradients with respect to the outputs to those with respect to what went into every hidden layer.
    pub fn backward(&mut self, parameters: &Buffer<f32>, memory: &LearnMemory) -> Result<Vec<Dispatch>, GpuError> {
        let observations = self.sizes.observations;
        let depth = self.layers.iter().map(|layers| layers.len() - 1).max().unwrap_or(0);
        let mut level = |level: usize| {
            let layers: Vec<_> = (self.layers.iter())
                .filter(|layers| level + 1 < layers.len())
                .map(|layers| layers[layers.len() - 1 - level])
                .collect();
            let tile = self.tile(layers.iter().map(|layer| layer.inputs));
            let job = |layer: &Layer| {
                let to = layer.x_row - observations;
                [layer.outputs, layer.inputs, layer.weight, 0, layer.z_row, to, 1]
            };
            self.product(false, tile, layers.iter().map(job), parameters, &[&memory.gradient])
        };
        (0..depth).map(&mut level).collect()
    }

    fn tile(&self, outputs: impl Iterator<Item = usize>) -> Tile {
        self.tiles.layers.unwrap_or_else(|| tile_for(outputs.max().unwrap_or(1), self.layout.chunk))
    }

    /// One dispatch for jobs: inputs, outputs, weight, bias, first row in, first row out, hidden.
    fn product(
        &mut self,
        forward: bool,
        tile: Tile,
        jobs: impl Iterator<Item = [usize; 7]>,
        parameters: &Buffer<f32>,
        buffers: &[&Buffer<f32>],
    ) -> Result<Dispatch, GpuError> {
        let mut end = 0;
        let jobs: Vec<[u32; 8]> = jobs
            .map(|job| {
                end += tile.workgroups(job[1] as u32, self.layout.chunk as u32);
                let [inputs, outputs, weight, bias, from, to, hidden] = job.map(|x| x as u32);
                [end, inputs, outputs, weight, bias, from, to, hidden]
            })
            .collect();
        let table = self.table(&jobs)?;
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
        let kernel = if forward { compile_forward(self.gpu, tile)? } else { compile_backward(self.gpu, tile)? };
        self.compiled.insert((forward, tile), kernel.clone());
        Ok(kernel)
    }

    /// The gradients of all parameters of a chunk, one dispatch for every chunk of a minibatch.
    pub fn outer(&self, memory: &LearnMemory) -> Result<Vec<Dispatch>, GpuError> {
        let (jobs, splits) = (self.outer_jobs(), self.splits());
        let table = self.table(&jobs)?;
        let tiles = jobs.last().map_or(0, |job| job[0] as usize);
        let kernel = compile_outer(self.gpu, self.outer)?;
        let [activation, gradient] = [memory.activation.binding(), memory.gradient.binding()];
        let buffers = [activation, gradient, table.binding(), memory.partial.binding()];
        let threads = tiles * splits.count * self.outer.threads() as usize;
        let chunk = |chunk: usize| {
            let length = self.networks.len() + METRICS;
            let places = [splits.count, splits.groups, chunk * splits.count, length];
            let shape: Vec<_> =
                [jobs.len(), self.layout.chunk / 4].into_iter().chain(places).map(|x| x as u32).collect();
            prepare(self.gpu, &kernel, &buffers, &shape, threads)
        };
        (0..self.layout.chunks).map(chunk).collect()
    }

    /// Tiles so far, inputs, outputs, first row of the input, first row of the gradient, weight, bias.
    fn outer_jobs(&self) -> Vec<[u32; 8]> {
        let sums =
            |outputs, z_row, bias| Layer { inputs: 0, outputs, weight: bias, bias, x_row: 0, z_row, hidden: false };
        let actions = self.sizes.actions;
        let log_std = sums(actions, self.layout.sums_row, self.networks.log_std_range().start);
        let metrics = sums(METRICS, self.layout.sums_row + actions, self.networks.len());
        let (mut end, outer) = (0, self.outer);
        let job = |layer: &Layer| {
            end += outer.workgroups(layer.inputs.max(1) as u32, layer.outputs as u32);
            let Layer { inputs, outputs, weight, bias, x_row, z_row, .. } = *layer;
            let [inputs, outputs, x_row, z_row, weight, bias] =
                [inputs, outputs, x_row, z_row, weight, bias].map(|x| x as u32);
            [end, inputs, outputs, x_row, z_row, weight, bias, 0]
        };
        self.layers.iter().flatten().chain(&[log_std, metrics]).map(job).collect()
    }

    fn table(&self, jobs: &[[u32; 8]]) -> Result<Buffer<u32>, GpuError> {
        let table = self.gpu.buffer("jobs", 8 * jobs.len())?;
        self.gpu.write(&table, 0, jobs.as_flattened())?;
        Ok(table)
    }
}

const FORWARD: &str = "fn fetch_bias(output: u32) -> f32 {
    return parameters[shape.bias + output];
}

fn keep(output: u32, group: u32, z: vec4<f32>) {
    let place = (shape.y_row + output) * shape.groups + group;
    let above = all.observations * shape.groups;
    if shape.hidden == 0u {
        activation[above + place] = z;
        return;
    }
    // Held where the exponential would overflow.
    let s = 1.0 / (1.0 + exp(-max(z, vec4<f32>(-87.0))));
    let h = z * s;
    activation[above + place] = h;
    gradient[place] = fma(h, 1.0 - s, s);
}";

const BACKWARD: &str = "fn fetch_bias(output: u32) -> f32 {
    return 0.0;
}

fn keep(output: u32, group: u32, sum: vec4<f32>) {
    gradient[(shape.y_row + output) * shape.groups + group] *= sum;
}";

fn compile_forward(gpu: &Gpu, tile: Tile) -> Result<Kernel, GpuError> {
    let text = include_str!("product.wgsl")
        .replace("$BINDINGS", "@group(0) @binding(3) var<storage, read_write> activation: array<vec4<f32>>;")
        .replace("$SHAPE", "4")
        .replace("$WEIGHT", "shape.weight + input * shape.outputs + output")
        .replace("$SOURCE", "activation")
        .replace("$FUNCTIONS", FORWARD);
    let text = tile.fill_in(&text, "keep(output, group, sum);");
    use Access::{Read, ReadWrite, Uniform};
    compile(gpu, "forward", tile, &text, &[Read, Read, ReadWrite, ReadWrite, Uniform])
}

fn compile_backward(gpu: &Gpu, tile: Tile) -> Result<Kernel, GpuError> {
    let text = include_str!("product.wgsl")
        .replace("$BINDINGS", "")
        .replace("$SHAPE", "3")
        .replace("$WEIGHT", "shape.weight + output * shape.inputs + input")
        .replace("$SOURCE", "gradient")
        .replace("$FUNCTIONS", BACKWARD);
    let text = tile.fill_in_transposed(&text, "keep(output, group, sum);");
    use Access::{Read, ReadWrite, Uniform};
    compile(gpu, "backward", tile, &text, &[Read, Read, ReadWrite, Uniform])
}

fn compile_outer(gpu: &Gpu, tile: Tile) -> Result<Kernel, GpuError> {
    let text = tile.fill_in_turned(include_str!("outer.wgsl"), "keep(output, group, sum);");
    use Access::{Read, ReadWrite, Uniform};
    compile(gpu, "weight gradients", tile, &text, &[Read, Read, Read, ReadWrite, Uniform])
}

fn compile(gpu: &Gpu, what: &str, tile: Tile, text: &str, access: &[Access]) -> Result<Kernel, GpuError> {
    let label = format!("{what} {}x{}", tile.outputs, tile.columns);
    // SAFETY: the jobs are made from the layout that the buffers were made for, in this file; what lies beyond a job is
    // left out. Shared memory is written before it is read. Loops end after the jobs, the inputs or the samples.
    unsafe { gpu.compile_trusted(&label, Source::Wgsl(text), "main", access) }
}
