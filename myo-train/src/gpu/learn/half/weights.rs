//! The gradients of the weights on the matrix units.

use std::fmt::Write;

use myo_gpu::{Access, GpuError, Recipe};

use super::super::context::Context;
use super::super::layers::{LayerRows, layers};
use super::super::layout::{HALF_BLOCK, Layout, METRICS, Precision};
use super::memory::HalfMemory;
use crate::gpu::Sizes;
use crate::gpu::dense::Dispatch;
use crate::gpu::kernels::{prepare, table};
use crate::gpu::units::{Matrices, SUBGROUP, THREAD, UNIT, units};
use crate::networks::Networks;

/// Workgroups that keep a large card busy.
const WORKGROUPS: usize = 1024;

/// Rows and columns of a tile at most: so many rows lie after the last ones, so that every tile can be read.
pub const TILE_MAX: usize = 128;

/// What one workgroup makes of a layer's gradient.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct MatrixTile {
    /// Inputs of the layer, and of one subgroup.
    rows: [u32; 2],
    /// Outputs of the layer, and of one subgroup.
    columns: [u32; 2],
}

impl MatrixTile {
    /// A tile of `size` rows and columns, of which a subgroup makes `each`.
    ///
    /// # Panics
    /// Subgroups do not fill the tile, make no matrices of 16 x 16, or it is larger than 128 x 128.
    pub const fn new(size: (u32, u32), each: (u32, u32)) -> Self {
        assert!(size.0 <= TILE_MAX as u32 && size.1 <= TILE_MAX as u32, "at most 128 x 128");
        assert!(each.0.is_multiple_of(UNIT) && each.1.is_multiple_of(UNIT), "subgroups make matrices of 16 x 16");
        assert!(size.0.is_multiple_of(each.0) && size.1.is_multiple_of(each.1), "subgroups fill the tile");
        Self { rows: [size.0, each.0], columns: [size.1, each.1] }
    }

    fn across(self) -> u32 {
        self.columns[0] / self.columns[1]
    }

    fn subgroups(self) -> u32 {
        self.rows[0] / self.rows[1] * self.across()
    }

    fn tiles(self, inputs: usize, outputs: usize) -> usize {
        inputs.div_ceil(self.rows[0] as usize) * outputs.div_ceil(self.columns[0] as usize)
    }

    fn matrices(self) -> Matrices {
        Matrices { rows: self.rows[1] / UNIT, columns: self.columns[1] / UNIT }
    }

    fn text(self) -> String {
        const FILES: &str = concat!(include_str!("weights.wgsl"), include_str!("../job.wgsl"));
        let Self { rows: [tile_rows, rows_each], columns: [tile_columns, columns_each] } = self;
        let sizes = format!(
            "
const TILE_ROWS = {tile_rows}u;
const TILE_COLUMNS = {tile_columns}u;
const ROWS_EACH = {rows_each}u;
const COLUMNS_EACH = {columns_each}u;
"
        );
        [FILES, &units(self.subgroups()), &sizes, &self.make_part()].concat()
    }

    /// What a subgroup makes: the next matrices are loaded while these are multiplied.
    fn make_part(self) -> String {
        let matrices = self.matrices();
        let keep = matrices.staged(|row, column, half| {
            let row = format!("part.first_row + {}u + line", UNIT * row + 8 * half);
            let column = format!("part.first_column + {}u + 4u * quad", UNIT * column);
            format!("keep(job, part.first, {row}, {column}, sum_{half});")
        });
        let (zero, multiply, step) = (matrices.zero(), matrices.multiply(), self.step());
        let [first, next] = [("var", ""), ("let", "next_")].map(|(keyword, prefix)| self.load(keyword, prefix));
        format!(
            "
fn make_part(job: Job, part: Part, subgroup: u32, lane: u32) {{
{THREAD}{zero}    // Groups of four numbers from 16 samples to the next.
    let h_step = all.h_rows * 4u;
    let z_step = all.z_rows * 4u;
    var h = (part.begin_block * 4u * all.h_rows + job.h_row + part.first_row) * 4u;
    var z = (part.begin_block * 4u * all.z_rows + job.z_row + part.first_column) * 4u;
{first}    for (var block = part.begin_block; block < part.end_block; block += 1u) {{
        for (var samples = 0u; samples < 64u; samples += 16u) {{
            // After the last ones the last ones again.
            let more = block + 1u < part.end_block || samples < 48u;
            h += select(0u, h_step, more);
            z += select(0u, z_step, more);
{next}{multiply}{step}        }}
    }}
{keep}}}
"
        )
    }

    /// Loads the matrices of 16 samples into `w_0` and following, `x_0` and following.
    fn load(self, keyword: &str, prefix: &str) -> String {
        let (Matrices { rows, columns }, mut text) = (self.matrices(), String::new());
        for row in 0..rows {
            let load = format!("coopLoadT<coop_mat16x16<f16, A>>(&activation[h + {}u], 4u)", row * UNIT * 4);
            _ = writeln!(text, "            {keyword} {prefix}w_{row} = {load};");
        }
        for column in 0..columns {
            let load = format!("coopLoad<coop_mat16x16<f16, B>>(&gradient[z + {}u], 4u)", column * UNIT * 4);
            _ = writeln!(text, "            {keyword} {prefix}x_{column} = {load};");
        }
        text
    }

    /// Makes the next matrices those to be multiplied.
    fn step(self) -> String {
        let Matrices { rows, columns } = self.matrices();
        let names = (0..rows).map(|row| format!("w_{row}")).chain((0..columns).map(|column| format!("x_{column}")));
        names.map(|name| format!("            {name} = next_{name};\n")).collect()
    }
}

/// The best tile on an H200, from a thousand to 65,536 samples of networks of 128 and of 256 (`benches/examples/gpu_learner.rs`,
/// `tiles`): larger ones wait for memory, smaller ones load more.
const TILE: MatrixTile = MatrixTile::new((64, 64), (64, 32));

/// The products, and how they are divided among workgroups.
#[derive(Debug)]
pub struct Weights<'a> {
    layout: &'a Layout,
    networks: &'a Networks,
    tile: MatrixTile,
}

impl<'a> Weights<'a> {
    /// For these networks. `forced` takes this tile rather than the best one, for measurements.
    pub fn new(layout: &'a Layout, networks: &'a Networks, forced: Option<MatrixTile>) -> Self {
        Self { layout, networks, tile: forced.unwrap_or(TILE) }
    }

    /// Parts into which the blocks of a chunk are split, and blocks of each.
    fn split(&self) -> [usize; 2] {
        let layers = layers(self.networks, 0, Precision::Half);
        let tiles: usize = layers.iter().flatten().map(|layer| self.tile.tiles(layer.inputs + 1, layer.outputs)).sum();
        let blocks = self.blocks();
        let each = blocks.div_ceil(WORKGROUPS.div_ceil(tiles).min(blocks));
        [blocks.div_ceil(each), each]
    }

    fn blocks(&self) -> usize {
        self.layout.chunk / HALF_BLOCK
    }

    /// Partial gradients of a chunk.
    pub fn parts(&self) -> usize {
        self.split()[0]
    }

    /// The gradients of all parameters of a chunk, one dispatch for every chunk of a minibatch.
    pub fn dispatches(&self, context: &Context<'_>, half: &HalfMemory) -> Result<Vec<Dispatch>, GpuError> {
        let Context { gpu, sizes, memory, .. } = *context;
        let (jobs, [splits, each]) = (self.jobs(sizes), self.split());
        let table = table(gpu, "jobs", &jobs)?;
        let kernel = gpu.kernel(&self.recipe())?;
        let sources = [memory.activation.binding(), memory.gradient.binding(), half.summand.binding()];
        let buffers: Vec<_> = sources.into_iter().chain([table.binding(), memory.partial.binding()]).collect();
        let tiles = jobs.last().map_or(0, |job| job[0] as usize);
        let threads = tiles * splits * (SUBGROUP * self.tile.subgroups()) as usize;
        let down = (1.0 / self.layout.gradient_scale()).to_bits();
        let chunk = |chunk: usize| {
            let Layout { rows, gradient_rows, .. } = *self.layout;
            let (slot, length) = (chunk * splits, self.networks.len() + METRICS);
            let places = [jobs.len(), self.blocks(), splits, each, slot, length, rows, gradient_rows];
            let shape: Vec<_> = places.map(|x| x as u32).into_iter().chain([down]).collect();
            prepare(gpu, &kernel, &buffers, &shape, threads)
        };
        (0..self.layout.chunks).map(chunk).collect()
    }

    /// Tiles so far, inputs with the row of ones, outputs, first row of the input, first row of the gradient, weight.
    fn jobs(&self, sizes: &Sizes) -> Vec<[u32; 8]> {
        let mut end = 0;
        let mut job = |inputs: usize, outputs: usize, h_row: usize, z_row: usize, weight: usize| {
            end += self.tile.tiles(inputs.max(1), outputs);
            [end, inputs, outputs, h_row, z_row, weight, 0, 0].map(|x| x as u32)
        };
        // Biases follow the weights: they are the row after the last one.
        let layer = |layer: LayerRows| job(layer.inputs + 1, layer.outputs, layer.x_row, layer.z_row, layer.weight);
        let layers = layers(self.networks, sizes.observations, Precision::Half);
        let mut jobs: Vec<_> = layers.into_iter().flatten().map(layer).collect();
        jobs.push(job(0, sizes.actions, 0, 0, self.networks.log_std_range().start));
        jobs.push(job(0, METRICS, 0, sizes.actions, self.networks.len()));
        jobs
    }

    /// What the kernel is compiled from.
    pub fn recipe(&self) -> Recipe {
        use Access::{Read, ReadWrite, Uniform};
        let MatrixTile { rows, columns } = self.tile;
        let label = format!("weight gradients {}x{}", rows[0], columns[0]);
        let access = [Read, Read, Read, Read, ReadWrite, Uniform];
        // SAFETY: the jobs are made from the layout that the buffers were made for, in this file; after the last rows there
        // are as many as a tile may read beyond its job, and what lies there is left out. Shared memory is written before it
        // is read. Loops end after the jobs, the blocks or the samples.
        unsafe { Recipe::new(label, self.tile.text(), access).trusted() }
    }
}

/// Kernels of several tiles.
#[cfg(test)]
pub fn texts() -> Vec<String> {
    let sizes = [((32, 32), (16, 32)), ((64, 64), (32, 32)), ((128, 64), (32, 64)), ((128, 128), (64, 64))];
    let tiles = sizes.into_iter().map(|(size, each)| MatrixTile::new(size, each)).chain([TILE]);
    tiles.map(MatrixTile::text).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Mlp;

    #[test]
    fn biases_follow_the_weights() {
        let networks = Networks { policy: Mlp::new(7, &[5, 3], 2), value: Mlp::new(7, &[4], 1) };
        for layer in layers(&networks, 7, Precision::Half).iter().flatten() {
            assert_eq!(layer.weight + layer.inputs * layer.outputs, layer.bias);
        }
    }
}
