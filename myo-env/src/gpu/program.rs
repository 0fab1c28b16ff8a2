//! Recorded programs as kernels, and the buffers that they run on.
//!
//! Kernels run unchecked, so nothing here hands one out: all that can be done with it is to bind it, which looks at the size
//! of every buffer, and to run what was bound.

use crate::config::BuildError;
use myo_gpu::{Access, Batch, Bindings, Buffer, BufferRef, Cached, Gpu, GpuError, Kernel, Source};
use myo_scalar::symbolic::print::{ENTRY_POINT, Use};
use myo_scalar::symbolic::{Entries, Program};

/// Operations above which a driver takes minutes, whatever the form: Mesa's software driver took a quarter of an hour for a body of 1,560 muscles. An arm
/// with all its fingers needs 26,116 for a person, which an H200 is ready for in 17 s. Its driver (580) broke down over 28,256 and 29,118 of that
/// body with the reset in the same kernel, though not over 31,912 for a user without noise and costs. Why is not known.
const MAX_OPERATIONS: usize = 40_000;

/// A kernel, the constants that it looks up, and what it touches in each of its buffers.
#[derive(Clone, Debug)]
pub(crate) struct Compiled {
    kernel: Kernel,
    table: Option<Buffer<f32>>,
    entries: Vec<Entries>,
}

/// A kernel with buffers for a number of environments.
#[derive(Clone, Debug)]
pub(crate) struct Bound {
    kernel: Kernel,
    bindings: Bindings,
    num_envs: u32,
}

/// Refuses what would take a driver minutes.
pub(crate) fn check_size(program: &Program) -> Result<(), BuildError> {
    let (operations, most) = (program.operations(), MAX_OPERATIONS);
    if operations <= most { Ok(()) } else { Err(BuildError::TooLargeForGpu { operations, most }) }
}

/// Threads of a workgroup: as many as a device runs as one, 32 to 64. In workgroups of two such subgroups NVIDIA's driver (580) gives
/// kernels of 22,000 operations 32 registers instead of 255, and they take 2.4 times as long (`docs/performance.md`).
fn workgroup(min_subgroup_threads: u32) -> u32 {
    min_subgroup_threads.clamp(32, 64)
}

/// A device that is lost as its driver compiles was not lost by anybody else's doing.
fn broke_down(error: GpuError, operations: usize) -> BuildError {
    match error {
        GpuError::DeviceLost { reason } => BuildError::DriverBrokeDown { operations, reason },
        other => other.into(),
    }
}

impl Compiled {
    /// Compiles a program for its buffers, its table and the number of environments.
    pub fn new(gpu: &Gpu, label: &str, program: &Program, names: &[&str]) -> Result<Self, BuildError> {
        check_size(program)?;
        let entries = (0..names.len()).map(|binding| program.entries(binding as u32)).collect();
        let printed = program.to_kernel(names, workgroup(gpu.adapter().min_subgroup_threads));
        let access = |used: &Use| match used {
            Use::Read | Use::Table => Access::Read,
            Use::Write => Access::ReadWrite,
            Use::Environments => Access::Uniform,
        };
        let bindings: Vec<Access> = printed.bindings.iter().map(access).collect();
        let source = Source::Naga(Box::new(printed.module));
        // SAFETY: recorded programs access entry `row * environments + env` of a buffer, with `env` below the number of
        // environments, or entry `row`; `bind` sees to it that all rows are there. They look up entries of their own table,
        // which is written once, below; their loops have constant bounds or one of that table, and they divide no integers.
        // The kernel does not leave this file.
        let kernel = unsafe { gpu.compile_trusted(label, source, ENTRY_POINT, &bindings) }
            .map_err(|error| broke_down(error, program.operations()))?;
        let table = match &printed.table[..] {
            [] => None,
            constants => {
                let table = gpu.buffer("table", constants.len())?;
                gpu.write(&table, 0, constants)?;
                Some(table)
            }
        };
        Ok(Self { kernel, table, entries })
    }

    /// Whether the kernel was found on disk or is there now.
    pub fn cached(&self) -> &Cached {
        self.kernel.cached()
    }

    /// Binds the program's buffers, all of elements of 4 bytes, for so many environments.
    ///
    /// # Errors
    /// A buffer is too small, there are too few or too many of them, or the device is lost.
    pub fn bind(&self, gpu: &Gpu, buffers: &[BufferRef<'_>], num_envs: u32) -> Result<Bound, GpuError> {
        for (buffer, entries) in buffers.iter().zip(&self.entries) {
            let (has, needs) = (buffer.bytes() / 4, entries.needed(num_envs));
            if has < needs {
                let reason =
                    format!("buffer {} has {has} entries, {num_envs} environments need {needs}", buffer.label());
                return Err(GpuError::Bind { kernel: self.kernel.label().to_owned(), reason });
            }
        }
        let environments = gpu.buffer("environments", 1)?;
        gpu.write(&environments, 0, &[num_envs])?;
        let table = self.table.as_ref().map(Buffer::binding);
        let all: Vec<BufferRef<'_>> = buffers.iter().copied().chain(table).chain([environments.binding()]).collect();
        Ok(Bound { kernel: self.kernel.clone(), bindings: self.kernel.bind(&all)?, num_envs })
    }
}

impl Bound {
    /// Adds a run for all environments to a batch.
    pub fn dispatch(&self, batch: &mut Batch) {
        batch.dispatch(&self.kernel, &self.bindings, self.num_envs);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_workgroup_is_one_subgroup() {
        let [nvidia, amd_before_rdna, software] = [32, 64, 8].map(workgroup);
        assert_eq!([nvidia, amd_before_rdna, software], [32, 64, 32]);
    }

    #[test]
    fn a_device_that_is_lost_as_it_compiles_was_lost_to_the_kernel() {
        let lost = broke_down(GpuError::DeviceLost { reason: "unknown".into() }, 32_232).to_string();
        assert!(lost.contains("32232 operations") && lost.contains("(unknown)") && lost.contains("cpu"), "{lost}");
        let other = GpuError::Kernel { kernel: "reset".into(), reason: "no entry point".into() };
        assert_eq!(broke_down(other.clone(), 9).to_string(), other.to_string());
    }
}
