//! Passes and gradients on the matrix units of a card: numbers of 16 bits, sums of 32.

mod memory;
mod passes;
mod shape;
mod weights;

use myo_gpu::{GpuError, Recipe};

use super::Tiles;
use super::context::Context;
use crate::gpu::dense::Dispatch;
use memory::HalfMemory;
use passes::Passes;
pub use shape::fits;
use weights::Weights;
pub use weights::{MatrixTile, TILE_MAX};

/// Partial gradients of a chunk.
pub fn parts(layout: &super::Layout, networks: &crate::networks::Networks, tiles: Tiles) -> usize {
    Weights::new(layout, networks, tiles.matrix_weights).parts()
}

/// What the kernels are compiled from.
pub fn recipes(layout: &super::Layout, networks: &crate::networks::Networks, tiles: Tiles) -> Vec<Recipe> {
    let weights = Weights::new(layout, networks, tiles.matrix_weights).recipe();
    passes::recipes(layout, networks, tiles.columns).into_iter().chain([weights]).collect()
}

/// From gathered samples to gradients with respect to what goes into every layer, and the gradients of all parameters, one
/// dispatch for every chunk of a minibatch.
///
/// # Errors
/// A kernel is refused, there is no memory left, or the card is lost.
pub fn dispatches(context: Context<'_>, tiles: Tiles) -> Result<(Vec<Dispatch>, Vec<Dispatch>), GpuError> {
    let memory = HalfMemory::new(&context)?;
    let passes = Passes { context, memory: &memory, columns: tiles.columns };
    let weights = Weights::new(context.layout, context.networks, tiles.matrix_weights);
    Ok((passes.dispatches()?, weights.dispatches(&context, &memory)?))
}

/// The kernels, of several sizes.
#[cfg(test)]
pub fn texts() -> Vec<String> {
    [vec![passes::PACK.to_owned()], shape::texts(), weights::texts()].concat()
}
