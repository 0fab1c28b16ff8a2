//! What the passes on matrix units need besides activations and gradients.

use myo_gpu::{Buffer, GpuError};

use super::super::context::Context;
use super::super::layout::METRICS;
use super::passes::packed_words;

/// Buffers of the passes on matrix units. Kernels that they are bound to keep them.
#[derive(Debug)]
pub struct HalfMemory {
    /// Weights, as words of two numbers; see `pack.wgsl`.
    pub packed: Buffer<u32>,
    /// Outputs of both networks, `(actions + 1, chunk)`.
    pub output: Buffer<f32>,
    /// What is summed up over samples besides: gradients of the logarithms of the standard deviations and metrics,
    /// `(actions + 4, chunk)`.
    pub summand: Buffer<f32>,
}

impl HalfMemory {
    /// Memory for one update, zero.
    ///
    /// # Errors
    /// There is no memory left, a buffer is larger than the card allows, or the card is lost.
    pub fn new(context: &Context<'_>) -> Result<Self, GpuError> {
        let Context { gpu, sizes, layout, networks, .. } = *context;
        Ok(Self {
            packed: gpu.buffer("packed weights", packed_words(networks))?,
            output: gpu.buffer("outputs", (sizes.actions + 1) * layout.chunk)?,
            summand: gpu.buffer("summands", (sizes.actions + METRICS) * layout.chunk)?,
        })
    }
}
