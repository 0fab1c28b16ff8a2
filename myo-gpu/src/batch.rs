//! Work for the device, in order.

use std::sync::PoisonError;

use bytemuck::Pod;

use crate::buffer::Buffer;
use crate::error::GpuError;
use crate::gpu::Gpu;
use crate::kernel::{Bindings, Kernel};
use crate::timing::Timer;
use crate::transfer::Read;

/// Kernels and copies that run one after the other, each seeing what those before it wrote, submitted at once.
///
/// Recording never fails; what was wrong comes out when the batch is submitted, and nothing of it has run then.
#[derive(Debug)]
pub struct Batch {
    pub(crate) gpu: Gpu,
    /// Open while kernel follows kernel. It must end before the encoder does.
    pass: Option<wgpu::ComputePass<'static>>,
    pub(crate) encoder: wgpu::CommandEncoder,
    pub(crate) timer: Option<Timer>,
    wrong: Option<GpuError>,
}

impl Gpu {
    /// An empty batch.
    pub fn batch(&self) -> Batch {
        let descriptor = wgpu::CommandEncoderDescriptor { label: Some("batch") };
        // On a lost device this encoder is of no use, which comes out when it is submitted.
        let encoder = self.device().create_command_encoder(&descriptor);
        Batch { gpu: self.clone(), pass: None, encoder, timer: None, wrong: None }
    }
}

impl Batch {
    /// Runs a kernel on at least `threads` threads, in whole workgroups of the size that the kernel states.
    ///
    /// Workgroups lie in a rectangle, so the kernel calculates the index of its thread as
    /// `(workgroup_id.y * num_workgroups.x + workgroup_id.x) * workgroup_size + local_invocation_index`
    /// and must return where that is `threads` or more.
    pub fn dispatch(&mut self, kernel: &Kernel, bindings: &Bindings, threads: u32) -> &mut Self {
        let most = self.gpu.limits().max_compute_workgroups_per_dimension;
        let active = self.gpu.groups.as_ref().map(|groups| groups.active.clone()).filter(|_| kernel.0.in_groups);
        if kernel.0.in_groups && active.is_none() {
            let reason = "it is a kernel for groups, in a batch of none".into();
            self.remember(GpuError::Bind { kernel: kernel.label().to_owned(), reason });
            return self;
        }
        let [x, y] = grid(threads.div_ceil(kernel.workgroup_size()), most);
        let z = active.as_ref().map_or(1, |active| active.list.len() as u32);
        if x > 0 && z > 0 {
            let pass = self.pass(kernel);
            pass.set_pipeline(&kernel.0.pipeline);
            pass.set_bind_group(0, &bindings.0, &[]);
            if let Some(active) = &active {
                pass.set_bind_group(1, &active.bindings, &[]);
            }
            pass.dispatch_workgroups(x, y, z);
        }
        self
    }

    /// Copies `count` elements from one buffer to another; for every group that the batch runs for, from its part to its part.
    pub fn copy<T: Pod>(
        &mut self,
        from: &Buffer<T>,
        from_offset: usize,
        to: &Buffer<T>,
        to_offset: usize,
        count: usize,
    ) -> &mut Self {
        match (from.bytes(from_offset, count), to.bytes(to_offset, count)) {
            (Ok(source), Ok(target)) => {
                self.end_pass();
                let size = target.end - target.start;
                let groups = self.gpu.groups.as_ref().map_or_else(|| [0].into(), |groups| groups.active.list.clone());
                for &group in &*groups {
                    let [read, write] = [from.parts(), to.parts()].map(|parts| parts.start(group));
                    let (read, write) = (read + source.start, write + target.start);
                    self.encoder.copy_buffer_to_buffer(from.raw(), read, to.raw(), write, size);
                }
            }
            (Err(wrong), _) | (_, Err(wrong)) => self.remember(wrong),
        }
        self
    }

    /// Hands the work to the device and returns at once.
    ///
    /// # Errors
    /// What was wrong with any of the calls above, no memory left, or device lost.
    pub fn submit(self) -> Result<(), GpuError> {
        self.finish()?.submit().map(drop)
    }

    /// Hands the work to the device together with reading some buffers, and waits for both: one wait instead of two.
    ///
    /// # Errors
    /// As for [`submit`](Self::submit).
    pub fn submit_and_read(self, reads: &mut [Read<'_>]) -> Result<(), GpuError> {
        let (gpu, encoder) = self.close()?;
        let mut staging = gpu.staging().lock().unwrap_or_else(PoisonError::into_inner);
        staging.run(&gpu, None, encoder, reads, || ()).map_err(|fault| fault.during("a batch"))
    }

    /// The open pass, or a new one for each kernel that is timed.
    fn pass(&mut self, kernel: &Kernel) -> &mut wgpu::ComputePass<'static> {
        if self.timer.is_some() {
            self.end_pass();
        }
        let Self { encoder, pass, timer, .. } = self;
        pass.get_or_insert_with(|| {
            let timestamp_writes = timer.as_mut().and_then(|timer| timer.next(kernel));
            let descriptor = wgpu::ComputePassDescriptor { label: Some(kernel.label()), timestamp_writes };
            encoder.begin_compute_pass(&descriptor).forget_lifetime()
        })
    }

    pub(crate) fn end_pass(&mut self) {
        let pass = self.pass.take();
        if let Err(fault) = self.gpu.guarded(|| drop(pass)) {
            self.remember(fault.during("a batch"));
        }
    }

    /// The first mistake is the one to report.
    fn remember(&mut self, wrong: GpuError) {
        self.wrong.get_or_insert(wrong);
    }

    pub(crate) fn close(mut self) -> Result<(Gpu, wgpu::CommandEncoder), GpuError> {
        self.end_pass();
        match self.wrong {
            Some(wrong) => Err(wrong),
            None => Ok((self.gpu, self.encoder)),
        }
    }
}

/// The least rectangle of at least `groups` workgroups with no side over `most`.
fn grid(groups: u32, most: u32) -> [u32; 2] {
    let y = groups.div_ceil(most);
    [groups.div_ceil(y.max(1)), y]
}

#[cfg(test)]
mod tests {
    use super::grid;

    #[test]
    fn a_grid_holds_all_groups_and_few_more() {
        for groups in [0, 1, 2, 65_535, 65_536, 65_537, 131_071, 1 << 20, (1 << 26) + 1, u32::MAX] {
            let [x, y] = grid(groups, 65_535).map(u64::from);
            assert!(x * y >= u64::from(groups) && x * y < u64::from(groups) + y.max(1), "{groups}: {x} x {y}");
            assert!(x <= 65_535 || groups == u32::MAX);
        }
        assert_eq!(grid(0, 65_535)[0], 0);
        assert_eq!(grid(65_535, 65_535), [65_535, 1]);
    }
}
