//! What the kernels of an update have in common.

use myo_gpu::{Buffer, Gpu};

use super::layout::Layout;
use super::memory::LearnMemory;
use crate::PpoConfig;
use crate::gpu::{RolloutBuffers, Sizes};
use crate::networks::Networks;

/// What the kernels of an update work on.
#[derive(Clone, Copy)]
pub struct Context<'a> {
    /// The card.
    pub gpu: &'a Gpu,
    /// Sizes of the roll-out.
    pub sizes: &'a Sizes,
    /// Sizes of the update.
    pub layout: &'a Layout,
    /// The networks.
    pub networks: &'a Networks,
    /// Settings.
    pub config: &'a PpoConfig,
    /// Their parameters.
    pub parameters: &'a Buffer<f32>,
    /// The record.
    pub record: &'a RolloutBuffers,
    /// Memory of the update.
    pub memory: &'a LearnMemory,
}
