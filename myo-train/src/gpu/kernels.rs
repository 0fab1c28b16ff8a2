//! The small kernels around the networks: noise, observations, outcomes, sums.

use myo_gpu::{Access, BufferRef, Gpu, GpuError, Kernel, Source};

use super::dense::Dispatch;

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
    /// Compiles them.
    ///
    /// # Errors
    /// The card refuses one, or is lost.
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        use Access::{Read, ReadWrite, Uniform};
        let compile = |label, text, access: &[Access]| gpu.compile(label, Source::Wgsl(text), "main", access);
        let observe = [Read, Read, Read, Read, ReadWrite, ReadWrite, ReadWrite, Uniform];
        let outcome = [Read, Read, ReadWrite, ReadWrite, ReadWrite, Uniform];
        Ok(Self {
            gpu: gpu.clone(),
            noise: compile("noise", include_str!("noise.wgsl"), &[Read, Read, ReadWrite, ReadWrite, Uniform])?,
            observe: compile("observe", include_str!("observe.wgsl"), &observe)?,
            outcome: compile("outcome", include_str!("outcome.wgsl"), &outcome)?,
            sums: compile("sums", include_str!("sums.wgsl"), &[Read, ReadWrite, Uniform])?,
        })
    }

    /// Prepares a kernel for these buffers and the words of its uniform `Shape`.
    pub fn prepare(
        &self,
        kernel: &Kernel,
        buffers: &[BufferRef<'_>],
        shape: &[u32],
        threads: usize,
    ) -> Result<Dispatch, GpuError> {
        // Uniforms come in vectors of four words.
        let uniform = self.gpu.buffer("shape", shape.len().next_multiple_of(4))?;
        self.gpu.write(&uniform, 0, shape)?;
        let buffers: Vec<_> = buffers.iter().copied().chain([uniform.binding()]).collect();
        Ok(Dispatch { kernel: kernel.clone(), bindings: kernel.bind(&buffers)?, threads: threads as u32 })
    }
}
