//! Whole networks on the card: one dispatch per layer and chunk of columns.

use myo_gpu::{Batch, Buffer, Gpu, GpuError, Recipe};

use super::dense::{Columns, DenseKernels, DenseLayer, Dispatch, Finish, GROUP, Kind, Sampling};
use crate::Mlp;

/// Most columns that go through a network at a time: enough to fill any card, few enough that the activations between
/// two layers stay in the cache of a large one.
const CHUNK: usize = 32_768;
/// Most numbers of a buffer of activations.
const CHUNK_NUMBERS: usize = 16 << 20;

/// Memory for the activations between layers, used in turn.
#[derive(Debug)]
pub(crate) struct Activations {
    buffers: [Buffer<f32>; 2],
    /// Columns at a time.
    chunk: usize,
}

impl Activations {
    /// For at most `columns` columns at a time of networks with these widths.
    pub fn new(gpu: &Gpu, networks: &[&Mlp], columns: usize) -> Result<Self, GpuError> {
        let chunk = chunk(networks, columns);
        let buffer = |label| gpu.buffer(label, widest(networks) * chunk);
        Ok(Self { buffers: [buffer("activations 0")?, buffer("activations 1")?], chunk })
    }

    fn columns(&self, layer: usize) -> Columns<'_> {
        Columns { buffer: &self.buffers[layer % 2], stride: self.chunk, first: 0 }
    }
}

fn widest(networks: &[&Mlp]) -> usize {
    let outputs = networks.iter().flat_map(|net| net.layers()).map(|[_, outputs, ..]| outputs);
    outputs.max().unwrap_or(1)
}

/// Columns that go through networks at a time, of so many.
pub(crate) fn chunk(networks: &[&Mlp], columns: usize) -> usize {
    let most = (CHUNK_NUMBERS / widest(networks) / GROUP * GROUP).clamp(GROUP, CHUNK);
    columns.next_multiple_of(GROUP).min(most)
}

/// First column and number of columns of every chunk.
fn chunks(columns: usize, chunk: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..columns).step_by(chunk).map(move |start| (start, chunk.min(columns - start)))
}

/// A pass of some columns through a network, prepared once and run again and again.
#[derive(Clone, Debug)]
pub(crate) struct Pass(Vec<Dispatch>);

/// Where a network finds everything.
#[derive(Clone, Copy)]
pub(crate) struct NetworkBuffers<'a> {
    /// Its sizes.
    pub network: &'a Mlp,
    /// All parameters.
    pub parameters: &'a Buffer<f32>,
    /// The first one of this network.
    pub first_parameter: usize,
    /// Memory between layers.
    pub activations: &'a Activations,
}

impl Pass {
    /// From the columns of `x` to those of `y`, `columns` of them, a multiple of [`GROUP`]. With `sampling`, the outputs are
    /// means of actions and `y` gets the actions; if they are noisy, it holds the noise.
    pub fn new(
        kernels: &mut DenseKernels,
        buffers: NetworkBuffers<'_>,
        x: Columns<'_>,
        y: Columns<'_>,
        columns: usize,
        sampling: Option<Sampling<'_>>,
    ) -> Result<Self, GpuError> {
        let mut dispatches = Vec::new();
        for (start, columns) in chunks(columns, buffers.activations.chunk) {
            let shifted = |c: Columns<'_>| c.first + start;
            let (x, y) = (Columns { first: shifted(x), ..x }, Columns { first: shifted(y), ..y });
            let sampling = sampling.map(|s| Sampling { first_env: s.first_env + start, ..s });
            add_layers(kernels, buffers, x, y, columns, sampling, &mut dispatches)?;
        }
        Ok(Self(dispatches))
    }

    /// What the kernels of a pass are compiled from, of so many columns in chunks, whose last layer is of this kind.
    pub fn recipes(kernels: &DenseKernels, network: &Mlp, columns: usize, chunk: usize, last: Kind) -> Vec<Recipe> {
        let hidden = network.layers().count() - 1;
        let layers = || network.layers().zip((0..hidden).map(|_| Kind::Silu).chain([last]));
        let recipes =
            |(_, columns)| layers().map(move |([_, outputs, ..], kind)| kernels.recipe(outputs, columns, kind));
        chunks(columns, chunk).flat_map(recipes).collect()
    }

    /// Adds it to a batch.
    pub fn add(&self, batch: &mut Batch) {
        self.0.iter().for_each(|dispatch| dispatch.add(batch));
    }
}

/// Prepares the layers for one chunk.
fn add_layers(
    kernels: &mut DenseKernels,
    buffers: NetworkBuffers<'_>,
    x: Columns<'_>,
    y: Columns<'_>,
    columns: usize,
    sampling: Option<Sampling<'_>>,
    out: &mut Vec<Dispatch>,
) -> Result<(), GpuError> {
    let last = buffers.network.layers().count() - 1;
    for (index, [inputs, outputs, weight, bias]) in buffers.network.layers().enumerate() {
        let layer = DenseLayer {
            inputs,
            outputs,
            weight: buffers.first_parameter + weight,
            bias: buffers.first_parameter + bias,
        };
        let from = if index == 0 { x } else { buffers.activations.columns(index - 1) };
        let to = if index == last { y } else { buffers.activations.columns(index) };
        let finish = match sampling {
            _ if index < last => Finish::Silu,
            None => Finish::Linear,
            Some(sampling) if sampling.held.is_some() => Finish::Sample(sampling),
            Some(sampling) => Finish::Act(sampling),
        };
        out.push(kernels.layer(buffers.parameters, layer, from, to, columns, finish)?);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::testing::{assert_close, gpu};
    use crate::gpu::tile::Tile;
    use crate::random::{Stream, fill_normal};

    fn numbers(n: usize, step: u64, scale: f32) -> Vec<f32> {
        let mut x = vec![0.0; n];
        fill_normal(5, Stream::Weights, step, 0, &mut x);
        x.iter_mut().for_each(|x| *x *= scale);
        x
    }

    /// Outputs for `columns` samples, `(outputs, columns)`, of a network whose parameters begin at 7.
    fn forward(gpu: &Gpu, net: &Mlp, parameters: &[f32], x: &[f32], columns: usize, tile: Option<Tile>) -> Vec<f32> {
        let padded = columns.next_multiple_of(GROUP);
        let buffer = gpu.buffer("parameters", 7 + parameters.len()).unwrap();
        gpu.write(&buffer, 7, parameters).unwrap();
        let [x_buffer, y_buffer] =
            [net.inputs(), net.outputs()].map(|rows| gpu.buffer("x", rows * padded + 4).unwrap());
        for row in 0..net.inputs() {
            let column: Vec<f32> = (0..columns).map(|k| x[k * net.inputs() + row]).collect();
            gpu.write(&x_buffer, 4 + row * padded, &column).unwrap();
        }
        gpu.write(&y_buffer, 0, &vec![f32::NAN; y_buffer.len()]).unwrap();
        let activations = Activations::new(gpu, &[net], columns).unwrap();
        let buffers =
            NetworkBuffers { network: net, parameters: &buffer, first_parameter: 7, activations: &activations };
        let columns_of = |buffer| Columns { buffer, stride: padded, first: 4 };
        let mut kernels = DenseKernels::new(gpu, tile);
        let pass =
            Pass::new(&mut kernels, buffers, columns_of(&x_buffer), columns_of(&y_buffer), padded, None).unwrap();
        let mut batch = gpu.batch();
        pass.add(&mut batch);
        let mut y = vec![0.0; y_buffer.len()];
        batch.submit_and_read(&mut [y_buffer.part(0, &mut y).unwrap()]).unwrap();
        assert!(y[..4].iter().all(|y| y.is_nan()), "written before the first column");
        (0..net.outputs()).flat_map(|row| y[4 + row * padded..][..columns].to_vec()).collect()
    }

    fn check(gpu: &Gpu, net: &Mlp, columns: usize, tile: Option<Tile>) {
        let parameters = numbers(net.len(), 0, 0.2);
        let x = numbers(net.inputs() * columns, 1, 1.0);
        let got = forward(gpu, net, &parameters, &x, columns, tile);
        let expected = net.forward(&parameters, &x, &mut net.work(columns)).to_vec();
        let expected: Vec<f32> =
            (0..net.outputs()).flat_map(|row| expected.iter().skip(row).step_by(net.outputs()).copied()).collect();
        assert_close("output", &got, &expected, 1e-5);
    }

    #[test]
    fn networks_of_any_size_agree_with_the_processor() {
        let Some(gpu) = gpu() else { return };
        for (inputs, hidden, outputs, columns) in [
            (1, &[][..], 1, 1),
            (50, &[128, 128], 26, 200),
            (55, &[33, 7, 65], 5, 131),
            (3, &[256], 70, 64),
            (17, &[16, 16], 1, 1030),
        ] {
            check(&gpu, &Mlp::new(inputs, hidden, outputs), columns, None);
        }
    }

    #[test]
    fn every_tile_gives_the_same_bits() {
        let Some(gpu) = gpu() else { return };
        let (net, columns) = (Mlp::new(29, &[70, 40], 9), 150);
        let (parameters, x) = (numbers(net.len(), 2, 0.2), numbers(29 * columns, 3, 1.0));
        let tiles = [
            Tile::new(4, 64, 8, (4, 4)),
            Tile::new(16, 64, 16, (4, 4)),
            Tile::new(32, 32, 16, (4, 8)),
            Tile::new(64, 128, 8, (8, 4)),
            Tile::new(64, 128, 8, (8, 8)),
        ];
        let outputs = tiles.map(|tile| forward(&gpu, &net, &parameters, &x, columns, Some(tile)));
        assert!(outputs.iter().all(|y| *y == outputs[0]));
        // A column's result does not depend on its neighbours.
        assert_eq!(forward(&gpu, &net, &parameters, &x[29 * 149..], 1, None)[0], outputs[0][149]);
    }

    #[test]
    fn columns_that_a_buffer_lacks_are_refused() {
        let Some(gpu) = gpu() else { return };
        let net = Mlp::new(3, &[], 2);
        let [x, y, parameters] = ["x", "y", "parameters"].map(|label| gpu.buffer(label, 8).unwrap());
        let activations = Activations::new(&gpu, &[&net], 4).unwrap();
        let buffers =
            NetworkBuffers { network: &net, parameters: &parameters, first_parameter: 0, activations: &activations };
        let of = |buffer| Columns { buffer, stride: 4, first: 0 };
        let error = Pass::new(&mut DenseKernels::new(&gpu, None), buffers, of(&x), of(&y), 4, None).unwrap_err();
        assert_eq!(error.to_string(), "elements 0..12 of buffer x were asked for; it has 8");
    }
}
