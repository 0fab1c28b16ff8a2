//! Work that is ready for the device.

use std::sync::PoisonError;

use crate::batch::Batch;
use crate::error::GpuError;
use crate::gpu::Gpu;
use crate::transfer::Read;

/// A batch made ready: handing it to the device costs little. Made by [`Batch::finish`], best while the device is busy with
/// something else.
#[derive(Debug)]
pub struct Commands {
    gpu: Gpu,
    raw: wgpu::CommandBuffer,
}

/// Work that the device has.
#[derive(Clone, Debug)]
pub struct Submitted {
    gpu: Gpu,
    index: wgpu::SubmissionIndex,
}

impl Batch {
    /// Makes the work ready, which for many kernels takes longer than handing it over.
    ///
    /// # Errors
    /// What was wrong with any of the calls, no memory left, or device lost.
    pub fn finish(self) -> Result<Commands, GpuError> {
        let (gpu, encoder) = self.close()?;
        let raw = gpu.guarded(|| encoder.finish()).map_err(|fault| fault.during("a batch"))?;
        Ok(Commands { gpu, raw })
    }
}

impl Commands {
    /// Hands the work to the device and returns at once.
    ///
    /// # Errors
    /// No memory left, or device lost.
    pub fn submit(self) -> Result<Submitted, GpuError> {
        let Self { gpu, raw } = self;
        let index = gpu.guarded(|| gpu.queue().submit([raw])).map_err(|fault| fault.during("a batch"))?;
        Ok(Submitted { gpu, index })
    }

    /// Hands the work to the device together with reading some buffers, does something else meanwhile, and waits.
    /// `meanwhile` must not read from the device.
    ///
    /// # Errors
    /// As for [`submit`](Self::submit).
    pub fn submit_and_read<T>(self, reads: &mut [Read<'_>], meanwhile: impl FnOnce() -> T) -> Result<T, GpuError> {
        let Self { gpu, raw } = self;
        let copies = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("copies") });
        let mut staging = gpu.staging().lock().unwrap_or_else(PoisonError::into_inner);
        staging.run(&gpu, Some(raw), copies, reads, meanwhile).map_err(|fault| fault.during("a batch"))
    }
}

impl Submitted {
    /// Waits until the device has done this work, whatever it got after it.
    ///
    /// # Errors
    /// [`GpuError::DeviceLost`].
    pub fn wait(&self) -> Result<(), GpuError> {
        self.gpu.wait_for(Some(self.index.clone()))
    }
}
