//! Acting and learning on the graphics card beside the environment: neither a roll-out nor an update needs a word from the
//! host.
//!
//! Matrices of samples are feature-major, as the environment's own buffers are: entry `row` of column `k` is at
//! `row * stride + k`. A step's columns begin at multiples of four; where the number of environments is none, the columns
//! between are idle.

mod ahead;
mod buffers;
mod card;
mod dense;
mod evaluate;
mod kernels;
mod learn;
mod network;
mod noise;
#[cfg(test)]
mod read;
mod rollout;
#[cfg(test)]
mod several;
mod sizes;
#[cfg(test)]
mod testing;
#[cfg(test)]
mod tests;
mod tile;
mod together;
mod units;
#[cfg(test)]
mod wgsl;

pub use ahead::compile_ahead;
pub use buffers::{ALL_FINITE, RolloutBuffers};
pub(crate) use card::{Card, CardUpdate};
pub use evaluate::DeviceEvaluator;
pub use learn::{DeviceLearner, Layout, LearnMemory, MatrixTile, Precision, Settings, Tiles};
pub use rollout::DeviceRollout;
pub use sizes::Sizes;
pub use tile::Tile;
pub(crate) use together::Together;
