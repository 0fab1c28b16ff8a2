//! How much memory environments take on a card, and whether there is so much.

use crate::config::BuildError;
use crate::memory;
use crate::record::RESULT_ROWS;
use crate::storage::WORDS;
use crate::vector::EnvSpec;
use myo_gpu::{AdapterKind, Gpu, GpuError};

/// Least size (bytes) that every card allows one buffer to have.
const PORTABLE_BUFFER: usize = 128 << 20;

/// Numbers of each environment on the device: of its state, and of its task where that is its own.
#[derive(Clone, Copy, Debug)]
pub struct Counts {
    /// Of the state.
    pub state: usize,
    /// Of the task.
    pub task: usize,
}

/// Bytes on the device for each environment: state, task, actions, observations, summary, result, commands.
fn device_bytes(spec: &EnvSpec, counts: Counts) -> usize {
    let seen = 2 * spec.observation_size() + spec.action_size() + spec.episode_size();
    4 * (counts.state + counts.task + WORDS + seen + RESULT_ROWS + 2)
}

/// Refuses what the machine or the card has no memory for. How much of a card's memory is free shows only when it is used up.
pub fn check_memory(gpu: &Gpu, spec: &EnvSpec, counts: Counts) -> Result<(), BuildError> {
    let (adapter, each) = (gpu.adapter(), device_bytes(spec, counts));
    let each = each * gpu.groups();
    let is_software = adapter.kind == AdapterKind::Software;
    memory::check(spec.num_envs, spec.bytes_per_env() + if is_software { each } else { 0 })?;
    let memory = adapter.memory_bytes.filter(|_| !is_software);
    check_device(spec.num_envs, each, memory, &adapter.name)
}

/// Refuses what is more than all memory that a card has, if that is known.
fn check_device(num_envs: usize, bytes_each: usize, memory: Option<u64>, device: &str) -> Result<(), BuildError> {
    let bytes = num_envs as u64 * bytes_each as u64;
    match memory {
        Some(memory) if bytes > memory => Err(BuildError::OutOfGpuMemory {
            num_envs,
            bytes,
            device: device.to_owned(),
            refusal: GpuError::OutOfMemory { what: format!("it has {memory} bytes") },
        }),
        _ => Ok(()),
    }
}

/// Says for how many environments the memory of the card was wanted.
pub fn without_memory(error: GpuError, gpu: &Gpu, spec: &EnvSpec, counts: Counts) -> BuildError {
    match error {
        GpuError::OutOfMemory { .. } | GpuError::TooLarge { .. } => BuildError::OutOfGpuMemory {
            num_envs: spec.num_envs,
            bytes: (spec.num_envs * gpu.groups()) as u64 * device_bytes(spec, counts) as u64,
            device: gpu.adapter().name.clone(),
            refusal: error,
        },
        other => other.into(),
    }
}

/// Environments whose widest buffer every card allows: a power of two.
pub fn portable_envs(spec: &EnvSpec, counts: Counts) -> usize {
    let widest =
        counts.state.max(counts.task).max(spec.observation_size()).max(spec.action_size()).max(spec.episode_size());
    1 << (PORTABLE_BUFFER / (4 * widest)).ilog2()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_than_a_card_has_is_refused_with_both_sizes_before_any_of_it_is_taken() {
        let check = |num_envs, memory| check_device(num_envs, 1000, memory, "Card").map_err(|error| error.to_string());
        let sentence =
            "1001 environments need 1001000 bytes on Card: the GPU is out of memory (it has 1000000 bytes); take fewer";
        assert_eq!(check(1001, Some(1_000_000)), Err(sentence.to_owned()));
        assert_eq!(check(1000, Some(1_000_000)), Ok(()));
        assert_eq!(check(1 << 31, None), Ok(()));
    }
}
