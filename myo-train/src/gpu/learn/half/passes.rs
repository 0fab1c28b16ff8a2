//! Both networks and the loss in one kernel, with the products on the matrix units of the card.

use myo_gpu::{Access, GpuError, Recipe};

use super::super::context::Context;
use super::super::layers::{LayerRows, layers};
use super::super::layout::{Layout, Precision};
use super::memory::HalfMemory;
use super::shape::{Shape, columns_for, matrices};
use crate::gaussian::Bound;
use crate::gpu::dense::Dispatch;
use crate::gpu::kernels::{prepare, table};
use crate::gpu::units::UNIT;
use crate::networks::Networks;

/// The kernel that packs the weights.
pub const PACK: &str = concat!(include_str!("pack.wgsl"), include_str!("../job.wgsl"));

/// Words that the packed weights take: two for a group of four numbers, every layer twice.
pub fn packed_words(networks: &Networks) -> usize {
    layers(networks, 0, Precision::Half).iter().flatten().map(|layer| 4 * groups(layer.inputs, layer.outputs)).sum()
}

/// Groups of four numbers that one copy of a layer's packed weights takes.
fn groups(inputs: usize, outputs: usize) -> usize {
    matrices(inputs) * matrices(outputs) * (UNIT * UNIT / 4) as usize
}

/// What the kernels of the passes are compiled from; `columns` are those of a workgroup rather than the best number.
pub fn recipes(layout: &Layout, networks: &Networks, columns: Option<u32>) -> [Recipe; 2] {
    [pack(), pass(shape(layout, networks, columns))]
}

fn shape(layout: &Layout, networks: &Networks, columns: Option<u32>) -> Shape {
    Shape::new(networks, columns.unwrap_or_else(|| columns_for(networks, layout.chunk)))
}

fn pack() -> Recipe {
    use Access::{Read, ReadWrite, Uniform};
    Recipe::new("pack", PACK, [Read, Read, ReadWrite, Uniform])
}

fn pass(shape: Shape) -> Recipe {
    use Access::{Read, ReadWrite, Uniform};
    let access = [Read, Read, Read, Read, ReadWrite, ReadWrite, ReadWrite, ReadWrite, Uniform];
    let label = format!("passes of {} columns", shape.columns);
    // SAFETY: layers lie as the layout says that the buffers were made for, and workgroups take all its columns and no
    // more. Shared memory is written before it is read: as many rows as the layer has, in matrices of 16, of which the
    // shape has enough. Loops end after the layers and their matrices.
    unsafe { Recipe::new(label, shape.text(), access).trusted() }
}

/// The kernels of the passes.
pub struct Passes<'a> {
    /// What they work on.
    pub context: Context<'a>,
    /// What they need besides.
    pub memory: &'a HalfMemory,
    /// Columns of a workgroup rather than the best number: for measurements.
    pub columns: Option<u32>,
}

impl Passes<'_> {
    /// From gathered samples to gradients with respect to what goes into every layer.
    pub fn dispatches(&self) -> Result<Vec<Dispatch>, GpuError> {
        Ok(vec![self.pack()?, self.pass()?])
    }

    /// Packs the weights, layer by layer.
    fn pack(&self) -> Result<Dispatch, GpuError> {
        let Context { gpu, parameters, .. } = self.context;
        let kernel = gpu.kernel(&pack())?;
        let mut end = 0;
        let mut jobs = Vec::<[u32; 8]>::new();
        for LayerRows { inputs, outputs, weight, .. } in self.layers().into_iter().flatten() {
            for [lines, length, step, line_step] in [[outputs, inputs, outputs, 1], [inputs, outputs, 1, outputs]] {
                end += groups(inputs, outputs);
                let job = [end, lines, length, matrices(length), weight, step, line_step, 0];
                jobs.push(job.map(|x| x as u32));
            }
        }
        let table = table(gpu, "pack jobs", &jobs)?;
        let buffers = [parameters.binding(), table.binding(), self.memory.packed.binding()];
        prepare(gpu, &kernel, &buffers, &[jobs.len() as u32], end)
    }

    /// Takes all columns through both networks and back.
    fn pass(&self) -> Result<Dispatch, GpuError> {
        let Context { gpu, layout, networks, parameters, memory, .. } = self.context;
        let shape = shape(layout, networks, self.columns);
        let kernel = gpu.kernel(&pass(shape))?;
        let blocks = layout.chunk.div_ceil(shape.columns as usize);
        let table = table(gpu, "layers", &self.places())?;
        let buffers = [
            parameters.binding(),
            self.memory.packed.binding(),
            table.binding(),
            memory.sample.binding(),
            memory.activation.binding(),
            memory.gradient.binding(),
            self.memory.summand.binding(),
            self.memory.output.binding(),
        ];
        prepare(gpu, &kernel, &buffers, &self.words(blocks), 2 * blocks * shape.threads() as usize)
    }

    /// The uniform of the kernel.
    fn words(&self, blocks: usize) -> Vec<u32> {
        let Context { sizes, layout, networks, config, .. } = self.context;
        let [policy, value] = self.layers().map(|layers| layers.len());
        let [rows, gradient_rows] = [layout.rows, layout.gradient_rows];
        let log_std = networks.log_std_range().start;
        let places = [layout.chunk / 4, blocks, policy, value, rows, gradient_rows, sizes.actions, log_std];
        let Bound { least, most, factor } = config.bound();
        let (clip, value) = (config.ratio_clip(sizes.control_dt), config.value_coefficient as f32);
        let numbers = [clip, value, layout.gradient_scale(), least, most, factor];
        places.map(|x| x as u32).into_iter().chain(numbers.map(f32::to_bits)).collect()
    }

    fn layers(&self) -> [Vec<LayerRows>; 2] {
        layers(self.context.networks, self.context.sizes.observations, Precision::Half)
    }

    /// The table of layers.
    fn places(&self) -> Vec<[u32; 8]> {
        let mut packed = 0;
        let place = |LayerRows { inputs, outputs, bias, h_row, z_row, .. }: LayerRows| {
            let (weight, groups) = (packed, groups(inputs, outputs));
            packed += 2 * groups;
            [inputs, outputs, weight, weight + groups, bias, h_row, z_row, 0].map(|x| x as u32)
        };
        self.layers().into_iter().flatten().map(place).collect()
    }
}
