//! Large requests for memory, refused where they cannot be met.

use crate::config::BuildError;

/// Most environments of one batch: their numbers are integers of 32 bits, of which one bit tells how episodes begin.
pub const MOST_ENVS: usize = 1 << 31;

/// Refuses numbers of environments that the machine has no memory for, at so many bytes each.
///
/// # Errors
/// [`BuildError::TooManyEnvironments`] or [`BuildError::OutOfMemory`].
pub fn check(num_envs: usize, bytes_each: usize) -> Result<(), BuildError> {
    if num_envs > MOST_ENVS {
        return Err(BuildError::TooManyEnvironments { num_envs });
    }
    let bytes = num_envs as u64 * bytes_each as u64;
    match available() {
        Some(available) if bytes > available => {
            Err(BuildError::OutOfMemory { num_envs, bytes, available: Some(available) })
        }
        _ => Ok(()),
    }
}

/// Zeros for `num_envs` environments, together `len` numbers.
///
/// # Errors
/// [`BuildError::OutOfMemory`].
pub fn zeros<T: Clone + Default>(num_envs: usize, len: usize) -> Result<Vec<T>, BuildError> {
    let mut zeros = Vec::new();
    zeros.try_reserve_exact(len).map_err(|_| BuildError::OutOfMemory {
        num_envs,
        bytes: (len as u64).saturating_mul(size_of::<T>() as u64),
        available: available(),
    })?;
    zeros.resize(len, T::default());
    Ok(zeros)
}

/// Bytes that programs can still have, as far as the system says so: Linux lets programs ask for more than there is and
/// ends them when they use it.
fn available() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let kibibytes = |name: &str| -> Option<u64> {
        let line = text.lines().find_map(|line| line.strip_prefix(name))?;
        line.trim_start_matches(':').trim().trim_end_matches("kB").trim().parse().ok()
    };
    Some(1024 * (kibibytes("MemAvailable")? + kibibytes("SwapFree").unwrap_or(0)))
}
