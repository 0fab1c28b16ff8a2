//! Acting on the graphics card: the policy beside the environment, so that a roll-out needs no word from the host.
//!
//! Matrices of samples are feature-major, as the environment's own buffers are: entry `row` of column `k` is at
//! `row * stride + k`. A step's columns begin at multiples of four; where the number of environments is none, the columns
//! between are idle.

mod buffers;
mod dense;
mod kernels;
mod learn;
mod network;
mod read;
mod rollout;
mod sizes;
#[cfg(test)]
mod testing;
#[cfg(test)]
mod tests;
mod tile;

pub use buffers::{ALL_FINITE, RolloutBuffers};
pub use learn::{DeviceLearner, Layout, LearnMemory, Settings};
pub use rollout::DeviceRollout;
pub use sizes::Sizes;
pub use tile::Tile;
