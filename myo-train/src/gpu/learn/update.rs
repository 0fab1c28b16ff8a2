//! A whole update on the card.

use myo_gpu::{Batch, Buffer, Gpu, GpuError};

use super::context::Context;
use super::half::{self, MatrixTile};
use super::layout::{Layout, Precision};
use super::memory::{LearnMemory, STEP_METRICS};
use super::outer::Outer;
use super::products::Products;
use super::schedule::{rates, stats};
use crate::gpu::dense::{Dispatch, fits};
use crate::gpu::{RolloutBuffers, Sizes, Tile};
use crate::learn::LearnStats;
use crate::networks::Networks;
use crate::random::shuffle;
use crate::{Mlp, PpoConfig, TrainError};

/// What one update depends on besides the record and what the card holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Seed of the order of the samples.
    pub seed: u64,
    /// Updates before this one.
    pub update: u64,
    /// Adam's step size.
    pub learning_rate: f64,
    /// Gradient steps before this update.
    pub gradient_steps: u64,
}

/// What is taken rather than the best choice: for measurements.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tiles {
    /// Tiles of layers made by threads, forward and backward.
    pub layers: Option<Tile>,
    /// Of gradients of weights made by threads: inputs, outputs, samples.
    pub weights: Option<Tile>,
    /// Samples of a workgroup that takes them through a network with matrix units.
    pub columns: Option<u32>,
    /// Tiles of gradients of weights made by matrix units.
    pub matrix_weights: Option<MatrixTile>,
}

/// Learns from the record of a [`DeviceRollout`](super::super::DeviceRollout): advantages, gradients and Adam steps of all
/// passes, in one batch.
#[derive(Clone)]
pub struct DeviceLearner {
    gpu: Gpu,
    config: PpoConfig,
    layout: Layout,
    samples_per_step: Vec<f64>,
    memory: LearnMemory,
    estimates: Vec<Dispatch>,
    gather: Vec<Vec<Dispatch>>,
    /// From gathered samples to gradients with respect to what goes into every layer.
    passes: Vec<Dispatch>,
    /// Gradients with respect to the parameters, per chunk of a minibatch.
    outer: Vec<Dispatch>,
    reduce: Dispatch,
    adam: Vec<Dispatch>,
    order: Vec<u32>,
    words: Vec<u32>,
}

impl DeviceLearner {
    /// Memory and kernels for updates of `parameters`, in the order of [`Checkpoint`](crate::Checkpoint), from the record
    /// in `record`.
    ///
    /// # Errors
    /// Fewer parameters than the networks have, no memory left, or the card is lost.
    pub fn new(
        gpu: &Gpu,
        sizes: &Sizes,
        config: &PpoConfig,
        parameters: &Buffer<f32>,
        record: &RolloutBuffers,
    ) -> Result<Self, GpuError> {
        Self::with_tiles(gpu, sizes, config, parameters, record, Tiles::default())
    }

    /// As [`DeviceLearner::new`], with tiles of one's own: for measurements.
    ///
    /// # Errors
    /// As for [`DeviceLearner::new`].
    pub fn with_tiles(
        gpu: &Gpu,
        sizes: &Sizes,
        config: &PpoConfig,
        parameters: &Buffer<f32>,
        record: &RolloutBuffers,
        tiles: Tiles,
    ) -> Result<Self, GpuError> {
        Self::with_limit(gpu, sizes, config, parameters, record, (max_bytes(gpu), tiles))
    }

    /// As [`DeviceLearner::new`], with activations of at most `max_bytes` at a time.
    pub(super) fn with_limit(
        gpu: &Gpu,
        sizes: &Sizes,
        config: &PpoConfig,
        parameters: &Buffer<f32>,
        record: &RolloutBuffers,
        (max_bytes, tiles): (u64, Tiles),
    ) -> Result<Self, GpuError> {
        let networks = Networks {
            policy: Mlp::new(sizes.observations, &config.policy_hidden, sizes.actions),
            value: Mlp::new(sizes.observations, &config.value_hidden, 1),
        };
        // The kernels of the passes, alone, are compiled without checks of their own. What they work on besides is made here.
        fits(parameters, networks.len())?;
        let precision = precision(gpu, config, &networks);
        let layout = Layout::new(sizes, &networks, config, max_bytes, precision);
        let outer = Outer::new(gpu, sizes, &layout, &networks, tiles.weights);
        let parts = match precision {
            Precision::Single => outer.splits().count,
            Precision::Half => half::parts(&layout, &networks, tiles),
        };
        let memory = LearnMemory::new(gpu, sizes, &networks, &layout, layout.chunks * parts)?;
        let context =
            Context { gpu, sizes, layout: &layout, networks: &networks, config, parameters, record, memory: &memory };
        let (passes, outer) = match precision {
            Precision::Single => {
                let mut products = Products::new(gpu, sizes, &layout, &networks, tiles.layers);
                let mut passes = products.forward(parameters, &memory)?;
                passes.push(context.loss(products.output_rows())?);
                passes.extend(products.backward(parameters, &memory)?);
                (passes, outer.dispatches(&memory)?)
            }
            Precision::Half => half::dispatches(context, tiles)?,
        };
        Ok(Self {
            estimates: context.estimates()?,
            gather: context.gather()?,
            passes,
            outer,
            reduce: context.reduce(layout.chunks * parts)?,
            adam: context.adam()?,
            order: vec![0; layout.blocks],
            words: vec![0; layout.blocks],
            samples_per_step: vec![0.0; layout.steps()],
            gpu: gpu.clone(),
            config: config.clone(),
            layout,
            memory,
        })
    }

    /// The learner of one group, where the device is for several: what is prepared and read here is that group's. Added to a
    /// batch for other groups as well, it learns for all of these.
    ///
    /// # Panics
    /// There is no such group.
    pub fn of(&self, group: usize) -> Self {
        Self { memory: self.memory.of(group), ..self.clone() }
    }

    /// How the work is divided.
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// The buffers of an update.
    pub fn memory(&self) -> &LearnMemory {
        &self.memory
    }

    /// Uploads what the next update needs: the order of the samples and the step sizes, some kilobytes.
    ///
    /// # Errors
    /// The card is lost.
    pub fn prepare(&mut self, sizes: &Sizes, settings: Settings) -> Result<(), GpuError> {
        let (layout, epochs) = (self.layout, self.layout.epochs as u64);
        for epoch in 0..layout.epochs {
            let step = settings.update * epochs + epoch as u64;
            shuffle(settings.seed, step, &mut self.order, &mut self.words);
            self.gpu.write(&self.memory.order, epoch * layout.blocks, &self.order)?;
            for index in 0..layout.minibatches {
                let (step, first) = (epoch * layout.minibatches + index, epoch * layout.blocks);
                let range = layout.range(step);
                let blocks = &self.order[range.start - first..range.end - first];
                self.samples_per_step[step] = blocks.iter().map(|&b| used(sizes, layout.block, b) as f64).sum();
            }
        }
        self.gpu.write(&self.memory.rates, 0, rates(&self.config, settings, layout.steps()).as_flattened())?;
        self.gpu.write(&self.memory.metrics, 0, &vec![0.0; self.memory.metrics.len()])
    }

    /// Adds an update to a batch, after the roll-out.
    pub fn record(&self, batch: &mut Batch) {
        self.estimates.iter().for_each(|dispatch| dispatch.add(batch));
        for step in 0..self.layout.steps() {
            self.record_gradient(batch, step);
            self.adam[step].add(batch);
        }
    }

    /// Adds the gradient of one step's minibatch alone, at the parameters as they are.
    fn record_gradient(&self, batch: &mut Batch, step: usize) {
        for (gather, outer) in self.gather[step].iter().zip(&self.outer) {
            gather.add(batch);
            self.passes.iter().for_each(|dispatch| dispatch.add(batch));
            outer.add(batch);
        }
        self.reduce.add(batch);
    }

    /// Adds the passes, gradients and Adam step of the first minibatch alone: for measurements and tests.
    pub fn record_step(&self, batch: &mut Batch) {
        self.record_gradient(batch, 0);
        self.adam[0].add(batch);
    }

    /// Adds the advantages, targets and their scales alone: for measurements.
    pub fn record_estimates(&self, batch: &mut Batch) {
        self.estimates.iter().for_each(|dispatch| dispatch.add(batch));
    }

    /// Numbers to read after an update for [`DeviceLearner::stats`].
    pub fn metrics_len(&self) -> usize {
        STEP_METRICS * self.layout.steps()
    }

    /// What an update tells, from [`LearnMemory::metrics`].
    ///
    /// # Errors
    /// A loss, the gradient or a parameter is not finite.
    pub fn stats(&self, metrics: &[f32], update: u64) -> Result<LearnStats, TrainError> {
        stats(metrics, &self.samples_per_step, self.layout.minibatches, update)
    }
}

/// Greatest buffer that a kernel of this card can use whole.
pub(super) fn max_bytes(gpu: &Gpu) -> u64 {
    let adapter = gpu.adapter();
    adapter.max_buffer_bytes.min(adapter.max_binding_bytes)
}

/// 16 bits where the card has matrix units and the networks are narrow enough for the kernel that uses them.
pub(super) fn precision(gpu: &Gpu, config: &PpoConfig, networks: &Networks) -> Precision {
    let adapter = gpu.adapter();
    let units = config.matrix_units && adapter.cooperative_matrix && half::fits(networks, adapter);
    if units { Precision::Half } else { Precision::Single }
}

/// Columns of a block that hold samples.
fn used(sizes: &Sizes, block: usize, index: u32) -> usize {
    let first = index as usize * block;
    (first..(first + block).min(sizes.samples())).filter(|column| column % sizes.padded < sizes.envs).count()
}
