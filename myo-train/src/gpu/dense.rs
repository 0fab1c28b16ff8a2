//! Layers of networks on the card: matrix product, bias and what follows, in one kernel.

use std::collections::HashMap;

use myo_gpu::{Access, Batch, Bindings, Buffer, Gpu, GpuError, Kernel, Recipe};

use super::tile::{Tile, Weights};

/// Columns that lie side by side in one vector of the kernels; strides and first columns are multiples of it.
pub const GROUP: usize = 4;

/// What becomes of the sums of a layer.
#[derive(Clone, Copy, Debug)]
pub enum Finish<'a> {
    /// `z sigmoid(z)`, for hidden layers.
    Silu,
    /// Stays as it is.
    Linear,
    /// The sum is the mean of an action. `Y` holds standard normal noise and gets the action; the environment's
    /// actions get it mapped and clipped.
    Sample(Sampling<'a>),
    /// The same without noise.
    Act(Sampling<'a>),
}

impl<'a> Finish<'a> {
    fn kind(self) -> Kind {
        match self {
            Self::Silu => Kind::Silu,
            Self::Linear => Kind::Linear,
            Self::Sample(_) => Kind::Sample,
            Self::Act(_) => Kind::Act,
        }
    }

    fn sampling(self) -> Option<Sampling<'a>> {
        if let Self::Sample(sampling) | Self::Act(sampling) = self { Some(sampling) } else { None }
    }
}

/// A [`Finish`] as far as the kernel depends on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// See [`Finish::Silu`].
    Silu,
    /// See [`Finish::Linear`].
    Linear,
    /// See [`Finish::Sample`].
    Sample,
    /// See [`Finish::Act`].
    Act,
}

/// Columns of samples in a buffer: entry `row` of column `k` is at `row * stride + first + k`.
#[derive(Clone, Copy, Debug)]
pub struct Columns<'a> {
    /// Where they are.
    pub buffer: &'a Buffer<f32>,
    /// Numbers from one row to the next.
    pub stride: usize,
    /// First column.
    pub first: usize,
}

impl Columns<'_> {
    /// Refuses columns that the buffer does not have.
    fn check(&self, rows: usize, columns: usize) -> Result<(), GpuError> {
        fits(self.buffer, self.stride * (rows - 1) + self.first + columns)
    }
}

/// Refuses more entries than the buffer has.
pub fn fits(buffer: &Buffer<f32>, end: usize) -> Result<(), GpuError> {
    match end <= buffer.len() {
        true => Ok(()),
        false => Err(GpuError::OutOfRange { buffer: buffer.label().to_owned(), start: 0, end, len: buffer.len() }),
    }
}

/// A layer: where its parameters are in the flat vector, and its sizes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DenseLayer {
    /// Rows of the input.
    pub inputs: usize,
    /// Rows of the output.
    pub outputs: usize,
    /// First weight; they are `(outputs, inputs)` column-major.
    pub weight: usize,
    /// First bias.
    pub bias: usize,
}

/// What [`Finish::Sample`] and [`Finish::Act`] need besides.
#[derive(Clone, Copy, Debug)]
pub struct Sampling<'a> {
    /// Actions of the environment, `(actions, num_envs)`.
    pub env_actions: &'a Buffer<f32>,
    /// Environments.
    pub num_envs: usize,
    /// Environment of the first column.
    pub first_env: usize,
    /// Place of the first logarithm of a standard deviation among the parameters.
    pub log_std: usize,
    /// Offset and scale from the policy's output to an action.
    pub mapping: (f32, f32),
    /// With noise: what is left of earlier noise, which lies as `Y` does.
    pub held: Option<&'a Buffer<f32>>,
}

/// A kernel with its buffers, ready to be run.
#[derive(Clone, Debug)]
pub struct Dispatch {
    /// What runs.
    pub kernel: Kernel,
    /// On which buffers.
    pub bindings: Bindings,
    /// On how many threads.
    pub threads: u32,
}

impl Dispatch {
    /// Adds it to a batch.
    pub fn add(&self, batch: &mut Batch) {
        batch.dispatch(&self.kernel, &self.bindings, self.threads);
    }
}

/// The kernels of layers, compiled when first asked for.
#[derive(Debug)]
pub struct DenseKernels {
    gpu: Gpu,
    compiled: HashMap<(Tile, Kind), Kernel>,
    forced: Option<Tile>,
}

impl DenseKernels {
    /// No kernels yet. `forced` takes one tile for all layers, for measurements; otherwise it depends on their size.
    pub fn new(gpu: &Gpu, forced: Option<Tile>) -> Self {
        Self { gpu: gpu.clone(), compiled: HashMap::new(), forced }
    }

    /// Prepares `Y = finish(W X + b)` for `columns` columns, a multiple of [`GROUP`].
    ///
    /// # Errors
    /// The card refuses the kernel, has no memory left, or is lost.
    pub fn layer(
        &mut self,
        parameters: &Buffer<f32>,
        layer: DenseLayer,
        x: Columns<'_>,
        y: Columns<'_>,
        columns: usize,
        finish: Finish<'_>,
    ) -> Result<Dispatch, GpuError> {
        let sampling = finish.sampling();
        let held = sampling.and_then(|sampling| sampling.held);
        fits(parameters, layer.bias + layer.outputs)?;
        fits(parameters, layer.weight + layer.inputs * layer.outputs)?;
        if let Some(sampling) = sampling {
            fits(sampling.env_actions, layer.outputs * sampling.num_envs)?;
            fits(parameters, sampling.log_std + layer.outputs)?;
        }
        x.check(layer.inputs, columns)?;
        y.check(layer.outputs, columns)?;
        held.map_or(Ok(()), |buffer| Columns { buffer, ..y }.check(layer.outputs, columns))?;
        let tile = self.tile(layer.outputs, columns);
        let kernel = self.kernel(tile, finish.kind())?;
        let shape = self.gpu.buffer("shape", 16)?;
        self.gpu.write(&shape, 0, &words(layer, x, y, columns, sampling))?;
        let mut buffers = vec![parameters.binding(), x.buffer.binding(), y.buffer.binding(), shape.binding()];
        buffers.extend(sampling.map(|sampling| sampling.env_actions.binding()));
        buffers.extend(held.map(Buffer::binding));
        let bindings = kernel.bind(&buffers)?;
        let threads = tile.workgroups(layer.outputs as u32, columns as u32) * tile.threads();
        Ok(Dispatch { kernel, bindings, threads })
    }

    /// What the kernel of a layer with so many outputs is compiled from.
    pub fn recipe(&self, outputs: usize, columns: usize, kind: Kind) -> Recipe {
        recipe(self.tile(outputs, columns), kind)
    }

    /// Whatever the tile, the bits are the same: it may depend on how many groups there are.
    fn tile(&self, outputs: usize, columns: usize) -> Tile {
        self.forced.unwrap_or_else(|| tile_for(outputs, columns * self.gpu.groups()))
    }

    fn kernel(&mut self, tile: Tile, kind: Kind) -> Result<Kernel, GpuError> {
        if let Some(kernel) = self.compiled.get(&(tile, kind)) {
            return Ok(kernel.clone());
        }
        let kernel = self.gpu.kernel(&recipe(tile, kind))?;
        self.compiled.insert((tile, kind), kernel.clone());
        Ok(kernel)
    }
}

/// The tile that keeps a large card busy with so many columns, of all groups together: large ones need fewer copies per product, small ones give more workgroups. The
/// limits were measured on an H200 (`benches/examples/gpu_rollout.rs`, `tiles`).
pub fn tile_for(outputs: usize, columns: usize) -> Tile {
    const SMALL: Tile = Tile::new(16, 64, 16, (4, 4));
    const FLAT: Tile = Tile::new(32, 64, 16, (4, 4));
    const MEDIUM: Tile = Tile::new(64, 128, 8, (8, 4));
    const LARGE: Tile = Tile::new(64, 128, 8, (8, 8));
    match (outputs, columns) {
        (..=16, _) | (_, ..8192) => SMALL,
        (..=32, _) => FLAT,
        (_, ..24576) => MEDIUM,
        _ => LARGE,
    }
}

/// The uniform `Shape` of the kernel.
fn words(
    layer: DenseLayer,
    x: Columns<'_>,
    y: Columns<'_>,
    columns: usize,
    sampling: Option<Sampling<'_>>,
) -> [u32; 16] {
    let DenseLayer { inputs, outputs, weight, bias } = layer;
    let places = [x.stride, x.first, y.stride, y.first].map(|place| place / GROUP);
    let mut words = [0; 16];
    let sizes = [inputs, outputs, columns / GROUP, weight, bias].into_iter().chain(places);
    words.iter_mut().zip(sizes).for_each(|(word, size)| *word = size as u32);
    if let Some(sampling) = sampling {
        let (offset, scale) = sampling.mapping;
        let places = [sampling.log_std, sampling.first_env, sampling.num_envs].map(|place| place as u32);
        words[9..12].copy_from_slice(&places);
        words[12..14].copy_from_slice(&[offset.to_bits(), scale.to_bits()]);
    }
    words
}

/// The kernel's text.
fn text(tile: Tile, kind: Kind) -> String {
    let finish = match kind {
        Kind::Silu => include_str!("dense_silu.wgsl"),
        Kind::Linear => include_str!("dense_linear.wgsl"),
        Kind::Sample => concat!(include_str!("dense_sample.wgsl"), include_str!("dense_noisy.wgsl")),
        Kind::Act => concat!(include_str!("dense_sample.wgsl"), include_str!("dense_mean.wgsl")),
    };
    [include_str!("dense.wgsl"), finish, &tile.over_inputs(Weights::AsStored)].concat()
}

fn recipe(tile: Tile, kind: Kind) -> Recipe {
    use Access::{Read, ReadWrite, Uniform};
    let access: &[Access] = match kind {
        Kind::Silu | Kind::Linear => &[Read, Read, ReadWrite, Uniform],
        Kind::Sample => &[Read, Read, ReadWrite, Uniform, ReadWrite, Read],
        Kind::Act => &[Read, Read, ReadWrite, Uniform, ReadWrite],
    };
    let label = format!("layer {kind:?} {}x{} {:?}", tile.outputs, tile.columns, tile.per_thread).to_lowercase();
    // SAFETY: `DenseKernels::layer` checks that every buffer holds what the shape says, and what lies beyond the shape is
    // left out. Shared memory is written before it is read, and the loops end after `inputs` steps at most.
    unsafe { Recipe::new(label, text(tile, kind), access).trusted() }
}

/// The kernels of a tile.
#[cfg(test)]
pub fn texts(tile: Tile) -> Vec<String> {
    [Kind::Silu, Kind::Linear, Kind::Sample, Kind::Act].map(|kind| text(tile, kind)).to_vec()
}
