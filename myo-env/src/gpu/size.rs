//! How much memory environments take on a card, and whether there is so much.

use super::record::RESULT_ROWS;
use crate::config::BuildError;
use crate::memory;
use crate::storage::WORDS;
use crate::vector::EnvSpec;
use myo_gpu::{Gpu, GpuError, Kind};

/// Least size (bytes) that every card allows one buffer to have.
const PORTABLE_BUFFER: usize = 128 << 20;

/// Bytes on the device for each environment: state, actions, observations, summary, result, command.
fn device_bytes(spec: &EnvSpec, count: usize) -> usize {
    let seen = 2 * spec.observation_size() + spec.action_size() + spec.episode_size();
    4 * (count + WORDS + seen + RESULT_ROWS + 1)
}

/// Refuses what the machine has no memory for. How much a card has shows only when it is used up.
pub fn check_memory(gpu: &Gpu, spec: &EnvSpec, count: usize) -> Result<(), BuildError> {
    let on_host = if gpu.adapter().kind == Kind::Software { device_bytes(spec, count) } else { 0 };
    memory::check(spec.num_envs, on_host + spec.bytes_per_env())
}

/// Says for how many environments the memory of the card was wanted.
pub fn without_memory(error: GpuError, gpu: &Gpu, spec: &EnvSpec, count: usize) -> BuildError {
    match error {
        GpuError::OutOfMemory { .. } | GpuError::TooLarge { .. } => BuildError::OutOfGpuMemory {
            num_envs: spec.num_envs,
            bytes: spec.num_envs as u64 * device_bytes(spec, count) as u64,
            device: gpu.adapter().name.clone(),
            refusal: error,
        },
        other => other.into(),
    }
}

/// Environments whose widest buffer every card allows: a power of two.
pub fn portable_envs(spec: &EnvSpec, count: usize) -> usize {
    let widest = count.max(spec.observation_size()).max(spec.action_size()).max(spec.episode_size());
    1 << (PORTABLE_BUFFER / (4 * widest)).ilog2()
}
