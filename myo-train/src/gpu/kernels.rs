//! The small kernels around the networks: noise, observations, outcomes, sums.

use myo_gpu::{Access, Buffer, BufferRef, Gpu, GpuError, Kernel, Recipe};

use super::dense::Dispatch;
use super::noise;

/// Environments of one workgroup that keeps observations.
pub const OBSERVE_WORKGROUP: usize = 256;

/// Compiled kernels.
#[derive(Debug)]
pub struct Kernels {
    gpu: Gpu,
    /// Draws the noise of a whole roll-out.
    pub noise: Kernel,
    /// Keeps observations, normalised.
    pub observe: Kernel,
    /// Keeps rewards and what ended.
    pub outcome: Kernel,
    /// Sums of rows.
    pub sums: Kernel,
}

impl Kernels {
    /// Compiles them, unless they are there.
    ///
    /// # Errors
    /// The card refuses one, or is lost.
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let [noise, observe, outcome, sums] = recipes().each_ref().map(|recipe| gpu.kernel(recipe));
        Ok(Self { gpu: gpu.clone(), noise: noise?, observe: observe?, outcome: outcome?, sums: sums? })
    }

    /// Prepares one of them; see [`prepare`].
    ///
    /// # Errors
    /// As for [`prepare`].
    pub fn prepare(
        &self,
        kernel: &Kernel,
        buffers: &[BufferRef<'_>],
        shape: &[u32],
        threads: usize,
    ) -> Result<Dispatch, GpuError> {
        prepare(&self.gpu, kernel, buffers, shape, threads)
    }
}

/// What they are compiled from: noise, observations, outcomes, sums.
pub fn recipes() -> [Recipe; 4] {
    use Access::{Read, ReadWrite, Uniform};
    let outcome = [Read, ReadWrite, ReadWrite, ReadWrite, Uniform];
    [
        Recipe::new("noise", noise::text(), [Read, Read, ReadWrite, ReadWrite, ReadWrite, Uniform]),
        observe(),
        Recipe::new("outcome", include_str!("outcome.wgsl"), outcome),
        sums(),
    ]
}

/// Keeps observations, normalised.
pub fn observe() -> Recipe {
    use Access::{Read, ReadWrite, Uniform};
    let access = [Read, Read, Read, Read, ReadWrite, ReadWrite, ReadWrite, Uniform];
    Recipe::new("observe", include_str!("observe.wgsl"), access)
}

/// Sums of rows.
pub fn sums() -> Recipe {
    use Access::{Read, ReadWrite, Uniform};
    Recipe::new("sums", SUMS, [Read, ReadWrite, Uniform])
}

pub(super) const SUMS: &str = concat!(include_str!("sums.wgsl"), include_str!("workgroup_sum.wgsl"));

/// Prepares a kernel for these buffers and the words of its uniform `Shape`, which is bound last.
///
/// # Errors
/// The kernel has other bindings, there is no memory left, or the card is lost.
pub fn prepare(
    gpu: &Gpu,
    kernel: &Kernel,
    buffers: &[BufferRef<'_>],
    shape: &[u32],
    threads: usize,
) -> Result<Dispatch, GpuError> {
    // Uniforms come in vectors of four words.
    let uniform = gpu.buffer("shape", shape.len().next_multiple_of(4))?;
    gpu.write(&uniform, 0, shape)?;
    let buffers: Vec<_> = buffers.iter().copied().chain([uniform.binding()]).collect();
    Ok(Dispatch { kernel: kernel.clone(), bindings: kernel.bind(&buffers)?, threads: threads as u32 })
}

/// A table of eight words a row.
///
/// # Errors
/// There is no memory left, or the card is lost.
pub fn table(gpu: &Gpu, label: &str, rows: &[[u32; 8]]) -> Result<Buffer<u32>, GpuError> {
    let table = gpu.buffer(label, 8 * rows.len())?;
    gpu.write(&table, 0, rows.as_flattened())?;
    Ok(table)
}
