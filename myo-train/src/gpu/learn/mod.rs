//! Learning on the graphics card: a whole update of PPO in one batch, from the record of a roll-out to moved parameters.
//!
//! As `learn.rs` does on the processor, with two differences: samples are shuffled in blocks of neighbouring columns where
//! there are many (see `Layout`), and sums are single precision. Nothing depends on timing, so one card and driver always
//! give the same bits.

mod context;
mod half;
mod layers;
mod layout;
mod memory;
mod outer;
mod products;
mod recipes;
mod schedule;
mod small;
#[cfg(test)]
mod tests;
mod update;

#[cfg(test)]
use super::Tile;
pub use half::MatrixTile;
pub use layout::{Layout, Precision};
pub use memory::LearnMemory;
pub use recipes::recipes;
pub use update::{DeviceLearner, Settings, Tiles};

/// Kernels, of all kinds and of several sizes.
#[cfg(test)]
pub fn texts(tile: Tile) -> Vec<String> {
    let small = small::TEXTS.map(str::to_owned).to_vec();
    [small, products::texts(tile), vec![outer::text(tile)], half::texts()].concat()
}
