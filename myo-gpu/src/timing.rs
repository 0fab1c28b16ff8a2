//! How long kernels run, by the device's own clock.

use crate::batch::Batch;
use crate::error::GpuError;
use crate::gpu::Gpu;
use crate::kernel::Kernel;
use crate::transfer::Read;

/// Dispatches of one batch that can be timed.
pub const MAX_TIMED: usize = wgpu::QUERY_SET_MAX_QUERIES as usize / 2;

/// How long one dispatch ran.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Timing {
    /// Label of its kernel.
    pub kernel: String,
    /// From its first thread to its last, in seconds.
    pub seconds: f64,
}

impl Batch {
    /// Times the dispatches that follow, the first [`MAX_TIMED`] of them. They run one by one, a little slower.
    ///
    /// # Errors
    /// [`GpuError::NoClock`] where the device has none, device lost.
    pub fn timed(mut self) -> Result<Self, GpuError> {
        self.timer = Some(Timer::new(&self.gpu)?);
        Ok(self)
    }

    /// Hands the work to the device, waits for it, and says how long each timed dispatch took, in order.
    ///
    /// # Errors
    /// As for [`submit`](Self::submit).
    pub fn submit_and_time(mut self) -> Result<Vec<Timing>, GpuError> {
        let Some(timer) = self.timer.take().filter(|timer| !timer.kernels.is_empty()) else {
            return self.submit_and_read(&mut []).map(|()| Vec::new());
        };
        self.end_pass();
        self.encoder.resolve_query_set(&timer.queries, 0..2 * timer.kernels.len() as u32, &timer.resolved, 0);
        let mut ticks = vec![[0u64; 2]; timer.kernels.len()];
        let tick_s = f64::from(self.gpu.queue().get_timestamp_period()) * 1e-9;
        self.submit_and_read(&mut [Read::all(&timer.resolved, bytemuck::cast_slice_mut(&mut ticks))])?;
        let seconds = ticks.iter().map(|[start, end]| end.saturating_sub(*start) as f64 * tick_s);
        Ok(timer.kernels.into_iter().zip(seconds).map(|(kernel, seconds)| Timing { kernel, seconds }).collect())
    }
}

/// Where the device notes its clock.
#[derive(Debug)]
pub(crate) struct Timer {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    kernels: Vec<String>,
}

impl Timer {
    fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        if !gpu.features().contains(wgpu::Features::TIMESTAMP_QUERY) {
            return Err(GpuError::NoClock { adapter: gpu.adapter().name.clone() });
        }
        let (ty, count) = (wgpu::QueryType::Timestamp, wgpu::QUERY_SET_MAX_QUERIES);
        let size = u64::from(count) * u64::from(wgpu::QUERY_SIZE);
        let usage = wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC;
        gpu.guarded(|| Self {
            queries: gpu.device().create_query_set(&wgpu::QuerySetDescriptor { label: None, ty, count }),
            resolved: gpu.device().create_buffer(&wgpu::BufferDescriptor {
                label: Some("ticks"),
                size,
                usage,
                mapped_at_creation: false,
            }),
            kernels: Vec::new(),
        })
        .map_err(|fault| fault.during("timing"))
    }

    /// The two marks of the next dispatch, while there are some.
    pub fn next(&mut self, kernel: &Kernel) -> Option<wgpu::ComputePassTimestampWrites<'_>> {
        let mark = 2 * self.kernels.len() as u32;
        (self.kernels.len() < MAX_TIMED).then(|| {
            self.kernels.push(kernel.label().to_owned());
            wgpu::ComputePassTimestampWrites {
                query_set: &self.queries,
                beginning_of_pass_write_index: Some(mark),
                end_of_pass_write_index: Some(mark + 1),
            }
        })
    }
}
