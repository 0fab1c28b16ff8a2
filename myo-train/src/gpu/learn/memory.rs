//! The buffers of an update.

use myo_gpu::{Buffer, Gpu, GpuError};

use super::layout::{Layout, METRICS, SCALARS};
use crate::gpu::Sizes;
use crate::networks::Networks;

/// Numbers that an update tells per gradient step: sums of [`METRICS`], length of the gradient, and whether a parameter is
/// no longer finite.
pub const STEP_METRICS: usize = METRICS + 2;

/// Threads of the workgroups that reduce gradients.
const REDUCE_WORKGROUP: usize = 256;

/// What an update works on, on the card.
#[derive(Clone, Debug)]
pub struct LearnMemory {
    /// Decaying mean of the gradient, `(parameters)`.
    pub mean: Buffer<f32>,
    /// Decaying mean of its square, `(parameters)`.
    pub square: Buffer<f32>,
    /// Blocks in the order in which every pass takes them, `(epochs, blocks)`.
    pub order: Buffer<u32>,
    /// Step size, and one over the root of the bias of the mean square, `(gradient steps, 2)`.
    pub rates: Buffer<f32>,
    /// Advantages and targets, `(2, samples)`.
    pub estimate: Buffer<f32>,
    /// Sums per environment of advantages, targets, and their squares, `(4, envs)`.
    pub estimate_parts: Buffer<f32>,
    /// Sums of those, `(4)`.
    pub estimate_sums: Buffer<f32>,
    /// Mean and scale of the advantages, weight of a sample, `(gradient steps, 4)`.
    pub scale: Buffer<f32>,
    /// Observations and outputs of the layers, as words of one or two numbers; see [`Layout`].
    pub activation: Buffer<u32>,
    /// Derivatives of the activations, then gradients with respect to what went into them, as words of one or two numbers;
    /// see [`Layout`].
    pub gradient: Buffer<u32>,
    /// Actions and scalars of the samples of a chunk, `(actions + 4, chunk)`.
    pub sample: Buffer<f32>,
    /// Partial gradients with respect to the parameters, and partial sums of metrics.
    pub partial: Buffer<f32>,
    /// Their sum, `(parameters + 4)`.
    pub total: Buffer<f32>,
    /// Parts of its squared length.
    pub squares: Buffer<f32>,
    /// `(gradient steps, 6)`.
    pub metrics: Buffer<f32>,
}

impl LearnMemory {
    /// Memory for one update, zero, with so many partial gradients.
    ///
    /// # Errors
    /// There is no memory left, a buffer is larger than the card allows, or the card is lost.
    pub(super) fn new(
        gpu: &Gpu,
        sizes: &Sizes,
        networks: &Networks,
        layout: &Layout,
        parts: usize,
    ) -> Result<Self, GpuError> {
        let (parameters, steps) = (networks.len(), layout.steps());
        let length = parameters + METRICS;
        Ok(Self {
            mean: gpu.buffer("adam mean", parameters)?,
            square: gpu.buffer("adam square", parameters)?,
            order: gpu.buffer("order", layout.epochs * layout.blocks)?,
            rates: gpu.buffer("rates", 2 * steps)?,
            estimate: gpu.buffer("estimate", 2 * sizes.samples())?,
            estimate_parts: gpu.buffer("estimate parts", 4 * sizes.envs)?,
            estimate_sums: gpu.buffer("estimate sums", 4)?,
            scale: gpu.buffer("advantage scale", 4 * steps)?,
            activation: gpu.buffer("activations", layout.precision.words(layout.rows * layout.chunk))?,
            gradient: gpu.buffer("gradients", layout.precision.words(layout.gradient_rows * layout.chunk))?,
            sample: gpu.buffer("samples", (sizes.actions + SCALARS) * layout.chunk)?,
            partial: gpu.buffer("partial gradients", parts * length)?,
            total: gpu.buffer("gradient", length)?,
            squares: gpu.buffer("gradient squares", length.div_ceil(REDUCE_WORKGROUP))?,
            metrics: gpu.buffer("metrics", STEP_METRICS * steps)?,
        })
    }

    /// That of one group.
    pub(super) fn of(&self, group: usize) -> Self {
        Self {
            mean: self.mean.of(group),
            square: self.square.of(group),
            order: self.order.of(group),
            rates: self.rates.of(group),
            estimate: self.estimate.of(group),
            estimate_parts: self.estimate_parts.of(group),
            estimate_sums: self.estimate_sums.of(group),
            scale: self.scale.of(group),
            activation: self.activation.of(group),
            gradient: self.gradient.of(group),
            sample: self.sample.of(group),
            partial: self.partial.of(group),
            total: self.total.of(group),
            squares: self.squares.of(group),
            metrics: self.metrics.of(group),
        }
    }
}
